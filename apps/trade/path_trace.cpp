#include "apps/trade/path_trace.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Steps end at load factors that are asked for, but for rounding.
constexpr double kSameLoad = 1e-12;

}  // namespace

PathTrace::PathTrace(const BenchmarkProblem& problem) {
  for (const ExpectedValue& value : problem.expected_on_path)
    if (!value.critical_point && !value.point.empty()) wanted_.push_back(value);
}

void PathTrace::add(const Simulation& simulation, const StepReport& report) {
  for (const CriticalPoint& point : report.critical_points) critical_loads_.push_back(point.load_factor);
  for (const ExpectedValue& value : wanted_)
    if (std::abs(report.load_factor - *value.load_factor) <= kSameLoad)
      displacements_.push_back(simulation.displacement(value.point));
}

double PathTrace::error_against(const PathTrace& exact, double displacement) const {
  if (critical_loads_.size() != exact.critical_loads_.size() || displacements_.size() != exact.displacements_.size())
    return std::nan("");
  double size = 0.0, error = 0.0;
  for (const double load : exact.critical_loads_) size = std::max(size, std::abs(load));
  for (size_t i = 0; i < critical_loads_.size(); ++i)
    error = std::max(error, std::abs(critical_loads_[i] - exact.critical_loads_[i]) / size);
  for (size_t i = 0; i < displacements_.size(); ++i) {
    const Vector3 &here = displacements_[i], &there = exact.displacements_[i];
    error = std::max(error, std::hypot(here[0] - there[0], here[1] - there[1], here[2] - there[2]) / displacement);
  }
  return error;
}

}  // namespace mixbeam
