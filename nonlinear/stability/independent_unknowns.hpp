/// The tangent in the motions that supports and joints permit: theory (46).
///
/// With Z the motions of all vertices that belong to the independent unknowns y, dx = Z y, the free rows of the
/// equations are Z^T times forces and moments; their derivative A therefore gives A_free Z, which is the second
/// derivative of the energy along the constraints: symmetric in equilibrium when the loads are conservative, and with
/// its true inertia. Z is not derived once more: its transpose is how the equations project forces on free motions,
/// Model::project_on_free_motions, applied to unit forces.
#pragma once

#include "discretization/assembly/tangent.hpp"
#include "discretization/linear_system/vertex_matrix.hpp"
#include "nonlinear/linear/inertia_solver.hpp"

#include <functional>
#include <memory>
#include <vector>

namespace mixbeam {

/// Length of member that belongs to each owned vertex: half of the elements that meet there.
std::vector<double> vertex_lengths(const Structure& structure);

/// Unknowns, matrix and exchange of vectors of one structure; made once. The reduced matrix lives on rank 0.
///
/// Unknowns are measured so that numbers have no unit: a displacement of vertex v in L / sqrt(EI/L l_v/L), a rotation
/// in 1 / sqrt(EI/L l_v/L), with the length L and the bending stiffness EI of the structure and l_v the length of
/// member that belongs to the vertex. Eigenvalues are then in units of EI/L and do not depend on units or, once modes
/// are resolved, on the number of elements.
class IndependentUnknowns {
 public:
  explicit IndependentUnknowns(const Model& model);
  /// Those of the vertices that are left when chains are condensed to their ends: by Sylvester's law of inertia the
  /// reduced matrix has as many negative eigenvalues less as pivots of the chains are negative. `remaining` must
  /// hold the tangent that is to be reduced.
  IndependentUnknowns(const Model& model, const VertexMatrix& remaining);

  const RootCopy& root() const { return root_; }
  bool is_root() const { return root_.is_root(); }
  int count() const { return count_; }  ///< on every rank
  /// Measures as others of the same mesh do, of which lengths or stiffnesses may differ: before reduce().
  void measure_as(const IndependentUnknowns& other) { measure_ = other.measure_; }

  /// Takes Z of the state of a tangent and reduces the tangent. Collective; rank 0 has the result, other ranks an empty
  /// matrix.
  const SparseMatrix& reduce(const Tangent& tangent);
  /// The same of what `gather` puts in place of the tangent.
  const SparseMatrix& reduce(const Tangent& tangent, const std::function<void(const VertexMatrix&)>& gather);
  const SparseMatrix& matrix() const { return reduced_; }
  /// Motion of all vertices that belongs to y (rank 0, `count()` numbers; ignored elsewhere) at the state of reduce();
  /// not for the vertices that chains leave.
  void expand(const double* y, DofVector& motion) const;
  /// Z^T times forces and moments on all vertices that are projected on free motions, at the state of reduce();
  /// rank 0 has the result. Collective.
  std::vector<double> reduced_rows(const DofVector& projected) const;
  /// The same for rows of the remaining matrix.
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

  std::unique_ptr<VertexMatrix> whole_;  ///< null: of the vertices that chains leave
  RootCopy root_;
  Teuchos::RCP<const DofMap> map_, rows_;  ///< of all vertices, and of those that are numbered here
  std::vector<int> own_;                   ///< local vertices of this rank among those, in the order of the rows
  int vertices_ = 0, count_ = 0;           ///< vertices below are places among those that are numbered here
  std::vector<int> vertex_of_mesh_;        ///< (vertex); rank 0
  std::vector<int> master_;                ///< (vertex): -1 where it is no slave; rank 0
  std::vector<int> colour_;  ///< (vertex of the mesh): slaves of one master differ; 0 where it is no slave
  int colours_ = 1;
  std::vector<int> unknown_;                     ///< (6 * vertex + component): -1 where fixed; rank 0
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
  /// Motion of all vertices, those at the far sides of joints included, and the interior that follows it, as an
  /// increment (Model::apply). Largest of |du_i|/L, |dtheta_i| is one, and positive where it occurs first.
  MixedVector mode;
  /// Estimated error of the eigenvalue: what is left of its equation, and the rounding of the tangent.
  double error = 0.0;
  bool converged = true;  ///< false: found within the bounded work, but not to rounding
};

/// Motion that belongs to independent unknowns (rank 0) at the state of a tangent, which unknowns.reduce() got: of the
/// vertices, and of the interior that follows without forces of its own. Collective.
MixedVector complete_motion(const Tangent& tangent, const IndependentUnknowns& unknowns, const std::vector<double>& y);

/// Sum of weights[i] times vectors[i]; at least one vector.
MixedVector combination(const std::vector<MixedVector>& vectors, const double* weights);

/// Scales a mode as EigenMode promises, by the factor returned. Collective.
double normalize_mode(const Model& model, MixedVector& mode);

/// Work of rank 0 alone; what goes wrong there is a LinearSolverError on every rank.
void on_root(const RootCopy& root, const std::function<void()>& action);
/// A number that rank 0 finds, on every rank.
double number_of_root(const RootCopy& root, const std::function<double()>& number);

}  // namespace mixbeam
