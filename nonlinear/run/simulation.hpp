/// Solution of one scene: the facade for applications and tests.
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
  /// Builds mesh, equations and the undeformed state. A shared scene must not change afterwards; a reference is copied.
  /// Throws InputError.
  Simulation(std::shared_ptr<const Scene> scene, const SolverParameters& parameters, const Communicator& comm);
  Simulation(const Scene& scene, const SolverParameters& parameters, const Communicator& comm)
      : Simulation(std::make_shared<const Scene>(scene), parameters, comm) {}

  /// Follows the load path to its end, or as far as possible; state() is then the last converged state, and
  /// result().finished says whether that is the end. May be called once.
  const LoadPathResult& run(const PathObserver& observer = {}, const PathControl& control = {});

  /// Replaces run() if a state close to the end of the path is known, see settle_at_end().
  const LoadPathResult& settle(const State& start, const PathObserver& observer = {});

  /// Whether state() at this load factor is the end of the path.
  bool is_end_of_path(double load_factor) const;

  /// Restores the state of a snapshot and its load factor; run() can resume a path there. `known`: recorded stability
  /// of that state; `jumps`: number of jumps so far. Throws std::invalid_argument if the snapshot belongs to another
  /// mesh. Collective.
  void restore(const StateSnapshot& snapshot, double load_factor, const RecordedStability& known = {}, int jumps = 0);

  /// Copies the simulation with another state and the same result(). `known`: its stability; `jumps`: number of jumps
  /// so far, by default that of this simulation.
  Simulation at(const State& state, double load_factor, const RecordedStability& known = {},
                std::optional<int> jumps = {}) const;

  const LoadPathResult& result() const { return result_; }
  const State& state() const { return state_; }
  /// Load factor of state(), also inside an observer.
  double load_factor() const { return load_factor_; }
  /// Stability of state(), as far as it is known from the path or a stored run, in the words of result files.
  const RecordedStability& stability() const { return stability_; }
  /// Number of jumps so far.
  int jumps() const { return jumps_; }
  /// Completed share of the path: of its load factor, or of the controlled displacement.
  double share_done() const;
  const Scene& scene() const { return problem_->model.scene(); }
  const Model& model() const { return problem_->model; }
  const PhaseTimes& times() const { return problem_->model.times(); }
  const WorkCount& work() const { return problem_->work; }

  /// Estimates the condition of the next linear system of Newton's method: see condition_estimate(), for the tangent at
  /// state(). Costs about two iterations; infinity if the system is singular. Collective.
  double condition_estimate();

  /// See load_moves_control() in path_goal.hpp. Collective.
  bool load_moves_control() const { return mixbeam::load_moves_control(problem_, parameters_); }

  /// The force at state() that is least certain because of rounding errors, see force_sharing.hpp. Collective.
  std::optional<UncertainForce> uncertain_force() { return mixbeam::uncertain_force(*problem_, state_, load_factor_); }

  /// Estimates the error of state() against the continuous equations, see error_estimate.hpp. Collective.
  ErrorEstimate estimate_error() const { return mixbeam::estimate_error(*problem_, parameters_, state_, load_factor_); }
  /// See error_estimate.hpp. Collective.
  void polish() { state_ = polished(problem_, parameters_, state_, load_factor_); }
  /// Returns the simulation in the richer space of an existing estimate, to evaluate anything there. `layers`: end
  /// layers of its state, for which it has taken another Newton step. Collective.
  Simulation richer(const ErrorEstimate& estimate, std::vector<EndLayer>& layers) const;
  /// Makes the record of an estimate for a result file, with the errors of some points.
  RecordedErrorEstimate record_error(const ErrorEstimate& estimate, const std::vector<std::string>& points) const;

  /// See gradients_of(), at state() and its load factor.
  std::vector<RecordedGradient> gradients(GradientRequest request) const {
    request.modes = parameters_.analysis.modes;
    return gradients_of(*problem_, state_, load_factor_, request);
  }
  /// See critical_gradients_of(), for a point of the path.
  std::vector<RecordedGradient> gradients(const CriticalPoint& point, const CriticalGradientRequest& request) const {
    return critical_gradients_of(*problem_, point, request);
  }

  // All following functions are collective and return the same on every rank (samples: complete on rank 0).
  Vector3 displacement(const std::string& point) const;
  Vector3 position(const std::string& point) const;
  /// Rotation vector of Lambda_V, norm at most pi.
  Vector3 rotation(const std::string& point) const;
  /// Forces and moments of the supports on the structure, in the order of the scene.
  std::vector<Reaction> reactions() const { return mixbeam::reactions(problem_->model, state_, load_factor_); }
  /// Residual and balance of each of several disconnected parts of a structure, in its own scales. One rank only.
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
  /// Makes the record of the present state for a result file, with all data for resuming: the share of this rank.
  StepRecord record(const StepReport& report, int points_per_element,
                    const std::vector<std::string>& monitored_points) const;

  /// Whether state() is at the end of a stage that another one follows.
  bool is_between_stages() const;
  /// Finds the first `count` modes of linear_buckling(), about state() between two stages, else of the undeformed
  /// structure; none if that is not stable. Samples of this rank.
  std::vector<RecordedBucklingMode> buckling_modes(int count, int points_per_element) const;
  /// Returns a function for omega / (2 pi) of the natural modes about state() that the parameters request; NaN for a
  /// mode that does not exist. Its first call finds all modes. It must not outlive this object.
  std::function<double(int mode)> natural_frequency() const;
  /// Finds the first `count` of vibration_modes() about state(). Samples of this rank. `tracks`: assigns a track to
  /// each; null: none. `known`: see ModeTracks::follow().
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
