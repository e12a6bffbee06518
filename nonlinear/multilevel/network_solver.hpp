/// Chooses the solver for the tangents of a model; and the iterative one, for networks whose factors are too large:
/// conjugate gradients with a Hierarchy of coarse spaces, theory (64). Open this first.
#pragma once

#include "nonlinear/linear/chain_solver.hpp"
#include "nonlinear/multilevel/hierarchy.hpp"

namespace mixbeam {

/// Solves what chains leave by conjugate gradients, and by GMRES where the matrix is unsymmetric and its factors are
/// large. Aggregates are kept, and so are coarse spaces and their matrices until iterations have grown by half or
/// reset_factors() is called. Where neither can be done, in unstable states as a rule, and where the iteration does not
/// converge, factors are taken; a LinearSolverError says why where they are too large.
class NetworkSolver : public LinearSolver {
 public:
  /// Share of the error left, in energy, if no other number is given: Newton's method converges as with factors.
  static constexpr double kReduction = 1e-8;

  /// Factors with more entries are not taken: 8 GB.
  static constexpr double kMostFallbackEntries = 1e9;

  /// Iterations of the last solve.
  virtual int iterations() const = 0;
  /// How often coarse spaces were made.
  virtual int spaces_made() const = 0;
  /// Why factors were taken, or would have been if they were not too large; empty where the last matrix could be
  /// iterated with.
  virtual const std::string& objection() const = 0;
};

/// `has_factors_at_hand`: iteration is for where it is allowed.
std::unique_ptr<NetworkSolver> make_network_solver(const CondensedSystem& system, double residual_tolerance,
                                                   PhaseTimes& times, bool has_factors_at_hand = false,
                                                   double reduction = NetworkSolver::kReduction,
                                                   double most_fallback_entries = NetworkSolver::kMostFallbackEntries);

/// 8 bytes each: 0.8 GB, a cube of 26^3 junctions.
inline constexpr double kMostFactorEntries = 1e8;
/// Entries of the factors of what chains leave, roughly.
double factor_entries(const CondensedSystem& system);
/// Counts the entries of factors from the neighbours of each vertex alone: (vertex, and one more) first of them.
double factor_entries(const std::vector<int>& start, const std::vector<int>& next);
/// Whether stable states of a network with factors of that size take less time by iteration.
bool is_quicker_by_iteration(const CondensedSystem& system, double factor_entries);

/// The solver for the tangents of a model. `method`: kAutomatic, kIterative, or as make_direct_tangent_solver.
std::unique_ptr<TangentSolver> make_tangent_solver(const Model& model, const std::string& method,
                                                   double residual_tolerance);

}  // namespace mixbeam
