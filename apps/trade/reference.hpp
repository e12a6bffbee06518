/// What errors are measured against: a solution far finer than any that is judged, confirmed by another one.
#pragma once

#include "apps/trade/benchmark.hpp"

#include <cmath>

namespace mixbeam {

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

/// What a run estimates of its own error; not a number where it does not.
Errors estimated_errors(const Simulation& simulation, const std::string& point);

struct Discretization {
  int order = 0, elements = 0;
};

/// What a path met on its way to the end: critical points, and states for which the scene has expected values.
class PathTrace {
 public:
  explicit PathTrace(const BenchmarkProblem& problem);

  /// The next step of the path. Collective.
  void add(const Simulation& simulation, const StepReport& report);
  bool is_empty() const { return critical_loads_.empty() && displacements_.empty(); }
  /// Largest difference of the critical loads, over the largest of them, and of the displacements, over
  /// `displacement`; not a number where the paths met different things.
  double error_against(const PathTrace& exact, double displacement) const;

 private:
  std::vector<ExpectedValue> wanted_;   ///< short of the end
  std::vector<double> critical_loads_;  ///< load factors
  std::vector<Vector3> displacements_;  ///< of the points of `wanted_`, in the order of the path
};

class Reference {
 public:
  /// Solves on both meshes; the first is the reference, the second tells how far to trust it. Throws ConvergenceError.
  Reference(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& reference,
            const Discretization& confirmation);

  /// Of a simulation of the same scene on any mesh. Collective.
  Errors errors_of(const Simulation& simulation) const;
  /// Distance of the two solutions: errors as small as this are those of the reference.
  const Errors& difference() const { return difference_; }
  const Simulation& simulation() const { return simulation_; }
  /// What it met on its way.
  const PathTrace& trace() const { return trace_; }
  /// What errors of displacements are divided by.
  double displacement() const { return scale_[kDisplacement]; }

 private:
  PathTrace trace_;
  Simulation simulation_;
  std::vector<std::string> points_;  ///< whose displacements are judged
  Errors scale_{}, difference_{};
};

}  // namespace mixbeam
