#include "nonlinear/run/accurate_run.hpp"

#include "discretization/state/difference.hpp"
#include "discretization/state/transfer.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>

namespace mixbeam {

namespace {

/// Limits of meshes that are estimated, and of those abandoned before because their elements rotate too far.
constexpr int kMostMeshes = 6, kMostTurned = 5;
/// Number of meshes on which a path may fail to arrive before the scene itself is to blame.
constexpr int kMostFailures = 2;
/// Factor by which elements of a start mesh may rotate further than allowed, since the estimate will check them.
constexpr double kTurningMargin = 1.5;
/// Aims of the meshes after an estimate: a tenth of the accuracy, reduced by a factor each time that it was missed.
constexpr double kFirstAim = 0.1, kNextAim = 0.2;
/// Estimate below which failing to be halved by a finer mesh indicates rounding errors.
constexpr double kRoundingMayShow = 1e-7, kLeastEstimateGain = 0.5;
/// Limit of the extrapolated growth of rotations: on a path with infinite initial slope (a buckled member that is
/// shortened) the first step says nothing about the last.
constexpr double kLargestPreview = 10.0;
/// Least divisor for relative errors of critical load factors.
constexpr double kLeastLoadFactor = 1e-3;
/// Ratio of the motion by a correction to the estimated error above which it has led to another equilibrium.
constexpr double kLargestFinishingCorrection = 20.0;

class AccurateSolver {
 public:
  AccurateSolver(const Scene& scene, const SolverParameters& parameters, const Communicator& comm, bool keeps_path,
                 const AccurateRunObserver& observer, const MeshChoice* start = nullptr)
      : scene_(scene),
        parameters_(parameters),
        comm_(comm),
        observer_(observer),
        accuracy_(*scene.accuracy),
        keeps_path_(keeps_path || parameters.analysis.control.has_value()),
        compares_(start == nullptr && !keeps_some_mesh(scene)),
        most_failures_(start == nullptr ? kMostFailures : 0),
        choice_(start == nullptr ? start_mesh(scene, accuracy_, observer.of_vertices) : *start) {}

  AccurateRun run() {
    const auto done = [&](AccuracyEnd end) { return AccurateRun{*simulation_, estimate_, end, rounds_}; };
    for (;;) {
      if (solve()) {
        estimate();
        if (stopped_) return done(AccuracyEnd::interrupted);
        std::optional<AccuracyEnd> end = judge();
        if (!end && !choose_finer()) end = estimate_.exists() ? AccuracyEnd::kept_meshes : AccuracyEnd::not_estimated;
        if (!end && stops()) end = AccuracyEnd::interrupted;
        if (end) return done(*end);
      } else if (turned_) {
        finish_round("elements turn too far");
        if (stops()) return done(AccuracyEnd::interrupted);
      } else if (simulation_->result().interrupted) {
        finish_round("stopped");
        return done(AccuracyEnd::interrupted);
      } else {
        finish_round("no equilibrium");
        if (++failures_ > most_failures_ || !try_finer()) return done(AccuracyEnd::no_equilibrium);
      }
    }
  }

 private:
  bool stops() { return stopped_ = stopped_ || (observer_.stop && observer_.stop()); }
  bool is_reached(double error) const { return error <= kShareOfAccuracy * accuracy_; }
  std::unique_ptr<Simulation> simulation_of_choice() const {
    const Scene scene = on_mesh(scene_, choice_);
    SolverParameters parameters = parameters_;
    parameters.analysis.closeness = closeness_;
    if (observer_.threads) parameters.threads = observer_.threads(scene);
    return std::make_unique<Simulation>(scene, parameters, comm_);
  }

  void finish_round(const std::string& remark) {
    MeshRound& round = rounds_.back();
    const LoadPathResult& result = simulation_->result();
    round.steps = result.steps;
    round.failed_steps = result.failed_steps;
    round.iterations = result.newton_iterations;
    round.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    round.remark = remark;
  }

  /// Extrapolates the rotations of elements to the end of the path; if they will be too large, takes a mesh for that
  /// and returns true. If the load has turned back there is no extrapolation: no element is expected to rotate further.
  bool turns_too_far(const Simulation& simulation, double load_factor) {
    if (load_factor <= 0.0) return false;
    const bool goes_on = load_factor >= largest_load_factor_;
    largest_load_factor_ = std::max(largest_load_factor_, load_factor);
    const StateSnapshot snapshot = snapshot_of(simulation.model(), simulation.state());
    std::vector<double> turning(scene_.members.size());
    if (comm_->getRank() == 0)
      turning = element_turning(simulation.scene(), *simulation.model().whole_mesh(), snapshot.vertex_rotation);
    Teuchos::broadcast(*comm_, 0, static_cast<int>(turning.size()), turning.data());
    if (goes_on)
      for (double& angle : turning) angle *= std::min(kLargestPreview, scene_.stages / load_factor);
    std::vector<double> tolerated = turning;
    for (double& angle : tolerated) angle /= kTurningMargin;
    if (mesh_for_turning(scene_, choice_, tolerated, accuracy_, observer_.of_vertices) == choice_) return false;
    choice_ = mesh_for_turning(scene_, choice_, turning, accuracy_, observer_.of_vertices);
    return true;
  }

  /// Follows the path. The step at its end is held back for the estimate, and reported as an ordinary one only if a
  /// step closer to the end follows.
  bool follow() {
    simulation_ = simulation_of_choice();
    if (observer_.begin) observer_.begin(*simulation_);
    const bool may_turn = estimated_ == 0 && turned_meshes_ < kMostTurned;
    turned_ = false;
    largest_load_factor_ = 0.0;
    std::vector<double> critical;
    std::optional<Simulation> at_end;
    PathControl control;
    control.stop = [&] { return turned_ || stops(); };
    control.step_failed = observer_.step_failed;
    Simulation& running = *simulation_;
    const auto give = [&](const Simulation& step) {
      if (observer_.step) observer_.step(step, report_);
    };
    running.run(
        [&](const StepReport& report, const State& state) {
          if (at_end) give(*at_end);
          at_end.reset();
          report_ = report;
          keeps_path_ = keeps_path_ || !report.critical_points.empty();
          for (const CriticalPoint& point : report.critical_points)
            if (point.located) critical.insert(critical.end(), point.modes, point.load_factor);
          if (running.is_end_of_path(report.load_factor)) {
            at_end = running.at(state, report.load_factor);
            return;
          }
          give(running);
          if (may_turn) turned_ = turns_too_far(running, report.load_factor);
        },
        control);
    if (turned_) ++turned_meshes_;
    if (!running.result().finished) {
      if (at_end) give(*at_end);
      return false;
    }
    // A point at the very end may be found or not: ignore it.
    const auto is_at_end = [&](double load_factor) {
      return std::abs(load_factor - report_.load_factor) <= accuracy_ * std::abs(report_.load_factor);
    };
    critical.erase(std::remove_if(critical.begin(), critical.end(), is_at_end), critical.end());
    critical_before_.reset();
    if (!followed_.empty() && contains(choice_, followed_)) critical_before_ = critical_;
    critical_ = std::move(critical);
    followed_ = choice_;
    return true;
  }

  /// Newton's method from the state of the previous mesh; false if only the path determines which equilibrium is meant.
  bool settle(const Simulation& last, const StepReport& last_report) {
    simulation_ = simulation_of_choice();
    if (observer_.begin) observer_.begin(*simulation_);
    Simulation& running = *simulation_;
    try {
      const State carried = transfer(last.model(), last.state(), running.model());
      running.settle(carried, [&](const StepReport& report, const State&) { report_ = report; });
      if (!running.result().finished) return false;
      const StateDifference moved = difference(running.model(), carried, running.state());
      const double size = std::max(moved.largest_displacement, least_displacement_);
      if (moved.largest_change > kLargestFinishingCorrection * std::max(judged_error(estimate_), accuracy_) * size)
        return false;
    } catch (const std::invalid_argument&) {  // the state rotates too far inside the new elements
      return false;
    } catch (const LinearSolverError&) {  // its eigenvalues cannot be counted
      return false;
    }
    const auto count = [](const StepReport& report) { return report.stability ? report.stability->negative : 0; };
    return count(report_) == count(last_report);
  }

  bool solve() {
    start_ = std::chrono::steady_clock::now();
    rounds_.push_back({choice_});
    rounds_.back().error = rounds_.back().critical_error = std::numeric_limits<double>::quiet_NaN();
    const bool carries = !keeps_path_ && simulation_ != nullptr && simulation_->result().finished && estimate_.exists();
    bool solved = false;
    if (carries) {
      const std::unique_ptr<Simulation> last = std::move(simulation_);
      solved = settle(*last, StepReport(report_));
    }
    rounds_.back().followed = !solved;
    if (!solved) solved = follow();
    while (!solved && simulation_->result().returned && closeness_ < kMostCloseness) {
      ++closeness_;
      solved = follow();
    }
    rounds_.back().elements = static_cast<int>(simulation_->model().mesh().elements.size());
    return solved;
  }

  /// Estimates the error of critical load factors on the coarser mesh by their difference between two paths.
  void compare_critical_points() {
    MeshRound& round = rounds_.back();
    round.critical_points = static_cast<int>(critical_.size());
    if (critical_.empty() && (!critical_before_ || critical_before_->empty())) round.critical_error = 0.0;
    if (!critical_before_ || !compares_) return;
    if (critical_before_->size() != critical_.size()) {
      round.remark = "another number of critical points than on the mesh before";
      return;
    }
    round.critical_error = 0.0;
    for (size_t i = 0; i < critical_.size(); ++i)
      round.critical_error = std::max(round.critical_error, std::abs(critical_[i] - (*critical_before_)[i]) /
                                                                std::max(std::abs(critical_[i]), kLeastLoadFactor));
  }

  void estimate() {
    ++estimated_;
    least_displacement_ = least_displacement(simulation_->model().structure().length, accuracy_);
    compare_critical_points();
    ErrorEstimate estimate;
    if (stops())
      estimate.not_estimated = "the run was stopped";
    else
      estimate = simulation_->estimate_error();
    estimate_ = with_least_displacement(estimate, least_displacement_);
    if (estimate.exists()) rounds_.back().error = error_of(estimate_);
    if (!is_reached(rounds_.back().error) && rounds_.back().error < kRoundingMayShow && !parameters_.analysis.control)
      polish(estimate);
    shares_.clear();
    if (is_reached(rounds_.back().error))
      estimate_buckling();
    else if (estimate.exists() && observer_.shares_of)
      shares_ = observer_.shares_of(*simulation_, estimate);
    finish_round(estimate.exists() ? rounds_.back().remark : estimate.not_estimated);
    if (observer_.end) observer_.end(*simulation_, report_, estimate);
    estimate_.richer = Teuchos::null;
    estimate_.richer_state = {};
  }

  double error_of(const ErrorEstimate& estimate) const {
    return observer_.error_of ? observer_.error_of(*simulation_, estimate) : judged_error(estimate);
  }

  /// Repeats the estimate after another Newton iteration: a nearly sufficient one may be due to the residual.
  void polish(ErrorEstimate& estimate) {
    simulation_->polish();
    estimate = simulation_->estimate_error();
    estimate_ = with_least_displacement(estimate, least_displacement_);
    rounds_.back().error = estimate.exists() ? error_of(estimate_) : std::numeric_limits<double>::quiet_NaN();
  }

  void estimate_buckling() {
    const int count = parameters_.analysis.buckling_modes;
    // Without a path on this mesh they are not reported.
    if (!keeps_path_ || !estimates_error(parameters_.analysis, simulation_->model().mesh().elements.size())) return;
    if (count == 0) return;
    double& largest = rounds_.back().buckling_error;
    for (const RecordedBucklingMode& mode : simulation_->buckling_modes(count, 2)) {
      const double relative = mode.error / std::abs(mode.load_factor);
      if (!(relative <= largest)) largest = relative;  // keeps NaN
    }
  }

  /// Whether a finer mesh did not reduce a small error.
  bool shows_rounding(double MeshRound::*error) const {
    if (rounds_.size() < 2) return false;
    const double now = rounds_.back().*error, before = rounds_[rounds_.size() - 2].*error;
    return !is_reached(now) && now < kRoundingMayShow && now > kLeastEstimateGain * before;
  }

  /// Whether the estimates end the run.
  std::optional<AccuracyEnd> judge() {
    const MeshRound& round = rounds_.back();
    const bool is_known = (is_reached(round.critical_error) || !compares_) && is_reached(round.buckling_error);
    if (is_reached(round.error) && is_known) return AccuracyEnd::reached;
    if (estimate_.exists() && !observer_.error_of &&
        !is_reached(error_of_kept(scene_, *simulation_->model().whole_mesh(), estimate_)))
      return AccuracyEnd::kept_meshes;
    if (shows_rounding(&MeshRound::error) || shows_rounding(&MeshRound::critical_error)) return AccuracyEnd::rounding;
    if (estimated_ >= kMostMeshes) return estimate_.exists() ? AccuracyEnd::too_many : AccuracyEnd::not_estimated;
    return std::nullopt;
  }

  /// Takes a finer mesh without using the error; false if members keep theirs.
  bool try_finer() {
    const MeshChoice before = choice_;
    choice_ = doubled(scene_, choice_);
    return !(choice_ == before);
  }

  /// Takes the next mesh after an estimate, or without one; false if members prevent it.
  bool choose_finer() {
    if (!estimate_.exists()) return try_finer();
    const MeshChoice before = choice_;
    if (is_reached(rounds_.back().error)) {  // but not that of critical load factors
      choice_ = richer(scene_, choice_);
      return !(choice_ == before);
    }
    const double moved = judged_error(estimate_), error = observer_.error_of ? rounds_.back().error : moved;
    const auto mesh = simulation_->model().whole_mesh();
    if (!shares_.empty()) {
      choice_ = next_mesh(scene_, *mesh, choice_, shares_, aim_ * accuracy_);
      if (!critical_.empty()) choice_ = joined(choice_, before);  // so that critical points can be compared
    } else if (error > 0.0) {  // assumes that another judged error falls like that of displacements
      choice_ = next_mesh(scene_, *mesh, choice_, errors_of_members(scene_, *mesh, estimate_),
                          aim_ * accuracy_ * std::min(1.0, moved / error));
    }
    aim_ *= kNextAim;
    if (!observer_.error_of) return !(choice_ == before);
    divide_layers();
    if (choice_ == before || contains(before, choice_)) choice_ = richer(scene_, before);
    return !(choice_ == before);
  }

  /// Makes elements short enough for the layers at their ends.
  void divide_layers() {
    for (const EndLayer& layer : end_layers(simulation_->model(), simulation_->state())) {
      const size_t m = static_cast<size_t>(layer.member);
      if (scene_.members[m].keeps_elements) continue;
      const double present = simulation_->model().mesh().elements_of(layer.member);
      const double wanted = present * layer.length / (kLayersPerOrder * (choice_[m].order + 1) * layer.thickness);
      choice_[m].elements =
          std::max(choice_[m].elements, static_cast<int>(std::ceil(std::min(wanted, kLargestRefinement * present))));
    }
  }

  const Scene& scene_;
  const SolverParameters& parameters_;
  int closeness_ = 0;  ///< see AnalysisParameters
  const Communicator& comm_;
  const AccurateRunObserver& observer_;
  const double accuracy_;
  bool keeps_path_;      ///< follow the path on each mesh; set if some path had critical points
  const bool compares_;  ///< compare critical load factors: no member keeps its mesh
  const int most_failures_;
  MeshChoice choice_;
  double aim_ = kFirstAim;
  int failures_ = 0;
  std::unique_ptr<Simulation> simulation_;  ///< of `choice_`, or of the previous mesh
  StepReport report_{};                     ///< its last step
  ErrorEstimate estimate_{};
  std::vector<ErrorOfMember> shares_{};  ///< of its error, see AccurateRunObserver
  double least_displacement_ = 0.0;      ///< see least_displacement()
  /// Critical load factors of the last path, repeated for multiple eigenvalues, and those of the previous path, if on a
  /// mesh that the last one contains.
  std::vector<double> critical_{};
  std::optional<std::vector<double>> critical_before_{};
  MeshChoice followed_{};             ///< mesh of the last path that arrived
  double largest_load_factor_ = 0.0;  ///< on this path
  bool turned_ = false;               ///< the path was left because elements turn too far
  bool stopped_ = false;              ///< from outside
  int estimated_ = 0, turned_meshes_ = 0;
  std::vector<MeshRound> rounds_{};
  std::chrono::steady_clock::time_point start_{};
};

}  // namespace

std::string text_of(AccuracyEnd end) {
  static const std::map<AccuracyEnd, const char*> words = {
      {AccuracyEnd::reached, "reached"},
      {AccuracyEnd::kept_meshes, "orders or elements that members keep prevent it"},
      {AccuracyEnd::rounding, "rounding errors prevent it: a finer mesh is not more accurate"},
      {AccuracyEnd::too_many, "not reached on as many meshes as are tried"},
      {AccuracyEnd::not_estimated, "not known: the error cannot be estimated"},
      {AccuracyEnd::interrupted, "not reached: the run was stopped"},
      {AccuracyEnd::no_equilibrium, "not reached: no equilibrium was found"}};
  return words.at(end);
}

AccurateRun run_accurately(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                           bool keeps_path, const AccurateRunObserver& observer) {
  return AccurateSolver(scene, parameters, comm, keeps_path, observer).run();
}

AccurateRun search_mesh(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                        const MeshChoice& start, const AccurateRunObserver& observer) {
  SolverParameters shorter = parameters;
  AnalysisParameters& analysis = shorter.analysis;
  if (!analysis.trace && !analysis.control && analysis.branch == Branch::primary) analysis.stability = false;
  analysis.buckling_modes = 0;
  return AccurateSolver(scene, shorter, comm, false, observer, &start).run();
}

}  // namespace mixbeam
