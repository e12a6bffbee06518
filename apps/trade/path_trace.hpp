/// What a path met on its way to the end: critical points, and states for which the scene has expected values.
#pragma once

#include "apps/trade/benchmark.hpp"

#include <vector>

namespace mixbeam {

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

}  // namespace mixbeam
