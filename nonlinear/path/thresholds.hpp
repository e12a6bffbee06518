/// Thresholds of paths, each with its reason. A study or a test may change them before a run begins.
#pragma once

#include "kernels/math/constants.hpp"

namespace mixbeam {

struct PathThresholds {
  // Judging a step.
  /// Least cosine with which the chord and the tangents at its ends form one line: a path that bends by less has no
  /// room for another one.
  double straight = 0.97;
  /// Newton's correction half-way, over the chord, up to which the cubic counts as the path.
  double largest_correction = 0.2;
  /// Correction up to which the cubic is certainly the path.
  double sure_correction = 1e-2;
  /// Limit of repeated halvings of a step for a closer examination.
  double most_halvings = 3;
  /// Between points at which the load factor changes with the same sign, share of the smaller rate above which the rate
  /// must stay; otherwise the load may have gone back and forth between them.
  double least_gain = 0.5;
  /// Ratio of the load factor's last rate to its mean, the power of the motion with which it grows. Bars in tension
  /// make it grow with the third, members that are bent straight with any power, which a cubic cannot represent.
  double fastest_growth = 6.0;
  /// Largest slope of the quartic 16 e s^2 (1 - s)^2 over e. The cubic omits at least such a quartic if its load factor
  /// has the error e half-way.
  double error_of_rate = 3.1;
  /// Relative change of the load factor along a flat step: the cap alone shifts critical loads by 1e-7.
  double flat_load = 1e-5;
  /// Share of the step's chord by which the rate at the end would move a structure that has stiffened; the direction of
  /// that rate is then ignored if it misses least_cosine.
  double stiffened = 0.1;
  /// Share of the largest motion of a part below which other parts stand still.
  double least_share = 1e-8;
  /// Limit of iterations next to known points, where Newton's method takes three or four.
  double most_iterations_nearby = 15;
  /// Iterations from a nearly correct state above which a smaller step or stiffer springs cost less.
  double most_iterations_of_easy_solve = 12;
  /// Angle between an element and its vertices [rad]: at pi the relative rotation is not unique.
  double largest_end_angle = 2.8;
  // Critical points.
  /// Limit of samples of one step, far more than a few critical points need.
  double most_samples = 120;
  /// Number of eigenvalues, above kMostSeparated, up to which they are located if they vanish together, as in symmetric
  /// structures with as many equal parts.
  double most_multiple = 24;
  /// Length of a step (relative to the size of the structure) up to which more critical points than kMostSeparated are
  /// only counted; longer steps are halved.
  double short_step = 1e-3;
  /// Distance beyond an end of a step at which an eigenvalue is zero: enough to give it a sign, of relative size 1e-9.
  double beyond_step = 1e-2;
  /// Share of the step within which points form one multiple point.
  double together = 1e-6;
  /// Share of a bracket within which the secants of eigenvalues that vanish together cross zero. Then they must nearly
  /// agree to rounding in a smaller bracket, which extends by `closer` to both sides. Otherwise the bracket is divided,
  /// at least at the share `least_part`.
  double nearly_together = 1e-2, closer = 0.02, least_part = 0.1;
  /// Share of the smaller bracket within which these secants agree, as those of equal parts do to rounding.
  double together_closer = 1e-4;
  /// Least cosines for samples of one path: of tangents with the chord of the step, angles up to 60 degrees; and of
  /// tangents of neighbours next to a critical point, angles up to 0.05 rad.
  double least_cosine = 0.5, smooth_cosine = 0.999;
  /// Distance of samples over the bracket. Next to a bifurcation the equations are nearly singular, so the root is
  /// interpolated from four points beside it, at multiples of this distance, and three from farther away: the error is
  /// its fourth power or less. Samples keep away from the ends of the bracket, beyond which other points may lie,
  /// unless the share would become less than least_distance.
  double distance_of_samples = 0.004, least_distance = 1e-4;
  /// Distance at limit points, where nothing is singular, but the rounding of the load factor must be outweighed: six
  /// points leave an error of the sixth power of a larger distance.
  double distance_of_limit = 0.016;
  /// Difference of the roots of polynomials of two degrees, over the distance, above which the samples do not lie on
  /// one smooth path.
  double worst_root = 1e-2;
  double most_root_samples = 40;
  /// Limit of steps of regula falsi for a polynomial.
  double most_root_steps = 60;
  double root_rounding = 1e-15;
  /// Share of the distance of samples at which tangents are checked. An imperfection e bends a path within a distance
  /// of about sqrt(e / 0.05) from a bifurcation: this share still detects 1e-8, but not the 1e-11 that Newton's method
  /// leaves.
  double close_look = 0.03;
  /// Rate of the load factor over the largest in its bracket above which its sign is not rounding.
  double significant_rate = 1e-2;
  /// Share of the step to which the change of the count is located if no eigenvalue of the vertices passes zero, but an
  /// element is unstable inside.
  double counted_place = 1e-10;
  /// Ratio of an eigenvalue in so short a bracket to its value at the start of the step, below which it passes zero.
  double passed_zero = 0.05;
  /// Limit of deflated iterations: neighbours provide the state to 1e-6 or better, and each iteration squares the
  /// error.
  double deflated_iterations = 4;
  // Branches.
  /// First amplitude of the mode with which a branch is entered (largest rotation [rad] or displacement / L), halved
  /// until the branch is met close to the critical point.
  double branch_amplitude = 0.1;
  double branch_attempts = 40, most_iterations_onto_branch = 20;
  /// Least displacement over the length of the structure in a mode of unit motion that determines its sign; rounding
  /// leaves 1e-10, and displacements permitted by symmetry are of order one.
  double moves = 1e-3;
  /// Share of the largest from which on components are equal: rounding must not choose in symmetric structures.
  double nearly_largest = 0.9;
  /// Motion below which everything is rounding: displacements are accurate to about 1e-13 of the structure's length.
  double no_motion = 1e-12;
  /// Deviation of a step from its tangent, next to a critical point, that is rounding: the nearly singular tangent
  /// magnifies what Newton's method leaves, to 3e-9 at the point itself, and its rate without limit.
  double magnified_rounding = 1e-7;
  // Motion and ways.
  /// Weight of the load factor as a length: a path whose stage moves the structure by less than this share of its size
  /// is measured by its load, all others by their motion.
  double load_weight = 1e-6;
  /// Difference of two limit points at nearly the same load factor, over the displacement, up to which they are one: an
  /// error of 1e-7 in the load is one of 3e-4 in the state.
  double same_place = 1e-3;
  double same_load = 1e-7;
  /// Length of a closed path over its last step, and least cosine between its final and initial directions; the latter
  /// also between the motion onto a branch and its mode.
  double round_trip = 10.0, same_direction = 0.9;
  /// Displacement over the length of the scene below which a point has not moved.
  double still = 1e-9;
  // Goals.
  /// Difference of a controlled displacement from its target, over the scene's length, at which it has arrived:
  /// rounding.
  double control_precision = 1e-13;
  // Sizes of steps.
  /// Largest prescribed rotation in a load step. Rotations take the short way, so it must be less than pi; the margin
  /// is for the rotation limit of Newton's method.
  double largest_prescribed_turn = 0.5 * kPi;
  /// Aims of steps along a path, with which a helical rod of ten turns takes the fewest iterations in total: number of
  /// iterations, and rotation of the tangent [rad], usually or closely.
  double aimed_iterations = 6.0;
  double aimed_angle = 0.6, aimed_angle_closely = 0.25;
  /// Growth and shrinking from step to step.
  double largest_growth = 2.0, smallest_growth = 0.5;
  // Automatic paths.
  /// Limit of iterations of a load step, beyond which it seldom converges (dead loads of 1e8 EI/L^2 take 23).
  double most_iterations_of_load_step = 25;
  /// Limit of iterations of a step along the path, a little above its aim, see growth_along_path().
  double most_iterations_along_path = 10;
  /// Consecutive failures in the plane of the scene after which the path continues in space.
  double failures_in_plane = 3;
  /// Largest vertex rotation [rad] in the first step along a path, which is difficult after a failed load step.
  double first_spin = 0.4;
  /// Number of steps ahead for which loads are checked for turning back.
  double reach_of_turns = 2.0;
  /// Length of a step below which the path ends (1: the structure moves by its own size).
  double shortest_step = 1e-9;
  /// Distance from the end of the stage, in load factors, to which a diverging path is followed.
  double largest_detour = 100.0;
  /// Limit of the load for a controlled displacement, over the first critical load, or that of the first step.
  double largest_controlled_load = 1e6;
  /// Share of a step by which the rest of the stage may exceed it: rounding, and not worth another step.
  double rounded_steps = 1e-12;
  /// Largest rotation in a tangent of length 1 above which loads rotate members; limp ones rotate by about that length.
  double least_sideways_spin = 1e-3;
  /// Relative distance from pi within which relative rotations are not unique.
  double margin_of_half_turn = 1e-9;
  // Jumps.
  /// Share of a stage to which the load of a jump is located, unless the user prescribes steps.
  double bracket_of_jump = 1.0 / 16.0;
  // Descent.
  /// Scaled residual at which a state with springs counts as equilibrium: the potential is accurate to its square.
  double loose_residual = 1e-4;
  /// Share of the strain energy below which differences of the potential are due to loose_residual and rounding.
  double potential_digits = 1e-7;
  /// Springs over the present stresses, which bound negative eigenvalues: at first and at most.
  double first_shift = 0.1, most_shift = 1e4;
  double springs_stiffen = 4.0, springs_soften = 0.25;
  /// Number of iterations up to which springs are softened; after more they stay unchanged.
  double easy_iterations_of_descent = 4;
  /// Largest rotation [rad] or displacement / L of a push: at first, at most, at least.
  double first_push = 0.05, most_push = 0.2, least_push = 1e-6;
  /// Odd part of the change of the potential along a mode, over the change, below which it is rounding: then the sign
  /// is that of branches.
  double level_slope = 1e-8;
  // Steep starts.
  /// Decades by which yielding stiffnesses grow before members are rigid again.
  double decades_to_rigid = 8.0;
  /// Share of its motion from the start by which hardening may move the structure. That motion grows like the root of
  /// the load factor, and is large enough when members have approached by ten times what they yield.
  double hardened_motion = 0.05;
  /// Growth of the load factor after which restoring the stiffnesses is tried again, and limit of steps.
  double next_try = 2.0;
  double most_eased_steps = 60;
  /// Bending stiffness over load times L^2, and tension stiffness over load, with which limp members sag by some tenths
  /// of their length, and do not buckle to a side other than that of the load.
  double stiffness_of_limp = 0.005, tension_of_limp = 10.0;
  /// Share from which stiffnesses of cables are restored if that fails from zero: there they are stiffer in bending by
  /// a factor of 10 to 100.
  double share_stiffer = -0.2;
  /// Largest moment of a cable structure, over largest force and length.
  double little_bending = 0.01;
  /// Share by which stiffnesses are restored in a step: at first, at least, and at most with a descent.
  double first_share_back = 1.0 / 3.0, least_share_back = 0.01, share_of_descent = 0.1;
  /// Tolerance of the scaled residual for intermediate solutions.
  double tolerance_back = 1e-7;
  double most_solutions_back = 60, most_descents = 24;
  double easy_iterations_back = 6;
};

inline PathThresholds path_limit;

}  // namespace mixbeam
