/// The equations linearised at a state: every element condensed to its two vertices.
#pragma once

#include "discretization/assembly/cap.hpp"

#include <functional>
#include <optional>

namespace mixbeam {

struct TangentArrays;

/// Properties of a tangent that the caller chooses.
struct TangentKind {
  bool in_space = false;         ///< also for a state in the plane of the scene: to see motions that leave it
  bool counts_interior = false;  ///< for interior_count()
  /// (6 * owned vertex + component): stiffness of springs from the present place of each vertex to the ground, in the
  /// matrix over all vertices alone; empty: none.
  KernelView<const double*> springs{};
  /// Scaled right-hand side that condense() will be asked for next, condensed with the tangent; null: the residual.
  const MixedVector* right_hand_side = nullptr;
};

/// Knows the state, the scales and the cap that it was taken with. Its arrays are used again when it is gone. The model
/// must outlive it.
class Tangent {
 public:
  Tangent(const Model& model, const EvaluationPoint& point, const Cap& cap, const TangentKind& kind = {});
  Tangent(Tangent&&) = default;
  Tangent& operator=(Tangent&&) = default;

  const Model& model() const { return *model_; }
  const EvaluationPoint& point() const { return point_; }
  const Cap& cap() const { return cap_; }
  /// With three unknowns per vertex, in the plane of the scene: right-hand sides must lie in it.
  bool is_planar() const { return planar_; }
  const ElementEquations& elements() const;
  const PlanarTangents& planar_elements() const;

  /// Residual, condensed to the vertices, unscaled; or the right-hand side that was condensed last.
  DofVector& condensed_rows() const;
  /// Condenses a scaled right-hand side (rows as mixed_residual() gives them); recover() then refers to it. False:
  /// condensed_rows() are those of construction.
  bool condense(const MixedVector& scaled_rhs);
  /// Condenses rows without scales; those of vertices are spatial and are projected here.
  void condense_spatial(const MixedVector& rows);
  /// Condenses the residual again, if a right-hand side came in between. False: it did not.
  bool condense_residual();
  /// Increment of the interior that belongs to a vertex increment; both parts of `increment` are complete afterwards.
  void recover(MixedVector& increment) const;
  /// Recovers in the memory of the condensed right-hand side, which a later recover() takes to be zero.
  void recover_last(MixedVector& increment);

  /// Adds up the elements, loads, supports and joints in a matrix over all vertices (whole_matrix). Collective.
  void gather(const VertexMatrix& matrix) const;
  /// Gathers some of the vertices, from the links between them; `add_more` adds to them before motions are projected.
  void gather(const VertexMatrix& matrix, const LinkMatrices<kSpatialDofs>& links,
              const std::function<void(const MatrixRows&)>& add_more = {}) const;
  /// Model::project_on_free_motions at the state of the tangent.
  void project_on_free_motions(const KernelView<double*>& rows) const {
    model_->project_on_free_motions(point_.state, rows);
  }

  /// Eigenvalues below zero of the interiors of all elements while their vertices stand still: the J0 of Wittrick and
  /// Williams, which the count of the condensed matrix lacks. Collective; TangentKind::counts_interior.
  struct InteriorCount {
    long negative = 0;       ///< of elements without a potential their parity
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
  /// Sections with the cap, line fields of the point.
  StructureViews structure_views() const;
  void gather_condensed_rows(const KernelView<double* [2]>& loads, const KernelView<double*>& rows) const;
  void add_springs(const MatrixRows& rows) const;

  const Model* model_;
  EvaluationPoint point_;
  Cap cap_;
  bool planar_;
  KernelView<const double*> springs_;
  bool holds_residual_ = false;
  std::optional<MixedVector> held_;  ///< the right-hand side of construction, until it is asked for
  std::shared_ptr<TangentArrays> arrays_;
  MixedVector constants_;  ///< of the interior, ElementEquations::constants; in a plane not used
};

}  // namespace mixbeam
