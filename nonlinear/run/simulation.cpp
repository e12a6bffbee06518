#include "nonlinear/run/simulation.hpp"

#include "discretization/assembly/masses.hpp"
#include "discretization/state/member_stresses.hpp"
#include "discretization/text/result_names.hpp"
#include "kernels/execution/execution_space.hpp"
#include "kernels/math/constants.hpp"
#include "nonlinear/linear/condition_estimate.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/stability/linear_buckling.hpp"
#include "nonlinear/stability/vibration.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Elements for which one of a taper counts, since each of its samples has a section of its own.
constexpr size_t kElementsOfTaper = 10;

/// Number of elements, weighted by the cost of the stresses along them.
size_t elements_for_stresses(const Scene& scene, const Mesh& mesh) {
  size_t count = 0;
  for (size_t m = 0; m < mesh.members.size(); ++m)
    count += static_cast<size_t>(mesh.elements_of(static_cast<int>(m))) *
             (scene.members[m].end_section.empty() ? 1 : kElementsOfTaper);
  return count;
}

/// Records stability. With an even number of negative eigenvalues Coriolis forces may stabilise a state: theory (76).
RecordedStability recorded(const StepReport& report, const Model& model) {
  RecordedStability stability;
  if (report.stability) {
    const int negative = report.stability->negative;
    const bool may_be_held = negative > 0 && negative % 2 == 0 && norm(model.frame().at(report.load_factor)) > 0.0;
    stability.stable = text_of(may_be_held ? Verdict::unknown : report.stability->verdict());
    stability.negative = report.stability->negative;
    stability.has_potential = report.stability->symmetric;
  }
  if (report.held_stability) stability.held = text_of(report.held_stability->verdict());
  return stability;
}

/// Adds the data of jumps to the time series of every step, for paths that may jump.
void follow_jumps(StepRecord& record) {
  const RecordedJump jump = record.jump.value_or(RecordedJump{});
  const double values[] = {static_cast<double>(record.point.jumps), jump.released, jump.motion, jump.largest};
  for (size_t i = 0; i < kJumpSeries.size(); ++i) record.monitored.push_back({kJumpSeries[i], {values[i]}});
}

}  // namespace

Simulation::Simulation(std::shared_ptr<const Scene> scene, const SolverParameters& parameters, const Communicator& comm)
    : parameters_(parameters) {
  if (parameters.threads > 0) set_number_of_threads(parameters.threads);
  problem_ = Teuchos::rcp(new BeamProblem(std::move(scene), comm, parameters));
  state_ = problem_->model.reference_state();
  if (parameters.analysis.modes.in_plane) require_plane(problem_->model);
}

const LoadPathResult& Simulation::run(const PathObserver& observer, const PathControl& control) {
  const PathObserver remember = [&](const StepReport& report, const State& state) {
    load_factor_ = report.load_factor;
    stability_ = recorded(report, model());
    jumps_ = report.point.jumps;
    if (observer) observer(report, state);
  };
  result_ = follow_load_path(problem_, parameters_, state_, remember, control);
  return result_;
}

const LoadPathResult& Simulation::settle(const State& start, const PathObserver& observer) {
  state_ = start;
  load_factor_ = scene().stages;
  const PathObserver remember = [&](const StepReport& report, const State& settled) {
    stability_ = recorded(report, model());
    if (observer) observer(report, settled);
  };
  result_ = settle_at_end(problem_, parameters_, state_, remember);
  return result_;
}

double Simulation::share_done() const {
  if (!parameters_.analysis.control) return load_factor_ / scene().stages;
  const MonitoredComponent& control = *parameters_.analysis.control;
  return displacement(control.point)[control.component] / control.target;
}

bool Simulation::is_end_of_path(double load_factor) const {
  return PathGoal(model(), parameters_.analysis.control, scene().stages).is_reached(state_, load_factor);
}

void Simulation::restore(const StateSnapshot& snapshot, double load_factor, const RecordedStability& known, int jumps) {
  jumps_ = jumps;
  state_ = mixbeam::restore(model(), snapshot, load_factor);
  load_factor_ = load_factor;
  stability_ = known;
}

Simulation Simulation::at(const State& state, double load_factor, const RecordedStability& known,
                          std::optional<int> jumps) const {
  Simulation other = *this;
  other.state_ = state;
  other.load_factor_ = load_factor;
  other.stability_ = known;
  other.jumps_ = jumps.value_or(jumps_);
  return other;
}

Simulation Simulation::richer(const ErrorEstimate& estimate, std::vector<EndLayer>& layers) const {
  Simulation other = at(estimate.richer_state, load_factor_, stability_);
  other.problem_ = estimate.richer;
  layers = end_layers(other.model(), other.state(), &scene());
  if (layers.empty()) return other;
  try {
    other.state_ = with_layers(other.problem_, other.state_, load_factor_, layers);
    layers = end_layers(other.model(), other.state(), &scene());
  } catch (const LinearSolverError&) {  // keeps the layers of the uncorrected state
  }
  return other;
}

double Simulation::condition_estimate() {
  return condition_of_tangent(problem_->model, state_, load_factor_, sparse_solver_of(parameters_.linear.method));
}

std::array<double, 6> Simulation::motion(const std::string& point) const {
  return vertex_motion(model(), state_, vertex_of(model().mesh(), point));
}

Vector3 Simulation::displacement(const std::string& point) const {
  const auto m = motion(point);
  return {m[0], m[1], m[2]};
}

Vector3 Simulation::position(const std::string& point) const {
  const auto m = motion(point);
  const Vector3 reference = reference_position(model(), vertex_of(model().mesh(), point));
  return {reference[0] + m[0], reference[1] + m[1], reference[2] + m[2]};
}

Vector3 Simulation::rotation(const std::string& point) const {
  const auto m = motion(point);
  return {m[3], m[4], m[5]};
}

std::vector<MemberSamples> Simulation::samples(int points_per_element) const {
  return sample_members(scene(), model(), state_, points_per_element);
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
  record.point = report.point;
  const Balance sums = balance(&record.reactions);
  record.balance = {sums.applied_force,   sums.applied_moment, sums.reaction_force,
                    sums.reaction_moment, sums.force_error,    sums.moment_error};
  // State and samples come last, when memory is scarcest. After an iterative solve new arrays cost little, after the
  // last step none are needed.
  if (is_end_of_path(load_factor_)) problem_->release_idle();
  if (problem_->iterates()) model().release_idle_arrays();
  record.state = share_of(model(), state_);
  record.members = sample_own_elements(scene(), model(), state_, points_per_element);
  if (computes_stresses(parameters_.analysis, elements_for_stresses(scene(), model().mesh()),
                        is_end_of_path(load_factor_)))
    record.stresses = sample_stresses(scene(), model().mesh(), model().map()->getComm(), record.members);
  record.monitored = motions(monitored_points);
  record.stability = stability_;
  record.jump = report.jump;
  if (parameters_.analysis.snap == Snap::jump) follow_jumps(record);
  if (report.step == 0 && model().map()->getComm()->getRank() == 0)
    record.acting = std::make_shared<const Acting>(acting_on(scene(), *model().whole_mesh()));
  for (const CriticalPoint& point : report.critical_points)
    record.critical_points.push_back(
        at(point.state, point.load_factor).record(point, points_per_element, monitored_points));
  return record;
}

RecordedCriticalPoint Simulation::record(const CriticalPoint& point, int points_per_element,
                                         const std::vector<std::string>& monitored_points) const {
  RecordedCriticalPoint record;
  record.kind = name_of(point.kind);
  record.load_factor = point.load_factor;
  record.load_factor_error = point.error;
  record.negative_before = point.negative_before;
  record.negative_after = point.negative_after;
  record.modes = point.modes;
  record.omega = point.omega;
  for (const MemberSamples& member : sample_own_elements(scene(), model(), state_, points_per_element)) {
    record.position.insert(record.position.end(), member.position.begin(), member.position.end());
    record.displacement.insert(record.displacement.end(), member.displacement.begin(), member.displacement.end());
  }
  record.mode = sample_own_motion(scene(), model(), point.mode, points_per_element);
  record.monitored = motions(monitored_points);
  record.reactions = reactions();
  record.state = share_of(model(), state_);
  return record;
}

RecordedErrorEstimate Simulation::record_error(const ErrorEstimate& estimate,
                                               const std::vector<std::string>& points) const {
  RecordedErrorEstimate record = estimate;
  if (!estimate.exists()) return record;
  for (const std::string& point : points) {
    const Vector3& error = estimate.vertex_displacement[vertex_of(model().mesh(), point)];
    record.points.push_back({point, {error[0], error[1], error[2]}});
  }
  return record;
}

bool Simulation::is_between_stages() const {
  return load_factor_ >= 1.0 && load_factor_ < scene().stages && load_factor_ == std::floor(load_factor_);
}

std::vector<RecordedBucklingMode> Simulation::buckling_modes(int count, int points_per_element) const {
  const Simulation base = is_between_stages() ? *this : at(model().reference_state(), 0.0);
  std::vector<RecordedBucklingMode> recorded;
  try {
    for (const EigenMode& mode : linear_buckling(*problem_, count, base.state_, base.load_factor_))
      recorded.push_back({mode.eigenvalue, sample_own_motion(scene(), model(), mode.mode, points_per_element),
                          mode.error, mode.converged});
    if (recorded.empty() || !estimates_error(parameters_.analysis, model().mesh().elements.size())) return recorded;
    std::vector<EigenMode> finer;
    if (base.load_factor_ == 0.0) {
      finer = linear_buckling(*richer_problem(*problem_, parameters_), count);
    } else if (const ErrorEstimate there = base.estimate_error(); there.exists()) {
      finer = linear_buckling(*there.richer, count, there.richer_state, base.load_factor_);
    }
    for (size_t i = 0; i < std::min(finer.size(), recorded.size()); ++i)
      recorded[i].error = std::abs(finer[i].eigenvalue - recorded[i].load_factor);
  } catch (const LinearSolverError&) {  // of the first analysis: no modes; of the one in the richer space: no errors
  }
  return recorded;
}

std::vector<RecordedVibrationMode> Simulation::vibration_modes(int count, bool in_plane, int points_per_element,
                                                               const ModeSearchObserver& observer, ModeTracks* tracks,
                                                               const std::vector<int>& known) const {
  std::vector<RecordedVibrationMode> recorded;
  std::vector<VibrationMode> modes =
      mixbeam::vibration_modes(*problem_, state_, load_factor_, count, in_plane, observer, tracks != nullptr);
  const std::vector<int> numbers =
      tracks == nullptr ? std::vector<int>(modes.size(), -1) : tracks->follow(modes, known);
  for (const VibrationMode& mode : modes) {
    RecordedVibrationMode& record = recorded.emplace_back();
    record.track = numbers[recorded.size() - 1];
    record.eigenvalue = mode.pair.eigenvalue;
    record.omega = mode.rate.imag();
    record.growth = mode.rate.real();
    record.frequency = record.omega / (2.0 * kPi);
    record.modal_mass = mode.modal_mass;
    record.participation_x = mode.participation[0];
    record.participation_y = mode.participation[1];
    record.participation_z = mode.participation[2];
    record.residual = mode.pair.error;
    record.confirmed = mode.pair.converged;
    record.mode = sample_own_motion(scene(), model(), mode.pair.mode, points_per_element);
  }
  return recorded;
}

std::function<double(int mode)> Simulation::natural_frequency() const {
  return [this, known = std::optional<std::vector<double>>()](int mode) mutable {
    if (!known) {
      const ModesParameters& asked = parameters_.analysis.modes;
      known.emplace();
      for (const VibrationMode& one :
           mixbeam::vibration_modes(*problem_, state_, load_factor_, asked.number, asked.in_plane))
        known->push_back(one.rate.imag() / (2.0 * kPi));
    }
    return mode <= static_cast<int>(known->size()) ? (*known)[mode - 1] : std::numeric_limits<double>::quiet_NaN();
  };
}

std::vector<MonitoredQuantity> Simulation::motions(const std::vector<std::string>& points) const {
  std::vector<MonitoredQuantity> quantities;
  for (const std::string& point : points) {
    const Vector3 u = displacement(point), theta = rotation(point);
    quantities.push_back({point + ".displacement", {u[0], u[1], u[2]}});
    quantities.push_back({point + ".rotation", {theta[0], theta[1], theta[2]}});
  }
  return quantities;
}

}  // namespace mixbeam
