/// The tangent in the motions admitted by supports and joints: theory (46).
///
/// With the independent unknowns y and the motions dx = Z y of all vertices, the free rows of the equations are Z^T
/// times forces and moments; their derivative A therefore gives A_free Z, which is the second derivative of the energy
/// along the constraints: symmetric in equilibrium if the loads are conservative, and with its true inertia. Z has no
/// code of its own: its transpose is the projection of forces on free motions, Model::project_on_free_motions, applied
/// to unit forces.
#pragma once

#include "discretization/assembly/tangent.hpp"
#include "discretization/linear_system/vertex_matrix.hpp"
#include "nonlinear/linear/inertia_solver.hpp"

#include <functional>
#include <memory>
#include <vector>

namespace mixbeam {

/// Tributary length of each owned vertex: half of the elements that meet there.
std::vector<double> vertex_lengths(const Structure& structure);

/// Unknowns, matrix and exchange of vectors of one structure; made once. The reduced matrix is stored on rank 0.
///
/// Unknowns are dimensionless: a displacement of vertex v is measured in L / sqrt(EI/L l_v/L), a rotation in
/// 1 / sqrt(EI/L l_v/L), with the length L and the bending stiffness EI of the structure and the tributary length l_v
/// of the vertex. Eigenvalues are then in units of EI/L and do not depend on units or, once modes are resolved, on the
/// number of elements.
class IndependentUnknowns {
 public:
  explicit IndependentUnknowns(const Model& model);
  /// Unknowns of the vertices that remain when chains are condensed to their ends: by Sylvester's law of inertia the
  /// reduced matrix has fewer negative eigenvalues, by the number of negative pivots of the chains. `remaining` must
  /// hold the tangent that is to be reduced.
  IndependentUnknowns(const Model& model, const VertexMatrix& remaining);

  const RootCopy& root() const { return root_; }
  bool is_root() const { return root_.is_root(); }
  int count() const { return count_; }  ///< on every rank
  /// Adopts the units of others of the same mesh, whose lengths or stiffnesses may differ. Call before reduce().
  void measure_as(const IndependentUnknowns& other) { measure_ = other.measure_; }

  /// Evaluates Z at the state of a tangent and reduces the tangent. Collective; rank 0 has the result, other ranks an
  /// empty matrix.
  const SparseMatrix& reduce(const Tangent& tangent);
  /// Reduces the matrix that `gather` fills in place of the tangent.
  const SparseMatrix& reduce(const Tangent& tangent, const std::function<void(const VertexMatrix&)>& gather);
  const SparseMatrix& matrix() const { return reduced_; }
  /// Computes the motion Z y of the vertices that are numbered here (y: rank 0, `count()` numbers; ignored elsewhere)
  /// at the state of reduce().
  void expand(const double* y, DofVector& motion) const;
  /// Computes Z^T times forces and moments on all vertices, already projected on free motions, at the state of
  /// reduce(); rank 0 has the result. Collective.
  std::vector<double> reduced_rows(const DofVector& projected) const;
  /// Does so for rows of the remaining matrix.
  std::vector<double> reduced_remaining_rows(const DofVector& rows) const;

 private:
  void set_up(const Model& model);
  std::vector<double> gather_rows(const DofVector& all) const;
  std::vector<double> measured(const std::vector<double>& rows) const;
  void number(const Model& model);
  void measure(const Model& model);
  void build_structure();
  void probe(const Tangent& tangent);
  void list_shares();
  void reduce_row(const DofMatrix::local_matrix_host_type& full, size_t row, const std::vector<int>& slot,
                  double* out) const;
  int unknown(int vertex, int component) const {
    return unknown_[static_cast<size_t>(kVertexDofs) * vertex + component];
  }
  double motion_of(int vertex, int component, int by_vertex, int by_component) const;

  std::unique_ptr<VertexMatrix> whole_;  ///< null: only remaining vertices are numbered
  RootCopy root_;
  Teuchos::RCP<const DofMap> map_, rows_;  ///< of all vertices, and of those that are numbered here
  std::vector<int> own_;                   ///< local vertices of this rank among those, in the order of the rows
  int vertices_ = 0, count_ = 0;           ///< `vertex` below: place among those that are numbered here
  std::vector<int> vertex_of_mesh_;        ///< (vertex); rank 0
  std::vector<int> master_;                ///< (vertex): -1 if it is no slave; rank 0
  std::vector<int> colour_;  ///< (vertex of the mesh): differs among slaves of one master; 0 if it is no slave
  int colours_ = 1;
  std::vector<int> unknown_;                     ///< (6 * vertex + component): -1 if fixed; rank 0
  std::vector<double> measure_;                  ///< (6 * vertex + component): size of one unit of y; rank 0
  std::vector<std::vector<double>> unit_force_;  ///< (6 * colour + component): free rows of unit forces; rank 0
  struct Share {
    int unknown = 0;
    double motion = 0.0;  ///< per unit of y
  };
  std::vector<Share> share_;                  ///< entries of Z at the state of reduce(); rank 0
  std::vector<size_t> share_start_;           ///< (6 * vertex + component): its first share; rank 0
  std::vector<std::vector<int>> neighbours_;  ///< (vertex): vertices in its reduced rows; rank 0
  SparseMatrix reduced_;
};

// Modes in these unknowns.

struct EigenMode {
  double eigenvalue = 0.0;
  /// Motion of all vertices, slaves of joints included, and of the interior that follows it, as an increment
  /// (Model::apply). Scaled so that the largest of |du_i|/L, |dtheta_i| is one, and positive where it occurs first.
  MixedVector mode;
  /// Estimated error of the eigenvalue: residual of its equation, and rounding of the tangent.
  double error = 0.0;
  bool converged = true;  ///< false: found within the bounded work, but not to rounding
};

/// Completes independent unknowns (rank 0), at the state of the tangent last passed to unknowns.reduce(), to the motion
/// of all vertices and of the interior in equilibrium without loads. Collective.
MixedVector complete_motion(const Tangent& tangent, const IndependentUnknowns& unknowns, const std::vector<double>& y);

/// Sums weights[i] times vectors[i]; needs at least one vector.
MixedVector combination(const std::vector<MixedVector>& vectors, const double* weights);

/// Scales a mode as described at EigenMode; returns the factor. Collective.
double normalize_mode(const Model& model, MixedVector& mode);

/// Runs an action on rank 0; an exception there becomes a LinearSolverError on every rank.
void on_root(const RootCopy& root, const std::function<void()>& action);
/// Computes a number on rank 0 and broadcasts it.
double number_of_root(const RootCopy& root, const std::function<double()>& number);

}  // namespace mixbeam
