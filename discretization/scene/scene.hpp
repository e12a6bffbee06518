/// The scene that a user describes, as plain structs in any consistent set of units (angles in radians).
/// Reading and validating a scene is `read_scene` (read_scene.hpp); turning it into elements is `Mesh` (mesh.hpp).
#pragma once

#include "discretization/scene/field_table.hpp"
#include "kernels/element/force_integration.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

using Matrix6 = std::array<std::array<double, 6>, 6>;

enum class SectionShapeKind { circle, tube, rectangle, ellipse, i_section, box, t_section, l_section, u_section };

/// Cross-section of one material, from which stiffnesses follow (section_shape.hpp).
struct SectionShape {
  SectionShapeKind kind = SectionShapeKind::circle;
  double size2 = 0.0;   ///< outer dimension along axis 2 (circle, tube: the diameter; I, T, U: width of the flanges)
  double size3 = 0.0;   ///< outer dimension along axis 3 (circle, tube: unused; I, T, U: height)
  double wall = 0.0;    ///< tube, box, L: wall thickness; I, T, U: thickness of the flanges
  double web = 0.0;     ///< I, T, U: thickness of the web
  double fillet = 0.0;  ///< I: radius between web and flanges; box: outer radius of the corners
  double inner_fillet = 0.0;  ///< box: inner radius of the corners
  bool mirrored = false;      ///< T, L: upside down, as patterns mirror them
  double youngs_modulus = 0.0;
  double density = 0.0;  ///< mass per volume; 0: unknown
  double poisson_ratio = 0.0;
  std::optional<double> shear_modulus{};                    ///< absent: E / (2 (1 + nu))
  std::array<std::optional<double>, 2> shear_correction{};  ///< factors of GA2, GA3; absent: the value of the shape
  std::optional<double> strength{};                         ///< admissible von Mises stress
};

/// Stresses sigma_11, tau_12, tau_13 at a point of unit N, Q2, Q3, T, M2, M3.
using StressRows = std::array<std::array<double, 6>, 3>;

/// Points at which stresses of a section without a shape are evaluated, and the data they need besides stiffnesses.
struct StressPoints {
  double youngs_modulus = 0.0;
  std::optional<double> area{};             ///< absent: EA / E
  std::optional<double> torsion_modulus{};  ///< torque over shear stress; absent: the torque makes none
  std::optional<double> strength{};         ///< admissible von Mises stress
  struct Place {
    std::string name{};
    std::array<double, 2> at{};          ///< along axes 2 and 3, from the centroid
    std::optional<StressRows> stress{};  ///< of a section given by a matrix: at all points or at none
  };
  std::vector<Place> points{};
};

/// Linear elastic section; every stiffness is positive, and infinity means rigid in that component (compliance zero).
struct Section {
  std::string name{};
  double axial_stiffness = 0.0;               ///< EA
  std::array<double, 2> shear_stiffness{};    ///< GA2, GA3
  double torsional_stiffness = 0.0;           ///< GIt
  std::array<double, 2> bending_stiffness{};  ///< EI2, EI3
  /// Coupled section: symmetric positive definite stiffness of (gamma_1, gamma_2, gamma_3, kappa_1, kappa_2, kappa_3),
  /// material. The six numbers above are then its diagonal, where infinity makes a component rigid: its row and column
  /// of the compliance are zero whatever the matrix says.
  std::optional<Matrix6> matrix{};
  double mass = 0.0;                       ///< per length, for Gravity and vibrations; 0: unknown
  std::array<double, 3> rotary_inertia{};  ///< per length about axes 1, 2, 3 through the centre of mass
  double inertia_product = 0.0;            ///< per length: integral of density x2 x3
  std::array<double, 2> mass_offset{};     ///< of the centre of mass, along axes 2 and 3
  /// Damping in proportion to mass (forces alpha times momenta) and to material stiffness (stresses of strain + beta
  /// times its rate).
  double mass_damping = 0.0, stiffness_damping = 0.0;
  /// Shape from which the numbers above follow, if any; a taper between two shapes of one kind interpolates it. An L
  /// has a matrix too, since its axes are not the principal ones.
  std::optional<SectionShape> shape{};
  std::optional<StressPoints> stress_points{};  ///< never beside a shape
  std::optional<SectionShape> drawn_as{};       ///< for pictures alone; never beside a shape
  /// Strain beyond which a run warns (force strains, and at the edge of the shape): at 5 % metals have long yielded,
  /// and the law of rubber deviates from a line by about a tenth.
  double largest_strain = 0.05;
};

/// A named point of the undeformed structure; members that name the same point are rigidly joined there, unless a joint
/// says otherwise.
struct Point {
  std::string name{};
  Vector3 position{};
};

enum class CurveShape { line, circular_arc, helix, spline, parametric };

/// Undeformed centerline of a member. Line, arc and helix have a constant curvature vector in their own frame.
struct Curve {
  CurveShape shape = CurveShape::line;
  Vector3 center{};  ///< circular arc: its centre; helix: a point of its axis
  Vector3 axis{0, 0,
               1};     ///< arc: normal of its plane (the arc turns right-handed about it); helix: direction of its axis
  double angle = 0.0;  ///< arc and helix: angle swept about the axis, positive, in radians
  double rise = 0.0;   ///< helix: signed length gained along the axis over the whole angle
  std::vector<Vector3> through{};  ///< spline: interior points between start and end of the member
  /// spline: tangent directions at start and end (any length); zero: no curvature there; both zero: smooth if closed
  std::array<Vector3, 2> end_tangents{};
  std::array<std::string, 3> formula{};   ///< parametric: x, y, z as formulas of t, spatial
  std::array<double, 2> range{0.0, 1.0};  ///< parametric: t at start and end of the member
};

/// A named point inside a member, which becomes a vertex.
struct InnerPoint {
  std::string point{};
  double position = 0.0;  ///< arc length over the length of the member, in (0, 1)
};

/// A beam between two points, divided into elements: of equal length between its ends and inner points, unless
/// `stations` gives their ends.
struct Member {
  std::string name{};
  std::string start_point{};  ///< where arc length s = 0
  std::string end_point{};    ///< where s = L
  Curve curve;
  std::string section{};
  int order = 2;  ///< k = 1..8
  int elements = 1;
  ForceIntegration force_integration = ForceIntegration::both_reduced;
  Vector3 second_axis{};  ///< direction that g2 of the start triad should take; zero: chosen by the program
  /// Keeps axis 2 as near to `second_axis` as the tangent permits everywhere; else it is transported from the start.
  bool keeps_second_axis = false;
  /// In place of second_axis: point and direction of a line from which axis 2 points away at every place.
  std::optional<std::array<double, 6>> second_axis_from{};
  double twist = 0.0;  ///< pre-twist: rotation of the section about the tangent from start to end, in radians, on top
                       ///< of the transport of the triad along the curve
  std::vector<InnerPoint> inner_points{};  ///< ascending
  std::vector<double>
      stations{};               ///< relative arc length of every vertex from 0 to 1, ascending, elements + 1 of them;
                                ///< inner points are among them; empty: elements as equal as the inner points permit
  std::string end_section{};    ///< taper: section at the end of the member; empty: one section throughout
  std::string taper{};          ///< weight of the end section as formula of x = relative arc length; empty: x itself
  bool keeps_order = false;     ///< given by the user, so Scene::accuracy does not change it
  bool keeps_elements = false;  ///< likewise the elements
};

/// Stage in which a load or prescribed motion grows: its amplitude is clamp(load_factor - (stage - 1), 0, 1), so that
/// stage 1 grows while the load factor goes from 0 to 1, stage 2 from 1 to 2, and finished stages stay constant
/// (outside the range of all stages see Amplitude).
using Stage = int;

enum class JointKind {
  hinge,  ///< free rotation about `axis`
  ball,   ///< free rotation about any axis
  slider  ///< free translation along `axis`, no rotation
};

/// Connection between the ends of some members at a point and all others there. Each listed end has its own triad, and
/// in a slider its own position; the members not listed (at least one) stay rigidly joined to each other, and supports
/// and loads of the point act on them. With `together`, the listed ends are rigidly joined and share one triad (and
/// position): two members that cross at a pin are four halves, two of them listed.
struct Joint {
  std::string name{};
  std::string point{};
  std::vector<std::string> members{};  ///< each has one end at the point and is joined on its own
  JointKind kind = JointKind::hinge;
  Vector3 axis{0, 0, 1};   ///< spatial direction in the undeformed structure (any length); rotates with the others
  double stiffness = 0.0;  ///< of a spring in the free motion of hinge (moment per radian) or slider (force per length)
  bool together = false;   ///< whether the listed ends share one joint instead of having one each
};

using Axes = std::array<Vector3, 3>;  ///< three orthonormal directions, right-handed: [i] is the i-th
inline constexpr Axes kGlobalAxes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

/// Support of a vertex. Motions not fixed here are free.
struct Support {
  std::string point{};
  std::array<bool, 3> displacement_fixed{};  ///< components along `axes`
  std::array<bool, 3> rotation_fixed{};  ///< components along `axes`: none, all, two of them (a hinge about the third),
                                         ///< or one of them (that component of the rotation vector)
  Vector3 prescribed_displacement{};     ///< reached at the end of `stage`; fixed components only
  Vector3 prescribed_rotation{};  ///< rotation vector; amplitude * vector at each load factor, may exceed 2 pi; all
                                  ///< components fixed only
  Stage stage = 1;
  std::string amplitude{};  ///< of the prescribed motions: formula of t = load factor; empty: the ramp of `stage`
  Axes axes = kGlobalAxes;  ///< all components of this support refer to these spatial directions
  Vector3 displacement_stiffness{};  ///< springs to the ground on free components: force = - stiffness * displacement
  Vector3 rotation_stiffness{};      ///< energy 1/2 sum k_i theta_i^2 of the rotation vector of Lambda_V
  std::string load_case{};           ///< of the prescribed motions, see Scene::load_cases
};

enum class LoadFrame {
  dead,     ///< keeps its direction in space
  follower  ///< rotates with the vertex: components are in the member's triad at that end
};

struct PointLoad {
  std::string point{};
  Vector3 force{};
  Vector3 moment{};  ///< dead moments are spatial: virtual work moment . dtheta
  LoadFrame frame = LoadFrame::dead;
  std::string member{};  ///< follower loads: member whose triad the components refer to
  Stage stage = 1;
  std::string amplitude{};  ///< formula of t = load factor; empty: the ramp of `stage`
  std::string load_case{};
};

/// Body at a point, rigidly joined to the members there.
struct PointMass {
  std::string point{};
  double mass = 0.0;
  Vector3 inertia{};  ///< about `axes` through the point
  Axes axes = kGlobalAxes;
};

/// Load per unit reference length of a member: dead (spatial components) or follower (components in the triad of the
/// section on which it acts).
struct DistributedLoad {
  std::string member{};
  Vector3 force{};
  Vector3 couple{};
  Stage stage = 1;
  LoadFrame frame = LoadFrame::dead;
  std::array<std::string, 3> force_formula{};   ///< of s = arc length and x = s / length; empty: the constant above
  std::array<std::string, 3> couple_formula{};  ///< likewise
  bool is_projected = false;              ///< dead: `force` is per length projected along its own direction, as snow
  bool is_weight = false;                 ///< dead: weight of reference_mass() of a taper, scaled by its local mass
  std::array<double, 2> range{0.0, 1.0};  ///< relative arc lengths between which it acts; vertices are there
  std::string amplitude{};
  std::string load_case{};
};

/// Strain of a member without any stress: temperature, growth, actuation. Material components.
struct Eigenstrain {
  std::string member{};
  Vector3 strain{};     ///< gamma: axial, shear
  Vector3 curvature{};  ///< kappa: twist, bending, on top of the curvature of the undeformed member
  Stage stage = 1;
  std::array<std::string, 3> strain_formula{};     ///< of s and x, as in DistributedLoad
  std::array<std::string, 3> curvature_formula{};  ///< likewise
  std::string amplitude{};
  std::string load_case{};
  std::shared_ptr<const FieldTable> strain_table{}, curvature_table{};  ///< in place of constants and formulas
  double table_factor = 1.0;                                            ///< of both tables
  std::array<Vector3, 2> end_turns{};  ///< curvature concentrated at start and end: rotation vectors, material
};

/// Frame that rotates steadily about an axis, and supports and dead loads with it; the structure is at rest in it.
struct RotatingFrame {
  Vector3 point{};     ///< of the axis
  Vector3 velocity{};  ///< angular, along the axis: radian per unit of time
  Stage stage = 1;
  std::string amplitude{};  ///< of the velocity; forces grow with its square
  std::string load_case{};
  std::string name = "Rotating Frame";  ///< of its list
};

/// Buckling mode added to the geometry.
struct ModeImperfection {
  std::string name{};                   ///< of its list
  std::optional<int> mode{};            ///< number in linear buckling, by growing positive load factor; or
  std::optional<int> critical_point{};  ///< number on the path of the perfect structure, from 1
  double amplitude = 0.0;               ///< largest displacement of a vertex
};

/// Load cases that act together, each times a factor, and with all that belongs to no case.
struct Combination {
  std::string name{};
  std::vector<std::pair<std::string, double>> cases{};
  std::vector<std::pair<Stage, double>> stages{};  ///< further factors, of all that acts in these stages
};

struct Scene {
  std::string name{};
  std::string units{};  ///< of length and force, as "m, N": words for labels and reports; empty: unknown
  std::vector<Section> sections{};
  std::vector<Point> points{};
  std::vector<Member> members{};
  std::vector<Support> supports{};
  std::vector<PointLoad> point_loads{};
  std::vector<PointMass> point_masses{};
  std::vector<DistributedLoad> distributed_loads{};
  int stages = 1;  ///< largest stage in use; the load factor runs from 0 to this number
  std::vector<Joint> joints{};
  std::vector<Eigenstrain> eigenstrains{};
  std::vector<RotatingFrame> rotating_frames{};  ///< one, or none
  /// Names of alternatives that are solved one by one, each from the undeformed structure. A load or prescribed motion
  /// with a load case acts in that case only, one without in all of them. Solvers take a scene of one case.
  std::vector<std::string> load_cases{};
  std::vector<ModeImperfection> imperfection_modes{};  ///< see with_mode_shapes(): solvers take a scene without them
  std::string imperfection_case{};                     ///< case whose loads make the structure buckle
  std::vector<Combination> combinations{};  ///< solved one by one too, each by itself; names differ from those of cases
  double gravity = 0.0;                     ///< size of the acceleration; the weights are among the loads
  /// Target error of displacements over the largest one. If set, orders and elements that members do not keep are
  /// chosen (accurate_run.hpp), and those here mean nothing.
  std::optional<double> accuracy{};
  std::string accuracy_of{};  ///< quantity, or "stress", whose error counts instead; empty: displacements
};

inline long long elements_of(const Scene& scene) {
  long long elements = 0;
  for (const Member& member : scene.members) elements += member.elements;
  return elements;
}

}  // namespace mixbeam
