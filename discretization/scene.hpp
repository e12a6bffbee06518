/// The scene: what a user describes, as plain structs in any consistent set of units (angles in radians).
/// Reading and validating a scene is `read_scene` (scene_reader.hpp); turning it into elements is `Mesh` (mesh.hpp).
#pragma once

#include "kernels/force_integration.hpp"

#include <array>
#include <string>
#include <vector>

namespace mixbeam {

using Vector3 = std::array<double, 3>;

/// Linear elastic section; every stiffness is positive, and infinity means rigid in that component (compliance zero).
struct Section {
  std::string name;
  double axial_stiffness = 0.0;               ///< EA
  std::array<double, 2> shear_stiffness{};    ///< GA2, GA3
  double torsional_stiffness = 0.0;           ///< GIt
  std::array<double, 2> bending_stiffness{};  ///< EI2, EI3
};

/// A named point of the undeformed structure; members that name the same point are rigidly joined there.
struct Point {
  std::string name;
  Vector3 position{};
};

enum class CurveShape { line, circular_arc, helix };

/// Undeformed centerline of a member. All three shapes have a constant curvature vector in their own frame.
struct Curve {
  CurveShape shape = CurveShape::line;
  Vector3 center{};  ///< circular arc: its centre; helix: a point of its axis
  Vector3 axis{0, 0,
               1};     ///< arc: normal of its plane (the arc turns right-handed about it); helix: direction of its axis
  double angle = 0.0;  ///< arc and helix: angle swept about the axis, positive, in radians
  double rise = 0.0;   ///< helix: signed length gained along the axis over the whole angle
};

/// A beam between two points, divided into elements of equal length.
struct Member {
  std::string name;
  std::string start_point;  ///< where arc length s = 0
  std::string end_point;    ///< where s = L
  Curve curve;
  std::string section;
  int order = 2;  ///< k = 1..8
  int elements = 1;
  ForceIntegration force_integration = ForceIntegration::both_reduced;
  Vector3 second_axis{};  ///< direction that g2 of the start triad should take; zero: chosen by the program
};

/// When a load or a prescribed motion acts: its amplitude is clamp(load_factor - (stage - 1), 0, 1),
/// so stage 1 grows while the load factor goes from 0 to 1, stage 2 from 1 to 2, and finished stages stay.
using Stage = int;

/// What keeps a vertex in place. Motions not fixed here are free.
struct Support {
  std::string point;
  std::array<bool, 3> displacement_fixed{};  ///< global components
  std::array<bool, 3> rotation_fixed{};      ///< global components: none, all, or two of them (a hinge about the third)
  Vector3 prescribed_displacement{};         ///< reached at the end of `stage`; fixed components only
  Vector3 prescribed_rotation{};  ///< rotation vector; amplitude * vector at each load factor, may exceed 2 pi; all
                                  ///< components fixed only
  Stage stage = 1;
};

enum class LoadFrame {
  dead,     ///< keeps its direction in space
  follower  ///< turns with the vertex: components are in the member's triad at that end
};

struct PointLoad {
  std::string point;
  Vector3 force{};
  Vector3 moment{};  ///< dead moments are spatial: virtual work moment . dtheta
  LoadFrame frame = LoadFrame::dead;
  std::string member;  ///< follower loads: whose triad the components refer to
  Stage stage = 1;
};

/// Dead load per unit reference length of a member.
struct DistributedLoad {
  std::string member;
  Vector3 force{};
  Vector3 couple{};
  Stage stage = 1;
};

struct Scene {
  std::string name;
  std::vector<Section> sections;
  std::vector<Point> points;
  std::vector<Member> members;
  std::vector<Support> supports;
  std::vector<PointLoad> point_loads;
  std::vector<DistributedLoad> distributed_loads;
  int stages = 1;  ///< largest stage in use; the load factor runs from 0 to this number
};

}  // namespace mixbeam
