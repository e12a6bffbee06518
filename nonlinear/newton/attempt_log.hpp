/// Log of the attempts of Newton's method: why each failed, where its residual was largest, where the first NaN or
/// infinity arose. Filled while NOX iterates; costs nothing unless an attempt fails.
#pragma once

#include "discretization/assembly/equation_place.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// A failed attempt, as reported to an observer of the path when it happens.
struct StepFailure {
  int step = 0;              ///< number that the step would have had
  double load_factor = 0.0;  ///< at which equilibrium was sought
  int iterations = 0;
  std::string cause{};  ///< in a few words, see cause_text()
};

enum class AttemptEnd {
  iterations_used_up,  ///< or a status test of the user ended the solve
  not_finite,          ///< a number became infinite or not a number
  linear_solver,       ///< the tangent could not be factorised, or the solution does not solve the equations
  refused              ///< by the path follower, although Newton's method may have converged
};

/// Origin of the first number that is not finite.
struct NotFinite {
  enum class Source {
    load_factor,  ///< the one at which equilibrium was sought: the path had no direction
    load,         ///< value of a load or of its amplitude; `what` names the load
    tangent,      ///< condensed tangent of an element
    increment,    ///< Newton's correction
    residual      ///< at the new state
  };
  Source source = Source::residual;
  int iteration = 0;  ///< 0: at the state where the attempt started
  std::string what{};
  std::optional<EquationPlace> place{};
};

struct FailedAttempt {
  int step = 0;
  double load_factor = 0.0;
  int iterations = 0;
  AttemptEnd end = AttemptEnd::iterations_used_up;
  std::optional<NotFinite> not_finite{};
  std::string linear_solver{};         ///< message of the linear solver
  std::string refused_because{};       ///< message of the path follower
  std::optional<ResidualPeak> peak{};  ///< of the last iterate with a finite residual
  double first_residual = 0.0;         ///< scaled maximum norm after the first iteration
  double last_residual = 0.0;          ///< of the last iterate with a finite residual
  double smallest_residual = 0.0;
  EndAngle end_angle{};  ///< largest angle between an element and its vertices, at the last iterate
};

/// "no equilibrium in 50 iterations, residual 3.1e-02 (balance of forces, component y, at point "tip")".
std::string cause_text(const FailedAttempt& attempt);

class BeamGroup;

class AttemptLog {
 public:
  using Observer = std::function<void(const StepFailure& failure)>;

  /// Clears the log at the start of a path. `steps`: number of completed steps.
  void start_path(int steps, Observer observer);
  /// Clears the attempts when a step has converged.
  void step_completed(int steps);

  void start_attempt();
  /// Records an iteration. `previous`: the group before it, null for a start that is converged already (iteration 0).
  void iterated(const BeamGroup& group, const BeamGroup* previous, int iteration);
  /// Records that the attempt has failed.
  void failed(const BeamGroup& group, int iterations);

  /// Records that the path follower refused the step (`cause`) although Newton's method converged.
  void refused(double load_factor, const std::string& cause);

  /// Failed attempts since the last completed step, the latest last; at most kMostKept.
  const std::vector<FailedAttempt>& attempts() const { return attempts_; }
  int failures() const { return failures_; }  ///< number of all failed attempts since the last completed step

  static constexpr int kMostKept = 20;

 private:
  void add(const FailedAttempt& attempt);

  int steps_ = 0, failures_ = 0;
  FailedAttempt present_;
  std::vector<FailedAttempt> attempts_;
  Observer observer_;
};

}  // namespace mixbeam
