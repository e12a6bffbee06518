/// Supports, joints, loads, eigenstrains and load cases as a scene file gives them.
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/expression.hpp"
#include "input_text.hpp"

namespace mixbeam::scene_conditions_test {
namespace {

/// Three legs of different directions that meet at "hub", and a ring that starts and ends at "foot 3".
std::string tripod(const std::string& supports, const std::string& more) {
  const std::string section = "rod: {EA: 1e4, GA2: 5e3, GA3: 5e3, GIt: 2, EI2: 2, EI3: 2}, ";
  const auto leg = [](const std::string& name, const std::string& start) {
    return name + ": {Start: " + start + ", End: hub, Section: rod}, ";
  };
  const std::string ring =
      "ring: {Start: foot 3, End: foot 3, Section: rod, Curve: {Shape: arc, Center: [0, -3, 0], Axis: [0, 0, 1], "
      "Angle: 6.283185307179586}}, ";
  return "Scene: {Sections: {" + section +
         "}, Points: {foot 1: [4, 0, 0], foot 2: [0, 4, 0], foot 3: [0, -4, 0], hub: [0, 0, 2]}, Members: {" +
         leg("leg 1", "foot 1") + leg("leg 2", "foot 2") + leg("strut", "foot 3") + ring + "}, Supports: {" + supports +
         "}, " + more + "}";
}

const std::string kClamps = "clamps: {Point: foot *}, ";
Scene tripod_with(const std::string& more) { return scene_from(tripod(kClamps, more)); }
Scene supported_by(const std::string& supports) { return scene_from(tripod(supports, "")); }

void expect_refused(const std::string& more, const std::vector<std::string>& parts) {
  SCOPED_TRACE(more);
  const std::string message = message_of([&] { tripod_with(more); });
  expect_in(message, parts);
  expect_in(message, {"scene.yaml:1:", "YAML path \"Scene / "});
}
void expect_support_refused(const std::string& support, const std::vector<std::string>& parts) {
  SCOPED_TRACE(support);
  expect_in(message_of([&] { supported_by("S: {Point: hub, " + support + "}"); }), parts);
}
std::string line_load(const std::string& inside) { return "Distributed Loads: {L: {" + inside + "}}, "; }
std::string point_load(const std::string& inside) { return "Point Loads: {L: {" + inside + "}}, "; }
std::string eigenstrain(const std::string& inside) { return "Eigenstrains: {E: {" + inside + "}}, "; }
std::string joint(const std::string& inside) { return "Joints: {J: {" + inside + "}}, "; }

TEST(Supports, WildcardsMeanEveryPoint) {
  const Scene scene = supported_by(kClamps);
  ASSERT_EQ(scene.supports.size(), 3U);
  EXPECT_EQ(scene.supports[0].point, "foot 1");
  EXPECT_EQ(scene.supports[2].point, "foot 3");
  EXPECT_EQ(scene.supports[2].axes, kGlobalAxes);
  expect_in(message_of([&] { supported_by(kClamps + "again: {Point: foot 2}"); }),
            {"\"foot 2\" is supported by \"clamps\""});
  expect_in(message_of([&] { supported_by("S: {Point: feet *}"); }),
            {"Supports / S / Point", "\"feet *\" is not a point", "\"foot 1\""});
}

TEST(Supports, HaveAxesOfTheirOwn) {
  const Scene scene = supported_by("S: {Point: hub, Axes: [0, 0, -5, 0, 3, 40]}");
  const Axes& axes = scene.supports[0].axes;
  EXPECT_EQ(axes[0], (Vector3{0, 0, -1}));
  EXPECT_EQ(axes[1], (Vector3{0, 1, 0}));
  EXPECT_EQ(axes[2], (Vector3{1, 0, 0}));  // -e3 x e2 = e1
  expect_support_refused("Axes: [0, 0, 1, 0, 0, -2], ", {"S / Axes", "parallel"});
  expect_support_refused("Axes: [0, 0, 1, 0, 0, 0], ", {"S / Axes", "no direction"});
  expect_support_refused("Axes: [0, 0, 1], ", {"S / Axes", "6 values"});
}

TEST(Supports, MayBeSpringsInFreeDirections) {
  const std::string free = "Fixed Displacement: [x], Fixed Rotation: [], ";
  const Scene scene =
      supported_by("S: {Point: hub, " + free + "Displacement Stiffness: [0, 3, 4], Rotation Stiffness: [5, 0, 6]}");
  EXPECT_EQ(scene.supports[0].displacement_stiffness, (Vector3{0, 3, 4}));
  EXPECT_EQ(scene.supports[0].rotation_stiffness, (Vector3{5, 0, 6}));
  expect_support_refused(free + "Displacement Stiffness: [1, 0, 0], ",
                         {"S / Displacement Stiffness", "(1, 0, 0)", "direction x", "\"Fixed Displacement\" fixes"});
  expect_support_refused("Rotation Stiffness: [0, 0, 1], ", {"S / Rotation Stiffness", "direction z"});
  expect_support_refused(free + "Displacement Stiffness: [0, -1, 0], ", {"value >= 0"});
  expect_support_refused(free + "Displacement Stiffness: [0, inf, 0], ", {"value >= 0"});
  const std::string loose = "Fixed Displacement: [], Fixed Rotation: [], ";
  EXPECT_NO_THROW(supported_by("S: {Point: hub, " + loose + "Displacement Stiffness: [1, 1, 1]}"));
  expect_support_refused(loose, {"fixes nothing", "or a spring"});
}

TEST(Supports, MoveWithAnAmplitude) {
  const std::string motion = "Prescribed Displacement: [1, 0, 0], ";
  const Scene scene = supported_by("S: {Point: hub, " + motion + "Amplitude: sin(pi*t), Stage: 3}");
  EXPECT_EQ(scene.supports[0].amplitude, "sin(pi*t)");
  EXPECT_EQ(scene.stages, 3);  // a function of t acts in all stages up to its own: there is no gap
  expect_support_refused(motion + "Amplitude: sin(pi*s), ",
                         {"S / Amplitude", "is no formula", "\"s", "a formula of t"});
  expect_support_refused(motion + "Amplitude: ln(t), ", {"S / Amplitude", "is -inf at t = 0", "finite"});
  expect_support_refused(motion + "Amplitude: 1/(t - 1/2), ", {"at t = 0.5"});
  expect_support_refused("Amplitude: t, ", {"S / Amplitude", "nothing is prescribed"});
}

TEST(PointLoads, WildcardsMeanEveryPoint) {
  const std::string force = "Force: [0, 0, 1], ";
  EXPECT_EQ(tripod_with(point_load("Point: '*', " + force)).point_loads.size(), 4U);
  const Scene follower = tripod_with(point_load("Point: foot *, " + force + "Frame: follower, Member: '*'"));
  ASSERT_EQ(follower.point_loads.size(), 3U);
  EXPECT_EQ(follower.point_loads[1].member, "leg 2");
  EXPECT_EQ(follower.point_loads[2].member, "strut");  // the ring has both ends there
  expect_refused(point_load("Point: hub, " + force + "Frame: follower, Member: leg *"),
                 {"L / Member", "\"leg *\" means several of them", "\"leg 1\", \"leg 2\", \"strut\""});
  expect_refused(point_load("Point: foot 3, " + force + "Frame: follower, Member: ring"),
                 {"\"ring\" has both ends at the point"});
}

TEST(DistributedLoads, ByFormula) {
  const Scene scene = tripod_with(
      line_load("Member: leg*, Force Formula: [0, 'max(s, x)', -3*(1 - x)], Frame: follower, Amplitude: t^2"));
  ASSERT_EQ(scene.distributed_loads.size(), 2U);
  const DistributedLoad& load = scene.distributed_loads[1];
  EXPECT_EQ(load.member, "leg 2");
  EXPECT_EQ(load.force_formula[1], "max(s, x)");
  EXPECT_EQ(load.frame, LoadFrame::follower);
  EXPECT_EQ(load.amplitude, "t^2");
  EXPECT_TRUE(load.couple_formula[0].empty());
  expect_refused(line_load("Member: strut, Couple Formula: [0, 0, 1/x]"),
                 {"L / Couple Formula", "\"1/x\" is inf at s = 0, x = 0"});
  // The strut is sqrt(20) long: the root ends before it.
  expect_refused(line_load("Member: strut, Couple Formula: [0, 0, sqrt(4 - s)]"), {"is ", "x = 1"});
  EXPECT_NO_THROW(tripod_with(line_load("Member: strut, Couple Formula: [0, 0, sqrt(4.5 - s)]")));
  expect_refused(line_load("Member: strut, Force Formula: [0, 0, 1 +]"), {"is no formula"});
  expect_refused(line_load("Member: strut, Force Formula: [0, 0, t]"), {"a formula of s, x, X, Y and Z"});
  expect_refused(line_load("Member: strut, Force Formula: [0, 0]"), {"has 2 entries"});
  expect_refused(line_load("Member: strut, Force Formula: [0, 0, 1], Force: [0, 0, 1]"),
                 {"given beside \"Force\"", "one of the two"});
  expect_refused(line_load("Member: strut"), {"loads nothing", "\"Force Formula\""});
  expect_refused(line_load("Member: srtut*, Force: [0, 0, 1]"),
                 {"\"srtut*\" is not a member", "did you mean \"strut\"?"});
}

TEST(Eigenstrains, AreRead) {
  const Scene scene =
      tripod_with(eigenstrain("Member: ring, Strain: [1e-3, 0, 0], Curvature Formula: [0, x, 0.1], Temperature: 50, "
                              "Expansion Coefficient: 1e-5, Stage: 1"));
  ASSERT_EQ(scene.eigenstrains.size(), 1U);
  EXPECT_DOUBLE_EQ(scene.eigenstrains[0].strain[0], 1e-3 + 50 * 1e-5);
  EXPECT_EQ(scene.eigenstrains[0].curvature_formula[1], "x");
  const Scene along = tripod_with(eigenstrain(
      "Member: leg *, Strain Formula: ['s > 1 ? 1e-3 : 0', 0, 0], Temperature: -50, Expansion Coefficient: 1e-5"));
  ASSERT_EQ(along.eigenstrains.size(), 2U);
  const Expression axial(along.eigenstrains[0].strain_formula[0], {"s", "x"});
  EXPECT_DOUBLE_EQ(axial({0.5, 0.1}), -5e-4);
  EXPECT_DOUBLE_EQ(axial({1.5, 0.3}), 5e-4);
  expect_refused(eigenstrain("Member: ring, Temperature: 50"), {"E / Expansion Coefficient", "missing"});
  expect_refused(eigenstrain("Member: ring"), {"strains nothing"});
  expect_refused(eigenstrain("Member: ring, Strain: [-1, 0, 0]"), {"E / Strain", "an axial strain of -1", "no length"});
  expect_refused(eigenstrain("Member: ring, Temperature: -2e5, Expansion Coefficient: 1e-5"),
                 {"E / Temperature", "-2"});
  EXPECT_NO_THROW(tripod_with(eigenstrain("Member: ring, Strain: [-2, 0, 0], Amplitude: 0.1*t")));
  expect_refused(eigenstrain("Member: ring, End Turn: [0, 3, -1]"), {"E / End Turn", "3.16", "below pi"});
  EXPECT_NO_THROW(tripod_with(eigenstrain("Member: ring, Start Turn: [0, 3, 0]")));
  expect_refused(eigenstrain("Member: rings, Strain: [1, 0, 0]"), {"did you mean \"ring\"?"});
}

TEST(Joints, AreRead) {
  const Scene scene = tripod_with(joint("Point: hub, Members: [leg *], Kind: hinge, Axis: [0, 2, 0], Stiffness: 7"));
  ASSERT_EQ(scene.joints.size(), 1U);
  const Joint& hinge = scene.joints[0];
  EXPECT_EQ(std::tie(hinge.name, hinge.point, hinge.kind, hinge.axis, hinge.stiffness, hinge.together),
            std::tuple("J", "hub", JointKind::hinge, Vector3{0, 2, 0}, 7.0, false));
  EXPECT_EQ(hinge.members, (std::vector<std::string>{"leg 1", "leg 2"}));
  const std::string yes = "Together: true, ";
  const auto together = [&](const std::string& members) {
    return joint("Point: hub, Members: " + members + ", Kind: ball, " + yes);
  };
  EXPECT_TRUE(tripod_with(together("[leg 1, leg 2]")).joints[0].together);
  expect_refused(together("[leg 1]"), {"J / Together", "only \"leg 1\"", "two members or more"});
}

TEST(Joints, AreRefusedWithAPlace) {
  const std::string hub = "Point: hub, ", ball = "Kind: ball, ";
  const std::string hinge = "Kind: hinge, ", axis = "Axis: [0, 1, 0], ";
  expect_refused(joint(hub + "Members: [leg 1, leg 2, strut], " + ball),
                 {"J / Members", "all members at \"hub\" are in joints", "none is left"});
  expect_refused(joint(hub + "Members: ['*'], " + ball), {"all members at \"hub\""});
  expect_refused(joint(hub + "Members: [leg 1, leg *], " + ball), {"\"leg 1\" is in a joint at \"hub\" already"});
  const std::string second = "K: {" + hub + "Members: [leg 1], " + ball + "}, ";
  expect_refused("Joints: {J: {" + hub + "Members: [leg 1], " + ball + "}, " + second + "}, ",
                 {"Joints / K / Members", "\"leg 1\" is in a joint"});
  expect_refused(joint(hub + "Members: [ring], " + ball), {"\"ring\"", "members with one end at \"hub\""});
  expect_refused(joint("Point: foot 3, Members: [ring], " + ball), {"one end at \"foot 3\": \"strut\""});
  expect_refused(joint(hub + "Members: [lge 1], " + ball), {"is not a member", "did you mean \"leg 1\"?"});
  expect_refused(joint(hub + "Members: [bar *], " + ball), {"\"bar *\"", "members with one end at \"hub\""});
  expect_refused(joint("Point: hbu, Members: [leg 1], " + ball), {"did you mean \"hub\"?"});
  expect_refused(joint(hub + "Members: [], " + ball), {"is empty"});
  expect_refused(joint(hub + "Members: [leg 1], Kind: hing"), {"did you mean \"hinge\"?"});
  expect_refused(joint(hub + "Members: [leg 1], " + hinge), {"J / Axis", "missing"});
  expect_refused(joint(hub + "Members: [leg 1], " + hinge + "Axis: [0, 0, 0]"), {"no direction"});
  expect_refused(joint(hub + "Members: [leg 1], " + ball + axis), {"J / Axis", "no meaning for \"Kind\" = \"ball\""});
  expect_refused(joint(hub + "Members: [leg 1], " + hinge + axis + "Stiffness: -1"), {"value >= 0"});
}

// The member's end has a triad of its own, which the load on the point does not see.
TEST(Joints, AreNotPassedByFollowerLoads) {
  const auto pinned = [](const std::string& member) {
    return joint("Point: hub, Members: [leg 1], Kind: ball") +
           "Point Loads: {push: {Point: hub, Force: [0, 0, 1], Frame: follower, Member: " + member + "}}, ";
  };
  EXPECT_EQ(tripod_with(pinned("leg 2")).point_loads.back().member, "leg 2");
  expect_refused(pinned("leg 1"), {"scene.yaml:1:", "\"Scene / Point Loads / push / Member\"",
                                   "value \"leg 1\" is in a joint at the point", "not in a joint there: \"leg 2\""});
}

const std::string kCases = "Load Cases: [wind, snow], ";

std::string force_at_hub(const std::string& name, const std::string& more) {
  return name + ": {Point: hub, Force: [0, 0, 1], " + more + "}, ";
}

TEST(LoadCases, SelectWhatActs) {
  const Scene scene =
      tripod_with(kCases + "Point Loads: {" + force_at_hub("always", "") +
                  force_at_hub("gust", "Case: wind, Stage: 2") + force_at_hub("drift", "Case: snow") + "}");
  EXPECT_EQ(scene.load_cases, (std::vector<std::string>{"wind", "snow"}));
  EXPECT_EQ(scene.stages, 2);
  const Scene wind = scene_of_case(scene, "wind");
  ASSERT_EQ(wind.point_loads.size(), 2U);
  EXPECT_EQ(wind.point_loads[1].stage, 2);
  EXPECT_EQ(wind.stages, 2);
  EXPECT_TRUE(wind.load_cases.empty());
  EXPECT_EQ(scene_of_case(scene, "snow").point_loads.size(), 2U);
  EXPECT_EQ(scene_of_case(scene, "snow").stages, 1);
  EXPECT_EQ(scene_of_case(scene, "").point_loads.size(), 1U);
  EXPECT_THROW(scene_of_case(scene, "sonw"), std::invalid_argument);
}

TEST(LoadCases, MoveSupportsInTheirCaseOnly) {
  const std::string moved = "S: {Point: foot 1, Prescribed Displacement: [1, 0, 0], Amplitude: t, Case: snow}, ";
  const Scene scene = scene_from(tripod(moved, kCases));
  EXPECT_EQ(scene_of_case(scene, "snow").supports[0].prescribed_displacement[0], 1.0);
  EXPECT_EQ(scene_of_case(scene, "snow").supports[0].amplitude, "t");
  const Scene wind = scene_of_case(scene, "wind");
  ASSERT_EQ(wind.supports.size(), 1U);
  EXPECT_TRUE(wind.supports[0].displacement_fixed[0]);
  EXPECT_EQ(wind.supports[0].prescribed_displacement[0], 0.0);
  EXPECT_EQ(wind.supports[0].amplitude, "");
}

TEST(LoadCases, HaveStagesWithoutGapsEach) {
  const auto loads = [](const std::string& common, const std::string& first, const std::string& second) {
    return kCases + "Point Loads: {" + force_at_hub("a", common) + force_at_hub("b", "Case: wind, " + first) +
           force_at_hub("c", "Case: snow, " + second) + "}, ";
  };
  EXPECT_NO_THROW(tripod_with(loads("", "Stage: 2, ", "Stage: 2")));
  EXPECT_NO_THROW(tripod_with(loads("Stage: 2, ", "Stage: 1, ", "Stage: 1")));
  expect_refused(loads("", "Stage: 2, ", "Stage: 3"),
                 {"Point Loads / c / Stage", "value 3", "stage 2 of load case \"snow\""});
  expect_refused(loads("Stage: 2, ", "Stage: 1, ", "Stage: 3"),
                 {"Point Loads / a / Stage", "stage 1 of load case \"snow\""});
  expect_refused(loads("", "'Case ': '', ", ""), {"unknown name"});
}

TEST(LoadCases, AreRefusedWithThePlace) {
  expect_refused(kCases + "Point Loads: {" + force_at_hub("a", "Case: wnid") + "}, ",
                 {"a / Case", "\"wnid\" is not a load case", "\"wind\", \"snow\"", "did you mean \"wind\"?"});
  expect_refused("Point Loads: {" + force_at_hub("a", "Case: wind") + "}, ", {"a / Case", "(none)"});
  expect_refused("Load Cases: [wind, wind], ", {"Scene / Load Cases", "\"wind\" twice"});
}

TEST(LoadCases, AreCombined) {
  const std::string push = "push: {Point: hub, Force: [1, 0, 0], Case: wind}, ";
  const std::string loads = kCases + "Point Loads: {" + push + "}, ";
  const auto combined = [&](const std::string& entries) { return loads + "Combinations: {both: {" + entries + "}}, "; };
  const Scene scene = tripod_with(combined("wind: 1.5, snow: -0.5, Stage 1: 2"));
  EXPECT_EQ(scene_of_case(scene, "both").point_loads[0].force, (Vector3{3, 0, 0}));
  EXPECT_EQ(scene_of_case(scene, "wind").point_loads[0].force, (Vector3{1, 0, 0}));
  EXPECT_TRUE(scene_of_case(scene, "snow").point_loads.empty());
  expect_refused(combined("wnd: 1"), {"Combinations / both / wnd", "did you mean \"wind\"?"});
  expect_refused(combined("Stage 0: 1"), {"not a load case"});
  expect_refused(combined("wind: 1, Stage 2: 1"), {"Combinations / both / Stage 2", "nothing acts in this stage"});
  expect_refused(loads + "Imperfection: {Case: wnd}, ", {"Imperfection / Case", "did you mean \"wind\"?"});
  expect_refused(combined(""), {"Combinations / both", "0 entries"});
  expect_refused(loads + "Combinations: {wind: {wind: 1}}, ", {"the name of a load case too"});
}

TEST(LineLoads, ActOnPartsAndOnProjections) {
  const auto line = [](const std::string& more) {
    return "Distributed Loads: {q: {Member: leg 1, Force: [0, 0, -1], " + more + "}}, ";
  };
  const Scene part = tripod_with(line("Range: [0.25, 0.5], Per: projected length"));
  EXPECT_TRUE(part.distributed_loads[0].is_projected);
  ASSERT_EQ(part.members[0].inner_points.size(), 2U);
  EXPECT_EQ(part.members[0].inner_points[1].position, 0.5);
  EXPECT_TRUE(tripod_with(line("")).members[0].inner_points.empty());
  expect_refused(line("Range: [0.5, 0.25]"), {"Distributed Loads / q / Range", "where it begins"});
  expect_refused(line("Per: projected length, Frame: follower"), {"/ q / Per", "for dead ones"});
  const std::string couple = "Per: projected length, Couple: [1, 0, 0], ";
  expect_refused(line(couple), {"/ q / Per", "alone"});
}

std::string heavy(const std::string& more) {
  return changed(tripod(kClamps, more), "EA: 1e4, ", "EA: 1e4, Mass: 0.5, ");
}

TEST(Gravity, NeedsAMass) {
  expect_refused("Gravity: {Acceleration: [0, 0, -9.81]}, ", {"Scene / Gravity", "\"Density\"", "\"Mass\""});
  const Scene scene = scene_from(heavy("Gravity: {Acceleration: [0, 0, -10]}"));
  ASSERT_EQ(scene.distributed_loads.size(), scene.members.size());
  EXPECT_EQ(scene.distributed_loads[0].force, (Vector3{0, 0, -5}));
}

TEST(Gravity, MayBeSeveralOfStagesAndCases) {
  const auto text = [](const std::string& gravity) { return heavy(kCases + "Gravity: {" + gravity + "}"); };
  const Scene scene =
      scene_from(text("dead: {Acceleration: [0, 0, -10]}, quake: {Acceleration: [3, 0, 0], Stage: 2, Case: wind}"));
  const std::size_t members = scene.members.size();
  ASSERT_EQ(scene.distributed_loads.size(), 2 * members);
  EXPECT_EQ(scene.distributed_loads[0].force, (Vector3{0, 0, -5}));
  EXPECT_EQ(scene.distributed_loads[members].force, (Vector3{1.5, 0, 0}));
  EXPECT_EQ(scene.distributed_loads[members].stage, 2);
  EXPECT_EQ(scene.distributed_loads[members].load_case, "wind");
  EXPECT_EQ(scene.gravity, 10.0);
  const auto refused = [&](const std::string& gravity, const std::vector<std::string>& parts) {
    expect_in(message_of([&] { scene_from(text(gravity)); }), parts);
  };
  refused("", {"Scene / Gravity", "Acceleration"});
  refused("dead: {Stage: 1}", {"Gravity / dead / Acceleration", "missing"});
  refused("dead: {Acceleration: [0, 0, -10]}, Stage: 2", {"Gravity / Stage", "beside weights"});
  refused("Acceleraton: [0, 0, -10]", {"Gravity / Acceleraton", "did you mean \"Acceleration\""});
}

TEST(RotatingFrame, TurnsAboutAnAxisOfAnyLength) {
  const auto frame = [](const std::string& inside) { return heavy("Rotating Frame: {" + inside + "}"); };
  const Scene scene = scene_from(frame("Point: [1, 0, 0], Axis: [0, 3, 4], Angular Velocity: 10, Stage: 1"));
  ASSERT_EQ(scene.rotating_frames.size(), 1U);
  EXPECT_EQ(scene.rotating_frames[0].velocity, (Vector3{0, 6, 8}));
  const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
    expect_in(message_of([&] { scene_from(text); }), parts);
  };
  refused(frame("Angular Velocity: 10"), {"Rotating Frame / Axis", "missing"});
  refused(frame("Axis: [0, 0, 0], Angular Velocity: 1"), {"Rotating Frame / Axis", "no direction"});
  refused(frame("Axis: [0, 0, 1], Velocity: 1"), {"Rotating Frame / Velocity", "\"Angular Velocity\""});
  refused(tripod(kClamps, "Rotating Frame: {Axis: [0, 0, 1], Angular Velocity: 1}"),
          {"Scene / Rotating Frame", "nothing has a mass", "\"Density\""});
}

TEST(NamePatterns, ExactNamesWin) {
  // A member whose own name contains a star.
  const std::string starred =
      changed(tripod(kClamps, line_load("Member: leg *, Force: [1, 0, 0]")), "strut: {", "leg *: {");
  const Scene scene = scene_from(starred);
  ASSERT_EQ(scene.distributed_loads.size(), 1U);
  EXPECT_EQ(scene.distributed_loads[0].member, "leg *");
}

}  // namespace
}  // namespace mixbeam::scene_conditions_test
