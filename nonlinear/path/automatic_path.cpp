// A load path without tuning: load steps as large as Newton's method permits; where one fails or the stability changes
// within it, arc-length steps along the path, through limit points and snap-backs.
//
// Or from one stable state to the next: load steps that follow the path while it is stable, and where it ends or
// becomes unstable a jump down the total potential.
//
// LOCA's constrained group is used without its stepper, which cannot be resumed exactly along the arc length (its
// scaling depends on all previous steps), does not report why a step failed, and has no events between steps.
#include "discretization/assembly/equation_place.hpp"
#include "discretization/state/difference.hpp"
#include "discretization/state/potential.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/diagnosis/limp_members.hpp"
#include "nonlinear/path/branch.hpp"
#include "nonlinear/path/descent.hpp"
#include "nonlinear/path/path_goal.hpp"
#include "nonlinear/path/path_recorder.hpp"
#include "nonlinear/path/steep_start.hpp"
#include "nonlinear/path/step_judge.hpp"
#include "nonlinear/path/step_size.hpp"
#include "nonlinear/path/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace mixbeam {

namespace {

class AutomaticPath {
 public:
  AutomaticPath(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& start,
                const StageRange& range, PathRecorder& recorder)
      : problem_(problem),
        parameters_(parameters),
        range_(range),
        recorder_(recorder),
        jumps_(parameters.analysis.snap == Snap::jump),
        goal_(problem->model, jumps_ ? std::nullopt : parameters.analysis.control, range.to),
        rule_(step_size_rule(problem->model, parameters)),
        corrector_(problem, parameters, recorder.record()),
        judge_(problem, parameters, recorder.counts(), range.to),
        measure_(judge_.measure()),
        here_{start, range.from, {problem->model.create_vector(), 0.0}, {}},
        attempts_left_(range.attempts) {}

  bool follow() {
    try {
      if (jumps_ && recorder_.counts() == nullptr)
        throw GaveUp{"jumps need the stability of states, which is not counted in a structure of this size"};
      if (!begin()) return false;
      if (jumps_) {
        while (!arrived())
          if (!may_try() || !step_or_jump()) return false;
        return true;
      }
      const bool goes_along = parameters_.analysis.trace || !moves_at_first();
      if (!moves_at_first() && !range_.before) start_ = here_;
      if (goes_along && !along_path_ && !arrived() && !start_along_path()) return false;
      while (!arrived()) {
        if (!may_try()) return false;
        if (!(along_path_ ? step_along_path() : step_to_goal()) && !set_out_steeply()) return false;
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

 private:
  PathDirection increments(const Correction& found) const {
    return {found.moved.clone(true), found.load_factor - here_.load_factor};
  }
  double load_factor(double parameter) const { return judge_.loads().load_factor(parameter); }
  bool may_try() { return attempts_left_-- > 0; }
  bool arrived() const { return goal_.is_reached(here_.state, here_.load_factor); }
  double goal_now() const { return goal_.at(here_.state, here_.load_factor); }

  /// Makes the station. The path may be resumed here within a stage, so bits must not depend on earlier tangents.
  Station station_at(const Correction& found, const PathDirection* along) {
    if (!goal_.is_reached(found.state, found.load_factor)) problem_->forget_tangents();
    return judge_.station(found.state, found.load_factor, along);
  }

  /// Solves at the start of the stage, or restores the data of a completed step to continue from it.
  bool begin() {
    recorder_.enter_stage(range_.stage, range_.attempts);
    size_ = rule_.initial;
    branched_ = recorder_.branched();
    if (range_.before) {
      const PathPoint& before = *range_.before;
      size_ = before.step_size;
      along_path_ = before.path_length != 0.0;
      length_ = before.path_length;
      here_ = judge_.station(here_.state, here_.load_factor, nullptr);
      if (before.direction < 0) here_.tangent = scaled(here_.tangent, -1.0);
      begin_way();
      return true;
    }
    const Correction start = corrector_.at_load(here_.state, here_.load_factor, parameters_.newton.maximum_iterations);
    if (!start.converged) {
      recorder_.not_converged();
      return false;
    }
    Station at = jumps_ ? judge_.station(start.state, start.load_factor, nullptr) : station_at(start, nullptr);
    if (jumps_ && !is_stable(at)) {
      here_ = std::move(at);
      return jump(here_.load_factor, false);
    }
    accept(std::move(at), start.residual, {});
    begin_way();
    return true;
  }

  /// Sets the origin for detecting motion of the controlled displacement, and the return of the path.
  void begin_way() {
    way_.emplace(here_);
    start_of_goal_ = goal_now();
  }

  void accept(Station next, double residual, std::vector<CriticalPoint> passed,
              const std::optional<RecordedJump>& jump = {}) {
    here_ = std::move(next);
    failures_in_a_row_ = 0;
    ConvergedStep step{here_.state, here_.load_factor, residual};
    step.step_size = size_;
    step.path_length = along_path_ ? length_ : 0.0;
    step.direction = here_.tangent.load < 0.0 ? -1 : 1;
    step.branched = branched_;
    step.stability = here_.stability;
    if (goal_.is_controlled() && here_.stability && recorder_.reports_stability()) {
      const MixedVector held = goal_.row(here_.load_factor, 0.0).weights;
      step.held_stability = recorder_.counts()->try_ask({here_.state, here_.load_factor, nullptr, &held}, How::held);
    }
    step.critical_points = std::move(passed);
    step.jump = jump;
    recorder_.set_attempts(range_.attempts - attempts_left_);
    recorder_.converged(step);
  }

  /// Counts a failure and leaves the plane after several: if elements rotate by many radians each, Newton's method
  /// converges less often in the plane than in space.
  void not_converged() {
    recorder_.not_converged();
    if (++failures_in_a_row_ >= path_limit.failures_in_plane) here_.state.in_plane = false;
  }

  bool take(const Correction& found, const StepTest& test) {
    const PathDirection moved = increments(found);
    // A load step runs along the path in the direction of growing load.
    const PathDirection* along = !along_path_ && !goal_.is_controlled() ? nullptr : &moved;
    Station next = station_at(found, along);
    const int tangents = problem_->work.factorizations;
    StepFindings findings = judge_.examine({here_, moved, next}, test);
    if (!findings.objection.empty() && !hangs(next)) {
      recorder_.rejected(findings.objection, found.iterations);
      return false;
    }
    std::vector<CriticalPoint>& passed = findings.passed;
    for (const CriticalPoint& point : passed)
      if (take_branch(point, passed)) return !leads_away() || set_out_backwards();
    if (!passed.empty() && critical_load_ == 0.0) critical_load_ = std::abs(passed.front().load_factor);
    if (!passed.empty())
      goal_.require_motion(
          start_of_goal_, next,
          "the structure buckles at load factor " + rounded(load_factor(passed.front().load_factor), 6));
    way_->add(measure_, moved, problem_->model, passed);
    if (along_path_ && way_->returns(measure_, next, moved)) {
      recorder_.returned();
      throw GaveUp{"the path returns to an earlier state: it has changed to another one before load factor " +
                   rounded(load_factor(next.load_factor), 6)};
    }
    if (problem_->tries_iteration() && problem_->work.factorizations > tangents) next = station_at(found, along);
    accept(std::move(next), found.residual, std::move(passed));
    return true;
  }

  /// Closeness here. A path from a regular start cannot close: if it does, it has changed to a nearby path, and is
  /// followed again, more closely where other paths may be near.
  int closeness() const {
    const bool is_unstable = here_.stability && here_.stability->negative > 0;
    return (parameters_.analysis.trace ? 1 : 0) + (is_unstable ? parameters_.analysis.closeness : 0);
  }

  /// Whether the load moves the controlled displacement at first: otherwise no step of that has a direction.
  bool moves_at_first() const {
    return !goal_.is_controlled() || !here_.has_tangent() || goal_.is_moved_by(measure_, here_.tangent);
  }

  bool step_to_goal() {
    const double now = goal_now(), rest = goal_.value() - now;
    const double size = std::copysign(std::min(size_, std::abs(rest)), rest);
    const bool is_last = std::abs(rest) <= size_ * (1.0 + path_limit.rounded_steps);
    const int most = std::min<int>(path_limit.most_iterations_of_load_step, parameters_.newton.maximum_iterations);
    const PathDirection way = scaled(here_.tangent, size / goal_.rate(here_.tangent));
    const bool is_known = here_.has_tangent() && std::isfinite(way.load) && std::isfinite(way.x.maximum_norm());
    const Correction found = goal_.correct(corrector_, here_, is_last ? goal_.value() : now + size,
                                           is_known && !goal_.is_controlled() ? &way : nullptr, most);
    const bool turns = !goal_.is_controlled() && !judge_.loads().is_straight(now, now + size);
    if (found.converged) {
      const double before = size_;
      size_ = std::min(rule_.maximum, rule_.after_success(size_, found.iterations));
      if (take(found, kLoadStep)) return true;
      size_ = before;
    } else {
      not_converged();
    }
    if (is_at_start() && has_limp_members(problem_->model, here_.state, range_.to) && set_out_steeply()) return true;
    return turns ? shorten_load_step(size) : start_along_path();
  }

  bool is_at_start() const { return here_.load_factor == range_.from && !range_.before && !goal_.is_controlled(); }

  /// Whether the initial loads rotate members, and so determine to which side limp ones sag. A column under pure thrust
  /// may be as limp, but buckles to either side.
  bool sets_out_sideways() const {
    return !here_.has_tangent() || here_.tangent.x.largest_vertex_spin() > path_limit.least_sideways_spin;
  }

  /// Whether a step from the start, where no direction predicts it, has led to the only stable state of cables.
  bool hangs(const Station& next) const {
    const bool is_stable = next.stability && next.stability->verdict() != Verdict::unstable;
    const auto is_limp = [&] {  // a truss in tension after snap-through, in contrast, has passed limit points
      return !here_.has_tangent() || has_limp_members(problem_->model, here_.state, range_.to);
    };
    return is_at_start() && !along_path_ && is_stable && sets_out_sideways() && is_limp() &&
           hangs_in_tension(problem_->model, next.state, next.load_factor);
  }

  /// Halves the load step. Where loads turn back the path does so too, and arc-length steps would have to reverse.
  bool shorten_load_step(double size) {
    size_ = 0.5 * std::abs(size);
    return size_ >= rule_.minimum;
  }

  /// Whether the loads turn back within reach of the next step along the path, which then becomes a load step.
  bool meets_turning_loads() {
    if (goal_.is_controlled() || !(here_.tangent.load > 0.0)) return false;
    const double reach =
        std::min(path_limit.reach_of_turns * length_ * here_.tangent.load, range_.to - here_.load_factor);
    if (judge_.loads().is_straight(here_.load_factor, here_.load_factor + reach)) return false;
    along_path_ = false;
    size_ = std::clamp(reach, rule_.minimum, rule_.maximum);
    return true;
  }

  bool start_along_path() {
    if (!here_.has_tangent()) {
      recorder_.rejected("the direction of the path could not be computed: " + problem_->last_failure, 0);
      return false;
    }
    along_path_ = true;
    const double rate = goal_.rate(here_.tangent);
    // Start towards the goal. A displacement that the load does not move at first may reach it later, or not.
    if (moves_at_first() && goal_.is_controlled() && rate * (goal_.value() - goal_now()) < 0.0)
      here_.tangent = scaled(here_.tangent, -1.0);
    const double spin = here_.tangent.x.largest_vertex_spin();
    length_ = spin > 0.0 ? path_limit.first_spin / spin : 1.0;
    const double to_goal = std::abs((goal_.value() - goal_now()) / rate);
    if (std::isfinite(to_goal)) length_ = std::min(length_, to_goal);
    // At most one stage; if loads are not proportional less than the failed load step, which would be tried again.
    const double farthest =
        judge_.loads().is_straight(here_.load_factor, range_.to) ? 1.0 : size_ / path_limit.reach_of_turns;
    length_ = std::min(length_, farthest / std::max(std::abs(here_.tangent.load), 1e-300));
    return true;
  }

  /// Newton's method from the predicted point, or at the goal if the prediction or the path passes it.
  bool attempt(Correction& result, double& length) {
    const double rest = goal_.value() - goal_now();
    const double largest = rule_.maximum / std::max(std::abs(goal_.rate(here_.tangent)), 1e-300);
    const double step = length = std::min(length_, largest);
    const double to_goal = rest / goal_.rate(here_.tangent);
    if (to_goal > 0.0 && to_goal <= step * (1.0 + path_limit.rounded_steps)) {
      length = to_goal;
      const PathDirection guess = scaled(here_.tangent, to_goal);
      result = goal_.correct(corrector_, here_, goal_.value(), &guess, path_limit.most_iterations_along_path);
      if (!result.converged && !goal_.is_controlled())  // the cap of at_load() shifts critical loads by 1e-5
        result = corrector_.on_row({here_.state, here_.load_factor + guess.load, &guess.x},
                                   goal_.row(here_.load_factor, rest), path_limit.most_iterations_along_path);
      return result.converged;
    }
    const PathDirection guess = scaled(here_.tangent, step);
    result =
        corrector_.on_row({here_.state, here_.load_factor + guess.load, &guess.x},
                          measure_.row(here_.tangent, here_.load_factor, step), path_limit.most_iterations_along_path);
    result = goal_.within(corrector_, here_, std::move(result), rule_.maximum, path_limit.most_iterations_along_path);
    return result.converged;
  }

  bool shorten(double length) {
    length_ = 0.5 * length;
    return length_ >= path_limit.shortest_step;
  }

  void adapt_length(const Correction& found, double length, const PathDirection& before) {
    const PathDirection moved = increments(found);
    const double cosine = std::abs(measure_.cosine(before.x, moved.x));
    const bool is_still =
        measure_.motion(moved.x) < path_limit.no_motion;  // only the load measures the path: there is no angle
    const double angle = is_still ? 0.0 : 2.0 * std::acos(std::clamp(cosine, 0.0, 1.0));
    length_ = length * growth_along_path(found.iterations, angle, closeness());
  }

  bool step_along_path() {
    if (meets_turning_loads()) return true;
    Correction found{false, here_.state, here_.load_factor, problem_->model.create_vector()};
    double length = 0.0;
    if (!attempt(found, length)) {
      not_converged();
      return shorten(length);
    }
    adapt_length(found, length, here_.tangent);
    if (!take(found, closeness() > 0 ? kTracedStep : kPathStep)) return shorten(length);
    if (goal_.is_controlled()) return stays_in_reach() || set_out_backwards();
    if (std::abs(here_.load_factor - range_.to) < path_limit.largest_detour) return true;
    recorder_.rejected("the path leads away from the end of the stage", 0);
    return false;
  }

  /// Whether a controlled displacement has passed its target by more than rounding.
  bool has_passed_goal(const State& state, double load_factor) const {
    return goal_.is_controlled() && !goal_.is_reached(state, load_factor) &&
           (goal_.value() - goal_.at(state, load_factor)) * (goal_.value() - start_of_goal_) < 0.0;
  }

  /// Whether the first point of a branch is farther from a controlled goal than the start.
  bool leads_away() const {
    return start_ && std::abs(goal_.value() - goal_now()) >
                         std::abs(goal_.value() - goal_.at(start_->state, 0.0)) + path_limit.still;
  }

  /// Whether the load factor is within a limit, beyond which a controlled displacement is unlikely to reach its target.
  bool stays_in_reach() {
    if (has_passed_goal(here_.state, here_.load_factor))
      throw GaveUp{"the controlled displacement has passed its target"};
    if (first_load_ == 0.0) first_load_ = std::max(1.0, std::abs(here_.load_factor));
    return std::abs(here_.load_factor) <=
           path_limit.largest_controlled_load * (critical_load_ > 0.0 ? critical_load_ : first_load_);
  }

  /// Restarts with a falling load, once. If a controlled displacement does not move at first, the sense in which the
  /// load moves it is unknown: a falling load may reach the target.
  bool set_out_backwards() {
    const std::string where = "load factor " + rounded(here_.load_factor, 6);
    if (!start_) {
      goal_.require_motion(start_of_goal_, here_, where);
      throw GaveUp{"the controlled displacement does not reach its target up to " + where};
    }
    recorder_.rejected("the target lies elsewhere: the load sets out once more, falling", 0);
    here_ = *std::exchange(start_, std::nullopt);
    here_.tangent = scaled(here_.tangent, -1.0);
    branched_ = false;
    first_load_ = critical_load_ = 0.0;
    begin_way();
    return start_along_path();
  }

  /// Steps to the first point of a path with infinite initial slope, like that of limp cables and of inextensible rods.
  bool set_out_steeply() {
    if (!is_at_start() || sets_out_in_vain_) return false;
    const bool is_limp = has_limp_members(problem_->model, here_.state, range_.to);
    if (is_limp && !sets_out_sideways()) return false;
    sets_out_in_vain_ = true;
    const auto found = first_point_of_steep_path(problem_, parameters_, here_.state, range_, recorder_.counts());
    if (!found) return false;
    const PathDirection moved = increments(*found);
    Station next = station_at(*found, &moved);
    if (!next.has_tangent()) return false;
    branched_ = branched_ || (!is_limp && parameters_.analysis.branch != Branch::primary);
    along_path_ = true;
    length_ = measure_.length(moved);
    accept(std::move(next), found->residual, {});
    begin_way();
    return true;
  }

  /// Steps onto the branch that crosses the path at `from`, if requested.
  bool take_branch(const CriticalPoint& from, std::vector<CriticalPoint>& passed) {
    if (from.kind != CriticalKind::bifurcation || branched_ || parameters_.analysis.branch == Branch::primary)
      return false;
    const std::optional<MixedVector> direction =
        branch_direction(*problem_, parameters_.analysis, measure_, from.eigenspace);
    if (from.eigenspace.empty())
      throw GaveUp{
          "the bifurcation at load factor " + rounded(load_factor(from.load_factor), 6) +
          " has no mode to branch off along: an element buckles between its vertices (more \"Elements\"), or " +
          "several critical points lie together"};
    if (!direction)
      throw GaveUp{"the mode of the bifurcation at load factor " + rounded(load_factor(from.load_factor), 6) +
                   " does not move the point that chooses the branch"};
    const auto stays_near = [&](const Correction& found) {
      if (!found.converged) not_converged();
      return found.converged && std::abs(found.load_factor - from.load_factor) <= rule_.maximum &&
             (goal_.is_controlled() ? !has_passed_goal(found.state, found.load_factor)
                                    : found.load_factor <= range_.to);
    };
    const auto point = first_point_of_branch(*problem_, corrector_, measure_, from, *direction, stays_near);
    if (!point)
      throw GaveUp{"the branch at load factor " + rounded(load_factor(from.load_factor), 6) + " could not be taken"};
    const PathDirection moved{point->found.moved.clone(true), point->found.load_factor - from.load_factor};
    branched_ = along_path_ = true;
    length_ = point->amplitude;
    std::vector<CriticalPoint> up_to_here(passed.begin(), passed.begin() + (&from - passed.data()) + 1);
    accept(station_at(point->found, &moved), point->found.residual, std::move(up_to_here));
    begin_way();
    return true;
  }

  bool is_stable(const Station& at) const {
    return at.stability && (at.stability->verdict() == Verdict::stable || at.stability->verdict() == Verdict::neutral);
  }

  bool step_or_jump() {
    const double rest = range_.to - here_.load_factor, size = std::min(size_, rest);
    const double target = size == rest ? range_.to : here_.load_factor + size;
    if (follows_to(target)) return true;
    const bool own_steps = rule_.method == LoadPathMethod::fixed;
    if (!own_steps && size > std::max(rule_.minimum, path_limit.bracket_of_jump)) {
      size_ = 0.5 * size;
      return true;
    }
    if (jump(target, true)) return true;
    size_ = 0.5 * size;
    return size_ >= rule_.minimum;
  }

  /// Steps along the stable path to the target, if it leads there.
  bool follows_to(double target) {
    const PathDirection way = scaled(here_.tangent, (target - here_.load_factor) / here_.tangent.load);
    const bool predicts = here_.cap_ratio == 0.0 && std::isfinite(way.load) && std::isfinite(way.x.maximum_norm());
    const Correction found =
        corrector_.at_load(here_.state, target, path_limit.most_iterations_of_easy_solve, predicts ? &way.x : nullptr);
    if (!found.converged) {
      recorder_.not_converged();
      return false;
    }
    Station next = judge_.station(found.state, target, nullptr);
    const PathDirection moved{found.moved.clone(true), target - here_.load_factor};
    std::string objection = is_stable(next) ? judge_.examine({here_, moved, next}, kLoadStep).objection
                                            : "the equilibrium that was found is not stable";
    if (!objection.empty()) {
      recorder_.rejected(objection, found.iterations);
      return false;
    }
    if (rule_.method != LoadPathMethod::fixed) size_ = std::min(rule_.maximum, path_limit.largest_growth * size_);
    accept(std::move(next), found.residual, {});
    return true;
  }

  /// Descends to a stable state at the target. `from_stable`: Newton's method may have missed the path from `here_`.
  bool jump(double target, bool from_stable) {
    if (descent_ == nullptr)
      descent_ = std::make_unique<Descent>(problem_, parameters_, corrector_, *recorder_.counts(), measure_,
                                           recorder_.descent_observer());
    const DescentResult result = descent_->from(here_.state, target);
    if (!result.found) {
      recorder_.rejected(result.cause, result.factorizations);
      return false;
    }
    const Correction& found = *result.found;
    MixedVector none = problem_->model.create_vector();
    none.fill(0.0);
    const PathDirection moved{increment_between(problem_->model, here_.state, found.state, none),
                              target - here_.load_factor};
    Station next = judge_.station(found.state, target, nullptr);
    const bool is_step = from_stable && judge_.examine({here_, moved, next}, kLoadStep).objection.empty();
    std::optional<RecordedJump> jump;
    if (!is_step) jump = description(found, moved, result.factorizations);
    accept(std::move(next), found.residual, {}, jump);
    return true;
  }

  RecordedJump description(const Correction& found, const PathDirection& way, int factorizations) const {
    const Model& model = problem_->model;
    RecordedJump jump{here_.load_factor, found.load_factor};
    jump.released = released_energy(model, here_.state, jump.from, found.state, jump.to);
    jump.motion = measure_.motion(way.x);
    jump.factorizations = factorizations;
    const StateDifference moved = difference(model, here_.state, found.state);
    jump.largest = moved.largest_change;
    jump.place = text_of(place_of_vertex(model, moved.farthest_vertex));
    return jump;
  }

  Teuchos::RCP<BeamProblem> problem_;
  const SolverParameters& parameters_;
  const StageRange& range_;
  PathRecorder& recorder_;
  bool jumps_;  ///< from one stable state to the next
  PathGoal goal_;
  StepSizeRule rule_;
  Corrector corrector_;
  StepJudge judge_;
  const PathMeasure& measure_;
  std::unique_ptr<Descent> descent_{};
  Station here_;              ///< present point
  std::optional<Way> way_{};  ///< since the start of the stage, branch or resumed path, like start_of_goal_
  double start_of_goal_ = 0.0;
  std::optional<Station> start_{};                 ///< under displacement control, until falling loads were tried
  double first_load_ = 0.0, critical_load_ = 0.0;  ///< magnitudes of load factors; 0: not known yet
  bool along_path_ = false;                        ///< steps run along the path; false: to the goal
  double size_ = 0.0;                              ///< of the next step to the goal
  double length_ = 0.0;                            ///< of the next step along the path
  bool branched_ = false;
  bool sets_out_in_vain_ = false;  ///< a steep start has been tried
  int attempts_left_ = 0;
  int failures_in_a_row_ = 0;
};

}  // namespace

bool follow_stage_automatically(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                const State& start, const StageRange& range, PathRecorder& recorder) {
  return AutomaticPath(problem, parameters, start, range, recorder).follow();
}

}  // namespace mixbeam
