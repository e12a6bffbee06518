// Joints and supports against statics and kinematics in closed form.
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test::joints_test {
namespace {

constexpr double kBalanced = 1e-10;

void expect_balanced(const Simulation& simulation) {
  const Balance balance = simulation.balance();
  EXPECT_LT(balance.force_error, kBalanced) << simulation.scene().name;
  EXPECT_LT(balance.moment_error, kBalanced) << simulation.scene().name;
}

/// Spatial moment that the joined end of a member takes from a joint, in the order of the mesh.
Vec joint_moment(const Simulation& simulation, int joint) {
  const Model model(simulation.scene(), this_rank(), {});
  MixedVector rows = model.create_vector();
  element_rows(model, simulation.state(), simulation.load_factor(), ElementLoads::with_centrifugal, rows);
  return rows_of(rows.vertex(), model.mesh().joints[joint].slave, kMomentPart);
}

Scene three_hinged_frame(double force) {
  Scene scene = structure({{"A", {0, 0, 0}}, {"B", {0, 3, 0}}, {"C", {2, 3, 0}}, {"D", {4, 3, 0}}, {"E", {4, 0, 0}}},
                          {line("left", "A", "B", 2, 2), line("beam 1", "B", "C", 2, 2), line("beam 2", "C", "D", 2, 2),
                           line("right", "D", "E", 2, 2)},
                          {hinged("A"), hinged("E")}, {dead_load("B", {force, 0, 0})}, section(1e4, 5e3, 80, 100));
  scene.joints = {joint(JointKind::hinge, "C", {"beam 2"})};
  return scene;
}

/// A three-hinged frame of span 4 and height 3 with a horizontal force at its left corner: moments about the hinges in
/// A, C and E give all reactions. Displacements change them in proportion to the force, which the mean of both signs
/// removes; smaller forces would drown in the rounding of rotations times EI.
TEST(Joints, ThreeHingedFrame) {
  constexpr double kForce = 1e-4;
  for (const Mat& rotation : {identity_matrix<double>(), some_rotation()}) {
    const Simulation there = solved(turned(rotation, three_hinged_frame(kForce))),
                     back = solved(turned(rotation, three_hinged_frame(-kForce)));
    const auto mean = [&](int support) {
      return to_array(0.5 * (to_vec(there.reactions()[support].force) - to_vec(back.reactions()[support].force)));
    };
    EXPECT_TRUE(agrees_relatively(mean(0), turned(rotation, {-0.5 * kForce, -0.75 * kForce, 0}), 1e-8));
    EXPECT_TRUE(agrees_relatively(mean(1), turned(rotation, {-0.5 * kForce, 0.75 * kForce, 0}), 1e-8));
    const double hinge = dot(joint_moment(there, 0), to_vec(turned(rotation, {0, 0, 1})));
    EXPECT_LT(std::abs(hinge), 1e-12 * 3 * kForce);
    expect_balanced(there);
  }
}

/// k alpha = F L cos(alpha)
double angle_of_sprung_bar(double stiffness, double moment) {
  double alpha = 0.5;
  for (int i = 0; i < 50; ++i)
    alpha -= (stiffness * alpha - moment * std::cos(alpha)) / (stiffness + moment * std::sin(alpha));
  return alpha;
}

/// A stiff bar on a hinge with a spring, the hinge once a joint and once a support. EI is so large that the bar's own
/// bending stays below the tolerance.
TEST(Joints, BarOnAHingeWithASpring) {
  constexpr double kStiffness = 2.0, kForce = 3.0, kLength = 1.5, kTolerance = 1e-8;
  Scene by_support = cantilever(section(1e12, 1e12, 1e10, 1e10), kLength, 2, 1);
  by_support.supports = {hinged("clamp")};
  by_support.supports[0].rotation_stiffness = {0, 0, kStiffness};
  by_support.point_loads = {dead_load("tip", {0, kForce, 0})};
  Scene by_joint = by_support;
  by_joint.points.push_back({"wall", {-1, 0, 0}});
  by_joint.members.push_back(line("stub", "wall", "clamp", 2, 1));
  by_joint.joints = {joint(JointKind::hinge, "clamp", {"beam"}, {0, 0, 2}, kStiffness)};
  by_joint.supports = {clamp("wall")};
  const double alpha = angle_of_sprung_bar(kStiffness, kForce * kLength);
  for (const Scene& scene : {by_support, by_joint})
    for (const Mat& rotation : {identity_matrix<double>(), some_rotation()}) {
      const Simulation simulation = solved(turned(rotation, scene));
      const Vector3 tip = {kLength * std::cos(alpha), kLength * std::sin(alpha), 0};
      EXPECT_TRUE(agrees(simulation.position("tip"), turned(rotation, tip), kTolerance));
      EXPECT_LE(simulation.result().newton_iterations, 12);
      expect_balanced(simulation);
    }
}

/// A rod of EI = L = 1 on a spring k under a moment M at its end is a circle of curvature M whose start has turned by
/// M / k: by 7 and 100 radians, where the quaternion of the start has begun anew. What a file keeps tells the turns.
TEST(Joints, SpringsCountTurns) {
  constexpr double kTolerance = 1e-8, kMoment = 14.0;
  for (const double angle : {7.0, -100.0}) {
    const double moment = std::copysign(kMoment, angle);
    Scene by_support = cantilever(section(1e12, 1e12, 1.0, 1.0), 1.0, 5, 8);
    by_support.supports = {hinged("clamp")};
    by_support.supports[0].rotation_stiffness = {0, 0, kMoment / std::abs(angle)};
    by_support.point_loads = {{"tip", {}, {0, 0, moment}}};
    Scene by_joint = by_support;
    by_joint.points.push_back({"wall", {-1, 0, 0}});
    by_joint.members.push_back(line("stub", "wall", "clamp", 2, 1));
    by_joint.sections.push_back(section(1e12, 1e12, 1e10, 1e10));
    by_joint.sections[1].name = by_joint.members[1].section = "rigid";
    by_joint.joints = {joint(JointKind::hinge, "clamp", {"beam"}, {0, 0, 1}, kMoment / std::abs(angle))};
    by_joint.supports = {clamp("wall")};
    const Vector3 tip = {(std::sin(angle + moment) - std::sin(angle)) / moment,
                         (std::cos(angle) - std::cos(angle + moment)) / moment, 0};
    for (const Scene& scene : {by_support, by_joint}) {
      const Simulation rod = solved(scene);
      EXPECT_TRUE(agrees(rod.position("tip"), tip, kTolerance)) << angle;
      expect_balanced(rod);
      Simulation again(std::make_shared<Scene>(scene), {}, this_rank());
      again.restore(snapshot_of(rod.model(), rod.state()), rod.load_factor());
      EXPECT_EQ(again.state().turns, rod.state().turns) << angle;
      expect_balanced(again);
    }
  }
}

/// The slave moves along the axis, which turns with the master: k q = F . a, whatever the bending.
TEST(Joints, SliderOnABentBeam) {
  constexpr double kStiffness = 20.0;
  const Vector3 force = {8, -6, 3};
  Scene scene = cantilever(section(1e4, 5e3, 80, 100), 2.0, 3, 4);
  scene.points.push_back({"end", {3, 0, 0}});
  scene.members.push_back(line("rod", "tip", "end", 3, 2));
  scene.joints = {joint(JointKind::slider, "tip", {"rod"}, {1, 0, 0}, kStiffness)};
  scene.point_loads = {dead_load("end", force, {1, 2, -3})};
  const Simulation simulation = solved(scene);
  expect_balanced(simulation);
  const std::vector<MemberSamples> samples = simulation.samples(2);
  const Vec offset = to_vec(samples[1].position.front()) - to_vec(samples[0].position.back());
  const Vec axis = rotation_matrix(exp_quaternion(to_vec(simulation.rotation("tip")))) * Vec{{1, 0, 0}};
  const double along = dot(to_vec(force), axis) / kStiffness;
  EXPECT_GT(along, 0.1);
  EXPECT_TRUE(agrees(to_array(offset), to_array(along * axis), 1e-10));
}

/// Of any stiffness: rounding of what it joins, times the stiffness, is no force that must vanish. 1e3 is not rigid.
TEST(Joints, StiffSpringIsARigidConnection) {
  const auto end = [](JointKind kind, double stiffness) {
    Scene scene = cantilever(section(1e4, 5e3, 80, 100), 2.0, 3, 4);
    scene.points.push_back({"end", {3, 0.5, 0.2}});
    scene.members.push_back(line("rod", "tip", "end", 3, 2));
    if (stiffness > 0.0) scene.joints = {joint(kind, "tip", {"rod"}, {1, 2, 3}, stiffness)};
    scene.point_loads = {dead_load("end", {80, -60, 30})};
    return solved(scene).displacement("end");
  };
  for (const JointKind kind : {JointKind::hinge, JointKind::slider}) {
    const Vector3 rigid = end(kind, 0.0);
    for (const double stiffness : {1e15, 1e20}) EXPECT_TRUE(agrees(end(kind, stiffness), rigid, 1e-11));
    EXPECT_FALSE(agrees(end(kind, 1e3), rigid, 1e-3));
  }
}

/// Four bars: crank AB turned by a clamp, coupler BC, rocker CD. Nothing bends, and C is where the circles about B and
/// D meet.
TEST(Joints, FourBarLinkage) {
  const Vector3 d = {4, 0, 0}, c0 = {3, 3, 0};
  Scene scene =
      structure({{"A", {0, 0, 0}}, {"B", {0, 1, 0}}, {"C", c0}, {"D", d}},
                {line("crank", "A", "B", 2, 1), line("coupler", "B", "C", 2, 2), line("rocker", "C", "D", 3, 1)},
                {clamp("A"), hinged("D")}, {}, section(1e4, 5e3, 80, 100));
  scene.joints = {joint(JointKind::hinge, "B", {"coupler"}), joint(JointKind::hinge, "C", {"rocker"})};
  scene.supports[0].prescribed_rotation = {0, 0, -2.0};
  const double coupler = std::hypot(3, 2), rocker = std::hypot(1, 3);
  for (const Mat& rotation : {identity_matrix<double>(), some_rotation()}) {
    Simulation simulation(turned(rotation, scene), {}, this_rank());
    simulation.run([&](const StepReport& report, const State&) {
      const double angle = 0.5 * kPi - 2.0 * report.load_factor;
      const Vector3 b = {std::cos(angle), std::sin(angle), 0};
      const double x = d[0] - b[0], y = d[1] - b[1], r = std::hypot(x, y);
      const double along = (coupler * coupler - rocker * rocker + r * r) / (2 * r);
      const double across = std::sqrt(coupler * coupler - along * along);
      const Vector3 c = {b[0] + (along * x - across * y) / r, b[1] + (along * y + across * x) / r, 0};
      EXPECT_TRUE(agrees(simulation.position("C"), turned(rotation, c), 1e-10)) << report.load_factor;
    });
    EXPECT_TRUE(simulation.result().finished) << simulation.result().failure;
  }
}

/// No moment about the axis of a hinge, wherever it has turned to, but that of its spring, and none at a ball joint.
TEST(Joints, FreeMomentsVanish) {
  const Scene scene = portal_of_joints(3, 3);
  const Simulation simulation = solved(scene);
  const Mesh mesh = build_mesh(scene);
  int hinges = 0, balls = 0;
  for (size_t i = 0; i < mesh.joints.size(); ++i) {
    const Joint& described = scene.joints[mesh.joints[i].joint];
    const Vec moment = joint_moment(simulation, static_cast<int>(i));
    if (described.kind == JointKind::hinge && described.stiffness == 0.0) {
      const Mat turn = rotation_matrix(exp_quaternion(to_vec(simulation.rotation(described.point))));
      EXPECT_LT(std::abs(dot(moment, turn * to_vec(described.axis))), 1e-12 * norm(moment));
      EXPECT_GT(norm(moment), 0.1);  // it does carry the others
      ++hinges;
    } else if (described.kind == JointKind::ball) {
      EXPECT_LT(norm(moment), 1e-12);
      ++balls;
    }
  }
  EXPECT_EQ(hinges, 1);
  EXPECT_EQ(balls, 1);
  expect_balanced(simulation);
}

/// Two bars that cross at a pin in their middle P, both on hinges: bar A-P-C leans to the right, bar B-P-D to the left,
/// half as wide as `a` and half as high as `h`.
Scene scissor(double a, double h, bool together) {
  Scene scene = structure(
      {{"A", {0, 0, 0}}, {"B", {2 * a, 0, 0}}, {"C", {2 * a, 2 * h, 0}}, {"D", {0, 2 * h, 0}}, {"P", {a, h, 0}}},
      {line("A-P", "A", "P", 3, 2), line("P-C", "P", "C", 3, 2), line("B-P", "B", "P", 3, 2),
       line("P-D", "P", "D", 3, 2)},
      {hinged("A"), hinged("B")}, {}, section(1e4, 5e3, 80, 100));
  scene.joints = {joint(JointKind::hinge, "P", {"B-P", "P-D"})};
  scene.joints[0].together = together;
  return scene;
}

/// The same with all four halves rigidly joined: what the twins below must tell apart.
Scene cross_without_pin(Scene scene) {
  scene.joints.clear();
  return scene;
}

/// Loads F and G down on the tips C and D. Moments of the whole about A and of each bar about the pin:
/// reactions at A ((F + G) a / h, G), at B (-(F + G) a / h, F).
TEST(Joints, ScissorUnderLoad) {
  constexpr double kA = 1.5, kH = 2.0, kF = 1e-4, kG = 0.3e-4, kThrust = (kF + kG) * kA / kH;
  const auto loaded = [](Scene scene, double sign) {
    scene.point_loads = {dead_load("C", {0, -sign * kF, 0}), dead_load("D", {0, -sign * kG, 0})};
    return scene;
  };
  const auto reactions = [&](const Mat& rotation, const Scene& scene) {
    const Simulation there = solved(turned(rotation, loaded(scene, 1))),
                     back = solved(turned(rotation, loaded(scene, -1)));
    expect_balanced(there);
    std::array<Vector3, 2> mean;
    for (std::size_t i = 0; i < 2; ++i)
      mean[i] = to_array(0.5 * (to_vec(there.reactions()[i].force) - to_vec(back.reactions()[i].force)));
    return mean;
  };
  for (const Mat& rotation : {identity_matrix<double>(), some_rotation()}) {
    const auto at = reactions(rotation, scissor(kA, kH, true));
    EXPECT_TRUE(agrees_relatively(at[0], turned(rotation, {kThrust, kG, 0}), 1e-8));
    EXPECT_TRUE(agrees_relatively(at[1], turned(rotation, {-kThrust, kF, 0}), 1e-8));
  }
  const Vector3 rigid = reactions(identity_matrix<double>(), cross_without_pin(scissor(kA, kH, true)))[0];
  EXPECT_GT(std::abs(rigid[0] - kThrust), 0.05 * kThrust);
}

/// One foot of a scissor lift is pushed to the other: nothing bends, the bars turn by 57 degrees, and height follows
/// from half width a by Pythagoras.
TEST(Joints, ScissorLift) {
  constexpr double kHalfBar = 2.5, kFrom = 2.4, kTo = 0.7;
  const auto lift = [&](Scene scene, const Mat& rotation) {
    scene.supports[1].prescribed_displacement = {2 * (kTo - kFrom), 0, 0};  // along the axes of the support
    return turned(rotation, scene);
  };
  const double low = std::sqrt(kHalfBar * kHalfBar - kFrom * kFrom);
  for (const Mat& rotation : {identity_matrix<double>(), some_rotation()}) {
    Simulation simulation(lift(scissor(kFrom, low, true), rotation), {}, this_rank());
    simulation.run([&](const StepReport& report, const State&) {
      const double a = kFrom + report.load_factor * (kTo - kFrom), h = std::sqrt(kHalfBar * kHalfBar - a * a);
      EXPECT_TRUE(agrees(simulation.position("P"), turned(rotation, {a, h, 0}), 1e-10)) << report.load_factor;
      EXPECT_TRUE(agrees(simulation.position("C"), turned(rotation, {2 * a, 2 * h, 0}), 1e-10)) << report.load_factor;
      EXPECT_TRUE(agrees(simulation.position("D"), turned(rotation, {0, 2 * h, 0}), 1e-10)) << report.load_factor;
    });
    EXPECT_TRUE(simulation.result().finished) << simulation.result().failure;
  }
  const Simulation rigid = solved(lift(cross_without_pin(scissor(kFrom, low, true)), identity_matrix<double>()));
  EXPECT_FALSE(agrees(rigid.position("C"), {2 * kTo, 4.8, 0}, 0.1));
}

TEST(Joints, EndsTogetherShareAVertex) {
  const Mesh shared = build_mesh(scissor(1.5, 2.0, true)), separate = build_mesh(scissor(1.5, 2.0, false));
  EXPECT_EQ(shared.joints.size(), 1U);
  EXPECT_EQ(separate.joints.size(), 2U);
  EXPECT_EQ(separate.vertices(), shared.vertices() + 1);
  const auto at_pin = [](const Mesh& mesh, int member, int end) {
    const MeshMember& m = mesh.members[member];
    return mesh.elements[m.first_element + (end == 0 ? 0 : m.elements - 1)].vertex[end];
  };
  EXPECT_EQ(at_pin(shared, 2, 1), shared.joints[0].slave);
  EXPECT_EQ(at_pin(shared, 3, 0), shared.joints[0].slave);
  EXPECT_EQ(at_pin(separate, 2, 1), separate.joints[0].slave);
  EXPECT_EQ(at_pin(separate, 3, 0), separate.joints[1].slave);
  EXPECT_EQ(at_pin(shared, 1, 0), shared.joints[0].master);
}

TEST(Joints, ThatJoinNothingAreRefused) {
  Scene scene = portal_of_joints(1, 1);
  for (const std::vector<std::string>& members : {std::vector<std::string>{"left", "beam 1"}, {"arm"}, {"nobody"}}) {
    scene.joints[0].members = members;
    EXPECT_THROW(build_mesh(scene), std::invalid_argument) << members[0];
  }
  scene.joints[0].members = {"beam 1"};
  EXPECT_NO_THROW(build_mesh(scene));
}

/// Springs of three stiffnesses against the rotation vector: T(theta)^T (x cross F) = K theta, with T in Rodrigues'
/// form.
TEST(Supports, RotationSprings) {
  const Vector3 force = {1, -2, 3}, stiffness = {4, 5, 7};
  Scene scene = cantilever(section(1e12, 1e12, 1e10, 1e10), 1.5, 2, 1);
  scene.supports[0].rotation_fixed = {};
  scene.supports[0].rotation_stiffness = stiffness;
  scene.point_loads = {dead_load("tip", force, {0.5, -1, 2})};
  const Simulation simulation = solved(scene);
  const Vec theta = to_vec(simulation.rotation("clamp"));
  const Vec moment = cross(to_vec(simulation.position("tip")), to_vec(force)) + Vec{{0.5, -1, 2}};
  const double angle = norm(theta);
  const Mat h = hat(theta);
  const Mat tangent = identity_matrix<double>() + ((1 - std::cos(angle)) / (angle * angle)) * h +
                      ((angle - std::sin(angle)) / (angle * angle * angle)) * (h * h);
  EXPECT_GT(angle, 0.5);
  EXPECT_TRUE(agrees(to_array(transpose_times(tangent, moment)),
                     {stiffness[0] * theta[0], stiffness[1] * theta[1], stiffness[2] * theta[2]}, 1e-9));
  EXPECT_TRUE(agrees(simulation.reactions()[0].moment, to_array(-moment), 1e-9));
}

/// Tip deflection of a cantilever with a spring at its tip, in inclined axes and small: F / (k + 3 EI / L^3).
TEST(Supports, DisplacementSpringInInclinedAxes) {
  constexpr double kForce = 1e-7, kStiffness = 30.0;
  Scene scene = cantilever(section(1e4, kRigid, 80, 100), 2.0, 3, 2);
  Support spring = support("tip", {}, {});
  spring.axes = {{{0, 0.6, 0.8}, {1, 0, 0}, {0, 0.8, -0.6}}};
  spring.displacement_stiffness = {kStiffness, 0, 0};
  scene.supports.push_back(spring);
  scene.point_loads = {dead_load("tip", {0, 0.6 * kForce, 0.8 * kForce})};
  const Simulation simulation = solved(scene);
  const double expected = kForce / (kStiffness + 3 * 100 / 8.0);
  EXPECT_TRUE(agrees(simulation.displacement("tip"), {0, 0.6 * expected, 0.8 * expected}, 1e-8 * expected));
  expect_balanced(simulation);
}

/// A single fixed rotation: that component of the rotation vector stays zero.
TEST(Supports, OneFixedRotation) {
  Scene scene = portal_of_joints(2, 2, 3.0);
  const Simulation simulation = solved(scene);
  const Vector3 theta = simulation.rotation("E"), axis = scene.supports[1].axes[1];
  EXPECT_GT(largest_component(theta), 0.05);
  EXPECT_NEAR(dot(to_vec(theta), to_vec(axis)), 0.0, 1e-12);
  expect_balanced(simulation);
}

/// A formula says when a motion and a load act.
TEST(Supports, FormulasAsAmplitudes) {
  Scene scene = cantilever(section(1e4, 5e3, 80, 100), 2.0, 2, 2);
  scene.supports[0].prescribed_displacement = {0.1, 0, 0};
  scene.supports[0].prescribed_rotation = {0, 0, 0.5};
  scene.supports[0].amplitude = "t * (3 - t)";
  scene.point_loads = {dead_load("tip", {0, 2, 0})};
  scene.point_loads[0].amplitude = "-3 * t^2";
  Scene plain = scene;
  plain.supports[0].amplitude = plain.point_loads[0].amplitude = "";
  plain.supports[0].prescribed_displacement = {0.2, 0, 0};
  plain.supports[0].prescribed_rotation = {0, 0, 1};
  plain.point_loads[0].force = {0, -6, 0};
  const Simulation by_formula = solved(scene), by_ramp = solved(plain);
  EXPECT_TRUE(agrees(by_formula.position("tip"), by_ramp.position("tip"), 1e-10));
}

/// Dead and follower loads on a point inside a member, as on two members that meet there.
TEST(Supports, LoadsOnInnerPoints) {
  Scene one = cantilever(section(1e4, 5e3, 80, 100), 2.0, 2, 4), two = one;
  one.members[0].inner_points = {{"middle", 0.5}};
  two.points.push_back({"middle", {1, 0, 0}});
  two.members = {line("first", "clamp", "middle", 2, 2), line("beam", "middle", "tip", 2, 2)};
  one.point_loads = two.point_loads = {dead_load("middle", {0, 3, 1}, {1, 0, 2}),
                                       follower_load("middle", "beam", {0, -9, 4}, {0, 1, 0})};
  const Simulation a = solved(one), b = solved(two);
  EXPECT_TRUE(agrees(a.position("tip"), b.position("tip"), 1e-12));
  expect_balanced(a);
}

}  // namespace
}  // namespace mixbeam::test::joints_test
