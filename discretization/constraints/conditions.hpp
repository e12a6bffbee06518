/// Supports and joints as one rank applies them, at any load factor.
#pragma once

#include "discretization/mesh/structure.hpp"
#include "discretization/scene/amplitude.hpp"
#include "discretization/scene/joined_ends.hpp"

#include <vector>

namespace mixbeam {

/// Axes as rows.
Mat3<double> matrix_of(const Axes& axes);

/// How a support holds rotations: see constraint_rows.hpp.
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

/// One joined end of a member, see constraint_rows.hpp.
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

}  // namespace mixbeam
