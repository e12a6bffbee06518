#include "nonlinear/simulation.hpp"

#include "kernels/execution_space.hpp"

namespace mixbeam {

Simulation::Simulation(const Scene& scene, const SolverParameters& parameters, const Communicator& comm)
    : parameters_(parameters) {
  if (parameters.threads > 0) set_number_of_threads(parameters.threads);
  problem_ = Teuchos::rcp(new BeamProblem(scene, comm, parameters));
  state_ = problem_->assembler.reference_state();
}

const LoadPathResult& Simulation::run(const PathObserver& observer, const PathControl& control) {
  const PathObserver remember = [&](const StepReport& report, const State& state) {
    load_factor_ = report.load_factor;
    if (observer) observer(report, state);
  };
  result_ = follow_load_path(problem_, parameters_, state_, remember, control);
  return result_;
}

void Simulation::restore(const StateSnapshot& snapshot, double load_factor) {
  state_ = mixbeam::restore(assembler(), snapshot);
  load_factor_ = load_factor;
}

std::array<double, 6> Simulation::motion(const std::string& point) const {
  return vertex_motion(assembler(), state_, vertex_of(assembler().mesh(), point));
}

Vector3 Simulation::displacement(const std::string& point) const {
  const auto m = motion(point);
  return {m[0], m[1], m[2]};
}

Vector3 Simulation::position(const std::string& point) const {
  const auto m = motion(point);
  const Vector3& reference = assembler().mesh().vertex_position[vertex_of(assembler().mesh(), point)];
  return {reference[0] + m[0], reference[1] + m[1], reference[2] + m[2]};
}

Vector3 Simulation::rotation(const std::string& point) const {
  const auto m = motion(point);
  return {m[3], m[4], m[5]};
}

std::vector<MemberSamples> Simulation::samples(int points_per_element) const {
  return sample_members(scene(), assembler(), state_, points_per_element);
}

StepRecord Simulation::record(const StepReport& report, int points_per_element,
                              const std::vector<std::string>& monitored_points) const {
  StepRecord record;
  record.step = report.step;
  record.load_factor = report.load_factor;
  record.newton_iterations = report.newton_iterations;
  record.residual = report.residual;
  const StrainEnergy energy = strain_energy();
  record.strain_energy = energy.force + energy.moment;
  record.force_energy = energy.force;
  record.moment_energy = energy.moment;
  record.history = report.history;
  record.state = snapshot_of(assembler(), state_);
  record.point = report.point;
  record.members = samples(points_per_element);
  for (const Reaction& reaction : reactions())
    record.reactions.push_back({reaction.point, reaction.force, reaction.moment});
  const Balance sums = balance();
  record.balance = {sums.applied_force,   sums.applied_moment, sums.reaction_force,
                    sums.reaction_moment, sums.force_error,    sums.moment_error};
  for (const std::string& point : monitored_points) {
    const Vector3 u = displacement(point), theta = rotation(point);
    record.monitored.push_back({point + ".displacement", {u[0], u[1], u[2]}});
    record.monitored.push_back({point + ".rotation", {theta[0], theta[1], theta[2]}});
  }
  return record;
}

}  // namespace mixbeam
