#include "apps/trade/reference.hpp"

#include "discretization/state/sampling.hpp"
#include "discretization/text/errors.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// More than the k + 1 that are exact for what an element can represent: the reference is no such polynomial.
constexpr int kMoreGaussPoints = 4;

double norm(const Vec3<double>& v) { return std::hypot(v[0], v[1], v[2]); }
Vec3<double> vec(const Vector3& v) { return {{v[0], v[1], v[2]}}; }

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
  for (const auto& [name, vertex] : simulation.assembler().mesh().vertex_of_point) points.push_back(name);
  return points;
}

double largest_displacement(const Simulation& simulation) {
  double largest = 0.0;
  for (int vertex = 0; vertex < simulation.assembler().mesh().vertices(); ++vertex) {
    const auto motion = vertex_motion(simulation.assembler(), simulation.state(), vertex);
    largest = std::max(largest, std::hypot(motion[0], motion[1], motion[2]));
  }
  return largest;
}

}  // namespace

double Errors::largest() const {
  if (std::isnan(displacement + centerline + moment + energy)) return std::nan("");
  return std::max({displacement, centerline, moment, energy});
}

Reference::Reference(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& reference,
                     const Discretization& confirmation)
    : trace_(problem),
      simulation_(solved(problem, communicator, reference, trace_)),
      points_(judged_points(problem, simulation_)) {
  const int points = gauss_points(simulation_);
  displacement_ = problem.about.in_gallery ? largest_displacement(simulation_)
                                           : norm(vec(simulation_.displacement(problem.about.point)));
  centerline_ = simulation_.l2_norm(points, [](const PointSample& sample, int) { return sample.displacement; });
  moment_ = simulation_.l2_norm(points, [](const PointSample& sample, int) { return sample.moment; });
  energy_ = energy_of(simulation_);
  PathTrace trace(problem);
  difference_ = errors_of(solved(problem, communicator, confirmation, trace));
}

Errors Reference::errors_of(const Simulation& simulation) const {
  const int points = gauss_points(simulation);
  const auto& members = simulation_.assembler().mesh().members;
  const auto exact = [&](const PointSample& sample, int member) {
    const double length = members[member].curve.length;
    return sample_member(simulation_.assembler(), simulation_.state(), member, sample.arc_length / length);
  };
  Errors errors;
  for (const std::string& point : points_)
    errors.displacement =
        std::max(errors.displacement,
                 norm(vec(simulation.displacement(point)) - vec(simulation_.displacement(point))) / displacement_);
  errors.centerline = simulation.l2_norm(points, [&](const PointSample& sample, int member) {
    return sample.displacement - exact(sample, member).displacement;
  }) / centerline_;
  errors.moment = simulation.l2_norm(points, [&](const PointSample& sample, int member) {
    return sample.moment - exact(sample, member).moment;
  }) / moment_;
  errors.energy = std::abs(energy_of(simulation) - energy_) / energy_;
  return errors;
}

}  // namespace mixbeam
