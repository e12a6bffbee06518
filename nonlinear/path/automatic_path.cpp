#include "nonlinear/path/automatic_path.hpp"

#include "discretization/state/sampling.hpp"
#include "discretization/text/errors.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/path/branch_direction.hpp"
#include "nonlinear/path/corrector.hpp"
#include "nonlinear/path/loca_stage.hpp"
#include "nonlinear/path/step_examiner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

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
/// Largest vertex rotation [rad] in the first step along a path: what follows a failed load step is difficult.
constexpr double kFirstSpin = 0.4;
/// Steps are chosen so that the tangent turns by about this angle [rad], or closely.
constexpr double kAimedAngle = 0.6, kAimedAngleClosely = 0.25;
/// Growth and shrinking from step to step.
constexpr double kLargestGrowth = 2.0, kSmallestGrowth = 0.5;
/// Cosines of the angles between the tangents at both ends of a step and its chord, at least: of steps of the load
/// factor or of a controlled displacement, which may be as long as they please; of steps along the path; and where it
/// is traced.
constexpr StepTest kLoadStep{0.5, -0.5, false, false, true}, kPathStep{0.85, 0.85, true, false},
    kTracedStep{0.95, 0.95, true, true};
/// Loads that turn back are looked for so many steps ahead.
constexpr double kReach = 2.0;
/// The path is given up below this length (1: the structure moves by its own size).
constexpr double kShortestStep = 1e-9;
/// A path that runs away from the end of its stage is followed this far, in load factors of one stage.
constexpr double kLargestDetour = 100.0;
/// First amplitude of the mode with which a branch is entered (largest rotation [rad] or displacement / L), halved
/// until the branch is met close to the critical point.
constexpr double kBranchAmplitude = 0.1;
constexpr int kBranchAttempts = 40;
/// On the way from a critical point to the first point of a branch the structure moves along the mode: its share of the
/// motion is at least this cosine.
constexpr double kBranchCosine = 0.9;
/// A rest of the stage that exceeds the step by no more than this share of it is rounding, and not worth a step.
constexpr double kRoundedSteps = 1e-12;
/// A displacement over the length of the scene that has not moved.
constexpr double kStill = 1e-9;
/// A controlled displacement has arrived when it differs from the target by this share of the scene's length: rounding.
constexpr double kControlPrecision = 1e-13;

std::string plain_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

/// Nothing that could be tried further on leads to the end.
struct GaveUp {
  std::string cause;
};

/// Of the controlled displacement over the length of the scene.
MixedVector weights_of(const Model& model, const MonitoredComponent& control) {
  MixedVector weights = model.create_vector();
  weights.fill(0.0);
  const VertexPartition& partition = model.structure().partition;
  const int vertex = vertex_of(model.mesh(), control.point);
  if (partition.owns(vertex))
    weights.vertex()(kVertexDofs * (vertex - partition.owned_first()) + control.component) =
        1.0 / model.structure().length;
  return weights;
}

/// Whether a direction moves what is controlled, by more than rounding.
bool moves(const PathMeasure& measure, const PathDirection& direction, double rate) {
  return std::abs(rate) > kStill * std::max(measure.motion(direction.x), kNoMotion);
}

class AutomaticPath {
 public:
  AutomaticPath(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& start,
                const StageRange& range, PathRecorder& recorder)
      : problem_(problem),
        parameters_(parameters),
        range_(range),
        recorder_(recorder),
        rule_(step_size_rule(problem->model.scene(), parameters)),
        corrector_(problem, parameters, recorder.record()),
        examiner_(problem, parameters, recorder.counts(), range.to),
        measure_(examiner_.measure()),
        here_{start, range.from, {problem->model.create_vector(), 0.0}, {}},
        begin_(here_),
        way_{problem->model.create_vector(), 0.0},
        attempts_left_(range.attempts) {}

  bool follow();

 private:
  // What the path is followed to: a load factor, or a displacement.
  bool is_controlled() const { return parameters_.analysis.control.has_value(); }
  double controlled_displacement(const State& state) const;
  /// Of the load factor, or of the controlled displacement over the length of the scene.
  double goal() const;
  double goal_at(const State& state, double load_factor) const;
  double goal_rate(const PathDirection& direction) const;
  MixedVector control_weights() const { return weights_of(problem_->model, *parameters_.analysis.control); }
  ControlRow control_row(double change) const;
  Correction correct_at_goal(double goal, const PathDirection* way, int most_iterations);
  bool arrived() const;

  bool begin();
  bool step_to_goal();
  bool shorten_load_step(double size);
  bool start_along_path();
  bool meets_turning_loads();
  bool step_along_path();
  bool attempt(Correction& result, double& length);
  /// Takes a converged step if it follows the path; else says why not.
  bool take(const Correction& found, const StepTest& test);
  bool take_branch(const CriticalPoint& from, std::vector<CriticalPoint>& passed);
  bool shorten(double length);
  void adapt_length(const Correction& found, double length, const PathDirection& before);
  void accept(Station next, double residual, std::vector<CriticalPoint> passed);
  void not_converged();
  void begin_way();
  void require_motion(const Station& next, const std::string& until) const;
  bool moves_at_first() const;
  bool returns(const PathDirection& last) const;
  PathDirection increments(const Correction& found) const {
    return {found.moved.clone(true), found.load_factor - here_.load_factor};
  }
  bool may_try() { return attempts_left_-- > 0; }

  Teuchos::RCP<BeamProblem> problem_;
  const SolverParameters& parameters_;
  const StageRange& range_;
  PathRecorder& recorder_;
  StepSizeRule rule_;
  Corrector corrector_;
  StepExaminer examiner_;
  const PathMeasure& measure_;
  Station here_;  ///< where the path stands
  // since the stage, a branch or a resumed path began:
  Station begin_;
  PathDirection way_;       ///< sum of the increments
  double travelled_ = 0.0;  ///< sum of their lengths
  double start_of_goal_ = 0.0;
  bool along_path_ = false;  ///< steps along the path; else to the goal
  double size_ = 0.0;        ///< of the next step to the goal
  double length_ = 0.0;      ///< of the next step along the path
  bool branched_ = false;
  int attempts_left_ = 0;
  int failures_in_a_row_ = 0;
};

double AutomaticPath::controlled_displacement(const State& state) const {
  const MonitoredComponent& control = *parameters_.analysis.control;
  const Model& model = problem_->model;
  return vertex_motion(model, state, vertex_of(model.mesh(), control.point))[control.component];
}

double AutomaticPath::goal() const {
  return is_controlled() ? parameters_.analysis.control->target / problem_->model.structure().length : range_.to;
}

double AutomaticPath::goal_at(const State& state, double load_factor) const {
  return is_controlled() ? controlled_displacement(state) / problem_->model.structure().length : load_factor;
}

double AutomaticPath::goal_rate(const PathDirection& direction) const {
  return is_controlled() ? control_weights().inner_product(direction.x) : direction.load;
}

bool AutomaticPath::arrived() const {
  if (!is_controlled()) return is_end_of_stage(here_.load_factor, range_.to);
  return std::abs(goal_at(here_.state, here_.load_factor) - goal()) <= kControlPrecision;
}

/// The controlled displacement over the length of the scene moves by `change`.
ControlRow AutomaticPath::control_row(double change) const {
  return {control_weights(), 0.0, here_.load_factor, change};
}

/// Newton's method at a value of the goal. `way`: what is known of the way there.
Correction AutomaticPath::correct_at_goal(double goal, const PathDirection* way, int most_iterations) {
  if (!is_controlled()) {
    const bool predicts = way != nullptr && here_.cap_ratio == 0.0;
    return corrector_.at_load_along({here_.state, goal}, predicts ? &way->x : nullptr, most_iterations);
  }
  const ControlRow row = control_row(goal - goal_at(here_.state, here_.load_factor));
  Guess guess{here_.state, here_.load_factor};
  if (way != nullptr) {
    guess.load_factor += way->load;
    guess.moved = &way->x;
  }
  return corrector_.on_row(guess, row, most_iterations);
}

/// The state at the start of the stage, or what is needed to go on from a completed step.
bool AutomaticPath::begin() {
  recorder_.enter_stage(range_.stage, range_.attempts);
  size_ = rule_.initial;
  branched_ = recorder_.branched();
  if (range_.before) {
    const PathPoint& before = *range_.before;
    size_ = before.step_size;
    along_path_ = before.path_length != 0.0;
    length_ = before.path_length;
    here_ = examiner_.station(here_.state, here_.load_factor, nullptr);
    if (before.direction < 0) here_.tangent = scaled(here_.tangent, -1.0);
    begin_way();
    return true;
  }
  const Correction start = corrector_.at_load({here_.state, here_.load_factor}, parameters_.newton.maximum_iterations);
  if (!start.converged) {
    recorder_.not_converged();
    return false;
  }
  accept(examiner_.station(start.state, start.load_factor, nullptr), start.residual, {});
  begin_way();
  return true;
}

/// From here on is looked for motion and for the path's return.
void AutomaticPath::begin_way() {
  begin_ = here_;
  travelled_ = 0.0;
  way_.x.fill(0.0);
  start_of_goal_ = goal_at(here_.state, here_.load_factor);
}

void AutomaticPath::accept(Station next, double residual, std::vector<CriticalPoint> passed) {
  here_ = std::move(next);
  failures_in_a_row_ = 0;
  ConvergedStep step{here_.state, here_.load_factor, residual};
  step.step_size = size_;
  step.path_length = along_path_ ? length_ : 0.0;
  step.direction = here_.tangent.load < 0.0 ? -1 : 1;
  step.branched = branched_;
  step.stability = here_.stability;
  if (is_controlled() && here_.stability && recorder_.reports_stability())
    step.held_stability = recorder_.counts()->count_held(here_.state, here_.load_factor, control_row(0.0).weights);
  step.critical_points = std::move(passed);
  recorder_.set_attempts(range_.attempts - attempts_left_);
  recorder_.converged(step);
}

/// Where elements turn by many radians each, Newton's method in the plane arrives less often than that in space.
void AutomaticPath::not_converged() {
  recorder_.not_converged();
  if (++failures_in_a_row_ >= kFailuresInPlane) here_.state.in_plane = false;
}

bool AutomaticPath::take(const Correction& found, const StepTest& test) {
  const PathDirection moved = increments(found);
  // A step of the load is one along a path on which the load grows.
  const bool is_load_step = !along_path_ && !is_controlled();
  Station next = examiner_.station(found.state, found.load_factor, is_load_step ? nullptr : &moved);
  StepFindings findings = examiner_.examine({here_, moved, next}, test);
  if (!findings.objection.empty()) {
    recorder_.rejected(findings.objection, found.iterations);
    return false;
  }
  std::vector<CriticalPoint>& passed = findings.passed;
  for (const CriticalPoint& point : passed)
    if (take_branch(point, passed)) return true;
  if (!passed.empty())
    require_motion(next, "the structure buckles at load factor " + plain_text(passed.front().load_factor));
  travelled_ += measure_.motion(moved.x);
  way_.x.update(1.0, moved.x, 1.0);
  accept(std::move(next), found.residual, std::move(passed));
  if (returns(moved)) throw GaveUp{"the path returns to where it began"};
  return true;
}

/// Where the load does not move what is controlled, following the path further is of no use.
void AutomaticPath::require_motion(const Station& next, const std::string& until) const {
  if (!is_controlled() || std::abs(goal_at(next.state, next.load_factor) - start_of_goal_) > kStill) return;
  const MonitoredComponent& control = *parameters_.analysis.control;
  throw GaveUp{"the load does not move point \"" + control.point + "\" along " +
               std::string(1, "xyz"[control.component]) + " before " + until +
               ": follow a branch (\"Branch\" in \"Analysis\") or add a small lateral load"};
}

/// Whether the load moves what is controlled at first: else no step of it has a direction.
bool AutomaticPath::moves_at_first() const {
  return !is_controlled() || !here_.has_tangent() || moves(measure_, here_.tangent, goal_rate(here_.tangent));
}

/// Whether the path has come back to its start, in the same direction.
bool AutomaticPath::returns(const PathDirection& last) const {
  constexpr double kRound = 10.0, kSameDirection = 0.9;
  const double chord = measure_.motion(last.x);
  return along_path_ && begin_.has_tangent() && travelled_ > kRound * chord && measure_.motion(way_.x) <= chord &&
         std::abs(here_.load_factor - begin_.load_factor) <= std::abs(last.load) &&
         measure_.cosine(here_.tangent.x, begin_.tangent.x) >= kSameDirection &&
         here_.tangent.load * begin_.tangent.load > 0.0;
}

bool AutomaticPath::step_to_goal() {
  const double now = goal_at(here_.state, here_.load_factor), rest = goal() - now;
  const double size = std::copysign(std::min(size_, std::abs(rest)), rest);
  const bool is_last = std::abs(rest) <= size_ * (1.0 + kRoundedSteps);
  const int most = std::min(kMostIterationsOfLoadStep, parameters_.newton.maximum_iterations);
  const double rate = goal_rate(here_.tangent);
  PathDirection way = scaled(here_.tangent, size / rate);
  const bool is_known = here_.has_tangent() && std::isfinite(way.load) && std::isfinite(way.x.maximum_norm());
  const Correction found = correct_at_goal(
      is_last ? goal() : now + size, is_known && !is_controlled() ? &way : nullptr, most);
  const bool turns = !is_controlled() && !examiner_.loads_are_straight(now, now + size);
  if (!found.converged) {
    not_converged();
    return turns ? shorten_load_step(size) : start_along_path();
  }
  const double before = size_;
  size_ = std::min(rule_.maximum, rule_.after_success(size_, found.iterations));
  if (take(found, kLoadStep)) return true;
  size_ = before;
  return turns ? shorten_load_step(size) : start_along_path();
}

/// Where loads turn back the path does so too, and steps along it would have to turn on the spot.
bool AutomaticPath::shorten_load_step(double size) {
  size_ = 0.5 * std::abs(size);
  return size_ >= rule_.minimum;
}

/// Whether the loads turn back within reach of the next step along the path; then it is one of the load.
bool AutomaticPath::meets_turning_loads() {
  if (is_controlled() || !(here_.tangent.load > 0.0)) return false;
  const double reach = std::min(kReach * length_ * here_.tangent.load, range_.to - here_.load_factor);
  if (examiner_.loads_are_straight(here_.load_factor, here_.load_factor + reach)) return false;
  along_path_ = false;
  size_ = std::clamp(reach, rule_.minimum, rule_.maximum);
  return true;
}

bool AutomaticPath::start_along_path() {
  if (!here_.has_tangent()) {
    recorder_.rejected("the path has no direction here: " + problem_->last_failure, 0);
    return false;
  }
  along_path_ = true;
  const double rate = goal_rate(here_.tangent);
  // A path sets out towards its goal; a displacement that the load does not move at first is met later, or not.
  if (moves_at_first() && is_controlled() && rate * (goal() - goal_at(here_.state, here_.load_factor)) < 0.0)
    here_.tangent = scaled(here_.tangent, -1.0);
  const double spin = here_.tangent.x.largest_vertex_spin();
  length_ = spin > 0.0 ? kFirstSpin / spin : 1.0;
  const double to_goal = std::abs((goal() - goal_at(here_.state, here_.load_factor)) / rate);
  if (std::isfinite(to_goal)) length_ = std::min(length_, to_goal);
  length_ = std::min(length_, 1.0 / std::max(std::abs(here_.tangent.load), 1e-300));  // one stage
  return true;
}

/// Newton's method from the predicted point, at the goal where the prediction or the path passes it.
bool AutomaticPath::attempt(Correction& result, double& length) {
  const double now = goal_at(here_.state, here_.load_factor), rest = goal() - now;
  const double largest = is_controlled() ? rule_.maximum / std::max(std::abs(goal_rate(here_.tangent)), 1e-300)
                                         : rule_.maximum / std::max(std::abs(here_.tangent.load), 1e-300);
  const double step = length = std::min(length_, largest);
  const double to_goal = rest / goal_rate(here_.tangent);
  if (to_goal > 0.0 && to_goal <= step * (1.0 + kRoundedSteps)) {
    length = to_goal;
    const PathDirection guess = scaled(here_.tangent, to_goal);
    result = correct_at_goal(goal(), &guess, kMostIterationsAlongPath);
    return result.converged;
  }
  const PathDirection guess = scaled(here_.tangent, step);
  result = corrector_.on_row({here_.state, here_.load_factor + guess.load, &guess.x},
                             measure_.row(here_.tangent, here_.load_factor, step), kMostIterationsAlongPath);
  if (!result.converged) return false;
  // the path may have passed the goal, or the largest step, before the end of this one
  const double reached = goal_at(result.state, result.load_factor) - now;
  const bool passes = reached * rest > 0.0 && std::abs(reached) > std::abs(rest);
  const double allowed = std::min(passes ? std::abs(rest) : std::abs(reached), rule_.maximum);
  if (std::abs(reached) <= allowed) return true;
  const PathDirection part = scaled(increments(result), allowed / std::abs(reached));
  const bool ends = passes && allowed == std::abs(rest);
  result = correct_at_goal(ends ? goal() : now + std::copysign(allowed, reached), &part, kMostIterationsAlongPath);
  return result.converged;
}

bool AutomaticPath::shorten(double length) {
  length_ = 0.5 * length;
  return length_ >= kShortestStep;
}

void AutomaticPath::adapt_length(const Correction& found, double length, const PathDirection& before) {
  const PathDirection moved = increments(found);
  const double cosine = std::abs(measure_.cosine(before.x, moved.x));
  const double angle = 2.0 * std::acos(std::clamp(cosine, 0.0, 1.0));
  const double aimed = parameters_.analysis.trace ? kAimedAngleClosely : kAimedAngle;
  const double growth = std::min(kAimedIterations / std::max(found.iterations, 1), aimed / std::max(angle, 1e-9));
  length_ = length * std::clamp(growth, kSmallestGrowth, kLargestGrowth);
}

bool AutomaticPath::step_along_path() {
  if (meets_turning_loads()) return true;
  Correction found{false, here_.state, here_.load_factor, problem_->model.create_vector()};
  double length = 0.0;
  if (!attempt(found, length)) {
    not_converged();
    return shorten(length);
  }
  adapt_length(found, length, here_.tangent);
  if (!take(found, parameters_.analysis.trace ? kTracedStep : kPathStep)) return shorten(length);
  if (std::abs(here_.load_factor - range_.to) < kLargestDetour) return true;
  // Under control the load factor has no end, and a number of any size, as long as the displacement moves.
  require_motion(here_, "load factor " + plain_text(here_.load_factor));
  if (is_controlled()) return true;
  recorder_.rejected("the path leads away from the end of the stage", 0);
  return false;
}

/// Steps onto the branch that crosses the path at `from`, if that is asked for.
bool AutomaticPath::take_branch(const CriticalPoint& from, std::vector<CriticalPoint>& passed) {
  if (from.kind != CriticalKind::bifurcation || branched_ || parameters_.analysis.branch == Branch::primary)
    return false;
  const std::optional<MixedVector> direction =
      branch_direction(*problem_, parameters_.analysis, measure_, from.eigenspace);
  if (!direction)
    throw GaveUp{"the mode of the bifurcation at load factor " + plain_text(from.load_factor) +
                 " does not move the point that chooses the branch"};
  const LargestParts parts = largest_parts(*problem_->model.map()->getComm(), direction->vertex());
  const double size = 1.0 / std::max(parts.moved / problem_->model.structure().length, parts.turned);
  const PathDirection unit{direction->clone(true), 0.0};
  double amplitude = kBranchAmplitude * size;
  for (int i = 0; i < kBranchAttempts; ++i, amplitude *= 0.5) {
    const PathDirection guess = scaled(unit, amplitude);
    const Correction found =
        corrector_.on_row({from.state, from.load_factor, &guess.x}, measure_.row(unit, from.load_factor, amplitude),
                          2 * kMostIterationsAlongPath);
    if (!found.converged) {
      not_converged();
      continue;
    }
    const double change = found.load_factor - from.load_factor;
    const bool stays = std::abs(change) <= rule_.maximum && (is_controlled() || found.load_factor <= range_.to) &&
                       measure_.cosine(unit.x, found.moved) >= kBranchCosine;
    if (!stays) continue;
    const PathDirection done{found.moved.clone(true), change};
    branched_ = along_path_ = true;
    length_ = amplitude;
    std::vector<CriticalPoint> up_to_here(passed.begin(), passed.begin() + (&from - passed.data()) + 1);
    accept(examiner_.station(found.state, found.load_factor, &done), found.residual, std::move(up_to_here));
    begin_way();
    return true;
  }
  throw GaveUp{"the branch at load factor " + plain_text(from.load_factor) + " could not be taken"};
}

bool AutomaticPath::follow() {
  try {
    if (!begin()) return false;
    const bool goes_along = parameters_.analysis.trace || !moves_at_first();
    if (goes_along && !along_path_ && !arrived() && !start_along_path()) return false;
    while (!arrived()) {
      if (!may_try()) return false;
      if (!(along_path_ ? step_along_path() : step_to_goal())) return false;
    }
    return true;
  } catch (const PathInterrupted&) {
    recorder_.interrupted();
    return false;
  } catch (const GaveUp& reason) {
    recorder_.rejected(reason.cause, 0);
    return false;
  }
}

}  // namespace

bool follow_stage_automatically(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                const State& start, const StageRange& range, PathRecorder& recorder) {
  return AutomaticPath(problem, parameters, start, range, recorder).follow();
}

bool load_moves_control(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters) {
  if (!parameters.analysis.control) return true;
  const Model& model = problem->model;
  const StepExaminer examiner(problem, parameters, nullptr, 1.0);
  try {
    const PathDirection tangent = examiner.station(model.reference_state(), 0.0, nullptr).tangent;
    const double rate = weights_of(model, *parameters.analysis.control).inner_product(tangent.x);
    return !std::isfinite(rate) || moves(examiner.measure(), tangent, rate);
  } catch (const LinearSolverError&) {
    return true;
  }
}

}  // namespace mixbeam
