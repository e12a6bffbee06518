/// Supports and joints as one rank applies them, at any load factor, and the rows of vertices, in vectors and in the
/// matrix, in whose place they put theirs. Loops over supports
/// and joints only; without any of them there is nothing to do.
#pragma once

#include "discretization/mesh/mixed_vector.hpp"
#include "discretization/scene/amplitude.hpp"
#include "discretization/scene/joined_ends.hpp"
#include "kernels/element/row_scales.hpp"

#include <vector>

namespace mixbeam {

/// Axes as rows.
Mat3<double> matrix_of(const Axes& axes);

/// How a support holds rotations: see constraint_rows.cpp.
enum class SupportRotation { free, fixed, hinge, vector };

/// Angle about one axis against which a spring acts, over any number of turns.
struct CountedAngle {
  int place = -1;  ///< among State::turns, the same on every rank; -1: not counted, no spring
  /// `angle` in (-2 pi, 2 pi], of the quaternion as it is now.
  double operator()(double angle, const State& state) const;
  /// Turns after `from` has moved to `to`, by less than a full turn.
  void follow(double angle_before, const State& from, double angle, State& to) const;
};

struct VertexSupport {
  int vertex = 0;  ///< owned local vertex
  int index = 0;   ///< in Scene::supports
  bool fixed[6] = {};
  Mat3<double> axes{};          ///< rows e_1, e_2, e_3, spatial
  bool turns_forces = false;    ///< force rows take the components along the axes
  Vec3<double> displacement{};  ///< prescribed, components along the axes
  Vec3<double> rotation{};      ///< all three rotations fixed: the triad follows exp(amplitude * rotation); spatial
  SupportRotation rotation_kind = SupportRotation::free;
  Vec3<double> displacement_stiffness{}, rotation_stiffness{};  ///< of free components, zero elsewhere
  CountedAngle angle{};                                         ///< of a hinge
  Amplitude amplitude{};
};

/// One joined end of a member, see constraint_rows.cpp.
struct VertexJoint {
  int master = 0, slave = 0;  ///< owned local vertices
  JointKind kind = JointKind::hinge;
  Mat3<double> frame{};  ///< rows b1, b2, a in the undeformed structure, orthonormal and right-handed
  double stiffness = 0.0;
  CountedAngle angle{};  ///< of a hinge

  /// Whether row `component` of the slave is a constraint.
  bool holds(int component) const { return joint_holds(kind, component); }
};

/// Everything that holds vertices.
struct Conditions {
  std::vector<VertexSupport> supports;
  std::vector<VertexJoint> joints;
  int counted_angles = 0;  ///< places in State::turns, of the whole scene
};

Conditions build_conditions(const Scene& scene, const Mesh& mesh, const Structure& structure);

/// Largest prescribed rotation of any support per unit of load factor, or of the parameter of the piece in which the
/// clock runs, in radians (whole scene; amplitudes that are formulas: the steepest slope met at many load factors).
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

/// Whether the matrix rows need the moment on the vertex, because it is not balanced by loads alone.
inline bool turns_moment_rows(const VertexSupport& support) {
  return support.rotation_kind == SupportRotation::hinge || support.rotation_kind == SupportRotation::vector;
}
/// Force and moment of a support and its springs on the vertex, from its spatial rows without it.
SpatialLoad support_reaction(const VertexSupport& support, const State& state, const Vec& force, const Vec& moment);
/// Gives the slave's forces and moments to the master and leaves the free component to the slave; its constraint rows
/// become zero.
void join_rows(const VertexJoint& joint, const State& state, const KernelView<double*>& rows);
/// In the springs of a support against rotation, in that of a joint.
double stored_energy(const VertexSupport& support, const State& state);
double stored_energy(const VertexJoint& joint, const State& state);

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
  /// Divides rows of springs between members, which are scaled as others, by how far the rounding of what they join
  /// exceeds that scale, or multiplies them where `inverse`.
  void scale_springs(const ResidualScales& scales, bool inverse, const KernelView<double*>& rows) const;
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
