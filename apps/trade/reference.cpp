#include "apps/trade/reference.hpp"

#include "discretization/errors.hpp"

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

Simulation solved(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& mesh) {
  Simulation simulation(problem.with(mesh.order, mesh.elements, ForceIntegration::both_reduced), problem.solver,
                        communicator);
  simulation.run();
  if (!simulation.result().finished)
    throw ConvergenceError("no reference for " + problem.about.name + ", order " + std::to_string(mesh.order) + ", " +
                           std::to_string(mesh.elements) + " elements for each member: " + simulation.result().failure);
  return simulation;
}

}  // namespace

double Errors::largest() const {
  if (std::isnan(displacement + centerline + moment + energy)) return std::nan("");
  return std::max({displacement, centerline, moment, energy});
}

Reference::Reference(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& reference,
                     const Discretization& confirmation)
    : point_(problem.about.point), simulation_(solved(problem, communicator, reference)) {
  const int points = gauss_points(simulation_);
  displacement_ = norm(vec(simulation_.displacement(point_)));
  centerline_ = simulation_.l2_norm(points, [](const PointSample& sample, int) { return sample.displacement; });
  moment_ = simulation_.l2_norm(points, [](const PointSample& sample, int) { return sample.moment; });
  energy_ = energy_of(simulation_);
  difference_ = errors_of(solved(problem, communicator, confirmation));
}

Errors Reference::errors_of(const Simulation& simulation) const {
  const int points = gauss_points(simulation);
  const auto& members = simulation_.assembler().mesh().members;
  const auto exact = [&](const PointSample& sample, int member) {
    const double length = members[member].curve.length;
    return sample_member(simulation_.assembler(), simulation_.state(), member, sample.arc_length / length);
  };
  Errors errors;
  errors.displacement =
      norm(vec(simulation.displacement(point_)) - vec(simulation_.displacement(point_))) / displacement_;
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
