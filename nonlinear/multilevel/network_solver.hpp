/// Chooses the solver for the tangents of a model; and the iterative one, for networks whose factors are too large:
/// conjugate gradients with a Hierarchy of coarse spaces, theory (64). Open this first.
#pragma once

#include "nonlinear/linear/chain_solver.hpp"
#include "nonlinear/multilevel/hierarchy.hpp"

namespace mixbeam {

/// Solves what chains leave by conjugate gradients, on one rank. Coarse spaces are new with each tangent, aggregates
/// are kept. Where the matrix is not symmetric and positive definite, and where the iteration does not converge,
/// factors are taken as long as they are not too large; else a LinearSolverError says why.
class NetworkSolver : public LinearSolver {
 public:
  /// What is left of the error, in energy, where no other number is given: Newton's method converges as with factors.
  static constexpr double kReduction = 1e-8;

  NetworkSolver(const CondensedSystem& system, double residual_tolerance, PhaseTimes& times,
                double reduction = kReduction);

  void factorize() override;
  double solve(const DofVector& b, DofVector& x) override;
  bool iterates() const override { return true; }

  /// Of the last solve.
  int iterations() const { return iterations_; }
  /// Why factors were taken, or would have been if they were not too large; empty where the last matrix could be
  /// iterated with.
  const std::string& objection() const { return objection_; }

 private:
  void number_nodes();
  void read_values();
  LinkBlocks link_blocks(int link, double* room) const;
  bool iterate(const DofVector& b, DofVector& x, double reduction);
  void factorize_directly();

  const CondensedSystem& system_;
  double tolerance_, reduction_;
  PhaseTimes& times_;
  std::vector<unsigned char> free_;    ///< (row): 1 where it has an equation with other unknowns
  std::vector<int> node_;              ///< (vertex that remains): its place in the hierarchy, -1: has no free row
  std::vector<int> vertex_;            ///< (place)
  std::vector<int> link_;              ///< (link of the network): its number among those of the system
  std::vector<unsigned char> masked_;  ///< (link of the network): 1 where an end has a row that is not free
  std::vector<std::array<int, 2>> link_vertices_;
  LinkMatrices<kVertexDofs> matrices_;
  KernelView<double*> self_;
  std::unique_ptr<Hierarchy> hierarchy_;
  LevelVector r_, x_, z_, p_, q_;
  std::unique_ptr<LinearSolver> direct_;
  std::string objection_;
  int iterations_ = 0;
};

/// 8 bytes each: 0.8 GB, a cube of 26^3 junctions.
inline constexpr double kMostFactorEntries = 1e8;
/// Whether the factors of what chains leave would be so large that it is iterated with.
bool is_large_network(const CondensedSystem& system);

/// The solver for the tangents of a model. `method`: kAutomatic, kIterative, or as make_direct_tangent_solver.
std::unique_ptr<TangentSolver> make_tangent_solver(const Model& model, const std::string& method,
                                                   double residual_tolerance);

}  // namespace mixbeam
