/// The scenes on which accuracy is weighed against cost: those of other applications, and the one of the study's file.
#pragma once

#include "apps/common/application.hpp"

#include <string>
#include <vector>

namespace mixbeam {

struct Benchmark {
  std::string name;         ///< in tables and files: snake_case
  std::string file;         ///< scene, in the folder trade_benchmarks beside the program; empty: the study's own scene
  std::string kind;         ///< a few words: plane or space, smooth or kinked, slender or thick
  std::string point;        ///< whose displacement is judged; empty: the first loaded point
  std::string load_case;    ///< of the file
  double load_share = 1.0;  ///< of the point loads of the file: a fixed load short of where the path turns
  Branch branch = Branch::primary;        ///< where the load is beyond a bifurcation; else what the file says
  std::vector<ExpectedValue> limit = {};  ///< in place of the file's values, where these are those of a coarse mesh
  bool integrations = false;              ///< measured with force strains fully integrated too
  bool rates = false;                     ///< smooth, and every order converges as theory says: checked
};

const std::vector<Benchmark>& all_benchmarks();
std::vector<std::string> benchmark_names();

/// A benchmark, ready to be solved on any mesh.
struct BenchmarkProblem {
  Benchmark about;
  Scene scene;  ///< of one load case
  SolverParameters solver;
  std::vector<ExpectedValue> expected;  ///< those that belong to the end of the path

  /// Every member with this mesh and integration.
  Scene with(int order, int elements, ForceIntegration integration) const;
};

/// Reads the scene file. Stability is looked at only where a branch is to be followed: it would cost as much as the
/// solve, and tells nothing about accuracy.
BenchmarkProblem read_benchmark(const Application& app, const Benchmark& benchmark);

}  // namespace mixbeam
