// A load path from one stable state to the next: load steps that follow the path as long as it is stable, and where it
// ends or turns unstable a jump down the total potential.
#include "discretization/assembly/equation_place.hpp"
#include "discretization/state/difference.hpp"
#include "discretization/state/potential.hpp"
#include "kernels/math/vector_algebra.hpp"
#include "nonlinear/path/descent.hpp"
#include "nonlinear/path/path_recorder.hpp"
#include "nonlinear/path/step_judge.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// A step that follows a stable path takes a few iterations; more of them cost more than smaller steps.
constexpr int kMostIterationsOfStableStep = 12;
/// Without steps of the user's own the load of a jump is known to this share of a stage.
constexpr double kBracketOfJump = 1.0 / 16.0;
/// Steps grow by this after one that has followed the path.
constexpr double kGrowth = 2.0;

class JumpPath {
 public:
  JumpPath(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& start,
           const StageRange& range, PathRecorder& recorder)
      : problem_(problem),
        parameters_(parameters),
        range_(range),
        recorder_(recorder),
        rule_(step_size_rule(problem->model, parameters)),
        corrector_(problem, parameters, recorder.record()),
        judge_(problem, parameters, recorder.counts(), range.to),
        here_{start, range.from, {problem->model.create_vector(), 0.0}, {}},
        attempts_left_(range.attempts) {}

  bool follow() {
    try {
      if (recorder_.counts() == nullptr) {
        recorder_.rejected("jumps need the stability of states, which is not counted in a structure of this size", 0);
        return false;
      }
      if (!begin()) return false;
      while (!is_end_of_stage(here_.load_factor, range_.to))
        if (attempts_left_-- <= 0 || !step()) return false;
      return true;
    } catch (const PathInterrupted&) {
      recorder_.interrupted();
      return false;
    }
  }

 private:
  bool is_stable(const Station& at) const {
    return at.stability && (at.stability->verdict() == Verdict::stable || at.stability->verdict() == Verdict::neutral);
  }

  /// The state at the start of the stage, stable.
  bool begin() {
    recorder_.enter_stage(range_.stage, range_.attempts);
    size_ = range_.before ? range_.before->step_size : rule_.initial;
    if (range_.before) {
      here_ = judge_.station(here_.state, here_.load_factor, nullptr);
      return started_ = true;
    }
    const Correction start =
        corrector_.at_load({here_.state, here_.load_factor}, parameters_.newton.maximum_iterations);
    if (!start.converged) {
      recorder_.not_converged();
      return false;
    }
    Station at = judge_.station(start.state, start.load_factor, nullptr);
    if (!is_stable(at)) {
      here_ = std::move(at);
      return jump(here_.load_factor);
    }
    accept(std::move(at), start.residual, {});
    return true;
  }

  void accept(Station next, double residual, const std::optional<RecordedJump>& jump) {
    here_ = std::move(next);
    started_ = true;
    ConvergedStep step{here_.state, here_.load_factor, residual};
    step.step_size = size_;
    step.stability = here_.stability;
    step.jump = jump;
    recorder_.set_attempts(range_.attempts - attempts_left_);
    recorder_.converged(step);
  }

  bool step() {
    const double rest = range_.to - here_.load_factor, size = std::min(size_, rest);
    const double target = size == rest ? range_.to : here_.load_factor + size;
    if (follows_to(target)) return true;
    const bool own_steps = rule_.method == LoadPathMethod::fixed;
    if (!own_steps && size > std::max(rule_.minimum, kBracketOfJump)) {
      size_ = 0.5 * size;
      return true;
    }
    if (jump(target)) return true;
    size_ = 0.5 * size;
    return size_ >= rule_.minimum;
  }

  /// Along the stable path, if it goes as far.
  bool follows_to(double target) {
    const PathDirection way = scaled(here_.tangent, (target - here_.load_factor) / here_.tangent.load);
    const bool predicts = here_.cap_ratio == 0.0 && std::isfinite(way.load) && std::isfinite(way.x.maximum_norm());
    const Correction found =
        corrector_.at_load_along({here_.state, target}, predicts ? &way.x : nullptr, kMostIterationsOfStableStep);
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
    if (rule_.method != LoadPathMethod::fixed) size_ = std::min(rule_.maximum, kGrowth * size_);
    accept(std::move(next), found.residual, {});
    return true;
  }

  bool jump(double target) {
    if (descent_ == nullptr)
      descent_ = std::make_unique<Descent>(problem_, parameters_, corrector_, *recorder_.counts(), judge_.measure(),
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
    // Newton's method may have missed a state on the path.
    const bool is_step = started_ && judge_.examine({here_, moved, next}, kLoadStep).objection.empty();
    std::optional<RecordedJump> jump;
    if (!is_step) jump = description(found, moved, result.factorizations);
    accept(std::move(next), found.residual, jump);
    return true;
  }

  RecordedJump description(const Correction& found, const PathDirection& way, int factorizations) const {
    const Model& model = problem_->model;
    RecordedJump jump{here_.load_factor, found.load_factor};
    jump.released = released_energy(model, here_.state, jump.from, found.state, jump.to);
    jump.motion = judge_.measure().motion(way.x);
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
  StepSizeRule rule_;
  Corrector corrector_;
  StepJudge judge_;
  std::unique_ptr<Descent> descent_{};
  Station here_;
  bool started_ = false;  ///< here_ is a stable state
  double size_ = 0.0;     ///< of the next step
  int attempts_left_ = 0;
};

}  // namespace

bool follow_stage_with_jumps(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                             const State& start, const StageRange& range, PathRecorder& recorder) {
  return JumpPath(problem, parameters, start, range, recorder).follow();
}

}  // namespace mixbeam
