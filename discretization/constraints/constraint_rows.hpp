/// Supports and joints of one rank at any load factor, and their rows, which replace rows of vertices in vectors and in
/// the matrix. Loops over supports and joints only.
#pragma once

#include "discretization/mesh/mixed_vector.hpp"
#include "discretization/scene/amplitude.hpp"
#include "discretization/scene/joined_ends.hpp"
#include "kernels/element/row_scales.hpp"

#include <vector>

namespace mixbeam {

/// Matrix with the axes as rows.
Mat3<double> matrix_of(const Axes& axes);

/// Rotation condition of a support, see constraint_rows.cpp.
enum class SupportRotation { free, fixed, hinge, vector };

/// Angle about one axis, with a spring, over any number of turns.
struct CountedAngle {
  int place = -1;  ///< index in State::turns, the same on every rank; -1: not counted, no spring
  /// Counted angle; `angle` in (-2 pi, 2 pi] is that of the current quaternion.
  double operator()(double angle, const State& state) const;
  /// Updates the turns after a motion from `from` to `to` by less than a full turn.
  void follow(double angle_before, const State& from, double angle, State& to) const;
};

struct VertexSupport {
  int vertex = 0;  ///< owned local vertex
  int index = 0;   ///< in Scene::supports
  bool fixed[6] = {};
  Mat3<double> axes{};          ///< rows e_1, e_2, e_3, spatial
  bool turns_forces = false;    ///< force rows are components along the axes
  Vec3<double> displacement{};  ///< prescribed, components along the axes
  Vec3<double> rotation{};      ///< all three rotations fixed: the triad follows exp(amplitude * rotation); spatial
  SupportRotation rotation_kind = SupportRotation::free;
  Vec3<double> displacement_stiffness{}, rotation_stiffness{};  ///< of free components, else zero
  CountedAngle angle{};                                         ///< of a hinge
  Amplitude amplitude{};
};

/// Joined end of a member, see constraint_rows.cpp.
struct VertexJoint {
  int master = 0, slave = 0;  ///< owned local vertices
  JointKind kind = JointKind::hinge;
  Mat3<double> frame{};  ///< rows b1, b2, a of the undeformed structure, orthonormal and right-handed
  double stiffness = 0.0;
  CountedAngle angle{};  ///< of a hinge

  /// True if row `component` of the slave is a constraint.
  bool holds(int component) const { return joint_holds(kind, component); }
};

/// All conditions on vertices.
struct Conditions {
  std::vector<VertexSupport> supports;
  std::vector<VertexJoint> joints;
  int counted_angles = 0;  ///< size of State::turns, for the whole scene
};

Conditions build_conditions(const Scene& scene, const Mesh& mesh, const Structure& structure);

/// Largest prescribed rotation of any support, in radians per unit of load factor or of the parameter of the clock's
/// current piece (whole scene; for amplitudes given by formulas, the steepest slope found at many load factors).
double largest_prescribed_rotation(const Scene& scene, const LoadClock& clock);

/// First component of a vertex: of displacement or force, of rotation or moment.
enum VertexPart { kForcePart = 0, kMomentPart = 3 };

inline size_t vertex_row(int vertex, int component) { return static_cast<size_t>(kVertexDofs) * vertex + component; }

template <class Rows>
inline Vec rows_of(const Rows& rows, int vertex, VertexPart part) {
  return load_vector(&rows(vertex_row(vertex, part)));
}
inline void set_rows_of(const KernelView<double*>& rows, int vertex, VertexPart part, const Vec& value) {
  store_vector(value, &rows(vertex_row(vertex, part)));
}

/// Rows of owned vertices in the matrix of one rank. All rows of a vertex have the same columns: six for each of some
/// local vertices, ascending.
class MatrixRows {
 public:
  /// `place`: (local vertex) its index among rows and columns, -1 if it has none.
  MatrixRows(const DofMatrix::local_matrix_host_type& matrix, const KernelView<const int*>& place)
      : matrix_(matrix), place_(place) {}

  void clear(int vertex, int component) const;
  /// Adds value . (displacement or rotation of `column_vertex`) to a row.
  void add(int vertex, int component, int column_vertex, VertexPart column_part, const Vec& value) const;
  /// Adds a 3 x 3 block.
  void add(int vertex, VertexPart part, int column_vertex, VertexPart column_part, const Mat& block) const;
  /// Adds `factor` times the rows of `part` of another vertex, whose columns must be among those of this one.
  void add_rows(int vertex, VertexPart part, const Mat& factor, int other, VertexPart other_part) const;
  /// Replaces row i of the part by the sum of factor(i, j) times row j.
  void combine(int vertex, VertexPart part, const Mat& factor) const;

 private:
  size_t row(int vertex, int component) const { return vertex_row(place_(vertex), component); }
  /// The six entries of a row at one block column.
  double* entries(size_t row, int column_place) const;

  DofMatrix::local_matrix_host_type matrix_;
  KernelView<const int*> place_;
};

/// Force and moment on a vertex.
struct SpatialLoad {
  Vec3<double> force, moment;
};

/// True if the matrix rows need the moment on the vertex, because loads alone do not balance it.
inline bool turns_moment_rows(const VertexSupport& support) {
  return support.rotation_kind == SupportRotation::hinge || support.rotation_kind == SupportRotation::vector;
}
/// Force and moment of a support and its springs on the vertex, from its spatial rows without it.
SpatialLoad support_reaction(const VertexSupport& support, const State& state, const Vec& force, const Vec& moment);
/// Adds the slave's forces and moments to the master and leaves the free component to the slave, whose constraint rows
/// become zero.
void join_rows(const VertexJoint& joint, const State& state, const KernelView<double*>& rows);
/// Energy of the rotational springs of a support, and of the spring of a joint.
double stored_energy(const VertexSupport& support, const State& state);
double stored_energy(const VertexJoint& joint, const State& state);

/// Vertex with forces and moments that supports or joints balance in addition to loads.
struct CarriedForce {
  int vertex = 0;
  Vec force{}, moment{};
  Vec joined_moment{};  ///< including the slaves at the vertex
};
using CarriedForces = std::vector<CarriedForce>;  ///< ascending vertices

class ConstraintRows {
 public:
  ConstraintRows() = default;
  explicit ConstraintRows(const Conditions& conditions);

  void mark_fixed(const KernelView<unsigned char*>& fixed) const;

  /// Projects spatial forces and moments of all vertices, including those of external energies, on the equations; zero
  /// in the rows of constraints. Linear in `rows`.
  void project(const State& state, const KernelView<double*>& rows) const;
  /// Adds springs and constraints of a state, after project().
  void set(const State& state, double load_factor, const KernelView<double*>& rows) const;
  /// Divides the rows of springs between members, which are scaled like others, by the ratio of the rounding of what
  /// they join to that scale, if it exceeds one; multiplies if `inverse`.
  void scale_springs(const ResidualScales& scales, bool inverse, const KernelView<double*>& rows) const;
  /// Sets the derivatives of the constraints with respect to the load factor, after project().
  void set_slopes(double load_factor, const KernelView<double*>& rows) const;

  /// Forces carried by joints and supports, from the spatial rows of a state as passed to project(): the tangent
  /// depends on them.
  CarriedForces carried(const State& state, const KernelView<double*>& rows) const;

  /// Turns the derivative of the spatial rows into that of the equations.
  void project(const State& state, const CarriedForces& carried, const MatrixRows& rows) const;

  /// Updates State::turns of `to` after a motion from `from` by less than a turn; those of this rank.
  void follow(const State& from, State& to) const;
  /// Copies the turns of another state and clears all others.
  void keep_turns(const State& from, State& to) const;
  /// Counts the turns of a state in equilibrium whose turns are still zero: its unscaled spring rows, as left by set(),
  /// lack stiffness times whole turns.
  void count(const KernelView<double*>& rows, State& state) const;
  bool counts() const { return counted_angles_ > 0; }
  int counted_angles() const { return counted_angles_; }

 private:
  int index_of(int vertex) const;

  std::vector<VertexSupport> supports_;
  std::vector<VertexJoint> joints_;
  CarriedForces unloaded_;  ///< vertices, without forces
  int counted_angles_ = 0;
};

}  // namespace mixbeam
