// What a user of the program sees where a path passes near a singular point: answers, exit codes, words. The answers of
// the solver itself are in problems/known_paths_test.cpp.
#include "mixbeam_files.hpp"

namespace mixbeam {
namespace {

/// An inextensible cantilever of length and stiffness 1 along x, in the plane, under this force at its tip; `rest`:
/// lists beside the scene.
std::string column(const std::string& force, const std::string& rest) {
  return R"yaml(Scene:
  Sections: {rod: {Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}
  Points: {clamp: [0, 0, 0], tip: [1, 0, 0]}
  Members: {rod: {Start: clamp, End: tip, Section: rod, Order: 5, Elements: 16}}
  Supports: {clamp: {Point: clamp}, plane: {Point: tip, Fixed Displacement: [z], Fixed Rotation: [x, y]}}
  Point Loads: {load: {Point: tip, Force: [)yaml" +
         force + "]}}\n" + rest;
}

std::string expected(const std::string& quantity, const std::string& more, const std::string& value) {
  return "Expected: {value: {Quantity: " + quantity + ", " + more + "Value: " + value +
         ", Absolute Tolerance: 1e-8, Source: shooting on the rod equations}}\n";
}
std::string tip(const std::string& component) { return "Point: tip, Component: " + component + ", "; }

class SingularPaths : public MixbeamTest {};

/// 1.2 times Euler's load and a hundredth of it across.
const std::string kForce = "-2.9608813203268074, 0.029608813203268074, 0";

TEST_F(SingularPaths, TheImperfectColumnEndsOnItsSide) {
  expect_code(kOk, run_scene(column(kForce, expected("displacement", tip("y"), "0.65716809204"))));
  expect_code(kCheckFailed, run_scene(column(kForce, expected("displacement", tip("y"), "0.65717"))));
}

/// The straight column is not moved sideways by its thrust, so no displacement there can be driven by it.
TEST_F(SingularPaths, ADisplacementThatTheLoadDoesNotMoveIsNamed) {
  for (const std::string component : {"y", "x"}) {
    const std::string control = "Analysis: {Control: {" + tip(component) + "Target: -0.1}}\n";
    const Ended still = run_scene(column("-1, 0, 0", control));
    EXPECT_TRUE(still.exit_code == 2 || still.exit_code == 3) << still.exit_code;
    expect_in(still.out + still.err, {"not move", "tip"});
    EXPECT_EQ((still.out + still.err).find("in 0 iterations"), std::string::npos);
  }
}

const std::string kJump = "Snap: jump, ";

TEST_F(SingularPaths, JumpsAreToldAndCounted) {
  expect_in(
      expect_code(kOk, run_scene(column("-4, 0, 0", "Analysis: {" + kJump + "}\n" + expected("jumps", "", "1")))).out,
      {"scene: jump between load factors ", "energy released ", "point \"tip\"", "stable: true"});
  expect_in(text("summary.json"), {"\"jumps\"", "\"energy_released\"", "\"from_load_factor\""});
  expect_in(text("results/scene-monitor.csv"), {"jump.energy_released", "jump.largest_displacement", "jumps"});
  const std::string forbidden = "Analysis: {" + kJump + "}\n" + expected("jumps", "", "0");
  expect_code(kCheckFailed, run_scene(column("-4, 0, 0", forbidden)));
  expect_code(kOk, run_scene(column("-2, 0, 0", forbidden)));
}

TEST_F(SingularPaths, JumpsNeedAPotential) {
  const std::string scene = column("0, 0, 1", "Analysis: {" + kJump + "}");
  expect_refused(run_scene(changed(scene, "Force", "Moment")),
                 {"scene.yaml:", "\"Scene / Point Loads / load / Moment\"", "no potential", "allowed: dead"});
  const std::string traced = column("-4, 0, 0", "Analysis: {" + kJump + "Trace: true}");
  expect_refused(run_scene(traced), {"\"Analysis / Trace\"", "allowed: false"});
  expect_refused(run_scene(changed(traced, "jump", "jmup")), {"\"Analysis / Snap\"", "did you mean \"jump\"?"});
}

/// P from 2 to 6 with a force across of 0.01: y of the tip by shooting.
TEST_F(SingularPaths, ABatchOfImperfectColumns) {
  const std::string varied = "Vary: {P: {Parameter: 'Point Loads/load/Force[0]', First: -2, Last: -6, Count: 5}}, ";
  const std::string value = expected("displacement", tip("y"), "0.1");
  const std::string loose = changed(value, "1e-8", "10");
  expect_code(kOk,
              mixbeam({"batch", write_scene(column("-1, 0.01, 0", loose + "Batch: {" + varied + "Output: expected}")),
                       "--output", "results"}));
  const std::vector<Row> rows = rows_of(folder_ / "results/scene-batch.csv");
  const std::vector<double> right = {0.01738200818, 0.66614571490, 0.80251319246, 0.79535909617, 0.76109671324};
  ASSERT_EQ(rows.size(), right.size());
  for (std::size_t i = 0; i < right.size(); ++i) EXPECT_NEAR(std::stod(rows[i].at("value")), right[i], 1e-8);
}

/// Three legs, nearly symmetric: the path comes close to others, and the first pass changes to one of them and returns
/// to an earlier state. `value`: height of the apex at the end, that of the minimum of energy that Snap = jump finds;
/// the two share no step.
std::string dome(const std::string& value, const std::string& rest) {
  return R"yaml(Scene:
  Sections: {rod: {EA: 3000, GA2: 1500, GA3: 1500, GIt: 0.8, EI2: 1, EI3: 1}}
  Points:
    apex: [0, 0, 0.3]
    foot0: [0.9766109484880079, 0.21501408161642258, 0]
    foot1: [-0.6745131310952063, 0.7382628501964196, 0]
    foot2: [-0.30209781739280145, -0.9532769318128419, 0]
  Members:
    leg0: {Start: foot0, Second Axis: [-0.21501408161642258, 0.9766109484880079, 0], End: apex, Order: 5, Elements: 6}
    leg1: {Start: foot1, Second Axis: [-0.7382628501964196, -0.6745131310952063, 0], End: apex, Order: 5, Elements: 6}
    leg2: {Start: foot2, Second Axis: [0.9532769318128419, -0.30209781739280145, 0], End: apex, Order: 5, Elements: 6}
  Supports: {feet: {Point: "foot*"}}
  Point Loads: {load: {Point: apex, Force: [0.009632480637501132, -0.023869332136037428, -52.4]}}
Expected: {value: {Quantity: displacement, Point: apex, Component: z, Value: )yaml" +
         value + ", Absolute Tolerance: 1e-7, Source: Snap = jump}}\n" + rest;
}
const std::string kEnd = "-0.5682796882";

TEST_F(SingularPaths, ADomeWhosePathReturnsIsFollowedAgainMoreClosely) {
  expect_code(kOk, run_scene(dome(kEnd, "")));
  expect_code(kOk, run_scene(dome(kEnd, "Analysis: {Snap: jump}\n")));
  expect_code(kCheckFailed, run_scene(dome("-0.5682", "")));
}

}  // namespace
}  // namespace mixbeam
