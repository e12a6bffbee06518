/// Equations linearised at a state: every element condensed to its two vertices.
#pragma once

#include "discretization/assembly/cap.hpp"

#include <functional>
#include <optional>

namespace mixbeam {

struct TangentArrays;

/// Options of a tangent.
struct TangentKind {
  bool in_space = false;         ///< even for a state in the plane of the scene: to include out-of-plane motion
  bool counts_interior = false;  ///< for interior_count()
  /// (6 * owned vertex + component): stiffness of springs that tie each vertex to its current position, only in the
  /// matrix over all vertices; empty: none.
  KernelView<const double*> springs{};
  /// Scaled right-hand side that condense() will be called with next, condensed with the tangent; null: the residual.
  const MixedVector* right_hand_side = nullptr;
};

/// Holds the state, the scales and the cap that it was taken with. Its arrays are reused after its destruction. The
/// model must outlive it.
class Tangent {
 public:
  Tangent(const Model& model, const EvaluationPoint& point, const Cap& cap, const TangentKind& kind = {});
  Tangent(Tangent&&) = default;
  Tangent& operator=(Tangent&&) = default;

  const Model& model() const { return *model_; }
  const EvaluationPoint& point() const { return point_; }
  const Cap& cap() const { return cap_; }
  /// True with three unknowns per vertex, in the plane of the scene: right-hand sides must lie in it.
  bool is_planar() const { return planar_; }
  const ElementEquations& elements() const;
  const PlanarTangents& planar_elements() const;

  /// Condensed residual at the vertices, unscaled; or the right-hand side condensed last.
  DofVector& condensed_rows() const;
  /// Condenses a scaled right-hand side (rows like those of mixed_residual()), to which recover() then refers. Returns
  /// false if condensed_rows() are still those of construction.
  bool condense(const MixedVector& scaled_rhs);
  /// Condenses unscaled rows; those of vertices are spatial and projected here.
  void condense_spatial(const MixedVector& rows);
  /// Condenses the residual again if another right-hand side was condensed since; returns false if not.
  bool condense_residual();
  /// Recovers the interior for a vertex increment; both parts of `increment` are complete afterwards.
  void recover(MixedVector& increment) const;
  /// Recovers in the memory of the condensed right-hand side, which later calls of recover() take to be zero.
  void recover_last(MixedVector& increment);

  /// Assembles elements, loads, supports and joints in a matrix over all vertices (whole_matrix). Collective.
  void gather(const VertexMatrix& matrix) const;
  /// Assembles some of the vertices, from the links between them; `add_more` adds entries before motions are projected.
  void gather(const VertexMatrix& matrix, const LinkMatrices<kSpatialDofs>& links,
              const std::function<void(const MatrixRows&)>& add_more = {}) const;
  /// Model::project_on_free_motions at the state of the tangent.
  void project_on_free_motions(const KernelView<double*>& rows) const {
    model_->project_on_free_motions(point_.state, rows);
  }

  /// Number of negative eigenvalues of all element interiors with fixed vertices: the J0 of Wittrick and Williams,
  /// which the count of the condensed matrix lacks. Needs TangentKind::counts_interior. Collective.
  struct InteriorCount {
    long negative = 0;       ///< only the parity of elements without a potential
    bool uncertain = false;  ///< one is zero within rounding
  };
  InteriorCount interior_count() const;

 private:
  void evaluate();
  void evaluate_in_space(MixedVector& constants) const;
  void evaluate_rotating() const;
  void condense_rotating(const KernelView<const double*>& interior) const;
  KernelView<double*> condense_interior(MixedVector& rhs);
  void recover_in_place(MixedVector& increment) const;
  /// Sections with the cap, and line fields of the point.
  StructureViews structure_views() const;
  void gather_condensed_rows(const KernelView<double* [2]>& loads, const KernelView<double*>& rows) const;
  void add_springs(const MatrixRows& rows) const;

  const Model* model_;
  EvaluationPoint point_;
  Cap cap_;
  bool planar_;
  KernelView<const double*> springs_;
  bool holds_residual_ = false;
  std::optional<MixedVector> held_;  ///< right-hand side of construction, until condense() gets it
  std::shared_ptr<TangentArrays> arrays_;
  MixedVector constants_;  ///< interior part, ElementEquations::constants; unused in a plane
};

}  // namespace mixbeam
