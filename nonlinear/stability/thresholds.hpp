/// Thresholds of counts, modes and buckling, each with its reason. A study or a test may change them before a run
/// begins.
#pragma once

namespace mixbeam {

struct StabilityThresholds {
  // Counts and spectra.
  /// Asymmetry up to which a tangent is symmetric. Rounding leaves 1e-13 in refined meshes, an unfinished Newton
  /// iteration 1e-11; asymmetry this small changes eigenvalues by its square.
  double symmetric = 1e-9;
  /// Factors on the usual cap. For counts the raised cap lowers a critical load by a share of about 1e-7; modes are
  /// corrected to the true stiffness, so that the usual cap, with less rounding, suits them best.
  ///
  /// The cap is lower in proportion if both the stresses, N L^2/EI or M L/EI with the largest EI of the structure, and
  /// the stiffness of the structure (a stiff column on a soft spring, say) are below one: members 1e7 times as stiff
  /// are as good as rigid, and the rounding of much larger stiffnesses would hide the decisive ones.
  double cap_of_count = 100.0, cap_of_modes = 1.0;
  /// Stresses below which the stiffness of the unloaded structure is determined as well.
  double small_stress = 1e-2;
  /// Least share of the usual cap: that of a mechanism without stress.
  double least_cap_share = 1e-12;
  /// Share of the present stresses, N L^2/EI or M L/EI, below which an eigenvalue is zero: states are equilibria to
  /// 1e-11.
  double zero = 1e-9;
  /// Share of the present stresses below which an eigenvalue is computed more accurately: the cap shifts it by 1e-7,
  /// and that of the remaining system is a few dozen times larger.
  double near_zero = 1e-4;
  /// Multiple of its rounding error below which this also happens.
  double near_rounding = 100.0;
  /// Modes computed then: first attempt, and limit. More zero eigenvalues than this mean a mechanism.
  double first_null = 4, most_null = 16;
  /// Unsymmetric tangents: limit of the real eigenvalues that are counted, and number of additional ones that are
  /// computed, since negative ones need not be the nearest to zero.
  double most_divergent = 16, more_modes = 4;
  /// Asymmetry up to which they are counted: loads that have a potential except at the ends or for the discretization
  /// (rings under follower pressure: 5e-4). Beyond (dead moments that rotate a rod by a radian: 0.2), pairs of complex
  /// eigenvalues may become real and negative, which looks like two that passed zero.
  double nearly_conservative = 2e-2;
  /// Shift that makes a singular tangent invertible; all other eigenvalues are far larger.
  double shift_beside_zero = 1e-7;
  /// Relative imaginary part up to which a Ritz value is real.
  double real_value = 1e-8;
  /// Rounding of an eigenvalue over the size that counts as zero, below which its critical load has ten digits.
  double rounding_matters = 0.1;
  /// Motion (largest rotation, or displacement over the length) of the largest central difference of a derivative.
  /// Three of them are combined (kDifferences), with an error of its sixth power over 64 * 7!. Rounding is multiplied
  /// by 200.
  double difference_motion = 1.0 / 32.0;
  /// Remaining error over the size that counts as zero: states are equilibria to 1e-11.
  double variation_error = 1e-2;
  /// Residuals of modes as results, and of those that only span a space.
  double exact_modes = 1e-9, rough_modes = 1e-2;
  /// Share of the largest component from which on components are of equal size, so that rounding does not choose the
  /// one that determines the sign.
  double almost_largest = 1.0 - 1e-6;
  // Krylov spaces.
  /// Share of a vector below which the rest after orthogonalisation is rounding: the space contains the vector.
  double nothing_new = 1e-10;
  /// Blocks of one space, before it restarts from its Ritz vectors.
  double longest_space = 15;
  /// Stagnation, if rounding keeps residuals above their tolerance: a reduction by less than this factor in so many
  /// blocks.
  double standstill = 0.5;
  double standstill_blocks = 3;
  /// Residual above which stagnation is just a slow start.
  double largest_standstill = 1e-5;
  // Linear buckling.
  /// N L^2/EI and M L/EI of the states for a first estimate: far below buckling, which begins near ten.
  double first_stress = 0.02;
  /// Step of the final differences over the load factor nearest to zero: their error is its fourth power (times a small
  /// number), and rounding grows with its inverse.
  double difference_step = 0.02;
  /// Limit of rounds of a Rayleigh quotient and an inverse iteration, which improve a factor until the residual of its
  /// mode is small; the square of that is the error of the factor. They begin with the pencil of condensed tangents,
  /// which is accurate to the fourth power of the element length; each round at least squares the error of the mode.
  double most_rounds = 6;
  double small_residual = 1e-6;
  double aside_of_factor = 1e-5;
  /// Relative change of a factor below which its Rayleigh quotient has settled, and limit of secant iterations.
  double settled_factor = 1e-11;
  double most_secants = 6;
  /// Relative distance below which factors form one cluster, beside which the inertia is counted; largest residual of a
  /// confirmed factor.
  double beside_factor = 1e-4;
  /// Relative difference in magnitude up to which two factors are a pair of opposite signs.
  double same_size = 1e-6;
};

inline StabilityThresholds stability_limit;

}  // namespace mixbeam
