/// What a load path knows while it is followed, by whatever method: the last converged state and the report of each
/// step.
#pragma once

#include "nonlinear/newton/newton_setup.hpp"
#include "nonlinear/path/flutter_finder.hpp"
#include "nonlinear/path/load_path.hpp"
#include "nonlinear/path/step_size.hpp"

#include <memory>
#include <optional>
#include <string>

namespace mixbeam {

/// A stage, or the rest of one.
struct StageRange {
  int stage = 1;
  double from = 0.0, to = 1.0;
  int attempts = 0;                   ///< steps that may be tried
  std::optional<PathPoint> before{};  ///< of `from` when the stage is resumed there
  LoadPiece piece{};                  ///< of the stage; `from` and `to` are parameters of it

  /// The load step that led to `from`.
  std::optional<LastStep> last_step() const {
    if (!before) return std::nullopt;
    return LastStep{before->step_size, before->iterations};
  }
};

/// Leaves a path from inside an observer; LOCA's stepper cannot be stopped otherwise.
struct PathInterrupted {};

/// A converged point as a method of following the path hands it over.
struct ConvergedStep {
  const State& state;
  double load_factor = 0.0, residual = 0.0;
  double step_size = 0.0;                           ///< see PathPoint
  double path_length = 0.0;                         ///< likewise
  int direction = 1;                                ///< likewise
  bool branched = false;                            ///< likewise
  std::optional<StabilityResult> stability{};       ///< where it is known already
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
  /// Of the last step, in the piece of the stage that is followed.
  double parameter() const { return parameter_; }
  /// Counts negative eigenvalues to check steps, whether or not stability is asked for; null where that is not
  /// affordable.
  Stability* counts() { return stability_.get(); }
  bool reports_stability() const { return reports_stability_; }
  const std::function<void(const DescentProgress&)>& descent_observer() const { return control_.descends; }

  void enter_stage(int stage, int attempts);
  void enter_piece(const LoadPiece& piece) { part_ = piece.is_part ? piece.from : kNoPart; }
  void leave_stage();
  /// Attempts made in this stage so far, the one that is about to be reported as converged included.
  void set_attempts(int attempts) { attempts_made_ = attempts; }
  /// Failed ones of this stage, for methods that do not report them as they happen.
  void set_failed_attempts(int count) { failed_in_stage_ = count; }
  int successes() const { return successes_; }  ///< in this stage
  bool branched() const { return branched_; }   ///< the path has left the primary one, in this stage or before
  void interrupted() { result_.interrupted = true; }
  void returned() { result_.returned = true; }

  /// Throws PathInterrupted where the path is to stop here.
  void converged(const ConvergedStep& step);
  /// An attempt failed to converge; Newton's method has reported it already.
  void not_converged() { ++failed_in_stage_; }
  /// A converged attempt is not taken.
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
  std::unique_ptr<FlutterFinder> flutter_;  ///< where the scene asks for modes and may flutter
  bool reports_stability_ = false;
  bool looks_at_end_ = false;  ///< of each stage, in place of counts in every step
  int stage_ = 1;
  int attempts_ = 0, attempts_made_ = 0, successes_ = 0, failed_in_stage_ = 0;
  int counted_ = 0;
  int critical_points_ = 0, jumps_ = 0;  ///< on the whole path so far
  double parameter_ = 0.0;
  static constexpr double kNoPart = -1.0;
  double part_ = kNoPart;                ///< where the part of a plain stage begins that is followed
  std::vector<CriticalPoint> passed_{};  ///< since the last step that was reported, as jump_
  std::optional<RecordedJump> jump_{};
  bool started_ = false, branched_ = false;
  bool is_controlled_ = false;  ///< by a displacement: then no load factor is the end of the path
};

/// All return whether the path arrived at the end of the range; `start` is the state at its beginning. By
/// automatic_path.cpp, without tuning or from one stable state to the next; by LOCA's stepper.
bool follow_stage_automatically(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                const State& start, const StageRange& range, PathRecorder& recorder);
bool follow_stage_with_loca(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                            const State& start, const StageRange& range, PathRecorder& recorder);

}  // namespace mixbeam
