/// Choice of the solver for the tangents of a model, and the iterative solver for networks whose factors are too large:
/// conjugate gradients with a Hierarchy of coarse spaces, theory (64). Open this first.
#pragma once

#include "nonlinear/linear/chain_solver.hpp"
#include "nonlinear/multilevel/hierarchy.hpp"

namespace mixbeam {

/// Solves the remaining system of chains by conjugate gradients, or by GMRES if the matrix is unsymmetric and its
/// factors are large. Keeps aggregates, and coarse spaces with their matrices until the number of iterations has grown
/// by half or reset_factors() is called. If the matrix does not permit iteration, as in most unstable states, or the
/// iteration does not converge, it factorises; if factors are too large, a LinearSolverError states the reason.
class NetworkSolver : public LinearSolver {
 public:
  /// Default of the energy error left by a solve: Newton's method converges as with factors.
  static constexpr double kReduction = 1e-8;

  /// Limit of the entries of factors: 8 GB.
  static constexpr double kMostFallbackEntries = 1e9;

  /// Number of iterations of the last solve.
  virtual int iterations() const = 0;
  /// Number of times that coarse spaces were made.
  virtual int spaces_made() const = 0;
  /// Why the last matrix was factorised, or would have been if factors were not too large; empty if iteration worked.
  virtual const std::string& objection() const = 0;
};

/// Makes the iterative solver. `has_factors_at_hand`: factors are small enough; iterate only when allowed.
std::unique_ptr<NetworkSolver> make_network_solver(const CondensedSystem& system, double residual_tolerance,
                                                   PhaseTimes& times, bool has_factors_at_hand = false,
                                                   double reduction = NetworkSolver::kReduction,
                                                   double most_fallback_entries = NetworkSolver::kMostFallbackEntries);

/// Entries of factors above which networks are always solved by iteration: 0.8 GB, a cube of 26^3 junctions.
inline constexpr double kMostFactorEntries = 1e8;
/// Estimates the entries of the factors of the remaining system.
double factor_entries(const CondensedSystem& system);
/// Estimates them from the graph of vertices. `start`: (vertex, and one more) its first neighbour in `next`.
double factor_entries(const std::vector<int>& start, const std::vector<int>& next);
/// Whether stable states of a network with factors of that size take less time by iteration.
bool is_quicker_by_iteration(const CondensedSystem& system, double factor_entries);

/// Makes the solver for the tangents of a model. `method`: kAutomatic, kIterative, or see make_direct_tangent_solver.
std::unique_ptr<TangentSolver> make_tangent_solver(const Model& model, const std::string& method,
                                                   double residual_tolerance);

}  // namespace mixbeam
