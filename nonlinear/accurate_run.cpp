#include "nonlinear/accurate_run.hpp"

#include "discretization/state_difference.hpp"
#include "discretization/state_transfer.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

namespace mixbeam {

namespace {

constexpr int kMostMeshes = 6;
/// Meshes on which a path may fail to arrive before that is the scene's own fault.
constexpr int kMostFailures = 2;
/// Elements of a start mesh may turn this much further than they should: the estimate will tell.
constexpr double kTurningMargin = 1.5;
/// Aims of the meshes after an estimate: a tenth of the accuracy, and less each time that it was missed.
constexpr double kFirstAim = 0.1, kNextAim = 0.2;
/// Below this an estimate that a finer mesh does not halve is that of rounding errors.
constexpr double kRoundingMayShow = 1e-7, kLeastGain = 0.5;
/// A corrected state that moves by more than this many times the estimated error has gone to another equilibrium.
constexpr double kLargestCorrection = 20.0;

class AccurateSolver {
 public:
  AccurateSolver(const Scene& scene, const SolverParameters& parameters, const Communicator& comm, bool keeps_path,
                 const AccurateRunObserver& observer)
      : scene_(scene),
        parameters_(parameters),
        comm_(comm),
        observer_(observer),
        accuracy_(*scene.accuracy),
        keeps_path_(keeps_path || parameters.analysis.control.has_value()),
        choice_(start_mesh(scene, accuracy_)) {}

  AccurateRun run();

 private:
  std::unique_ptr<Simulation> simulation_of_choice() const;
  bool solve();
  bool follow();
  bool settle(const Simulation& last, const StepReport& last_report);
  void estimate();
  bool turns_too_far(const Simulation& simulation, double load_factor);
  std::optional<AccuracyEnd> judge();
  bool choose_finer();
  bool try_finer();
  void finish_round(const std::string& remark);
  const Scene& scene_;
  const SolverParameters& parameters_;
  const Communicator& comm_;
  const AccurateRunObserver& observer_;
  const double accuracy_;
  bool keeps_path_;  ///< or some path had critical points
  MeshChoice choice_;
  double aim_ = kFirstAim;
  int failures_ = 0;
  std::unique_ptr<Simulation> simulation_;  ///< of `choice_`, or the mesh before
  StepReport report_{};                     ///< its last step
  ErrorEstimate estimate_{};
  double largest_load_factor_ = 0.0;  ///< on the path of the start mesh
  bool turned_ = false;               ///< the path was left because elements turn too far
  std::vector<MeshRound> rounds_{};
  std::chrono::steady_clock::time_point start_{};
};

std::unique_ptr<Simulation> AccurateSolver::simulation_of_choice() const {
  const Scene scene = on_mesh(scene_, choice_);
  SolverParameters parameters = parameters_;
  if (observer_.threads) parameters.threads = observer_.threads(scene);
  return std::make_unique<Simulation>(scene, parameters, comm_);
}

void AccurateSolver::finish_round(const std::string& remark) {
  MeshRound& round = rounds_.back();
  const LoadPathResult& result = simulation_->result();
  round.steps = result.steps;
  round.failed_steps = result.failed_steps;
  round.iterations = result.newton_iterations;
  round.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  round.remark = remark;
}

/// Whether the elements will have turned too far at the end of the path, if they go on as they did up to here; then
/// takes a mesh for that. Where the load has turned back, what is left of it tells nothing about that: no element is
/// expected to turn further.
bool AccurateSolver::turns_too_far(const Simulation& simulation, double load_factor) {
  if (load_factor <= 0.0) return false;
  const bool goes_on = load_factor >= largest_load_factor_;
  largest_load_factor_ = std::max(largest_load_factor_, load_factor);
  const StateSnapshot snapshot = snapshot_of(simulation.assembler(), simulation.state());
  std::vector<double> turning(scene_.members.size());
  if (comm_->getRank() == 0)
    turning = element_turning(simulation.scene(), simulation.assembler().mesh(), snapshot.vertex_rotation);
  Teuchos::broadcast(*comm_, 0, static_cast<int>(turning.size()), turning.data());
  if (goes_on)
    for (double& angle : turning) angle *= scene_.stages / load_factor;
  std::vector<double> tolerated = turning;
  for (double& angle : tolerated) angle /= kTurningMargin;
  if (mesh_for_turning(scene_, choice_, tolerated, accuracy_) == choice_) return false;
  choice_ = mesh_for_turning(scene_, choice_, turning, accuracy_);
  return true;
}

bool AccurateSolver::follow() {
  simulation_ = simulation_of_choice();
  if (observer_.begin) observer_.begin(*simulation_);
  const bool is_first = rounds_.size() == 1;
  turned_ = false;
  bool critical = false;
  PathControl control;
  control.stop = [&] { return turned_ || (observer_.stop && observer_.stop()); };
  control.step_failed = observer_.step_failed;
  Simulation& running = *simulation_;
  running.run(
      [&](const StepReport& report, const State&) {
        report_ = report;
        critical = critical || !report.critical_points.empty();
        if (running.is_end_of_path(report.load_factor)) return;
        if (observer_.step) observer_.step(running, report);
        if (is_first) turned_ = turns_too_far(running, report.load_factor);
      },
      control);
  keeps_path_ = keeps_path_ || critical;
  return running.result().finished;
}

/// Newton's method from the state of the mesh before; false where the path must tell which equilibrium is meant.
bool AccurateSolver::settle(const Simulation& last, const StepReport& last_report) {
  simulation_ = simulation_of_choice();
  if (observer_.begin) observer_.begin(*simulation_);
  Simulation& running = *simulation_;
  try {
    const State carried = transfer(last.assembler(), last.state(), running.assembler());
    running.settle(carried, [&](const StepReport& report, const State&) { report_ = report; });
    if (!running.result().finished) return false;
    const StateDifference moved = difference(running.assembler(), carried, running.state());
    double largest = 0.0;
    for (const Vector3& u : moved.vertex_displacement) largest = std::max(largest, std::hypot(u[0], u[1], u[2]));
    if (largest > kLargestCorrection * std::max(judged_error(estimate_), accuracy_) * moved.largest_displacement)
      return false;
  } catch (const std::invalid_argument&) {  // the state turns too far inside the new elements
    return false;
  }
  const auto count = [](const StepReport& report) { return report.stability ? report.stability->negative : 0; };
  return count(report_) == count(last_report);
}

bool AccurateSolver::solve() {
  start_ = std::chrono::steady_clock::now();
  rounds_.push_back({choice_});
  rounds_.back().error = std::numeric_limits<double>::quiet_NaN();
  const bool carries = !keeps_path_ && simulation_ != nullptr && simulation_->result().finished && estimate_.exists();
  bool solved = false;
  if (carries) {
    const std::unique_ptr<Simulation> last = std::move(simulation_);
    solved = settle(*last, StepReport(report_));
  }
  rounds_.back().followed = !solved;
  if (!solved) solved = follow();
  rounds_.back().elements = static_cast<int>(simulation_->assembler().mesh().elements.size());
  return solved;
}

void AccurateSolver::estimate() {
  estimate_ = simulation_->estimate_error();
  if (estimate_.exists()) rounds_.back().error = judged_error(estimate_);
  finish_round(estimate_.not_estimated);
  if (observer_.end) observer_.end(*simulation_, report_, estimate_);
}

/// Whether the estimate ends the run.
std::optional<AccuracyEnd> AccurateSolver::judge() {
  const double error = rounds_.back().error;
  if (error <= kShareOfAccuracy * accuracy_) return AccuracyEnd::reached;
  if (estimate_.exists() &&
      error_of_kept(scene_, simulation_->assembler().mesh(), estimate_) > kShareOfAccuracy * accuracy_)
    return AccuracyEnd::kept_meshes;
  if (rounds_.size() >= 2 && error < kRoundingMayShow && error > kLeastGain * rounds_[rounds_.size() - 2].error)
    return AccuracyEnd::rounding;
  if (rounds_.size() >= kMostMeshes) return estimate_.exists() ? AccuracyEnd::too_many : AccuracyEnd::not_estimated;
  return std::nullopt;
}

/// Takes a mesh that is finer whatever the error is; false where members keep theirs.
bool AccurateSolver::try_finer() {
  const MeshChoice before = choice_;
  choice_ = doubled(scene_, choice_);
  return !(choice_ == before);
}

/// Takes the next mesh after an estimate, or for want of one; false where members prevent it.
bool AccurateSolver::choose_finer() {
  if (!estimate_.exists()) return try_finer();
  const MeshChoice before = choice_;
  choice_ = next_mesh(scene_, simulation_->assembler().mesh(), choice_, estimate_, aim_ * accuracy_);
  aim_ *= kNextAim;
  return !(choice_ == before);
}

AccurateRun AccurateSolver::run() {
  const auto done = [&](AccuracyEnd end) { return AccurateRun{*simulation_, estimate_, end, rounds_}; };
  for (;;) {
    if (solve()) {
      estimate();
      std::optional<AccuracyEnd> end = judge();
      if (!end && !choose_finer()) end = estimate_.exists() ? AccuracyEnd::kept_meshes : AccuracyEnd::not_estimated;
      if (end) return done(*end);
    } else if (turned_) {
      finish_round("elements turn too far");
    } else if (simulation_->result().interrupted) {
      finish_round("stopped");
      return done(AccuracyEnd::interrupted);
    } else {
      finish_round("no equilibrium");
      if (++failures_ > kMostFailures || !try_finer()) return done(AccuracyEnd::no_equilibrium);
    }
  }
}

}  // namespace

std::string text_of(AccuracyEnd end) {
  switch (end) {
    case AccuracyEnd::reached:
      return "reached";
    case AccuracyEnd::kept_meshes:
      return "orders or elements that members keep prevent it";
    case AccuracyEnd::rounding:
      return "rounding errors prevent it: a finer mesh is not more accurate";
    case AccuracyEnd::too_many:
      return "not reached on as many meshes as are tried";
    case AccuracyEnd::not_estimated:
      return "not known: the error cannot be estimated";
    case AccuracyEnd::interrupted:
      return "not reached: the run was stopped";
    case AccuracyEnd::no_equilibrium:
      return "not reached: no equilibrium was found";
  }
  return "";
}

AccurateRun run_accurately(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                           bool keeps_path, const AccurateRunObserver& observer) {
  return AccurateSolver(scene, parameters, comm, keeps_path, observer).run();
}

}  // namespace mixbeam
