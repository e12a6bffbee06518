/// The scenes on which accuracy is weighed against cost (those of other applications, the one of the study's file, and
/// the gallery), and what errors are measured against: a solution far finer than any that is judged, confirmed by
/// another one.
#pragma once

#include "apps/common/run/application.hpp"

#include <cmath>

namespace mixbeam {

/// A mesh: elements of order `order`, so many of them in each member or, see Benchmark::in_gallery, in the finest one.
struct Discretization {
  int order = 1, elements = 1;
  ForceIntegration integration = ForceIntegration::both_reduced;  ///< or full
};

struct Benchmark {
  std::string name;         ///< in tables and files: snake_case
  std::string file;         ///< scene, in the folder trade_benchmarks beside the program; empty: the study's own scene
  std::string kind;         ///< a few words: plane or space, smooth or kinked, slender or thick
  std::string point;        ///< whose displacement is judged; empty: the first loaded point
  std::string load_case{};  ///< of the file
  double load_share = 1.0;  ///< of the loads of the file: a fixed load short of where the path turns
  Branch branch = Branch::primary;  ///< where the load is beyond a bifurcation; else what the file says
  bool integrations = false;        ///< measured with force strains fully integrated too
  bool rates = false;               ///< smooth, and every order converges as theory says: checked
  bool in_gallery = false;          ///< solved as its file says, stability and steps included; see benchmarks_of()
  int refinement = 0;               ///< of a scene: elements of the reference for each one of its file
  const char* set() const { return in_gallery ? "gallery" : "matrix"; }
};

/// Those that every order is measured on, on meshes with as many elements in each member; or the scenes of the gallery,
/// for the accuracy that is asked of the program: their errors are those of all points and of the centerline, and
/// elements of their members stay in the proportions of the file.
std::vector<Benchmark> benchmarks_of(bool gallery);

/// All relative. Fields over the whole structure in the L2 norm.
enum ErrorOf {
  kDisplacement,  ///< of the judged point, over its displacement; in the gallery the largest of all points of the
                  ///< scene, over the largest displacement
  kCenterline,    ///< position of the centerline, over the norm of its displacement
  kMoment,        ///< material moment, over its norm
  kEnergy,        ///< strain energy
  kErrors
};
inline constexpr const char* kErrorNames[kErrors] = {"displacement", "centerline", "moment", "energy"};
using Errors = std::array<double, kErrors>;
/// Of a simulation that did not converge.
inline const Errors kNoErrors{std::nan(""), std::nan(""), std::nan(""), std::nan("")};
// Not a number if one of those is.
double largest_error(const Errors& errors);
double motion_error(const Errors& errors);  ///< of tip and centerline

/// A benchmark, ready to be solved on any mesh.
struct BenchmarkProblem {
  Benchmark about;
  Scene scene;  ///< of one load case
  SolverParameters solver;
  std::vector<ExpectedValue> expected{};          ///< those that belong to the end of the path
  std::vector<ExpectedValue> expected_on_path{};  ///< of a scene of the gallery: the others

  Scene with(const Discretization& mesh) const;
  /// Elements of the finest member in the file.
  int own_elements() const;
  /// Whether the program follows the path on the last mesh too when it is asked for an accuracy.
  bool keeps_path() const;
  /// The largest of the errors that are judged: in the gallery those of displacements only.
  double judged(const Errors& errors) const { return about.in_gallery ? motion_error(errors) : largest_error(errors); }
};

/// Reads the scene file. On the benchmarks stability is determined only where a branch is to be followed: it would cost
/// as much as the solve, and has no effect on accuracy.
BenchmarkProblem read_benchmark(const Application& app, const Benchmark& benchmark);

/// What a run estimates of its own error; not a number where it does not.
Errors estimated_errors(const Simulation& simulation, const std::string& point);

/// What a path met on its way to the end: critical points, and states for which the scene has expected values.
class PathTrace {
 public:
  explicit PathTrace(const BenchmarkProblem& problem);

  /// The next step of the path. Collective.
  void add(const Simulation& simulation, const StepReport& report);
  /// Largest difference of the critical loads, over the largest of them, and of the displacements, over
  /// `displacement`; not a number where the paths met different things, or nothing.
  double error_against(const PathTrace& exact, double displacement) const;

 private:
  std::vector<ExpectedValue> wanted_;   ///< short of the end
  std::vector<double> critical_loads_;  ///< load factors
  std::vector<Vector3> displacements_;  ///< of the points of `wanted_`, in the order of the path
};

struct Reference {
  /// Solves on both meshes; the first is the reference, the second gives the accuracy of the first. Throws
  /// ConvergenceError.
  Reference(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& reference,
            const Discretization& confirmation);
  /// Of a simulation of the same scene on any mesh. Collective.
  Errors errors_of(const Simulation& other) const;

  PathTrace trace;  ///< what it met on its way
  Simulation simulation;
  std::vector<std::string> points;  ///< whose displacements are judged
  Errors scale{};                   ///< what errors are divided by
  Errors difference{};              ///< of the two solutions: errors as small as this are those of the reference
};

}  // namespace mixbeam
