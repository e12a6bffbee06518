/// The rows of vertices, in vectors and in the matrix: what supports and joints put in their place. Loops over supports
/// and joints only; without any of them there is nothing to do.
#pragma once

#include "discretization/constraints/conditions.hpp"
#include "discretization/mesh/mixed_vector.hpp"

#include <vector>

namespace mixbeam {

/// First component of a vertex: of displacement or force, of rotation or moment.
enum VertexPart { kForcePart = 0, kMomentPart = 3 };

inline size_t vertex_row(int vertex, int component) { return static_cast<size_t>(kVertexDofs) * vertex + component; }

inline Vec rows_of(const KernelView<double*>& rows, int vertex, VertexPart part) {
  return load_vector(&rows(vertex_row(vertex, part)));
}
inline void set_rows_of(const KernelView<double*>& rows, int vertex, VertexPart part, const Vec& value) {
  store_vector(value, &rows(vertex_row(vertex, part)));
}

/// Rows of owned vertices in the matrix of one rank. Every row of a vertex has the same columns: six for each of some
/// local vertices, ascending.
class MatrixRows {
 public:
  /// `place`: (local vertex) where it stands among rows and columns, -1 where it has none.
  MatrixRows(const DofMatrix::local_matrix_host_type& matrix, const KernelView<const int*>& place)
      : matrix_(matrix), place_(place) {}

  void clear(int vertex, int component) const;
  /// Adds value . (displacement or rotation of `column_vertex`) to a row.
  void add(int vertex, int component, int column_vertex, VertexPart column_part, const Vec& value) const;
  /// Adds a 3 x 3 block.
  void add(int vertex, VertexPart part, int column_vertex, VertexPart column_part, const Mat& block) const;
  /// Adds `factor` times the rows of `part` of another vertex, whose columns must be among those of this one.
  void add_rows(int vertex, VertexPart part, const Mat& factor, int other, VertexPart other_part) const;
  /// Row i of the part becomes the sum of factor(i, j) times row j.
  void combine(int vertex, VertexPart part, const Mat& factor) const;

 private:
  size_t row(int vertex, int component) const { return vertex_row(place_(vertex), component); }
  /// The six entries of a row at a place among the columns.
  double* entries(size_t row, int column_place) const;

  DofMatrix::local_matrix_host_type matrix_;
  KernelView<const int*> place_;
};

/// Force and moment on a vertex.
struct SpatialLoad {
  Vec3<double> force, moment;
};

// Supports as equations of a vertex: theory (41).
//
// The force rows are turned into the axes e_i of the support; a fixed one becomes e_i . (u - prescribed), a free one
// keeps e_i . f, to which external_energy.hpp has added the spring k_i e_i . u. Rotations come in four ways:
//   - free: the moment rows stay as they are;
//   - all fixed: the rotation vector from the prescribed to the present triad;
//   - two fixed (a hinge about the third axis, any number of turns): the swings of Lambda_V (swing.hpp), and the moment
//     about the third axis, with a spring there + k angle (State::turns);
//   - one fixed, or springs and less than two: with theta the rotation vector of Lambda_V in the axes, a fixed one
//   becomes theta_i, a
//     free one (T(theta) e_i) . m + k_i theta_i, the derivative of the energy with respect to theta_i; |theta| < 2 pi.

/// Marks the rows that hold a constraint in place of an equilibrium.
void mark_fixed_rows(const VertexSupport& support, const KernelView<unsigned char*>& fixed);

/// Rows of the vertex, spatial forces and moments, in the form described above; those of fixed components become zero.
void project_rows(const VertexSupport& support, const State& state, const KernelView<double*>& rows);

/// Adds springs against rotation and writes the fixed rows, after project_rows.
void set_support_rows(const VertexSupport& support, const State& state, double load_factor,
                      const KernelView<double*>& rows);

/// Derivative of the fixed rows with respect to the load factor.
void set_support_slopes(const VertexSupport& support, double load_factor, const KernelView<double*>& rows);

/// Whether the matrix rows need the moment on the vertex, because it is not balanced by loads alone.
inline bool turns_moment_rows(const VertexSupport& support) {
  return support.rotation_kind == SupportRotation::hinge || support.rotation_kind == SupportRotation::vector;
}

/// Derivative of the rows above; the matrix holds the derivative of the spatial rows, `moment` is the spatial moment
/// row itself.
void project_matrix_rows(const VertexSupport& support, const State& state, const Vec& moment, const MatrixRows& matrix);

/// Force and moment of a support and its springs on the vertex, from its spatial rows without it.
SpatialLoad support_reaction(const VertexSupport& support, const State& state, const Vec& force, const Vec& moment);

/// In the springs of a support against rotation.
double stored_energy(const VertexSupport& support, const State& state);

// Joints as equations of two vertices, theory (43): the master, which the rest of the point shares, and the slave, the
// end of one member with displacement and triad of its own.
//
// The frame (b1, b2, a) of a joint turns with the master, a = Lambda_m a_0; p = x_s - x_m. In virtual motions that the
// joint permits, du_s = du_m + dtheta_m x p (+ dq a for a slider) and dtheta_s = dtheta_m (+ dq a for a hinge), so
//   master:  f_m + f_s,   m_m + m_s + p x f_s;
//   hinge:   u_s - u_m;   swings of Lambda_m^T Lambda_s against a_0 (swing.hpp),  a . m_s + k angle;
//   ball:    u_s - u_m;   m_s (which the master then does without);
//   slider:  b1 . p, b2 . p, a . f_s + k a . p;   rotation vector of Lambda_s Lambda_m^T.

void mark_fixed_rows(const VertexJoint& joint, const KernelView<unsigned char*>& fixed);

/// Gives the slave's forces and moments to the master and leaves the free component to the slave; its constraint rows
/// become zero.
void join_rows(const VertexJoint& joint, const State& state, const KernelView<double*>& rows);

/// Moment of the slave's spatial rows in the master's moment row.
Vec moment_on_master(const VertexJoint& joint, const State& state, const Vec& force, const Vec& moment);

/// Adds the spring and writes the constraint rows, after join_rows.
void set_joint_rows(const VertexJoint& joint, const State& state, const KernelView<double*>& rows);

/// Derivative of the rows above; the matrix holds the derivative of the spatial rows, and `force`, `moment` are the
/// spatial rows of the slave themselves.
void join_matrix_rows(const VertexJoint& joint, const State& state, const Vec& force, const Vec& moment,
                      const MatrixRows& matrix);

/// In the spring of a joint.
double stored_energy(const VertexJoint& joint, const State& state);

/// See ConstraintRows::follow.
void follow_turns(const VertexSupport& support, const State& from, State& to);
void follow_turns(const VertexJoint& joint, const State& from, State& to);

/// A vertex whose forces and moments are balanced by more than loads, by supports or joints.
struct CarriedForce {
  int vertex = 0;
  Vec force{}, moment{};
  Vec joined_moment{};  ///< with the slaves at the vertex
};
using CarriedForces = std::vector<CarriedForce>;  ///< ascending vertices

class ConstraintRows {
 public:
  ConstraintRows() = default;
  explicit ConstraintRows(const Conditions& conditions);

  void mark_fixed(const KernelView<unsigned char*>& fixed) const;

  /// Spatial forces and moments of all vertices, those of external energies added, as the equations take them; zero in
  /// the rows of constraints. Linear in `rows`.
  void project(const State& state, const KernelView<double*>& rows) const;
  /// Springs and constraints of a state, after project().
  void set(const State& state, double load_factor, const KernelView<double*>& rows) const;
  /// Derivatives of the constraints with respect to the load factor, after project().
  void set_slopes(double load_factor, const KernelView<double*>& rows) const;

  /// Returns the forces that joints carry, from the spatial rows of a state as project() gets them: the tangent has
  /// terms of these forces.
  CarriedForces carried(const State& state, const KernelView<double*>& rows) const;

  /// The derivative of the equations from that of the spatial rows.
  void project(const State& state, const CarriedForces& carried, const MatrixRows& rows) const;

  /// State::turns of `to`, to which `from` has moved by less than a turn; those of this rank.
  void follow(const State& from, State& to) const;
  /// Copies the turns of another state, all others zero.
  void keep_turns(const State& from, State& to) const;
  /// Counts the turns of a state in equilibrium whose turns are zero so far: its springs lack stiffness times whole
  /// turns in their unscaled rows, as set() leaves them.
  void count(const KernelView<double*>& rows, State& state) const;
  bool counts() const { return counted_angles_ > 0; }
  int counted_angles() const { return counted_angles_; }

 private:
  int index_of(int vertex) const;

  std::vector<VertexSupport> supports_;
  std::vector<VertexJoint> joints_;
  CarriedForces unloaded_;  ///< the vertices, without forces
  int counted_angles_ = 0;
};

}  // namespace mixbeam
