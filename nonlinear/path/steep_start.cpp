#include "nonlinear/path/steep_start.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/state/difference.hpp"
#include "nonlinear/diagnosis/limp_members.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/path/descent.hpp"
#include "nonlinear/path/path_recorder.hpp"
#include "nonlinear/path/thresholds.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mixbeam {

namespace {

/// Stiffnesses of yielding members in tension and shear, over EI / l^2 of the shortest one: a clamped member buckles
/// under 4 pi^2 EI / l^2, at a strain of 0.4 %. If its ends approach by little more than that, the next one is needed.
constexpr double kYielding[] = {1e4, 1e6, 1e8};

/// Modification of stiffnesses for the auxiliary structure.
struct Easing {
  double load = 0.0;      ///< in limp members; zero: none is limp, and rigid ones yield
  double length = 0.0;    ///< of the structure; of the shortest member if rigid ones yield
  double yielding = 0.0;  ///< see kYielding

  bool is_limp(const Section& section) const { return mixbeam::is_limp(section, load, length); }
  Scene scene(const Scene& own, double share) const;
};

/// Interpolates geometrically between the eased and the own stiffness; an infinite one is reached at the end only.
double between(double eased, double own, double share) {
  if (std::isinf(own)) return share < 1.0 ? eased * std::pow(10.0, share * path_limit.decades_to_rigid) : own;
  return eased * std::pow(own / eased, share);
}

/// Returns the scene at a share of the way back. Sections that are neither limp nor yield are unchanged.
Scene Easing::scene(const Scene& own, double share) const {
  Scene result = own;
  result.accuracy.reset();
  for (Section& section : result.sections) {
    auto stiffness = diagonal(section);
    const double bending = bending_of(section);
    if (!std::isfinite(bending)) continue;  // rigid bodies do not buckle; coupled sections stay unchanged
    if (is_limp(section)) {
      const double raise = std::pow(path_limit.stiffness_of_limp * load * length * length / bending, 1.0 - share);
      for (int i = 3; i < 6; ++i) stiffness[i] *= raise;
      stiffness[0] =
          between(std::min(stiffness[0], path_limit.tension_of_limp * load), stiffness[0], std::max(share, 0.0));
    } else if (load == 0.0) {
      for (int i = 0; i < 3; ++i)
        if (std::isinf(stiffness[i]))
          stiffness[i] = between(yielding * bending / (length * length), stiffness[i], share);
    }
    set_diagonal(section, stiffness);
  }
  return result;
}

bool differs(const Scene& scene, const Scene& eased) {
  for (size_t i = 0; i < scene.sections.size(); ++i)
    if (diagonal(scene.sections[i]) != diagonal(eased.sections[i])) return true;
  return false;
}

Easing easing_of(const Model& model, const State& state, double load_factor) {
  if (has_limp_members(model, state, load_factor))
    return {magnitude_of(model, state, load_factor).load_force, model.structure().length};
  return {0.0, *std::min_element(model.mesh().member_length.begin(), model.mesh().member_length.end())};
}

/// Whether loads are dead forces, and no slider rotates with the structure.
bool is_dead(const Scene& scene) {
  const auto none = [](const auto& all, const auto& is) { return std::none_of(all.begin(), all.end(), is); };
  return none(scene.point_loads,
              [](const PointLoad& l) { return l.frame == LoadFrame::follower || l.moment != Vector3{}; }) &&
         none(scene.distributed_loads, [](const DistributedLoad& l) { return l.frame == LoadFrame::follower; }) &&
         none(scene.joints, [](const Joint& joint) { return joint.kind == JointKind::slider; });
}

/// Smallest axial force N at the force points of members whose section `counts`.
template <class Counts>
double least_tension(const Model& model, const State& state, const Counts& counts) {
  double least = std::numeric_limits<double>::infinity(), all = least;
  for_each_element(model.structure(), state, [&](const ElementView& element) {
    const ElementBlock& block = element.block();
    if (!counts(model.scene().sections[block.section(element.index())])) return;
    const int points =
        block.general_section ? block.interior.force_points : axial_points(block.order, block.force_integration);
    for (int q = 0; q < points; ++q) least = std::min(least, element.force(q)[0]);
  });
  Teuchos::reduceAll(*model.map()->getComm(), Teuchos::REDUCE_MIN, 1, &least, &all);
  return all;
}

/// Largest displacement of a vertex between two states.
double motion(const Model& model, const State& a, const State& b) { return difference(model, a, b).largest_change; }

bool is_stable(Stability& stability, const Correction& at) {
  const auto found = stability.try_ask({at.state, at.load_factor}, How::inertia);
  return found && (found->verdict() == Verdict::stable || found->verdict() == Verdict::neutral);
}

/// Follows the path of the auxiliary problem, which is not reported.
class SteepStart {
 public:
  SteepStart(const Teuchos::RCP<BeamProblem>& own, const SolverParameters& parameters, const State& start,
             const StageRange& range, Stability* stability)
      : own_(own),
        scene_(own->model.scene()),
        parameters_(parameters),
        eased_parameters_(parameters),
        start_(start),
        range_(range),
        stability_(stability),
        easing_(easing_of(own->model, start, range.to)) {
    if (easing_.load > 0.0)
      eased_parameters_.newton.residual_tolerance =
          std::max(path_limit.tolerance_back, parameters.newton.residual_tolerance);
  }

  std::optional<Correction> first_point() {
    if (easing_.load > 0.0) {
      const int before = own_->work.check_iterations;
      const std::vector<const Section*> sections = sections_of_members(scene_);
      are_cables_ = is_dead(scene_) && std::all_of(sections.begin(), sections.end(),
                                                   [&](const Section* section) { return easing_.is_limp(*section); });
      are_cables_ ? hang() : follow();
      own_->work.newton_iterations += own_->work.check_iterations - before;  // they belong to the step
      own_->work.check_iterations = before;
    } else if (imposes_deformation(scene_)) {
      for (const double ratio : kYielding) {
        easing_.yielding = ratio;
        if (!first_ && !is_lost_ && differs(scene_, easing_.scene(scene_, 0.0))) follow();
      }
    }
    return std::move(first_);
  }

 private:
  /// Solves for cables at the end of the range directly: they have only one stable state, whatever the path to it.
  void hang() {
    for (const double share : {0.0, path_limit.share_stiffer}) {
      const auto found = solved(problem_at(share), start_, range_.to, true);
      if (found) first_ = back_from(found->state, range_.to, share);
      if (first_) break;
      descents_ = 0;
    }
    if (first_ && !hangs_in_tension(own_->model, first_->state, range_.to)) first_.reset();
  }

  void follow() {
    const auto problem = problem_at(0.0);
    double next_try = 0.0;  // load factor relative to the start
    bool gives_up = false, branched = false;
    PathControl control;
    control.resume.emplace();  // the start is known
    control.resume->load_factor = range_.from;
    control.stop = [&] { return gives_up || is_lost_ || first_.has_value(); };
    const PathObserver back = [&](const StepReport& report, const State& state) {
      const bool branches = report.point.branched && !branched;
      branched = report.point.branched;
      is_lost_ = !report.critical_points.empty() && !branches;
      gives_up = report.step > path_limit.most_eased_steps;
      const double loaded = report.load_factor - range_.from;
      if (gives_up || is_lost_ || (loaded < next_try && report.load_factor < range_.to)) return;
      first_ = back_from(state, report.load_factor, 0.0);
      next_try = path_limit.next_try * loaded;
    };
    SolverParameters parameters = eased_parameters_;
    parameters.analysis.stability = true;  // critical points must be detected
    State state = start_;
    LoadPathResult result;
    PathRecorder recorder(problem, parameters, state, back, control, result);
    problem->attempts.start_path(0, {});
    follow_stage_automatically(problem, parameters, start_, range_, recorder);
    count_work(*problem);
    if (own_->leave_if_asked) own_->leave_if_asked();  // an interruption has left only the inner path so far
  }

  Teuchos::RCP<BeamProblem> problem_at(double share) const {
    if (share == 1.0) return own_;
    const auto problem =
        Teuchos::rcp(new BeamProblem(easing_.scene(scene_, share), own_->model.map()->getComm(), eased_parameters_));
    problem->leave_if_asked = own_->leave_if_asked;
    problem->model.clock().run(range_.piece);
    return problem;
  }

  void count_work(const BeamProblem& done) {
    if (&done == own_.get()) return;
    own_->work.check_iterations += done.work.newton_iterations + done.work.check_iterations;
    own_->work.looks += done.work.looks;
  }

  /// Finds an equilibrium near a state; for cables a stable one, if necessary and `is_near` by a descent.
  std::optional<Correction> solved(const Teuchos::RCP<BeamProblem>& problem, const State& near, double load_factor,
                                   bool is_near) {
    SolveRecord record;
    const SolverParameters& parameters = problem == own_ ? parameters_ : eased_parameters_;
    Corrector corrector(problem, parameters, record, NewtonPurpose::check);
    std::optional<Correction> found = corrector.at_load(near, load_factor, path_limit.most_iterations_of_easy_solve);
    if (are_cables_) {
      Stability stability(*problem);
      const bool is_equilibrium = found->converged;
      found->converged = is_equilibrium && is_stable(stability, *found);
      if (!found->converged && is_near && ++descents_ <= path_limit.most_descents) {
        const PathMeasure measure(problem->model);
        Descent descent(problem, parameters, corrector, stability, measure, {});
        found = descent.from(is_equilibrium ? found->state : near, load_factor).found;
        if (found) found->iterations = path_limit.most_iterations_of_easy_solve;  // so that steps do not grow
      }
    }
    count_work(*problem);
    if (found && !found->converged) found.reset();
    return found;
  }

  /// Restores the own stiffnesses at the load factor of an equilibrium of the auxiliary structure, from its share
  /// `done` of the way. From the second solution on the chord predicts the next.
  std::optional<Correction> back_from(const State& eased, double load_factor, double done) {
    std::optional<Correction> found;
    State before = eased;
    double share = path_limit.first_share_back, last = 0.0;
    for (int i = 0; i < path_limit.most_solutions_back && done < 1.0 && share >= path_limit.least_share_back; ++i) {
      const double next = done + share < 1.0 - path_limit.least_share_back ? done + share : 1.0;
      std::optional<Correction> tried =
          solved(problem_at(next), found ? beyond(before, found->state, (next - done) / last) : eased, load_factor,
                 share <= path_limit.share_of_descent);
      if (!tried || !is_near(tried->state, eased)) {
        share *= 0.5;
        continue;
      }
      last = next - std::exchange(done, next);
      before = found ? found->state : eased;
      if (tried->iterations <= path_limit.easy_iterations_back) share *= 2.0;
      found = std::move(tried);
    }
    if (done < 1.0 || !is_of_small_loads(*found)) return std::nullopt;
    found->moved = way(start_, found->state);
    return found;
  }

  MixedVector way(const State& from, const State& to) const {
    MixedVector none = own_->model.create_vector();
    none.fill(0.0);
    return increment_between(own_->model, from, to, none);
  }

  State beyond(const State& before, const State& here, double share) const {
    return own_->model.apply(here, way(before, here), share);
  }

  bool is_near(const State& hard, const State& yielded) const {
    return easing_.load > 0.0 ||
           motion(own_->model, yielded, hard) <= path_limit.hardened_motion * motion(own_->model, start_, hard);
  }

  bool is_of_small_loads(const Correction& found) const {
    if (easing_.load == 0.0) return true;
    const auto is_limp = [&](const Section& section) { return easing_.is_limp(section); };
    return stability_ != nullptr && least_tension(own_->model, found.state, is_limp) > 0.0 &&
           is_stable(*stability_, found);
  }

  Teuchos::RCP<BeamProblem> own_;
  const Scene& scene_;
  const SolverParameters& parameters_;
  SolverParameters eased_parameters_;
  const State& start_;
  const StageRange& range_;
  Stability* stability_;
  Easing easing_;
  int descents_ = 0;
  bool are_cables_ = false;  ///< all members are limp, and loads dead
  bool is_lost_ = false;     ///< a critical point was passed
  std::optional<Correction> first_{};
};

}  // namespace

std::optional<Correction> first_point_of_steep_path(const Teuchos::RCP<BeamProblem>& problem,
                                                    const SolverParameters& parameters, const State& start,
                                                    const StageRange& range, Stability* stability) {
  return SteepStart(problem, parameters, start, range, stability).first_point();
}

bool hangs_in_tension(const Model& model, const State& state, double load_factor) {
  const StateMagnitude size = magnitude_of(model, state, load_factor);
  return is_dead(model.scene()) && size.moment <= path_limit.little_bending * size.force * model.structure().length &&
         least_tension(model, state, [](const Section&) { return true; }) > 0.0;
}

}  // namespace mixbeam
