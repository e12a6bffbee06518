#include "nonlinear/path/yielding_start.hpp"

#include "discretization/scene/section_law.hpp"
#include "discretization/state/difference.hpp"
#include "nonlinear/path/path_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Stiffness of tension and shear where members yield, over EI / l^2 of the shortest one: a clamped member buckles
/// under 4 pi^2 EI / l^2, at a strain of 0.4 %. Where its ends approach by little more than that, the next one.
constexpr double kYielding[] = {1e4, 1e6, 1e8};
constexpr double kHardening = 100.0;  ///< at a time
constexpr int kHardenings = 3;        ///< before members are rigid again
constexpr int kMostIterationsToHarden = 12;
/// Hardening may move the structure by this share of its way from the start. The way grows like the root of the load
/// factor, and is long enough when members have approached by ten times what they yield.
constexpr double kHardenedMotion = 0.05;
/// Hardening is tried where the load factor has grown by this factor since the last try, on so many steps.
constexpr double kNextTry = 2.0;
constexpr int kMostSteps = 60;

double shortest_member(const Mesh& mesh) {
  return *std::min_element(mesh.member_length.begin(), mesh.member_length.end());
}

/// The scene with that stiffness in place of the infinite ones; its sections are unchanged where there are none.
Scene yielding(const Scene& scene, double length, double ratio) {
  Scene result = scene;
  result.accuracy.reset();
  for (Section& section : result.sections) {
    auto stiffness = diagonal(section);
    const double bending = std::min(stiffness[4], stiffness[5]);
    if (!std::isfinite(bending) || section.matrix) continue;  // rigid bodies do not buckle; what is coupled stays so
    for (int i = 0; i < 3; ++i)
      if (std::isinf(stiffness[i])) stiffness[i] = ratio * bending / (length * length);
    set_diagonal(section, stiffness);
  }
  return result;
}

bool is_yielding(const Scene& scene, const Scene& yields) {
  for (size_t i = 0; i < scene.sections.size(); ++i)
    if (diagonal(scene.sections[i]) != diagonal(yields.sections[i])) return true;
  return false;
}

/// Largest displacement of a vertex between two states.
double motion(const Model& model, const State& a, const State& b) { return difference(model, a, b).largest_change; }

/// Follows a path of an auxiliary problem, which is not reported.
class YieldingPath {
 public:
  YieldingPath(const Teuchos::RCP<BeamProblem>& rigid, const SolverParameters& parameters, const State& start,
               const StageRange& range)
      : rigid_(rigid),
        parameters_(parameters),
        start_(start),
        range_(range),
        length_(shortest_member(rigid->model.mesh())) {}

  std::optional<Correction> first_point() {
    if (!imposes_deformation(rigid_->model.scene())) return std::nullopt;
    for (const double ratio : kYielding)
      if (!first_ && !is_lost_) follow(ratio);
    return std::move(first_);
  }

 private:
  void follow(double ratio) {
    const Scene yields = yielding(rigid_->model.scene(), length_, ratio);
    if (!is_yielding(rigid_->model.scene(), yields)) return;
    const auto problem = problem_of(yields);
    double next_try = 0.0;  // load factor since the start
    bool gives_up = false, branched = false;
    PathControl control;
    control.resume.emplace();  // the start is known
    control.resume->load_factor = range_.from;
    control.stop = [&] { return gives_up || is_lost_ || first_.has_value(); };
    const PathObserver harden = [&](const StepReport& report, const State& state) {
      const bool branches = report.point.branched && !branched;
      branched = report.point.branched;
      is_lost_ = !report.critical_points.empty() && !branches;
      gives_up = report.step > kMostSteps;
      const double loaded = report.load_factor - range_.from;
      if (gives_up || is_lost_ || (loaded < next_try && report.load_factor < range_.to)) return;
      first_ = hardened(state, report.load_factor, ratio);
      next_try = kNextTry * loaded;
    };
    SolverParameters parameters = parameters_;
    parameters.analysis.stability = true;  // without critical points nothing is known
    State state = start_;
    LoadPathResult result;
    PathRecorder recorder(problem, parameters, state, harden, control, result);
    problem->attempts.start_path(0, {});
    follow_stage_automatically(problem, parameters, start_, range_, recorder);
    count_work(*problem);
    if (rigid_->leave_if_asked) rigid_->leave_if_asked();  // the path within has only been left
  }

  Teuchos::RCP<BeamProblem> problem_of(const Scene& scene) const {
    const auto problem = Teuchos::rcp(new BeamProblem(scene, rigid_->model.map()->getComm(), parameters_));
    problem->leave_if_asked = rigid_->leave_if_asked;
    return problem;
  }

  void count_work(const BeamProblem& done) {
    rigid_->work.check_iterations += done.work.newton_iterations + done.work.check_iterations;
    rigid_->work.looks += done.work.looks;
  }

  /// Equilibrium near the state that yields, each with the stiffness before; then with none that is finite.
  std::optional<Correction> hardened(const State& yielded, double load_factor, double ratio) {
    std::optional<Correction> found;
    for (int i = 0; i <= kHardenings; ++i) {
      ratio *= kHardening;
      const auto problem = i < kHardenings ? problem_of(yielding(rigid_->model.scene(), length_, ratio)) : rigid_;
      SolveRecord record;
      found.emplace(Corrector(problem, parameters_, record, NewtonPurpose::check)
                        .at_load({found ? found->state : yielded, load_factor}, kMostIterationsToHarden));
      if (problem != rigid_) count_work(*problem);
      if (!found->converged || !is_near(found->state, yielded)) return std::nullopt;
    }
    MixedVector none = rigid_->model.create_vector();
    none.fill(0.0);
    found->moved = increment_between(rigid_->model, start_, found->state, none);
    return found;
  }

  bool is_near(const State& hard, const State& yielded) const {
    return motion(rigid_->model, yielded, hard) <= kHardenedMotion * motion(rigid_->model, start_, hard);
  }

  Teuchos::RCP<BeamProblem> rigid_;
  const SolverParameters& parameters_;
  const State& start_;
  const StageRange& range_;
  double length_;
  bool is_lost_ = false;  ///< a critical point was passed
  std::optional<Correction> first_{};
};

}  // namespace

std::optional<Correction> first_point_of_yielding(const Teuchos::RCP<BeamProblem>& problem,
                                                  const SolverParameters& parameters, const State& start,
                                                  const StageRange& range) {
  return YieldingPath(problem, parameters, start, range).first_point();
}

}  // namespace mixbeam
