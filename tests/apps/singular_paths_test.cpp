// What a user of the program sees where a path passes near a singular point: answers, exit codes, words. The answers of
// the solver itself are in problems/known_paths_test.cpp.
#include "tests/apps/process.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

Ended run(const std::string& command, const std::string& scene, const fs::path& folder) {
  write_text(folder / "scene.yaml", scene);
  std::vector<std::string> words = {command, (folder / "scene.yaml").string()};
  if (command != "check")
    for (const std::string& word : {std::string("--output"), folder.string(), std::string("--threads"),
                                    std::string("1"), std::string("--summary"), (folder / "summary.json").string()})
      words.push_back(word);
  return run_process(program("mixbeam"), words, folder);
}

/// 1.2 times Euler's load and a hundredth of it across.
const std::string kForce = "-2.9608813203268074, 0.029608813203268074, 0";

TEST(SingularPaths, TheImperfectColumnEndsOnItsSide) {
  const auto folder = folder_for("singular_right");
  const Ended right = run("run", column(kForce, expected("displacement", tip("y"), "0.65716809204")), folder);
  EXPECT_EQ(right.exit_code, 0) << right.out << right.err;
  EXPECT_EQ(run("run", column(kForce, expected("displacement", tip("y"), "0.65717")), folder).exit_code, 1);
}

TEST(SingularPaths, ACriticalPointThatDoesNotComeIsAFailedCheck) {
  const auto folder = folder_for("singular_missing");
  const std::string critical = "Critical Point: 1, ";
  const Ended missing = run("run", column(kForce, expected("load factor", critical, "0.5")), folder);
  EXPECT_EQ(missing.exit_code, 1) << missing.out << missing.err;
  EXPECT_TRUE(fs::exists(folder / "summary.json"));
}

TEST(SingularPaths, CheckTellsOfALoadFactorThatNoStepEndsAt) {
  const auto folder = folder_for("singular_load_factor");
  const std::string early = "Load Factor: 0.3, ";
  const Ended off = run("check", column(kForce, expected("displacement", tip("y") + early, "0.1")), folder);
  EXPECT_EQ(off.exit_code, 2) << off.out;
  expect_in(off.out + off.err, {"Load Factor"});
  const std::string end = "Load Factor: 1, ";
  EXPECT_EQ(run("check", column(kForce, expected("displacement", tip("y") + end, "0.1")), folder).exit_code, 0);
}

/// The straight column is not moved sideways by its thrust, so no displacement there can be driven by it.
TEST(SingularPaths, ADisplacementThatTheLoadDoesNotMoveIsNamed) {
  const auto folder = folder_for("singular_control");
  for (const std::string component : {"y", "x"}) {
    const std::string control = "Analysis: {Control: {" + tip(component) + "Target: -0.1}}\n";
    const Ended still = run("run", column("-1, 0, 0", control), folder);
    EXPECT_TRUE(still.exit_code == 2 || still.exit_code == 3) << still.exit_code;
    expect_in(still.out + still.err, {"not move", "tip"});
    EXPECT_EQ((still.out + still.err).find("in 0 iterations"), std::string::npos);
  }
}

const std::string kJump = "Snap: jump, ";

TEST(SingularPaths, JumpsAreToldAndCounted) {
  const auto folder = folder_for("singular_jumps");
  const Ended one = run("run", column("-4, 0, 0", "Analysis: {" + kJump + "}\n" + expected("jumps", "", "1")), folder);
  EXPECT_EQ(one.exit_code, 0) << one.out << one.err;
  expect_in(one.out, {"scene: jump between load factors ", "energy released ", "point \"tip\"", "stable: true"});
  expect_in(text_of(folder / "summary.json"), {"\"jumps\"", "\"energy_released\"", "\"from_load_factor\""});
  expect_in(text_of(folder / "scene-monitor.csv"), {"jump.energy_released", "jump.largest_displacement", "jumps"});
  const std::string forbidden = "Analysis: {" + kJump + "}\n" + expected("jumps", "", "0");
  EXPECT_EQ(run("run", column("-4, 0, 0", forbidden), folder).exit_code, 1);
  EXPECT_EQ(run("run", column("-2, 0, 0", forbidden), folder).exit_code, 0) << "below the critical load";
}

TEST(SingularPaths, JumpsNeedAPotential) {
  const auto folder = folder_for("singular_no_potential");
  const std::string scene = column("0, 0, 1", "Analysis: {" + kJump + "}");
  const Ended moment = run("run", changed(scene, "Force", "Moment"), folder);
  EXPECT_EQ(moment.exit_code, 2);
  expect_in(moment.err, {"scene.yaml:", "\"Scene / Point Loads / load / Moment\"", "no potential", "allowed: dead"});
  const std::string traced = column("-4, 0, 0", "Analysis: {" + kJump + "Trace: true}");
  const Ended both = run("run", traced, folder);
  EXPECT_EQ(both.exit_code, 2);
  expect_in(both.err, {"\"Analysis / Trace\"", "allowed: false"});
  const Ended misspelt = run("run", changed(traced, "jump", "jmup"), folder);
  EXPECT_EQ(misspelt.exit_code, 2);
  expect_in(misspelt.err, {"\"Analysis / Snap\"", "did you mean \"jump\"?"});
}

/// P from 2 to 6 with a force across of 0.01: y of the tip by shooting.
TEST(SingularPaths, ABatchOfImperfectColumns) {
  const auto folder = folder_for("singular_batch");
  const std::string varied = "Vary: {P: {Parameter: 'Point Loads/load/Force[0]', First: -2, Last: -6, Count: 5}}, ";
  const std::string value = expected("displacement", tip("y"), "0.1");
  const std::string loose = changed(value, "1e-8", "10");
  const Ended ended = run("batch", column("-1, 0.01, 0", loose + "Batch: {" + varied + "Output: expected}"), folder);
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  const std::string table = text_of(folder / "scene-batch.csv");
  std::istringstream rows(table);
  std::string row;
  std::getline(rows, row);
  const std::vector<double> right = {0.01738200818, 0.66614571490, 0.80251319246, 0.79535909617, 0.76109671324};
  for (const double y : right) {
    ASSERT_TRUE(std::getline(rows, row)) << table;
    const auto holds = [&row](double y_of_tip) {
      bool found = false;
      std::istringstream cells(row);
      for (std::string cell; std::getline(cells, cell, ',');) {
        char* end = nullptr;
        const double number = std::strtod(cell.c_str(), &end);
        found = found || (end != cell.c_str() && std::abs(number - y_of_tip) < 1e-8);
      }
      return found;
    };
    EXPECT_TRUE(holds(y)) << "no y = " << y << " in " << row;
    EXPECT_FALSE(holds(-y)) << "the other side passes";
    EXPECT_FALSE(holds(1.001 * y)) << "a wrong answer passes";
  }
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

TEST(SingularPaths, ADomeWhosePathReturnsIsFollowedAgainMoreClosely) {
  const auto folder = folder_for("singular_dome");
  const Ended followed = run("run", dome(kEnd, ""), folder);
  EXPECT_EQ(followed.exit_code, 0) << followed.out << followed.err;
  const Ended jumped = run("run", dome(kEnd, "Analysis: {Snap: jump}\n"), folder_for("singular_dome_jump"));
  EXPECT_EQ(jumped.exit_code, 0) << jumped.out << jumped.err;
  EXPECT_EQ(run("run", dome("-0.5682", ""), folder).exit_code, 1);
}

}  // namespace
}  // namespace mixbeam
