/// Numbers that decide about counts, modes and buckling, each with its reason. A study or a test may move them before
/// what they decide about begins.
#pragma once

namespace mixbeam {

struct StabilityThresholds {
  // Counts and spectra.
  /// Rounding leaves 1e-13 in refined meshes, an unfinished Newton iteration 1e-11; asymmetry this small changes
  /// eigenvalues by its square.
  double symmetric = 1e-9;
  /// Raises of the usual cap. Where eigenvalues are only counted it lowers a critical load by about 1e-7 of it; modes
  /// are corrected to the true stiffness, so that the usual cap, which leaves less of rounding, serves them best.
  ///
  /// Where the stresses, N L^2/EI or M L/EI with the largest EI of the structure, are below one and so is the stiffness
  /// of the structure, as that of a stiff column on a soft spring, the cap is lower in proportion: what is 1e7 times as
  /// stiff is as good as rigid, and in the rounding of stiffnesses far above the decisive ones would be lost.
  double cap_of_count = 100.0, cap_of_modes = 1.0;
  /// Below this share of EI the stiffness of the unloaded structure is asked for as well.
  double small_stress = 1e-2;
  /// A cap below this share of the usual one is that of a mechanism without stress.
  double least_cap_share = 1e-12;
  /// An eigenvalue below this share of the stresses at work, N L^2/EI or M L/EI, is zero: states are equilibria to
  /// 1e-11.
  double zero = 1e-9;
  /// Below this share of the stresses at work an eigenvalue is looked at closely: the cap shifts it by 1e-7, and that
  /// of the remaining system is a few dozen times larger.
  double near_zero = 1e-4;
  /// Also below this multiple of its rounding error, where that is more than the share above.
  double near_rounding = 100.0;
  /// Modes looked at there: at first, and at most. More zero eigenvalues than this are those of a mechanism.
  double first_null = 4, most_null = 16;
  /// Without symmetry up to so many real eigenvalues are counted, and so many more are looked at: negative ones need
  /// not be the nearest to zero.
  double most_divergent = 16, more_modes = 4;
  /// They are counted where the loads have a potential but for the ends or the discretization (rings under a pressure
  /// that follows them: 5e-4). Beyond (dead moments that turn a rod by a radian: 0.2), pairs of complex eigenvalues
  /// become real below zero, which passes for two that went through zero.
  double nearly_conservative = 2e-2;
  /// Shift that makes a singular tangent invertible; all other eigenvalues are far larger.
  double shift_beside_zero = 1e-7;
  /// A Ritz value is real when its imaginary part is rounding.
  double real_value = 1e-8;
  /// Where rounding leaves less of an eigenvalue than this share of what counts as zero, its critical load is known to
  /// ten digits.
  double rounding_matters = 0.1;
  /// Motion (largest rotation, or displacement over the length) of the largest of the differences below, and these:
  /// parts of it and their weights, which leave an error of its sixth power over 64 * 7!. Rounding is multiplied by
  /// 200.
  double difference_motion = 1.0 / 32.0;
  /// What is left of an error, of what counts as zero: states are equilibria to 1e-11.
  double variation_error = 1e-2;
  /// Residuals of modes as results, and of those that only span a space.
  double exact_modes = 1e-9, rough_modes = 1e-2;
  /// The first of several components of equal size gives the sign; rounding must not choose another one.
  double almost_largest = 1.0 - 1e-6;
  // Krylov spaces.
  /// After orthogonalisation less than this of a vector is rounding: the space holds it already.
  double nothing_new = 1e-10;
  /// Blocks of one space, before it is begun again with what it has found.
  double longest_space = 15;
  /// Where rounding keeps residuals above their tolerance they come to a standstill: not a factor of two in three
  /// blocks.
  double standstill = 0.5;
  double standstill_blocks = 3;
  /// A standstill above this is a slow start.
  double largest_standstill = 1e-5;
  // Linear buckling.
  /// Of N L^2/EI and M L/EI in the states that tell a first estimate: far below buckling, which begins near ten.
  double first_stress = 0.02;
  /// Of the load factor nearest to zero, in the final differences: their error is its fourth power (times a small
  /// number), and rounding grows with its inverse.
  double difference_step = 0.02;
  /// A factor is improved in rounds of a Rayleigh quotient and one inverse iteration until the residual of its mode is
  /// small, whose square is the error of the factor: the pencil of condensed tangents, where they begin, is right to
  /// the fourth power of the element length, and each round squares the error of the mode at least.
  double most_rounds = 6;
  double small_residual = 1e-6;
  double aside_of_factor = 1e-5;
  /// Of a factor: its Rayleigh quotient moves no more. The secant method needs at most most_secants.
  double settled_factor = 1e-11;
  double most_secants = 6;
  /// Factors this close, as a share, are one cluster, and the inertia is counted as far beside it; the residual of what
  /// is confirmed is at most as large.
  double beside_factor = 1e-4;
  /// Factors whose sizes differ by no more than this share are a pair of both signs.
  double same_size = 1e-6;
};

inline StabilityThresholds stability_limit;

}  // namespace mixbeam
