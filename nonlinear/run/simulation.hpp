/// One scene, solved: the facade that applications and tests use.
#pragma once

#include "discretization/state/reactions.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/state/snapshot.hpp"
#include "discretization/state/structure_parts.hpp"
#include "nonlinear/accuracy/error_estimate.hpp"
#include "nonlinear/diagnosis/force_sharing.hpp"
#include "nonlinear/path/load_path.hpp"
#include "nonlinear/path/path_goal.hpp"
#include "nonlinear/sensitivity/critical_gradient.hpp"
#include "nonlinear/stability/mode_tracks.hpp"

namespace mixbeam {

class Simulation {
 public:
  /// Builds mesh, equations and the undeformed state. The scene must not change from here on; one that may is copied.
  /// Throws InputError.
  Simulation(std::shared_ptr<const Scene> scene, const SolverParameters& parameters, const Communicator& comm);
  Simulation(const Scene& scene, const SolverParameters& parameters, const Communicator& comm)
      : Simulation(std::make_shared<const Scene>(scene), parameters, comm) {}

  /// Follows the load path to its end, or as far as it goes; then state() is the last converged state and
  /// result().finished tells which. May be called once.
  const LoadPathResult& run(const PathObserver& observer = {}, const PathControl& control = {});

  /// In place of run(), from a state that is nearly that of the end of the path, see settle_at_end().
  const LoadPathResult& settle(const State& start, const PathObserver& observer = {});

  /// Whether a path arrives with state() at this load factor.
  bool is_end_of_path(double load_factor) const;

  /// Takes the state of a snapshot and the load factor it belongs to; run() can resume a path there. `known`: the
  /// stability of that state as it was recorded; `jumps`: of the path so far. Throws std::invalid_argument when the
  /// snapshot is not one of this mesh. Collective.
  void restore(const StateSnapshot& snapshot, double load_factor, const RecordedStability& known = {}, int jumps = 0);

  /// The same structure in another state, with the same result(). `known`: its stability.
  Simulation at(const State& state, double load_factor, const RecordedStability& known = {}) const;

  const LoadPathResult& result() const { return result_; }
  const State& state() const { return state_; }
  /// Load factor of state(), also inside an observer.
  double load_factor() const { return load_factor_; }
  /// Whether state() is stable, as far as the path or a stored run states it; the words of files.
  const RecordedStability& stability() const { return stability_; }
  /// Number of jumps so far.
  int jumps() const { return jumps_; }
  /// Share of the path that is behind state(): of its load factor, or of the way of the controlled displacement.
  double share_done() const;
  const Scene& scene() const { return problem_->model.scene(); }
  const Model& model() const { return problem_->model; }
  const PhaseTimes& times() const { return problem_->model.times(); }
  const WorkCount& work() const { return problem_->work; }

  /// Of the linear system that Newton's method would solve next: condition_estimate() of the tangent at state(). Costs
  /// about two iterations; infinity where that system is singular. Collective.
  double condition_estimate();

  /// See load_moves_control() in path_goal.hpp. Collective.
  bool load_moves_control() const { return mixbeam::load_moves_control(problem_, parameters_); }

  /// The force at state() that rounding errors make least certain, see force_sharing.hpp. Collective.
  std::optional<UncertainForce> uncertain_force() { return mixbeam::uncertain_force(*problem_, state_, load_factor_); }

  /// How far state() is from the solution of the continuous equations, see error_estimate.hpp. Collective.
  ErrorEstimate estimate_error() const { return mixbeam::estimate_error(*problem_, parameters_, state_, load_factor_); }
  /// See error_estimate.hpp. Collective.
  void polish() { state_ = polished(problem_, parameters_, state_, load_factor_); }
  /// The same structure in the richer space of an estimate that exists, to evaluate anything there. `layers`: those of
  /// its state, which took one more Newton step for them. Collective.
  Simulation richer(const ErrorEstimate& estimate, std::vector<EndLayer>& layers) const;
  /// The same for a result file, with the errors of some points.
  RecordedErrorEstimate record_error(const ErrorEstimate& estimate, const std::vector<std::string>& points) const;

  /// See gradients_of(): at state() and its load factor.
  std::vector<RecordedGradient> gradients(GradientRequest request) const {
    request.modes = parameters_.analysis.modes;
    return gradients_of(*problem_, state_, load_factor_, request);
  }
  /// See critical_gradients_of(): of a point of the path.
  std::vector<RecordedGradient> gradients(const CriticalPoint& point, const CriticalGradientRequest& request) const {
    return critical_gradients_of(*problem_, point, request);
  }

  // All of the following are collective and give the same on every rank (samples: complete on rank 0).
  Vector3 displacement(const std::string& point) const;
  Vector3 position(const std::string& point) const;
  /// Rotation vector of Lambda_V, norm at most pi.
  Vector3 rotation(const std::string& point) const;
  /// Forces and moments of the supports on the structure, in the order of the scene.
  std::vector<Reaction> reactions() const { return mixbeam::reactions(problem_->model, state_, load_factor_); }
  /// Residual and balance of every part of a structure of several, each measured by itself. One rank only.
  std::vector<PartCheck> check_parts(const StructureParts& parts) const {
    return mixbeam::check_parts(problem_->model, state_, load_factor_, parts);
  }
  /// Sums of loads and reactions: errors below 1e-10 in every converged state.
  Balance balance(std::vector<Reaction>* reactions = nullptr) const {
    return mixbeam::balance(problem_->model, state_, load_factor_, reactions);
  }
  std::vector<MemberSamples> samples(int points_per_element) const;
  /// All fields at relative arc length `position` in [0, 1] of a member, see sample_member.
  PointSample sample(const std::string& member, double position) const {
    return sample_member(model(), state_, member_index(scene(), member), position);
  }
  StrainEnergy strain_energy() const { return mixbeam::strain_energy(model(), state_); }
  /// See l2_norm in sampling.hpp.
  double l2_norm(int gauss_points, const std::function<Vec3<double>(const PointSample&, int member)>& field) const {
    return mixbeam::l2_norm(model(), state_, gauss_points, field);
  }
  /// Record of the present state for a result file, with all that resuming needs: the share of this rank.
  StepRecord record(const StepReport& report, int points_per_element,
                    const std::vector<std::string>& monitored_points) const;

  /// Whether state() is that at the end of a stage which another one follows.
  bool is_between_stages() const;
  /// The first `count` modes of linear_buckling(), about state() between two stages, else of the undeformed structure;
  /// none when that is not stable. Of this rank's samples.
  std::vector<RecordedBucklingMode> buckling_modes(int count, int points_per_element) const;
  /// omega / (2 pi) of a natural mode about state(), one of those that the parameters ask for; NaN where it has fewer.
  /// All are found when the first is asked for. Only as long as this exists.
  std::function<double(int mode)> natural_frequency() const;
  /// The first `count` of vibration_modes() about state(). Of this rank's samples. `tracks`: gives each its track;
  /// null: they have none. `known`: see ModeTracks::follow().
  std::vector<RecordedVibrationMode> vibration_modes(int count, bool in_plane, int points_per_element,
                                                     const ModeSearchObserver& observer = {},
                                                     ModeTracks* tracks = nullptr,
                                                     const std::vector<int>& known = {}) const;

 private:
  std::array<double, 6> motion(const std::string& point) const;
  RecordedCriticalPoint record(const CriticalPoint& point, int points_per_element,
                               const std::vector<std::string>& monitored_points) const;
  std::vector<MonitoredQuantity> motions(const std::vector<std::string>& points) const;

  SolverParameters parameters_;
  Teuchos::RCP<BeamProblem> problem_;
  State state_;
  double load_factor_ = 0.0;
  RecordedStability stability_{};
  int jumps_ = 0;
  LoadPathResult result_;
};

}  // namespace mixbeam
