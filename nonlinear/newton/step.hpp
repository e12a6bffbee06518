/// One step of Newton's method, verb by verb: take_residual, linearize, find_increment, moved. The first page of
/// step.cpp has them in the order in which they happen; BeamGroup hands each to NOX.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"

#include <NOX_Abstract_Group.H>

namespace mixbeam {

/// How the tangents of one solve are taken.
struct TangentChoice {
  double cap_raise = 1.0;  ///< of the usual cap
  /// Keep the capped tangent's increments; do not correct them for the cap.
  bool keeps_cap = false;
  bool in_space = false;         ///< also in the plane of the scene: for right-hand sides that leave it
  bool counts_interior = false;  ///< Tangent::interior_count() is asked for
  /// Relative energy error allowed in a solve. Newton increments get a tighter one where a loose one would cost an
  /// iteration.
  double enough = 0.0;
  /// No iteration follows: what the cap leaves out within the tolerance of the residual stays.
  bool is_last = false;
  bool may_iterate = false;     ///< in networks where that is quicker: for states that are stable, as a rule
  bool vertices_alone = false;  ///< increments leave out the interior of elements; with keeps_cap
};

/// Bordered systems next to a critical point combine several solves with a nearly singular tangent, whose errors cancel
/// only if it is one and the same; and there the cap of the tangent is felt more than its condition: with the usual one
/// Newton's method comes to a stop at 1e-8.
constexpr TangentChoice near_critical(bool leaves_plane) { return {100.0, true, leaves_plane}; }

/// The equations linearised at a point and factorised.
class Linearization {
 public:
  Linearization(BeamProblem& problem, const EvaluationPoint& point, const Cap& cap, const TangentKind& kind,
                bool may_iterate = false, bool vertices_alone = false);
  Linearization(const Linearization&) = delete;
  Linearization& operator=(const Linearization&) = delete;

  const Tangent& tangent() const { return tangent_; }
  /// Why it could not be factorised: then every solve throws a LinearSolverError. Empty where it was.
  const std::string& failure() const { return failure_; }

  /// d with J_c d = -residual, J_c the capped tangent. `enough`: as of Solver::solve. Throws LinearSolverError.
  void newton_increment(MixedVector& increment, double enough = 0.0);
  /// The same for another right-hand side, scaled as the residual.
  void solve(const MixedVector& scaled_rhs, MixedVector& increment, double enough = 0.0);
  /// K dx = b of the condensed equations: forces and moments on all vertices that are projected on free motions.
  void solve_vertices(const DofVector& b, DofVector& x) { solver_->solve(b, x); }
  TangentSolver& solver() const { return *solver_; }
  /// (J - J_c) d, scaled as the residual.
  void cap_compliance_rows(const MixedVector& increment, MixedVector& rows) const;

 private:
  /// `is_first`: what stands in the tangent is still the first right-hand side.
  void solve_condensed(bool is_first, MixedVector& increment, double enough);

  Tangent tangent_;
  std::optional<MixedVector> first_;  ///< its solution, half done by the factorisation, until it is asked for
  std::shared_ptr<TangentSolver> solver_;
  bool vertices_alone_;
  std::string failure_;
};

/// Scales of the rows and residual of the elements, its rows scaled. Those that were taken last are not taken again.
EvaluationPoint take_residual(BeamProblem& problem, const State& state, double load_factor, MixedVector& rows);
/// Scales and state of take_residual(), without the rows.
EvaluationPoint take_point(BeamProblem& problem, const State& state, double load_factor);
/// The tangent there, factorised; Linearization::failure() where that was not possible. `first`: the right-hand side
/// that will be solved for first; null: the residual.
std::unique_ptr<Linearization> linearize(BeamProblem& problem, const EvaluationPoint& point,
                                         const TangentChoice& choice, const MixedVector* first = nullptr);
/// The Newton increment for the rows at that point, NaN where the linear solver fails (BeamProblem::last_failure).
/// Returns the cap that was left in it, of no stiffness where it was taken out.
Cap find_increment(BeamProblem& problem, Linearization& here, const MixedVector& rows, const TangentChoice& choice,
                   double enough, MixedVector& increment);
/// The state after a share of the increment.
State moved(const BeamProblem& problem, const State& from, const MixedVector& increment, double share);

/// Takes the cap of the tangent out of a Newton increment. The capped tangent J_c differs from J only by the compliance
/// that it adds to N and M where a section is (nearly) rigid. Forces that equilibrium determines do not feel it; but in
/// a redundant structure N and M are shared by stiffness, and an increment with J_c shares them by the capped one: then
/// Newton's method would need as many iterations as the cap is below the stiffness. J = J_c + D, D the E of theory
/// (38), is solved here instead by GMRES, preconditioned with the factorised J_c: its iterations are as many as there
/// are distinct ways of sharing.
///
/// From d with J_c d = -r to d with (J_c + D) d = -r. `cap_ratio`: of the cap to the largest finite stiffness
/// (Cap::least_ratio); what answers less belongs to closed frames that are exactly rigid, may carry any stress of their
/// own, and are not changed. `reduction`: of what the cap leaves out, where more is enough than the thresholds ask for.
/// The increment stays as it is where the iteration gains nothing. Returns whether it gained something. Throws
/// LinearSolverError, the increment being untouched then. Collective; the same for any number of threads.
bool remove_cap_compliance(Linearization& linearization, double cap_ratio, MixedVector& increment,
                           double reduction = 0.0);

/// Whether the strains that the cap has left out of a motion are more than the share `enough` of its largest rotation,
/// or displacement over the length. Collective.
bool feels_cap(const Linearization& linearization, const MixedVector& motion, double enough);

/// The same where the cap would slow down the iteration.
bool remove_cap_compliance_where_it_slows(Linearization& linearization, const MixedVector& residual,
                                          MixedVector& increment, bool is_last = false);

/// Newton steps limited by rotation instead of residual, theory (35): far from equilibrium the residual says little,
/// but a vertex that turns by more than a fraction of a radian in one iteration leaves the range of the linearisation.
///
/// Moves `group` from `from` along `direction` and returns the share of the step. Takes the full step when no vertex
/// turns by more than `largest_rotation`, or when the full step brings forces and moments into balance better than
/// before (pure bending and similar problems converge in three iterations only that way); otherwise scales the
/// increment so that no vertex turns further.
double step_within_rotation(NOX::Abstract::Group& group, const NOX::Abstract::Group& from,
                            const NOX::Abstract::Vector& direction, double largest_rotation);

}  // namespace mixbeam
