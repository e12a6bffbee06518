/// One step of Newton's method as a sequence of verbs: take_residual, linearize, find_increment, moved. The first page
/// of step.cpp has them in the order of execution; BeamGroup exposes each to NOX.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"

#include <NOX_Abstract_Group.H>

namespace mixbeam {

/// Options for the tangents of one solve.
struct TangentChoice {
  double cap_raise = 1.0;  ///< factor on the usual cap
  /// Keep the capped tangent's increments; do not correct them for the cap.
  bool keeps_cap = false;
  bool in_space = false;         ///< take spatial tangents of planar scenes too: for right-hand sides out of the plane
  bool counts_interior = false;  ///< count for Tangent::interior_count()
  /// Relative energy error allowed in a solve. Newton increments get a tighter one where a loose one would cost an
  /// iteration.
  double enough = 0.0;
  /// No iteration follows: do not correct for the cap if its effect is within the tolerance of the residual.
  bool is_last = false;
  bool may_iterate = false;     ///< solve networks by iteration where that is faster: usually for stable states
  bool vertices_alone = false;  ///< do not recover the interior of elements in increments; requires keeps_cap
};

/// Options next to a critical point. Bordered systems combine several solves with a nearly singular tangent, whose
/// errors cancel only if the tangent is the same; and the cap matters more than the condition number there: with the
/// usual cap Newton's method stagnates at 1e-8.
constexpr TangentChoice near_critical(bool leaves_plane) { return {100.0, true, leaves_plane}; }

/// The equations linearised at a point and factorised.
class Linearization {
 public:
  Linearization(BeamProblem& problem, const EvaluationPoint& point, const Cap& cap, const TangentKind& kind,
                bool may_iterate = false, bool vertices_alone = false);
  Linearization(const Linearization&) = delete;
  Linearization& operator=(const Linearization&) = delete;

  const Tangent& tangent() const { return tangent_; }
  /// Why the factorisation failed, in which case every solve throws a LinearSolverError; empty if it succeeded.
  const std::string& failure() const { return failure_; }

  /// Solves J_c d = -residual, J_c capped. `enough`: see Solver::solve. Throws LinearSolverError.
  void newton_increment(MixedVector& increment, double enough = 0.0);
  /// Solves J_c d = -rhs for another right-hand side, scaled like the residual.
  void solve(const MixedVector& scaled_rhs, MixedVector& increment, double enough = 0.0);
  /// Solves the condensed equations K dx = b; b: forces and moments on all vertices, projected on free motions.
  void solve_vertices(const DofVector& b, DofVector& x) { solver_->solve(b, x); }
  TangentSolver& solver() const { return *solver_; }
  /// Computes (J - J_c) d, scaled like the residual.
  void cap_compliance_rows(const MixedVector& increment, MixedVector& rows) const;

 private:
  /// `is_first`: the tangent still holds the first right-hand side.
  void solve_condensed(bool is_first, MixedVector& increment, double enough);

  Tangent tangent_;
  std::optional<MixedVector> first_;  ///< solution of the first solve, begun during factorisation; none afterwards
  std::shared_ptr<TangentSolver> solver_;
  bool vertices_alone_;
  std::string failure_;
};

/// Evaluates the scales of the rows and the scaled residual. The last evaluation is reused at the same point.
EvaluationPoint take_residual(BeamProblem& problem, const State& state, double load_factor, MixedVector& rows);
/// Evaluates the point of take_residual() without returning the rows.
EvaluationPoint take_point(BeamProblem& problem, const State& state, double load_factor);
/// Factorises the tangent at a point; see Linearization::failure() if that fails. `first`: the right-hand side that
/// will be solved for first; null: the residual.
std::unique_ptr<Linearization> linearize(BeamProblem& problem, const EvaluationPoint& point,
                                         const TangentChoice& choice, const MixedVector* first = nullptr);
/// Computes the Newton increment for these rows; NaN if the linear solver fails (BeamProblem::last_failure). Returns
/// the cap that is left in it, with zero stiffness if the increment was corrected for it.
Cap find_increment(BeamProblem& problem, Linearization& here, const MixedVector& rows, const TangentChoice& choice,
                   double enough, MixedVector& increment);
/// Returns the state after this share of the increment.
State moved(const BeamProblem& problem, const State& from, const MixedVector& increment, double share);

/// Corrects a Newton increment for the cap of the tangent. The capped tangent J_c differs from J only by the compliance
/// that it adds to N and M where a section is (nearly) rigid. Forces determined by equilibrium are not affected; but a
/// redundant structure distributes N and M by stiffness, and an increment with J_c distributes them by the capped one:
/// Newton's method would need a number of iterations proportional to stiffness over cap. Instead J = J_c + D, D the E
/// of theory (38), is solved here by GMRES, preconditioned with the factorised J_c: it takes as many iterations as
/// there are distinct ways of distributing forces.
///
/// Turns d with J_c d = -r into d with (J_c + D) d = -r. `cap_ratio`: the cap over the largest finite stiffness
/// (Cap::least_ratio); vectors with a smaller response belong to closed frames that are exactly rigid, may carry any
/// self-stress, and stay unchanged. `reduction`: allowed rest of the cap's effect, if larger than the threshold.
/// Leaves the increment unchanged if the iteration gains nothing; returns whether it changed. Throws LinearSolverError
/// and leaves the increment unchanged then. Collective; the same for any number of threads.
bool remove_cap_compliance(Linearization& linearization, double cap_ratio, MixedVector& increment,
                           double reduction = 0.0);

/// Whether the strains that the cap left out of a motion exceed the share `enough` of its largest rotation, or of its
/// largest displacement over the length. Collective.
bool feels_cap(const Linearization& linearization, const MixedVector& motion, double enough);

/// Calls remove_cap_compliance() if the cap would slow down Newton's method; false also if the linear solver fails.
bool remove_cap_compliance_where_it_slows(Linearization& linearization, const MixedVector& residual,
                                          MixedVector& increment, bool is_last = false);

/// Limits a Newton step by rotation instead of residual, theory (35): far from equilibrium the residual says little,
/// but a vertex that rotates by more than a fraction of a radian in one iteration leaves the range of linearisation.
///
/// Moves `group` from `from` along `direction` and returns the share of the step. Takes the full step if no vertex
/// rotates by more than `largest_rotation`, or if the full step reduces the imbalance of forces and moments to
/// NewtonThresholds::balance_gain (pure bending and similar problems converge in three iterations only that way);
/// otherwise scales the increment so that no vertex rotates further.
double step_within_rotation(NOX::Abstract::Group& group, const NOX::Abstract::Group& from,
                            const NOX::Abstract::Vector& direction, double largest_rotation);

}  // namespace mixbeam
