/// Numbers that decide about paths, each with its reason. A study or a test may move them before
/// what they decide about begins.
#pragma once

#include "kernels/math/constants.hpp"

namespace mixbeam {

struct PathThresholds {
  // A step, judged.
  /// The chord and the tangents at its ends are taken for one line when their cosines are at least this: a path that
  /// turns aside by less has no room for another one.
  double straight = 0.97;
  /// Newton's correction half-way, over the chord, up to which the cubic counts as the path.
  double largest_correction = 0.2;
  /// A correction this small leaves no doubt that the cubic is the path.
  double sure_correction = 1e-2;
  /// A step is halved for a closer look so many times at most.
  double most_halvings = 3;
  /// Between points in which the load factor changes at rates of one sign the rate stays above this share of the
  /// smaller one, or the load may have gone back and forth between them.
  double least_gain = 0.5;
  /// Of the load factor's last rate over its mean: it grows with this power of the motion. Bars in tension make it grow
  /// with the third, what is bent until it is straight with any power, and a cubic says nothing of that.
  double fastest_growth = 6.0;
  /// What the cubic leaves out of the load factor half-way, e, is at least a multiple of the parabola of fourth degree
  /// 16 e s^2 (1 - s)^2, whose slope reaches this times e.
  double error_of_rate = 3.1;
  /// A change of the load factor along a step, over the load factor: the cap alone shifts critical loads by 1e-7.
  double flat_load = 1e-5;
  /// A structure has stiffened when its rate at the end would move it by less than this share of the step's chord, and
  /// the direction of that rate is of no importance where it misses least_cosine.
  double stiffened = 0.1;
  /// Parts that move by a smaller share of what the part that moves farthest does stand still.
  double least_share = 1e-8;
  /// Next to known points Newton's method takes three or four iterations.
  double most_iterations_nearby = 15;
  /// More iterations than this, from a state that is nearly right, cost more than a smaller step or stiffer springs.
  double most_iterations_of_easy_solve = 12;
  /// Between an element and its vertices [rad]: at pi the relative rotation is not unique.
  double largest_end_angle = 2.8;
  // Critical points.
  /// Samples of one step, far more than a few critical points need.
  double most_samples = 120;
  /// More eigenvalues than kMostSeparated are located where they vanish at one place, up to these, as those of
  /// symmetric structures with as many equal parts.
  double most_multiple = 24;
  /// More critical points than kMostSeparated are told by their number only, in steps as short as this (the structure
  /// moves by so much of its size); longer ones are halved.
  double short_step = 1e-3;
  /// Beyond an end of a step at which an eigenvalue is zero: far enough for it to have a sign, of relative size 1e-9.
  double beyond_step = 1e-2;
  /// Points closer together than this share of the step are one multiple point.
  double together = 1e-6;
  /// Eigenvalues vanish together when their secants cross zero within this share of a bracket, and again of one that
  /// reaches from there by `closer` of it to both sides, nearly to rounding. Else the bracket is divided, at this share
  /// of it at least.
  double nearly_together = 1e-2, closer = 0.02, least_part = 0.1;
  /// The latter secants of eigenvalues that do vanish together, those of equal parts, agree to rounding.
  double together_closer = 1e-4;
  /// Samples belong to one path when their tangents point along the chord of the step, angles up to 60 degrees; and
  /// next to a critical point those of neighbours differ by no more than 0.05 rad.
  double least_cosine = 0.5, smooth_cosine = 0.999;
  /// Next to a bifurcation the equations are nearly singular, so the root is interpolated from four points beside it,
  /// at multiples of this share of the bracket, and three from farther away: they leave an error of its fourth power
  /// and less. Other points may lie beyond the ends of the bracket: the samples keep away from there, unless the share
  /// became less than least_distance.
  double distance_of_samples = 0.004, least_distance = 1e-4;
  /// At limit points nothing is singular, and the load factor's own rounding is what must be outweighed: six points
  /// leave an error of the sixth power of a larger distance.
  double distance_of_limit = 0.016;
  /// Where polynomials of two degrees differ by more than this share of the distance, the samples lie on no one smooth
  /// path.
  double worst_root = 1e-2;
  double most_root_samples = 40;
  /// Of the rule of false position for a polynomial.
  double most_root_steps = 60;
  double root_rounding = 1e-15;
  /// An imperfection e turns a path aside over a distance of about sqrt(e / 0.05) from a bifurcation: tangents at this
  /// share of the distance of the samples still show those of 1e-8, and 1e-11 that Newton's method leaves is no corner.
  double close_look = 0.03;
  /// A rate of the load factor over the largest in its bracket whose sign is not one of rounding.
  double significant_rate = 1e-2;
  /// Where no eigenvalue of the vertices passes zero, an element is unstable inside: the place is that where the count
  /// changes, to this share of the step.
  double counted_place = 1e-10;
  /// An eigenvalue that passes zero in a bracket as short as that is there below this share of what it was at the
  /// start of the step.
  double passed_zero = 0.05;
  /// Deflated iterations at most: the state is known to 1e-6 or better from its neighbours, and each squares the error.
  double deflated_iterations = 4;
  // Branches.
  /// First amplitude of the mode with which a branch is entered (largest rotation [rad] or displacement / L), halved
  /// until the branch is met close to the critical point.
  double branch_amplitude = 0.1;
  double branch_attempts = 40, most_iterations_onto_branch = 20;
  /// A displacement over the length of the structure that a mode of motion one has at least where it counts; rounding
  /// leaves 1e-10, and what symmetry does not forbid is of the order of one.
  double moves = 1e-3;
  /// Components are nearly equal from here on: symmetric structures must not choose by their rounding errors.
  double nearly_largest = 0.9;
  /// A motion smaller than this is rounding: the displacements of a structure are known to about 1e-13 of its length.
  double no_motion = 1e-12;
  /// So is what a step that ends next to a critical point misses its tangent by: the nearly singular tangent magnifies
  /// what Newton's method leaves, to 3e-9 at the point itself, and its rate to anything.
  double magnified_rounding = 1e-7;
  // Motion and ways.
  /// Weight of the load factor in lengths: a path whose stage moves the structure by less than this share of its size
  /// is measured by its load, all others by their motion.
  double load_weight = 1e-6;
  /// Two limit points at nearly one load factor are one, of the displacement: an error of 1e-7 of the load is one of
  /// 3e-4 of the place.
  double same_place = 1e-3;
  double same_load = 1e-7;
  /// A path that has come back has travelled so many times its last step, and runs as it began by this cosine, by
  /// which the way onto a branch is one along its mode.
  double round_trip = 10.0, same_direction = 0.9;
  /// A displacement over the length of the scene that has not moved.
  double still = 1e-9;
  // Goals.
  /// A controlled displacement has arrived when it differs from the target by this share of the scene's length:
  /// rounding.
  double control_precision = 1e-13;
  // Sizes of steps.
  /// A prescribed rotation is followed the short way, so one load step may not turn a support by pi or more; the margin
  /// leaves room for the rotation limit of Newton's method.
  double largest_prescribed_turn = 0.5 * kPi;
  /// Steps along a path aim at what a helical rod of ten turns needs the fewest iterations in all with ...
  double aimed_iterations = 6.0;
  /// ... and at this angle [rad] by which the tangent turns, or closely.
  double aimed_angle = 0.6, aimed_angle_closely = 0.25;
  /// Growth and shrinking from step to step.
  double largest_growth = 2.0, smallest_growth = 0.5;
  // Automatic paths.
  /// Load steps that have not converged by then seldom do (dead loads of 1e8 EI/L^2 take 23), and the attempt is lost.
  double most_iterations_of_load_step = 25;
  /// Steps along the path are abandoned a little above what they aim at, see growth_along_path().
  double most_iterations_along_path = 10;
  /// Attempts in a row that fail in the plane of the scene before the path goes on in space.
  double failures_in_plane = 3;
  /// Largest vertex rotation [rad] in the first step along a path: what follows a failed load step is difficult.
  double first_spin = 0.4;
  /// Loads that turn back are looked for so many steps ahead.
  double reach_of_turns = 2.0;
  /// The path ends below this length (1: the structure moves by its own size).
  double shortest_step = 1e-9;
  /// A path that runs away from the end of its stage is followed this far, in load factors of one stage.
  double largest_detour = 100.0;
  /// A controlled displacement is not sought beyond this multiple of the first critical load, or of the first step's.
  double largest_controlled_load = 1e6;
  /// A rest of the stage that exceeds the step by no more than this share of it is rounding, and not worth a step.
  double rounded_steps = 1e-12;
  /// Of a tangent of length 1; limp members turn by about that length.
  double least_sideways_spin = 1e-3;
  /// Relative rotations so near to pi, as a share, are not unique.
  double margin_of_half_turn = 1e-9;
  // Jumps.
  /// Without steps of the user's own the load of a jump is known to this share of a stage.
  double bracket_of_jump = 1.0 / 16.0;
  // Descent.
  /// Scaled residual at which a state with springs counts as their equilibrium: the potential is known to its square.
  double loose_residual = 1e-4;
  /// Of the potential that has been moved: differences below are those of loose_residual and rounding.
  double potential_digits = 1e-7;
  /// Springs over the stresses at work, which bound negative eigenvalues: at first and at most.
  double first_shift = 0.1, most_shift = 1e4;
  double springs_stiffen = 4.0, springs_soften = 0.25;
  /// Iterations from which on springs are not made softer, and stay as they are.
  double easy_iterations_of_descent = 4;
  /// Largest rotation [rad] or displacement / L of a push: at first, at most, at least.
  double first_push = 0.05, most_push = 0.2, least_push = 1e-6;
  /// A slope of the potential along a mode below this share of forces times motion is rounding: then signs are those
  /// of branches.
  double level_slope = 1e-8;
  // Steep starts.
  /// From there, before members are rigid again.
  double decades_to_rigid = 8.0;
  /// Hardening may move the structure by this share of its way from the start. The way grows like the root of the
  /// load factor, and is long enough when members have approached by ten times what they yield.
  double hardened_motion = 0.05;
  /// The way back is tried where the load factor has grown by this factor since the last try, on so many steps.
  double next_try = 2.0;
  double most_eased_steps = 60;
  /// With this bending stiffness over load times L^2, and this tension stiffness over the load, limp members sag by
  /// some tenths of their length, and buckle to no other side than that of the load.
  double stiffness_of_limp = 0.005, tension_of_limp = 10.0;
  /// Share of the way from where a structure of cables goes back whose way from zero does not arrive: there it is
  /// stiffer in bending by a factor of 10 to 100.
  double share_stiffer = -0.2;
  /// Of a structure of cables: what bending carries, largest moment over largest force and length.
  double little_bending = 0.01;
  /// Share of the way on which stiffnesses go back at first, at least, and up to which a descent is worth its price.
  double first_share_back = 1.0 / 3.0, least_share_back = 0.01, share_of_descent = 0.1;
  /// Scaled residual up to which the solutions on the way are worth their iterations.
  double tolerance_back = 1e-7;
  double most_solutions_back = 60, most_descents = 24;
  double easy_iterations_back = 6;
};

inline PathThresholds path_limit;

}  // namespace mixbeam
