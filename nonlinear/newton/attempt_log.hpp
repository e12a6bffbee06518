/// What became of each attempt of Newton's method: why it failed, where the residual was largest, where a number ceased
/// to be one. Filled while NOX iterates; costs nothing as long as all goes well.
#pragma once

#include "discretization/assembly/equation_place.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// A failed attempt as an observer of the path sees it, at the moment when it happens.
struct StepFailure {
  int step = 0;              ///< number that the step would have had
  double load_factor = 0.0;  ///< at which equilibrium was sought
  int iterations = 0;
  std::string cause{};  ///< a few words
};

enum class AttemptEnd {
  iterations_used_up,  ///< or ended by a status test of the user
  not_finite,          ///< a number became infinite or not a number
  linear_solver,       ///< the tangent could not be factorised, or the solution does not solve the equations
  refused              ///< by what follows the path, whatever Newton's method found
};

/// Where a number that is not finite arose first.
struct NotFinite {
  enum class Source {
    load_factor,  ///< at which equilibrium was sought: the path had no direction
    load,         ///< value of a load or of its amplitude; `what` says which
    tangent,      ///< condensed tangent of an element
    increment,    ///< Newton's correction
    residual      ///< the equations at the new state
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
  std::string linear_solver{};         ///< message
  std::string refused_because{};       ///< likewise
  std::optional<ResidualPeak> peak{};  ///< of the last iterate with a finite residual
  double first_residual = 0.0;         ///< scaled maximum norm after the first iteration
  double last_residual = 0.0;          ///< of the last iterate with a finite residual
  double smallest_residual = 0.0;
  EndAngle end_angle{};  ///< largest between an element and its vertices, at the end
};

/// "no equilibrium in 50 iterations, residual 3.1e-02 (balance of forces, component y, at point "tip")".
std::string cause_text(const FailedAttempt& attempt);

class BeamGroup;

class AttemptLog {
 public:
  using Observer = std::function<void(const StepFailure& failure)>;

  /// A path begins: forgets everything. `steps`: completed ones.
  void start_path(int steps, Observer observer);
  /// A step has converged: the attempts before it are forgotten.
  void step_completed(int steps);

  void start_attempt();
  /// After each iteration, and before the first one; `previous`: the group before the iteration, null if there is none.
  void iterated(const BeamGroup& group, const BeamGroup* previous, int iteration);
  /// The attempt has failed.
  void failed(const BeamGroup& group, int iterations);

  /// The path follower refused the step (`cause`) although Newton's method converged.
  void refused(double load_factor, const std::string& cause);

  /// Since the last completed step, the latest last; at most kMostKept.
  const std::vector<FailedAttempt>& attempts() const { return attempts_; }
  int failures() const { return failures_; }  ///< since the last completed step, all of them

  static constexpr int kMostKept = 20;

 private:
  void add(const FailedAttempt& attempt);

  int steps_ = 0, failures_ = 0;
  FailedAttempt present_;
  std::vector<FailedAttempt> attempts_;
  Observer observer_;
};

}  // namespace mixbeam
