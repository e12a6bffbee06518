/// Whether an equilibrium is stable: the signs of the eigenvalues of the tangent in the motions that supports and
/// joints permit, and the modes whose eigenvalues are nearest to zero.
///
/// K phi = mu S phi with the reduced tangent K and S as IndependentUnknowns measures motions: EI/L times l_v/L for
/// rotations, that over L^2 for displacements. Eigenvalues have no unit.
///
/// Under loads with a potential K is symmetric and an equilibrium is stable when no eigenvalue is negative. Under
/// follower loads and spatial moments K is not symmetric: real eigenvalues below zero mean divergence, and their parity
/// is the sign of the determinant; flutter is a matter of dynamics and not seen here.
///
/// The tangent of Newton's method caps the stiffness of forces (Assembler), which lowers eigenvalues by about 1e-5 of
/// the loads. Modes are corrected to the true stiffness, to second order in the cap.
///
/// Only vertices are looked at: an element that buckles between vertices that stand still (beyond four times the Euler
/// load of a hinged column of its length) goes unnoticed.
#pragma once

#include "discretization/condensed_system.hpp"
#include "nonlinear/beam_problem.hpp"
#include "nonlinear/block_krylov.hpp"
#include "nonlinear/eigen_mode.hpp"
#include "nonlinear/independent_unknowns.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace mixbeam {

struct StabilityResult {
  int negative = 0;        ///< eigenvalues below zero; unsymmetric: real ones
  int null = 0;            ///< pivots that are exactly zero; a mechanism often leaves tiny ones instead
  bool symmetric = true;   ///< the tangent was treated as symmetric
  double asymmetry = 0.0;  ///< largest |K_ij - K_ji| / sqrt(K_ii K_jj)
};

struct Spectrum {
  StabilityResult stability;     ///< `negative` agrees with the corrected eigenvalues
  std::vector<EigenMode> modes;  ///< nearest to zero first; unsymmetric: real ones alone
};

/// Works on the tangent of the assembler and leaves another state there: Newton's method assembles its own again.
/// All functions are collective, give the same on every rank and throw LinearSolverError.
class Stability {
 public:
  explicit Stability(BeamProblem& problem);

  /// Inertia of the tangent as it is, capped: one factorisation, most of it that of chains, in parallel. Within about
  /// 1e-5 of a critical load the count may differ from that of spectrum().
  StabilityResult count(const State& state, double load_factor);

  /// The `count` eigenvalues nearest to zero (or all there are), with modes, and the number of negative ones.
  Spectrum spectrum(const State& state, double load_factor, int count);
  std::vector<EigenMode> modes_near_zero(const State& state, double load_factor, int count) {
    return spectrum(state, load_factor, count).modes;
  }

 private:
  /// Eigenvectors of the reduced matrix on rank 0, eigenvalues everywhere.
  struct Reduced {
    std::vector<double> eigenvalue;
    std::vector<std::vector<double>> vector, left;  ///< left: unsymmetric only
  };

  void evaluate_tangent(const State& state, double load_factor);
  void assemble(const State& state, double load_factor);
  std::optional<StabilityResult> inertia_with_chains(const State& state);
  /// `keeps_factors`: those of the tangent itself are wanted afterwards.
  StabilityResult inertia(bool keeps_factors);
  bool is_positive_in_its_symmetric_part();
  void count_real_negative(StabilityResult& result);
  Reduced nearest(const StabilityResult& stability, int count);
  std::vector<EigenMode> corrected_modes(const State& state, const StabilityResult& stability, const Reduced& reduced);

  BeamProblem& problem_;
  // When first needed:
  std::unique_ptr<IndependentUnknowns> unknowns_;
  std::unique_ptr<InertiaSolver> symmetric_, general_;  ///< rank 0
  std::unique_ptr<CondensedSystem> chains_;
  std::unique_ptr<IndependentUnknowns> unknowns_beside_chains_;
  std::unique_ptr<InertiaSolver> symmetric_beside_chains_;  ///< rank 0
};

}  // namespace mixbeam
