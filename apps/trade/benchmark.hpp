/// The scenes on which accuracy is weighed against cost: those of other applications, the one of the study's file, and
/// the gallery.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

struct Benchmark {
  std::string name;         ///< in tables and files: snake_case
  std::string file;         ///< scene, in the folder trade_benchmarks beside the program; empty: the study's own scene
  std::string kind;         ///< a few words: plane or space, smooth or kinked, slender or thick
  std::string point;        ///< whose displacement is judged; empty: the first loaded point
  std::string load_case{};  ///< of the file
  double load_share = 1.0;  ///< of the loads of the file: a fixed load short of where the path turns
  Branch branch = Branch::primary;     ///< where the load is beyond a bifurcation; else what the file says
  std::vector<ExpectedValue> limit{};  ///< in place of the file's values, where these are those of a coarse mesh
  bool integrations = false;           ///< measured with force strains fully integrated too
  bool rates = false;                  ///< smooth, and every order converges as theory says: checked
  bool in_gallery = false;             ///< solved as its file says, stability and steps included; see all_scenes()
  int refinement = 0;                  ///< of a scene: elements of the reference for each one of its file
};

/// Those that every order is measured on, on meshes with as many elements in each member.
const std::vector<Benchmark>& all_benchmarks();
/// The scenes of the gallery, for the accuracy that is asked of the program: their errors are those of all points and
/// of the centerline. Elements of their members stay in the proportions of the file.
const std::vector<Benchmark>& all_scenes();

/// A benchmark, ready to be solved on any mesh.
struct BenchmarkProblem {
  Benchmark about;
  Scene scene;  ///< of one load case
  SolverParameters solver;
  std::vector<ExpectedValue> expected{};          ///< those that belong to the end of the path
  std::vector<ExpectedValue> expected_on_path{};  ///< of a scene of the gallery: the others

  /// On a mesh with so many elements in the finest member: in every one, or in proportion to the file, see
  /// Benchmark::in_gallery.
  Scene with(int order, int elements, ForceIntegration integration) const;
  /// Elements of the finest member in the file.
  int own_elements() const;
  /// Whether the program follows the path on the last mesh too when it is asked for an accuracy.
  bool keeps_path() const;
};

/// Reads the scene file. On the benchmarks stability is looked at only where a branch is to be followed: it would cost
/// as much as the solve, and tells nothing about accuracy.
BenchmarkProblem read_benchmark(const Application& app, const Benchmark& benchmark);

}  // namespace mixbeam
