/// The linear system of a tangent with its chains condensed to their ends: a matrix over the vertices where members
/// meet, or that carry supports, joints, moments or loads that follow.
#pragma once

#include "discretization/assembly/tangent.hpp"

#include <memory>

namespace mixbeam {

/// A right-hand side that a matrix is solved for first, and the vector for its solution: neither is written to before.
struct FirstSolve {
  const DofVector* b = nullptr;  ///< null: not known
  DofVector* x = nullptr;
};

class CondensedSystem {
 public:
  /// Collective. The model must outlive the system. `kept`: owned local vertices that are not to be eliminated, beside
  /// those where something acts.
  explicit CondensedSystem(const Model& model, const std::vector<int>& kept = {});
  ~CondensedSystem();

  const Model& model() const { return model_; }
  /// Vertices eliminated in chains, on this rank.
  int eliminated_vertices() const { return structure_.eliminated_vertices(); }
  const Teuchos::RCP<DofMatrix>& matrix() const { return remaining_->matrix(); }
  const VertexMatrix& remaining() const { return *remaining_; }
  /// Links of the matrix; their vertices are local ones.
  const std::vector<RemainingLink>& links() const { return structure_.remaining(); }
  /// Their matrices, before loads, supports and joints take part; of the tangent that was condensed last.
  LinkMatrices<kSpatialDofs> link_matrices() const;

  /// Whether some elements have line loads without potential: chains are then eliminated without symmetry.
  bool is_unsymmetric() const { return is_unsymmetric_; }
  /// Eliminates the chains of a tangent, to which all that follows refers: it must not be gone by then. False where a
  /// pivot is so small that nothing can be relied on. `symmetric_part`: of (K + K^T) / 2 in chains without symmetry;
  /// `add_more` as in Tangent::gather. `first`: condensed with the chains, so that condense_rows() need not read these
  /// again.
  bool condense(const Tangent& tangent, bool symmetric_part = false,
                const std::function<void(const MatrixRows&)>& add_more = {}, const FirstSolve& first = {});
  /// Frees the factors, until condense() makes others.
  void release();
  /// Takes full matrices (local element, kFullTangent) in place of those of the tangent, in space.
  bool condense(const Tangent& tangent, const KernelView<const double**>& elements,
                const std::function<void(const MatrixRows&)>& add_more);
  /// Gathers what is no element: springs, loads, constraints. `zeros`: a matrix for each local element; `add_more` as
  /// in Tangent::gather.
  void gather_outside(const Tangent& tangent, const KernelView<const double**>& zeros,
                      const std::function<void(const MatrixRows&)>& add_more = {}) const;
  /// Chain pivots below zero; without symmetry they tell the sign of the determinant alone.
  long negative_pivots() const { return negative_pivots_; }
  bool is_eliminated(int local_vertex) const { return eliminated_(local_vertex) != 0; }
  /// Projects as Tangent::project_on_free_motions does.
  void project_on_free_motions(const KernelView<double*>& rows) const { tangent_->project_on_free_motions(rows); }

  /// First half of a solve: the right-hand side of the remaining system; x is half done.
  void condense_rows(const DofVector& b, DofVector& remaining_b, DofVector& x);
  /// Second half.
  void expand(const DofVector& remaining_x, DofVector& x) const;

  /// The entries of x at the vertices that remain.
  void remaining_values(const DofVector& x, DofVector& remaining_x) const;

  /// max over the rows of chains of |b - K x|_i / (|K| X + |b|)_i as backward_error() measures it, and the same for
  /// what the condensed chains do to their end vertices. Collective.
  double chain_error(const DofVector& b, const DofVector& x) const { return measure(b, x, {}); }
  /// b - K x at eliminated vertices, zero at others. Collective.
  void chain_residual(const DofVector& b, const DofVector& x, DofVector& residual) const {
    measure(b, x, MixedVector::view_of(residual));
  }

 private:
  class PlanarChains;
  /// The error, and the residual unless that has no entries.
  double measure(const DofVector& b, const DofVector& x, const KernelView<double*>& residual) const;
  /// Rows that the remaining runs add to those of their end vertices.
  const KernelView<double* [12]>& arrived() const;

  const Model& model_;
  const Tangent* tangent_ = nullptr;       ///< whose chains are eliminated
  FirstSolve first_;                       ///< its rows are condensed in the chains, and no others since
  KernelView<const double**> elements_{};  ///< matrices in place of its own; empty: none
  bool is_unsymmetric_;
  ChainStructure structure_;
  ChainCondensation<kSpatialDofs> chains_;
  std::unique_ptr<PlanarChains> planar_chains_;  ///< where the scene has a plane
  PlanarChains* planar_ = nullptr;               ///< the same while the tangent is in the plane
  long negative_pivots_ = 0;
  std::unique_ptr<VertexMatrix> remaining_;
  KernelView<double*> run_forces_;         ///< (6 * owned vertex + component), at vertices that remain
  KernelView<int* [2]> ends_;              ///< (local element, end): local vertex
  KernelView<unsigned char*> eliminated_;  ///< (local vertex)
  KernelView<unsigned char*> condensed_;   ///< (local element): 1 where it is part of a condensed chain
};

}  // namespace mixbeam
