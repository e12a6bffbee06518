/// Linear system of a tangent with its chains condensed to their ends: a matrix over the vertices where members meet,
/// or that carry supports, joints, moments or follower loads.
#pragma once

#include "discretization/assembly/tangent.hpp"

#include <memory>

namespace mixbeam {

/// First right-hand side to be solved for, and the vector for its solution; neither is written to before that solve.
struct FirstSolve {
  const DofVector* b = nullptr;  ///< null: unknown
  DofVector* x = nullptr;
};

class CondensedSystem {
 public:
  /// Collective. The model must outlive the system. `kept`: owned local vertices not to be eliminated, in addition to
  /// those of external energies, supports and joints.
  explicit CondensedSystem(const Model& model, const std::vector<int>& kept = {});
  ~CondensedSystem();

  const Model& model() const { return model_; }
  /// Vertices eliminated in chains, on this rank.
  int eliminated_vertices() const { return structure_.eliminated_vertices(); }
  const Teuchos::RCP<DofMatrix>& matrix() const { return remaining_->matrix(); }
  const VertexMatrix& remaining() const { return *remaining_; }
  /// Links of the matrix, with local vertices.
  const std::vector<RemainingLink>& links() const { return structure_.remaining(); }
  /// Their matrices without loads, supports and joints, for the tangent condensed last.
  LinkMatrices<kSpatialDofs> link_matrices() const;

  /// True if elements have line loads without potential: chains are then eliminated without symmetry.
  bool is_unsymmetric() const { return is_unsymmetric_; }
  /// Eliminates the chains of a tangent, which must outlive the calls below. False if a pivot is too small to rely on.
  /// `symmetric_part`: uses (K + K^T) / 2 in unsymmetric chains. `add_more` as in Tangent::gather. `first`: condensed
  /// in the same pass, so that condense_rows() need not read the chains again.
  bool condense(const Tangent& tangent, bool symmetric_part = false,
                const std::function<void(const MatrixRows&)>& add_more = {}, const FirstSolve& first = {});
  /// Frees the factors until the next condense().
  void release();
  /// Condenses full spatial matrices (local element, kFullTangent) instead of those of the tangent.
  bool condense(const Tangent& tangent, const KernelView<const double**>& elements,
                const std::function<void(const MatrixRows&)>& add_more);
  /// Gathers everything except the elements: springs, loads, constraints. `zeros`: a matrix per local element;
  /// `add_more` as in Tangent::gather.
  void gather_outside(const Tangent& tangent, const KernelView<const double**>& zeros,
                      const std::function<void(const MatrixRows&)>& add_more = {}) const;
  /// Number of negative chain pivots; without symmetry, only the sign of the determinant.
  long negative_pivots() const { return negative_pivots_; }
  bool is_eliminated(int local_vertex) const { return eliminated_(local_vertex) != 0; }
  /// Same as Tangent::project_on_free_motions.
  void project_on_free_motions(const KernelView<double*>& rows) const { tangent_->project_on_free_motions(rows); }

  /// First half of a solve: right-hand side of the remaining system; x is partly computed.
  void condense_rows(const DofVector& b, DofVector& remaining_b, DofVector& x);
  /// Second half of a solve.
  void expand(const DofVector& remaining_x, DofVector& x) const;

  /// Copies the entries of x at the remaining vertices.
  void remaining_values(const DofVector& x, DofVector& remaining_x) const;

  /// Maximum over the rows of chains of |b - K x|_i / (|K| X + |b|)_i as in backward_error(), and the same for the
  /// forces of condensed chains on their end vertices. Collective.
  double chain_error(const DofVector& b, const DofVector& x) const { return measure(b, x, {}); }
  /// b - K x at eliminated vertices, zero at others. Collective.
  void chain_residual(const DofVector& b, const DofVector& x, DofVector& residual) const {
    measure(b, x, MixedVector::view_of(residual));
  }

 private:
  class PlanarChains;
  /// Returns the error; computes the residual unless it has no entries.
  double measure(const DofVector& b, const DofVector& x, const KernelView<double*>& residual) const;
  /// Rows that the remaining runs add to those of their end vertices.
  const KernelView<double* [12]>& arrived() const;

  const Model& model_;
  const Tangent* tangent_ = nullptr;       ///< the tangent condensed last
  FirstSolve first_;                       ///< its rows are condensed in the chains, and none since
  KernelView<const double**> elements_{};  ///< matrices used instead of those of the tangent; empty: none
  bool is_unsymmetric_;
  ChainStructure structure_;
  ChainCondensation<kSpatialDofs> chains_;
  std::unique_ptr<PlanarChains> planar_chains_;  ///< if the scene has a plane
  PlanarChains* planar_ = nullptr;               ///< planar_chains_ if the tangent is planar, else null
  long negative_pivots_ = 0;
  std::unique_ptr<VertexMatrix> remaining_;
  KernelView<double*> run_forces_;         ///< (6 * owned vertex + component), at vertices that remain
  KernelView<int* [2]> ends_;              ///< (local element, end): local vertex
  KernelView<unsigned char*> eliminated_;  ///< (local vertex)
  KernelView<unsigned char*> condensed_;   ///< (local element): 1 if part of a condensed chain
};

}  // namespace mixbeam
