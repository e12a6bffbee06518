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

/// Nodes of each level are numbered so that those of an aggregate follow each other, and neighbours lie close in memory
/// on every level.
struct Nesting {
  std::vector<int> order;               ///< (place on the finest level): number of the node
  std::vector<std::vector<int>> first;  ///< (level)(aggregate, and one more): place of its first node
};

/// Aggregates of about eight nodes, theory (63), level by level until the graph is small or coarsens no more: cubes
/// where the network is a cubic lattice, displaced or not. `places`: of the nodes. Deterministic.
Nesting nest(const std::vector<Vector3>& places, const LinkEnds& ends);

class Hierarchy {
 public:
  /// Aggregates of the network, kept for all values. On several ranks each has aggregates of its own nodes, `places`
  /// are theirs, and links that touch them are given, with ghosts of `halo` at their other ends; all functions are then
  /// collective.
  Hierarchy(const std::vector<Vector3>& places, const LinkEnds& ends, Halo halo = {});

  /// (place): number of the node; vectors of a Hierarchy are in this order.
  const std::vector<int>& order() const { return order_; }
  /// New spaces and matrices. Throws NegativeCurvature, LinearSolverError.
  void set(const NetworkMatrix& matrix);
  /// A new matrix on the finest level alone; coarser levels stay as they are. Throws NegativeCurvature.
  void set_finest(const NetworkMatrix& matrix);
  const Level& finest() const { return *levels_.front(); }
  /// z = M^-1 r, M symmetric positive definite.
  void precondition(const LevelVector& r, const LevelVector& z);

 private:
  void factorize_coarsest();
  void solve_coarsest();
  void cycle(size_t level);

  std::vector<int> order_;
  std::vector<std::unique_ptr<Level>> levels_;
  size_t used_ = 0;  ///< levels that are in use, the coarsest of them solved directly
  struct Vectors {
    LevelVector residual, x, step, other;
  };
  std::vector<Vectors> vectors_;
  std::unique_ptr<InertiaSolver> direct_;  ///< on the first rank alone
  GatherPlan coarsest_rows_;               ///< several ranks only
};

}  // namespace mixbeam
