/// Record of a load path while it is followed, by any method: the last converged state and the report of each step.
#pragma once

#include "nonlinear/newton/newton_setup.hpp"
#include "nonlinear/path/flutter_finder.hpp"
#include "nonlinear/path/load_path.hpp"
#include "nonlinear/path/step_size.hpp"

#include <memory>
#include <optional>
#include <string>

namespace mixbeam {

/// A piece of a stage, or the rest of one.
struct StageRange {
  int stage = 1;
  double from = 0.0, to = 1.0;
  int attempts = 0;                   ///< limit of attempts
  std::optional<PathPoint> before{};  ///< point at `from`, if the stage is resumed there
  LoadPiece piece{};                  ///< of the stage; `from` and `to` are parameters of it

  /// The load step that led to `from`.
  std::optional<LastStep> last_step() const {
    if (!before) return std::nullopt;
    return LastStep{before->step_size, before->iterations};
  }
};

/// Thrown to leave a path from inside an observer; LOCA's stepper cannot be stopped otherwise.
struct PathInterrupted {};

/// A converged point, as passed to the recorder by the method that follows the path.
struct ConvergedStep {
  const State& state;
  double load_factor = 0.0, residual = 0.0;
  double step_size = 0.0;                           ///< see PathPoint
  double path_length = 0.0;                         ///< see PathPoint
  int direction = 1;                                ///< see PathPoint
  bool branched = false;                            ///< see PathPoint
  std::optional<StabilityResult> stability{};       ///< if known already
  std::optional<StabilityResult> held_stability{};  ///< see StepReport
  std::vector<CriticalPoint> critical_points{};     ///< passed since the last step
  std::optional<RecordedJump> jump{};               ///< see StepReport
};

class PathRecorder {
 public:
  PathRecorder(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, State& state,
               const PathObserver& observer, const PathControl& control, LoadPathResult& result);

  SolveRecord& record() { return record_; }
  double load_factor() const { return result_.load_factor; }
  /// Parameter of the last step, in the piece of the stage that is followed.
  double parameter() const { return parameter_; }
  /// Counts negative eigenvalues to check steps, whether or not stability is requested; null if that is too expensive.
  Stability* counts() { return stability_.get(); }
  bool reports_stability() const { return reports_stability_; }
  const std::function<void(const DescentProgress&)>& descent_observer() const { return control_.descends; }

  void enter_stage(int stage, int attempts);
  void enter_piece(const LoadPiece& piece) { part_ = piece.is_part ? piece.from : kNoPart; }
  void leave_stage();
  /// Sets the number of attempts in this stage so far, including the one about to be reported as converged.
  void set_attempts(int attempts) { attempts_made_ = attempts; }
  /// Sets the number of failed attempts in this stage, for methods that do not report them as they happen.
  void set_failed_attempts(int count) { failed_in_stage_ = count; }
  int successes() const { return successes_; }  ///< in this stage
  bool branched() const { return branched_; }   ///< the path has left the primary path, in this stage or before
  void interrupted() { result_.interrupted = true; }
  void returned() { result_.returned = true; }

  /// Records and reports a step. Throws PathInterrupted if the path is to stop here.
  void converged(const ConvergedStep& step);
  /// Counts an attempt that failed to converge; Newton's method has reported it already.
  void not_converged() { ++failed_in_stage_; }
  /// Reports that a converged attempt is rejected.
  void rejected(const std::string& cause, int iterations);

 private:
  void keep(const ConvergedStep& step);
  void add_flutter(StepReport& report);
  PathPoint point(const ConvergedStep& step, const std::optional<StabilityResult>& stability) const;

  Teuchos::RCP<BeamProblem> problem_;
  State& state_;
  const PathObserver& observer_;
  const PathControl& control_;
  LoadPathResult& result_;
  SolveRecord record_;
  std::unique_ptr<Stability> stability_;
  std::unique_ptr<FlutterFinder> flutter_;  ///< if modes are requested and the structure may flutter
  bool reports_stability_ = false;
  bool looks_at_end_ = false;  ///< determine stability at the end of each stage, not in every step
  int stage_ = 1;
  int attempts_ = 0, attempts_made_ = 0, successes_ = 0, failed_in_stage_ = 0;
  int counted_ = 0;
  int critical_points_ = 0, jumps_ = 0;  ///< on the whole path so far
  double parameter_ = 0.0;
  static constexpr double kNoPart = -1.0;
  double part_ = kNoPart;                ///< start of the part of a plain stage that is followed
  std::vector<CriticalPoint> passed_{};  ///< since the last reported step, like jump_
  std::optional<RecordedJump> jump_{};
  bool started_ = false, branched_ = false;
  bool is_controlled_ = false;  ///< displacement control, in which no load factor is the end of the path
};

/// Follow a stage from the state `start`, and return whether the path arrived at the end of the range: without tuning
/// or from one stable state to the next (automatic_path.cpp), or by LOCA's stepper.
bool follow_stage_automatically(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                const State& start, const StageRange& range, PathRecorder& recorder);
bool follow_stage_with_loca(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                            const State& start, const StageRange& range, PathRecorder& recorder);

}  // namespace mixbeam
