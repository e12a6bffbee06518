/// Report, as data, of a path that ended without an equilibrium: attempts, location of the failure, the last
/// equilibrium, and advice, the most promising first.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// Most likely cause that stopped the path.
enum class FailureCause {
  load_not_finite,  ///< a load or prescribed motion has no value
  steps_used_up,    ///< nothing failed, or not finally: no more steps were permitted
  mechanism,        ///< the undeformed structure moves without strain
  end_angle,        ///< elements rotate by nearly pi against their vertices
  critical_point,   ///< the tangent at the last equilibrium is nearly singular: limit point or bifurcation
  overflow,         ///< numbers beyond double precision
  linear_solver,    ///< the tangent is regular, but solving with it failed
  path_lost,        ///< equilibria continue, but not to the end of the stage
  incompatible,     ///< imposed strains or motions are incompatible with rigid members
  taut,             ///< loads act across a straight inextensible member that is held at both ends
  slow,             ///< the residual was still falling when the iterations were used up
  wandering         ///< the residual did not fall
};

/// Elements of a member that rotate far against their vertices; the rotation must stay below pi.
struct WideAngle {
  std::string member{};
  int element = 0;   ///< element with the largest angle
  int elements = 0;  ///< present number of the member
  double angle = 0.0;
  bool converged = true;       ///< in the last equilibrium; false: only in a failed attempt
  int suggested_elements = 0;  ///< number that would keep the angle below a quarter turn at the end of the path
};

/// A vertex that moves in a mode.
struct MovingVertex {
  EquationPlace place;
  Vector3 direction{};  ///< unit vector, spatial: of the displacement, or the axis of the rotation
  bool turns = false;   ///< the rotation is larger than the displacement over the length of the structure
  double share = 0.0;   ///< ratio to the largest motion of the mode, 0..1
};

struct CriticalMode {
  double eigenvalue = 0.0;  ///< as in stability.hpp
  double relative = 0.0;    ///< ratio to the eigenvalue nearest to zero of the undeformed structure without loads
  std::vector<MovingVertex> vertices{};  ///< those that move most, the largest motion first
};

/// The tangent at the last equilibrium.
struct TangentReport {
  bool known = false;
  std::string unknown_because{};
  int negative = 0, null = 0;  ///< numbers of eigenvalues below zero, and of zero ones
  bool mechanism = false;      ///< the undeformed structure moves without strain
  bool nearly_singular = false;
  std::optional<double> condition{};  ///< estimate of the condition number of the linear system; none: unknown
  std::vector<CriticalMode> modes{};  ///< nearest to zero first
};

enum class AdviceKind {
  correct_load,
  check_units,
  add_support,
  prescribe_displacement,
  add_imperfection,
  more_elements,
  more_iterations,
  smaller_rotation,
  smaller_first_step,
  smaller_minimum_step,
  more_steps,
  check_sections,
  finite_stiffness,
  stay_below,
  separate_stages,
  jump
};

struct Advice {
  AdviceKind kind;
  std::string text{};  ///< one sentence that names parameters with their present values
};

struct FailureReport {
  int last_step = 0;
  double last_load_factor = 0.0;
  int stages = 1;
  double minimum_step = 0.0;
  bool step_at_minimum = false;
  bool steps_used_up = false;
  std::string lost_at{};                  ///< see PathEnd
  int failures = 0;                       ///< number of failed attempts since the last equilibrium
  std::vector<FailedAttempt> attempts{};  ///< the last of them
  std::vector<WideAngle> wide_angles{};   ///< widest first
  /// Points, and angles of rotation vectors at the last equilibrium, of supports whose springs end at 2 pi.
  std::vector<std::pair<std::string, double>> spent_springs{};
  TangentReport tangent{};
  FailureCause cause = FailureCause::wandering;
  std::vector<Advice> next{};
};

/// End of a path.
struct PathEnd {
  const State& state;  ///< last equilibrium
  int step = 0;
  double load_factor = 0.0;
  double minimum_step = 0.0;  ///< change of the load factor below which no step is tried
  bool steps_used_up = false;
  std::string lost_at{};  ///< where the path became unstable, in words; empty: nowhere, or unknown
};

/// Reports the attempts that `problem` has kept and the equations at the last equilibrium. Collective; throws nothing:
/// facts that cannot be determined are reported as unknown.
FailureReport report_failure(BeamProblem& problem, const SolverParameters& parameters, const PathEnd& end);

/// Advises what to try for the cause and the facts of a report, in order. Part of report_failure().
std::vector<Advice> advice_for(const FailureReport& report, const BeamProblem& problem,
                               const SolverParameters& parameters);

/// Writes the report as a page in plain words (failure_text.cpp).
std::string text_of(const FailureReport& report);

}  // namespace mixbeam
