/// Inertia of a structure about a state: elements with mass, and bodies at vertices.
#pragma once

#include "discretization/assembly/tangent.hpp"
#include "kernels/vibration/vibration.hpp"

#include <array>

namespace mixbeam {

/// Throws InputError if modes are restricted to the plane of a scene that has none.
void require_plane(const Model& model);

/// Momenta of all ranks in one vector: those of each mesh element in turn, then those of the bodies. Functions that
/// return momenta, strains, sums or norms are collective.
class Masses {
 public:
  /// Sets up the inertia; condense() does the rest. `in_plane` (models with a plane): out-of-plane motion has no mass,
  /// and vertices are held in the plane.
  Masses(const Model& model, bool in_plane);

  const std::vector<VibratingBlock>& blocks() const { return blocks_; }
  int momenta() const { return count_; }

  /// Condenses K + shift M of the elements, with the sections of a cap.
  void condense(const Tangent& at, double shift, VibrationUse use);
  /// Matrices of the condensed elements: (local element, kFullTangent).
  const KernelView<double**>& condensed() const { return condensed_; }
  /// Adds shift times the inertia of the bodies.
  void add_bodies(const Tangent& at, double shift, const MatrixRows& rows) const;
  /// Owned local vertices with a body.
  std::vector<int> body_vertices() const;
  /// Sums over all ranks, see Tangent::interior_count().
  Tangent::InteriorCount interior_count() const;

  /// G dx.
  std::vector<double> momenta_of(const State& state, const MixedVector& motion) const;
  /// Computes rows G^T of momenta: of interiors in `rows`, and those of vertices gathered after the elimination of
  /// interiors. `strains`: rows of stresses (damped_strains() numbers); null: zero.
  void condense_momenta(const State& state, const double* momenta, MixedVector& rows,
                        const double* strains = nullptr) const;

  /// Damping C = G^T alpha G + beta D^T S^-1 D, beta times the stiffness of the material.
  bool is_damped() const { return damped_; }
  /// Number of strains of all ranks; zero if no section has a beta.
  int damped_strains() const { return strain_count_; }
  /// beta D dx.
  std::vector<double> damped_strains_of(const MixedVector& motion) const;
  /// alpha times momenta plus Coriolis forces on them, theory (76): C = G^T W G at the state condensed last.
  std::vector<double> damped_momenta(const double* momenta) const;
  /// Columns of momenta that act as forces and are overwritten by those of the motions. `excess`: with rows of the
  /// excess of the cap.
  MomentumColumns columns_of(double* momenta, int columns, bool excess);
  /// Computes the vertex rows of each column.
  void condense_columns(const State& state, const MomentumColumns& of, std::vector<MixedVector>& rows) const;
  /// Computes momenta and excess rows from the motions of the vertices.
  void recover_columns(const State& state, const MomentumColumns& of, const std::vector<MixedVector>& motions) const;
  /// Norm of the excess rows of each column.
  std::vector<double> excess_norms(const MomentumColumns& of) const;
  /// Computes vertex rows from interior rows only.
  void condense_interior(MixedVector& rows) const;
  /// Recovers the interior of `motion` from its vertices and the interior rows.
  void recover(const MixedVector& rows, MixedVector& motion) const;
  /// Computes the interior rows due to the cap from the stresses of a motion.
  void excess_rows(const MixedVector& motion, MixedVector& rows) const;
  /// phi . K phi of the elements, with the stresses of phi and the true compliance. Collective.
  double stiffness_form(const MixedVector& motion) const;
  /// Momenta of a unit translation along a spatial axis.
  std::vector<double> translation(const State& state, int axis) const;

 private:
  void take_damping();
  void keep_in_plane(const ElementBlock& block, const KernelView<double**>& mass) const;
  void keep_in_plane(VertexBody& body) const;
  void hold_vertices() const;
  void gather_vertices(const std::vector<double*>& rows, const KernelView<const double**>& of) const;
  void add_rows_of_bodies(const State& state, const double* momenta, const KernelView<double*>& vertex) const;
  std::vector<double> rows_of_elements(MotionRow row, const KernelView<const double* [6]>& vertex,
                                       const MixedVector& motion) const;
  void take_momenta_of_bodies(const State& state, const KernelView<const double* [6]>& vertex, double* momenta) const;
  void take_coriolis(const EvaluationPoint& at);
  void add_coriolis(const double* momenta, std::vector<double>& forces) const;
  size_t place_of(const VertexBody& body) const;

  const Model* model_;
  bool in_plane_;
  std::vector<VibratingBlock> blocks_;
  std::vector<VertexBody> bodies_;
  int stride_ = 0, count_ = 0;            ///< most momenta of an element; of all
  KernelView<double**> condensed_;        ///< (local element, kFullTangent)
  KernelView<double**> of_elements_;      ///< (local element, stride): momenta
  KernelView<double* [12]> vertex_rows_;  ///< (local element)
  KernelView<int*> place_;                ///< (local element): offset of its first momentum
  KernelView<double**> ends_, excess_;    ///< of the columns used last
  bool damped_ = false;
  std::vector<std::array<double, 2>> damping_;  ///< (mesh element): alpha, beta
  int strain_stride_ = 0, strain_count_ = 0;    ///< same for strains
  KernelView<double**> strains_;                ///< (local element, stride)
  std::vector<KernelView<double**>> coriolis_;  ///< of each block: (element, 36 * point): W; empty: no rotation
  std::vector<std::array<Mat, 2>> of_bodies_;   ///< (body of this rank): W of its velocity and of its spin; likewise
};

}  // namespace mixbeam
