/// Numbers that decide within Newton's method, each with its reason. A study or a test may move them before
/// what they decide about begins.
#pragma once

namespace mixbeam {

struct NewtonThresholds {
  /// Of tangents of a path, and at most of Newton increments: what the path bends by in a step, and what the
  /// linearisation leaves of an imbalance, is more.
  double enough_for_tangents = 1e-4, enough_for_increments = 1e-3;
  /// Iterations, and vectors that are kept. Newton's method goes on with what is left.
  double most_vectors = 20;
  /// Where to stop: what was left out need not be known better than the increment itself, which the rounding errors of
  /// the condensed equations disturb in the fifth digit where the cap is reached.
  double reduction = 1e-6;
  /// Of the cap ratio: no stress shared by finite stiffness answers a unit vector with less.
  double rigid_answer = 0.1;
  /// A smaller gain is not worth a change.
  double worthwhile = 0.5;
  /// The cap is let be where it leaves less than this fraction of what the next residual holds anyway.
  double negligible_cap = 0.1;
  /// A full step beyond the rotation limit must reduce the imbalance of forces and moments at least to this fraction.
  /// Pure bending reaches round-off, whatever the angle; a step that merely shuffles the imbalance has left the range
  /// of the linearisation, and with 0.4 in place of 0.1 the kinked frame and the fork converge to other equilibria.
  double balance_gain = 0.1;
  /// An increment that is not exact leaves so much less of the residual than its linearisation does, and than the
  /// tolerance of the residual: in its largest row an error in energy is up to ten times larger.
  double less_than_curvature = 0.01;
  /// Of the tolerance: where the linearisation will leave no more, it often leaves less, and the iteration is the last.
  double nearly_there = 100.0;
  /// Where every stiffness that is cut off is infinite, in place of the ratio to the largest finite one: an increment
  /// that equilibrium determines loses all of what the cap adds, one that closed rigid frames share stays as it is.
  double rigid_ratio = 1e-2;
  /// Of the motion. Each iteration divides what is left by the cap, 1e5 as a rule: a bound near rounding would ask for
  /// one iteration more than is of use.
  double negligible_cap_motion = 1e-9;
  /// Beyond, rounding errors of the strains make the forces oscillate, and more iterations do not help.
  double most_refusals = 2;
  double iterations_without_end = 1000;
};

inline NewtonThresholds newton_limit;

}  // namespace mixbeam
