#include "apps/trade/reference.hpp"

#include "discretization/state/sampling.hpp"
#include "discretization/text/errors.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

/// More than the k + 1 that are exact for what an element can represent: the reference is no such polynomial.
constexpr int kMoreGaussPoints = 4;
/// Steps end at load factors that are asked for, but for rounding.
constexpr double kSameLoad = 1e-12;

double distance(const Vector3& a, const Vector3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

double energy_of(const Simulation& simulation) {
  const StrainEnergy energy = simulation.strain_energy();
  return energy.force + energy.moment;
}

int gauss_points(const Simulation& simulation) { return simulation.scene().members.front().order + kMoreGaussPoints; }

Simulation solved(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& mesh,
                  PathTrace& trace) {
  Simulation simulation(problem.with(mesh.order, mesh.elements, ForceIntegration::both_reduced), problem.solver,
                        communicator);
  simulation.run([&](const StepReport& report, const State&) { trace.add(simulation, report); });
  if (!simulation.result().finished)
    throw ConvergenceError("no reference for " + problem.about.name + ", order " + std::to_string(mesh.order) + ", " +
                           std::to_string(mesh.elements) + " elements for each member: " + simulation.result().failure);
  return simulation;
}

std::vector<std::string> judged_points(const BenchmarkProblem& problem, const Simulation& simulation) {
  if (!problem.about.in_gallery) return {problem.about.point};
  std::vector<std::string> points;
  for (const auto& [name, vertex] : simulation.model().mesh().vertex_of_point) points.push_back(name);
  return points;
}

double largest_displacement(const Simulation& simulation) {
  double largest = 0.0;
  for (int vertex = 0; vertex < simulation.model().mesh().vertices(); ++vertex) {
    const auto motion = vertex_motion(simulation.model(), simulation.state(), vertex);
    largest = std::max(largest, std::hypot(motion[0], motion[1], motion[2]));
  }
  return largest;
}

}  // namespace

double largest_error(const Errors& errors) {
  for (const double error : errors)
    if (std::isnan(error)) return error;
  return *std::max_element(errors.begin(), errors.end());
}

double motion_error(const Errors& errors) {
  return std::isnan(errors[kDisplacement]) ? std::nan("") : std::max(errors[kDisplacement], errors[kCenterline]);
}

Errors estimated_errors(const Simulation& simulation, const std::string& point) {
  const ErrorEstimate estimate = simulation.estimate_error();
  if (!estimate.exists()) return kNoErrors;
  const Vector3 error = estimate.vertex_displacement.at(vertex_of(simulation.model().mesh(), point));
  return {distance(error, {}) / distance(simulation.displacement(point), {}), estimate.displacement.relative(),
          estimate.moment.relative(), std::abs(estimate.energy.relative())};
}

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
  for (size_t i = 0; i < displacements_.size(); ++i)
    error = std::max(error, distance(displacements_[i], exact.displacements_[i]) / displacement);
  return error;
}

Reference::Reference(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& reference,
                     const Discretization& confirmation)
    : trace_(problem),
      simulation_(solved(problem, communicator, reference, trace_)),
      points_(judged_points(problem, simulation_)) {
  const int points = gauss_points(simulation_);
  scale_[kDisplacement] = problem.about.in_gallery ? largest_displacement(simulation_)
                                                   : distance(simulation_.displacement(problem.about.point), {});
  scale_[kCenterline] = simulation_.l2_norm(points, [](const PointSample& sample, int) { return sample.displacement; });
  scale_[kMoment] = simulation_.l2_norm(points, [](const PointSample& sample, int) { return sample.moment; });
  scale_[kEnergy] = energy_of(simulation_);
  PathTrace trace(problem);
  difference_ = errors_of(solved(problem, communicator, confirmation, trace));
}

Errors Reference::errors_of(const Simulation& simulation) const {
  const int points = gauss_points(simulation);
  const auto exact = [&](const PointSample& sample, int member) {
    const double length = simulation_.model().mesh().members[member].curve.length;
    return sample_member(simulation_.model(), simulation_.state(), member, sample.arc_length / length);
  };
  Errors errors{};
  for (const std::string& point : points_)
    errors[kDisplacement] =
        std::max(errors[kDisplacement], distance(simulation.displacement(point), simulation_.displacement(point)));
  errors[kCenterline] = simulation.l2_norm(points, [&](const PointSample& sample, int member) {
    return sample.displacement - exact(sample, member).displacement;
  });
  errors[kMoment] = simulation.l2_norm(
      points, [&](const PointSample& sample, int member) { return sample.moment - exact(sample, member).moment; });
  errors[kEnergy] = std::abs(energy_of(simulation) - scale_[kEnergy]);
  for (int i = 0; i < kErrors; ++i) errors[i] /= scale_[i];
  return errors;
}

}  // namespace mixbeam
