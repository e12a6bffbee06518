/// Thresholds of Newton's method, each with its reason. A study or a test may change them before a run begins.
#pragma once

namespace mixbeam {

struct NewtonThresholds {
  /// Energy error allowed in tangents of a path, and at most in Newton increments: the curvature of the path over a
  /// step, and the error of the linearisation, are larger.
  double enough_for_tangents = 1e-4, enough_for_increments = 1e-3;
  /// Limit of GMRES iterations, and of vectors kept. Newton's method removes the rest.
  double most_vectors = 20;
  /// Reduction at which GMRES stops: the correction need not be more accurate than the increment itself, which the
  /// rounding errors of the condensed equations disturb in the fifth digit where the cap is reached.
  double reduction = 1e-6;
  /// Share of the cap ratio: stresses distributed by finite stiffness respond to a unit vector by no less.
  double rigid_answer = 0.1;
  /// Change the increment only if GMRES reduces the residual at least to this fraction.
  double worthwhile = 0.5;
  /// Do not correct for the cap if it leaves less than this fraction of what the next residual contains anyway.
  double negligible_cap = 0.1;
  /// A full step beyond the rotation limit must reduce the imbalance of forces and moments at least to this fraction.
  /// Pure bending reaches round-off, whatever the angle; a step that merely shuffles the imbalance has left the range
  /// of the linearisation, and with 0.4 in place of 0.1 the kinked frame and the fork converge to other equilibria.
  double balance_gain = 0.1;
  /// Energy error of an inexact increment over the residual left by linearisation, or over the residual tolerance: in
  /// the largest row the error is up to ten times larger than in energy.
  double less_than_curvature = 0.01;
  /// Multiple of the tolerance: a predicted residual below it is often smaller still, and the iteration is the last.
  double nearly_there = 100.0;
  /// Cap ratio to use if every stiffness cut off is infinite: increments determined by equilibrium lose all of the
  /// cap's compliance, those that closed rigid frames share stay unchanged.
  double rigid_ratio = 1e-2;
  /// Share of the motion. Each iteration divides the rest by the cap, usually 1e5: a bound near rounding would require
  /// one useless iteration more.
  double negligible_cap_motion = 1e-9;
  /// Limit of refusals: beyond, rounding errors of strains make the forces oscillate, and more iterations do not help.
  double most_refusals = 2;
  double iterations_without_end = 1000;
};

inline NewtonThresholds newton_limit;

}  // namespace mixbeam
