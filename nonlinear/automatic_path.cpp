#include "nonlinear/automatic_path.hpp"

#include "discretization/errors.hpp"
#include "discretization/sampling.hpp"
#include "nonlinear/corrector.hpp"
#include "nonlinear/critical_point_finder.hpp"
#include "nonlinear/loca_stage.hpp"
#include "nonlinear/path_measure.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Load steps that have not converged by then seldom do (dead loads of 1e8 EI/L^2 take 23), and the attempt is lost.
constexpr int kMostIterationsOfLoadStep = 25;
/// Steps along the path aim at kAimedIterations, which is what a helical rod of ten turns needs the fewest in all with,
/// and are given up a little above.
constexpr double kAimedIterations = 6.0;
constexpr int kMostIterationsAlongPath = 10;
/// Attempts in a row that fail in the plane of the scene before the path goes on in space.
constexpr int kFailuresInPlane = 3;
/// Largest vertex rotation [rad] in the first step along a path: what follows a failed load step is difficult, and
/// 0.5 lets Lee's frame jump to another path.
constexpr double kFirstSpin = 0.2;
/// Steps are chosen so that the tangent turns by about this angle [rad].
constexpr double kAimedAngle = 0.5;
/// Growth and shrinking from step to step.
constexpr double kLargestGrowth = 2.0, kSmallestGrowth = 0.5;
/// A step is believed if the tangent has not turned much further (cosine), and if Newton's method has not left the
/// predicted direction (cosine): else it may have jumped to another path.
constexpr double kSmallestTurnCosine = 0.5, kSmallestPredictorCosine = 0.85;
/// Below this length (1: the structure moves by its own size) a turn is a kink of the path itself, and accepted.
constexpr double kShortStep = 1e-4;
/// The path is given up below this length.
constexpr double kShortestStep = 1e-7;
/// A path that runs away from the end of its stage is followed this far, in load factors of one stage.
constexpr double kLargestDetour = 100.0;
/// First amplitude of the mode with which a branch is entered (largest rotation [rad] or displacement / L), halved
/// until Newton's method stays on it.
constexpr double kBranchAmplitude = 0.1;
constexpr int kBranchAttempts = 8;
/// A rest of the stage that exceeds the step by no more than this share of it is rounding, and not worth a step.
constexpr double kRoundedSteps = 1e-12;
/// A controlled displacement has arrived when it differs from the target by this share of the scene's length: rounding.
constexpr double kControlPrecision = 1e-13;

class AutomaticPath {
 public:
  AutomaticPath(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& start,
                const StageRange& range, PathRecorder& recorder)
      : problem_(problem),
        parameters_(parameters),
        range_(range),
        recorder_(recorder),
        rule_(step_size_rule(problem->assembler.scene(), parameters)),
        corrector_(problem, parameters, recorder.record()),
        measure_(problem->assembler),
        state_(start),
        load_(range.from),
        attempts_left_(range.attempts) {}

  bool follow();

 private:
  bool begin();
  bool step_by_load();
  bool step_by_control();
  double controlled_displacement(const State& state) const;
  bool step_along_path();
  bool start_along_path();
  bool attempt(Correction& result, double& length);
  bool is_believable(const Correction& found, const PathDirection& done, const PathDirection& tangent);
  std::optional<StabilityResult> stability_of(const Correction& found);
  bool changes(const std::optional<StabilityResult>& stability) const;
  std::vector<CriticalPoint> critical_points(const Correction& found, const ControlRow& row);
  bool take_branch(const CriticalPoint& from, std::vector<CriticalPoint>& passed);
  void accept(const Correction& found, const std::optional<StabilityResult>& stability,
              std::vector<CriticalPoint> passed);
  void not_converged();
  PathDirection increments(const Correction& found) const {
    return {found.moved.clone(true), found.load_factor - load_};
  }
  bool arrived() const;
  bool may_try() { return attempts_left_-- > 0; }

  Teuchos::RCP<BeamProblem> problem_;
  const SolverParameters& parameters_;
  const StageRange& range_;
  PathRecorder& recorder_;
  StepSizeRule rule_;
  Corrector corrector_;
  PathMeasure measure_;
  // where the path stands
  State state_;
  double load_ = 0.0;
  std::optional<StabilityResult> stability_{};
  std::optional<PathDirection> tangent_{};  ///< along the path; none: steps of the load factor
  double size_ = 0.0;                       ///< of the next load step
  double length_ = 0.0;                     ///< of the next step along the path
  bool branched_ = false;
  int attempts_left_ = 0;
  int failures_in_a_row_ = 0;
};

/// The state at the start of the stage, or what is needed to go on from a completed step.
bool AutomaticPath::begin() {
  recorder_.enter_stage(range_.stage, range_.attempts);
  size_ = rule_.initial;
  branched_ = recorder_.branched();
  if (range_.before) {
    const PathPoint& before = *range_.before;
    if (before.negative >= 0) stability_ = StabilityResult{before.negative};
    size_ = before.step_size;
    if (before.path_length == 0.0) return true;
    length_ = before.path_length;
    tangent_ = path_tangent(corrector_.global(), problem_, measure_, state_, load_);
    if (before.direction < 0) tangent_ = scaled(*tangent_, -1.0);
    return true;
  }
  const Correction start = corrector_.at_load({state_, load_}, parameters_.newton.maximum_iterations);
  if (start.converged) {
    accept(start, stability_of(start), {});
  } else {
    recorder_.not_converged();
  }
  return start.converged;
}

void AutomaticPath::accept(const Correction& found, const std::optional<StabilityResult>& stability,
                           std::vector<CriticalPoint> passed) {
  state_ = found.state;
  load_ = found.load_factor;
  stability_ = stability;
  failures_in_a_row_ = 0;
  ConvergedStep step{state_, load_, found.residual};
  step.step_size = size_;
  step.path_length = tangent_ ? length_ : 0.0;
  step.direction = tangent_ && tangent_->load < 0.0 ? -1 : 1;
  step.branched = branched_;
  step.stability = stability_;
  step.critical_points = std::move(passed);
  recorder_.set_attempts(range_.attempts - attempts_left_);
  recorder_.converged(step);
}

/// Where elements turn by many radians each, Newton's method in the plane arrives less often than that in space.
void AutomaticPath::not_converged() {
  recorder_.not_converged();
  if (++failures_in_a_row_ >= kFailuresInPlane) state_.in_plane = false;
}

std::optional<StabilityResult> AutomaticPath::stability_of(const Correction& found) {
  Stability* stability = recorder_.stability();
  if (stability == nullptr) return std::nullopt;
  return stability->count(found.state, found.load_factor);
}

bool AutomaticPath::changes(const std::optional<StabilityResult>& stability) const {
  return stability && stability_ && stability->negative != stability_->negative;
}

bool AutomaticPath::step_by_load() {
  const double size = std::min(size_, range_.to - load_);
  const double target = range_.to - load_ <= size_ * (1.0 + kRoundedSteps) ? range_.to : load_ + size;
  const int most = std::min(kMostIterationsOfLoadStep, parameters_.newton.maximum_iterations);
  const Correction found = corrector_.at_load({state_, target}, most);
  if (!found.converged) {
    not_converged();
    return start_along_path();
  }
  const std::optional<StabilityResult> stability = stability_of(found);
  // Without symmetry the count is not that of any energy, and says nothing about the path between the two states.
  if (changes(stability) && stability->symmetric && stability_->symmetric) {
    recorder_.rejected("stability changes within the step: the path is followed by its length", found.iterations);
    return start_along_path();
  }
  size_ = std::min(rule_.maximum, rule_.after_success(size_, found.iterations));
  accept(found, stability, {});
  return true;
}

double AutomaticPath::controlled_displacement(const State& state) const {
  const MonitoredComponent& control = *parameters_.analysis.control;
  const Assembler& assembler = problem_->assembler;
  return vertex_motion(assembler, state, vertex_of(assembler.mesh(), control.point))[control.component];
}

bool AutomaticPath::arrived() const {
  if (!parameters_.analysis.control) return is_end_of_stage(load_, range_.to);
  const double target = parameters_.analysis.control->target;
  return std::abs(controlled_displacement(state_) - target) <=
         kControlPrecision * problem_->assembler.structure().length;
}

/// The monitored displacement moves by a share of its way, the load factor follows.
bool AutomaticPath::step_by_control() {
  const MonitoredComponent& control = *parameters_.analysis.control;
  const Assembler& assembler = problem_->assembler;
  const double length = assembler.structure().length, rest = control.target - controlled_displacement(state_);
  const double size = std::min(size_, std::abs(rest) / length);
  ControlRow row{assembler.create_vector(), 0.0, load_, std::copysign(size, rest)};
  row.weights.fill(0.0);
  const VertexPartition& partition = assembler.structure().partition;
  const int vertex = vertex_of(assembler.mesh(), control.point);
  if (partition.owns(vertex))
    row.weights.vertex()(kVertexDofs * (vertex - partition.owned_first()) + control.component) = 1.0 / length;
  const Correction found = corrector_.on_row({state_, load_}, row, kMostIterationsOfLoadStep);
  if (!found.converged) {
    not_converged();
    size_ = rule_.after_failure(size);
    return size_ >= kShortestStep;
  }
  std::vector<CriticalPoint> passed;
  const std::optional<StabilityResult> stability = stability_of(found);
  if (changes(stability)) passed = critical_points(found, row);
  size_ = std::min(rule_.maximum, size * std::min(kLargestGrowth, kAimedIterations / std::max(found.iterations, 1)));
  accept(found, stability, std::move(passed));
  return true;
}

bool AutomaticPath::start_along_path() {
  PathDirection tangent = path_tangent(corrector_.global(), problem_, measure_, state_, load_);
  if (!std::isfinite(tangent.load)) {
    recorder_.rejected("the path has no direction here: " + problem_->last_failure, 0);
    return false;
  }
  tangent_ = std::move(tangent);
  const double spin = tangent_->x.largest_vertex_spin();
  length_ = std::min(spin > 0.0 ? kFirstSpin / spin : 1.0, (range_.to - load_) / tangent_->load);
  return true;
}

/// Newton's method from the predicted point, at the end of the stage where the prediction passes it.
bool AutomaticPath::attempt(Correction& result, double& length) {
  const double step = std::min(length_, rule_.maximum / std::max(std::abs(tangent_->load), 1e-300));
  PathDirection guess = scaled(*tangent_, step);
  length = step;
  if (load_ + guess.load >= range_.to) {
    length = (range_.to - load_) / tangent_->load;
    guess = scaled(*tangent_, length);
    result = corrector_.at_load({state_, range_.to, &guess.x}, kMostIterationsAlongPath);
    return result.converged;
  }
  result = corrector_.on_row({state_, load_ + guess.load, &guess.x}, measure_.row(*tangent_, load_, step),
                             kMostIterationsAlongPath);
  if (!result.converged || result.load_factor <= range_.to) return result.converged;
  // the path reached the end of the stage before the end of the step
  const PathDirection part = scaled(increments(result), (range_.to - load_) / (result.load_factor - load_));
  result = corrector_.at_load({state_, range_.to, &part.x}, kMostIterationsAlongPath);
  return result.converged;
}

bool AutomaticPath::is_believable(const Correction& found, const PathDirection& done, const PathDirection& tangent) {
  const double length = measure_.length(done);
  if (length < kShortStep) return true;
  if (measure_.inner(done, *tangent_) < kSmallestPredictorCosine * length) return false;
  return measure_.inner(*tangent_, tangent) >= kSmallestTurnCosine && std::isfinite(found.residual);
}

bool AutomaticPath::step_along_path() {
  Correction found{false, state_, load_, problem_->assembler.create_vector()};
  double length = 0.0;
  if (!attempt(found, length)) {
    not_converged();
    length_ = 0.5 * length;
    return length_ >= kShortestStep;
  }
  const PathDirection done = increments(found);
  PathDirection next = path_tangent(corrector_.global(), problem_, measure_, found.state, found.load_factor);
  if (measure_.inner(done, next) < 0.0) next = scaled(next, -1.0);
  if (!is_believable(found, done, next)) {
    recorder_.rejected("the path bends too much: another one may have been met", found.iterations);
    length_ = 0.5 * length;
    return length_ >= kShortestStep;
  }
  std::vector<CriticalPoint> passed;
  const std::optional<StabilityResult> stability = stability_of(found);
  if (changes(stability)) {
    const double chord = measure_.length(done);
    passed = critical_points(found, measure_.row(scaled(done, 1.0 / chord), load_, chord));
  }
  for (const CriticalPoint& point : passed)
    if (take_branch(point, passed)) return true;
  const double angle = std::acos(std::clamp(measure_.inner(*tangent_, next), -1.0, 1.0));
  const double growth = std::min(kAimedIterations / std::max(found.iterations, 1), kAimedAngle / std::max(angle, 1e-9));
  length_ = length * std::clamp(growth, kSmallestGrowth, kLargestGrowth);
  tangent_ = std::move(next);
  accept(found, stability, std::move(passed));
  if (std::abs(load_ - range_.to) < kLargestDetour) return true;
  recorder_.rejected("the path leads away from the end of the stage", 0);
  return false;
}

std::vector<CriticalPoint> AutomaticPath::critical_points(const Correction& found, const ControlRow& row) {
  CriticalPointFinder finder(problem_, corrector_, *recorder_.stability(), measure_);
  try {
    return finder.find({state_, load_, increments(found), row});
  } catch (const ConvergenceError& error) {
    recorder_.rejected(error.what(), 0);
    return {};
  }
}

/// Steps onto the branch that crosses the path at `from`, if that is asked for.
bool AutomaticPath::take_branch(const CriticalPoint& from, std::vector<CriticalPoint>& passed) {
  if (from.kind != CriticalKind::bifurcation || branched_ || parameters_.analysis.branch == Branch::primary)
    return false;
  const double sign = parameters_.analysis.branch == Branch::positive ? 1.0 : -1.0;
  PathDirection mode{from.mode.clone(true), 0.0};
  mode.x.scale(sign);
  const double length = measure_.length(mode);
  const PathDirection unit = scaled(mode, 1.0 / length);
  double amplitude = kBranchAmplitude * length;
  for (int i = 0; i < kBranchAttempts; ++i, amplitude *= 0.5) {
    const PathDirection guess = scaled(unit, amplitude);
    const Correction found =
        corrector_.on_row({from.state, from.load_factor, &guess.x}, measure_.row(unit, from.load_factor, amplitude),
                          2 * kMostIterationsAlongPath);
    if (!found.converged) {
      not_converged();
      continue;
    }
    const PathDirection done{found.moved.clone(true), found.load_factor - from.load_factor};
    PathDirection next = path_tangent(corrector_.global(), problem_, measure_, found.state, found.load_factor);
    if (measure_.inner(done, next) < 0.0) next = scaled(next, -1.0);
    branched_ = true;
    length_ = amplitude;
    tangent_ = std::move(next);
    std::vector<CriticalPoint> up_to_here(passed.begin(), passed.begin() + (&from - passed.data()) + 1);
    accept(found, stability_of(found), std::move(up_to_here));
    return true;
  }
  return false;
}

bool AutomaticPath::follow() {
  try {
    if (!begin()) return false;
    const bool controlled = parameters_.analysis.control.has_value();
    const bool traced = parameters_.analysis.trace && !controlled;
    if (traced && !tangent_ && !arrived() && !start_along_path()) return false;
    while (!arrived()) {
      if (!may_try()) return false;
      if (!(controlled ? step_by_control() : tangent_ ? step_along_path() : step_by_load())) return false;
    }
    return true;
  } catch (const PathInterrupted&) {
    recorder_.interrupted();
    return false;
  }
}

}  // namespace

bool follow_stage_automatically(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                const State& start, const StageRange& range, PathRecorder& recorder) {
  return AutomaticPath(problem, parameters, start, range, recorder).follow();
}

}  // namespace mixbeam
