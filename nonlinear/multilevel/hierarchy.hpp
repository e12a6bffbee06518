/// Multilevel preconditioner for the tangents of networks: spectral coarse spaces, theory (63), and the symmetric
/// V-cycle over them, theory (64).
#pragma once

#include "kernels/math/vector_algebra.hpp"
#include "nonlinear/linear/inertia_solver.hpp"
#include "nonlinear/multilevel/level.hpp"

#include <memory>

namespace mixbeam {

/// Symmetric matrix over the nodes of a network, six unknowns each.
struct NetworkMatrix {
  KernelView<double*> self;  ///< (node, 36)
  LinkSource links;
};

/// Numbering of the nodes of each level such that nodes of an aggregate are consecutive, and neighbours are close in
/// memory on every level.
struct Nesting {
  std::vector<int> order;               ///< (place on the finest level): number of the node
  std::vector<std::vector<int>> first;  ///< (level)(aggregate, and one more): place of its first node
};

/// Groups nodes to aggregates of about eight, theory (63), level by level until the graph is small or coarsens no more:
/// to cubes if the network is a cubic lattice, perturbed or not. `places`: positions of the nodes. Deterministic.
Nesting nest(const std::vector<Vector3>& places, const LinkEnds& ends);

class Hierarchy {
 public:
  /// Finds the aggregates of the network, which are kept for all matrices. On several ranks each has aggregates of its
  /// own nodes, `places` are theirs, and `ends` are the links that touch them, with ghosts of `halo` at their other
  /// ends; all functions are then collective.
  Hierarchy(const std::vector<Vector3>& places, const LinkEnds& ends, Halo halo = {});

  /// (place): number of the node; vectors of a Hierarchy are in this order.
  const std::vector<int>& order() const { return order_; }
  /// Makes coarse spaces and matrices of all levels. Throws NegativeCurvature, LinearSolverError.
  void set(const NetworkMatrix& matrix);
  /// Replaces the matrix of the finest level; coarser levels stay unchanged. Throws NegativeCurvature.
  void set_finest(const NetworkMatrix& matrix);
  const Level& finest() const { return *levels_.front(); }
  /// Computes z = M^-1 r, M symmetric positive definite.
  void precondition(const LevelVector& r, const LevelVector& z);

 private:
  void factorize_coarsest();
  void solve_coarsest();
  void cycle(size_t level);

  std::vector<int> order_;
  std::vector<std::unique_ptr<Level>> levels_;
  size_t used_ = 0;  ///< number of levels in use, the coarsest of which is solved directly
  struct Vectors {
    LevelVector residual, x, step, other;
  };
  std::vector<Vectors> vectors_;
  std::unique_ptr<InertiaSolver> direct_;  ///< on rank 0 alone
  GatherPlan coarsest_rows_;               ///< several ranks only
};

}  // namespace mixbeam
