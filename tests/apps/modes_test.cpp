/// Natural modes as `mixbeam run` answers them: files, terminal, quantities, and what it refuses.
#include "apps/common/run/followed_points.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/text/number_text.hpp"
#include "mixbeam_files.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/same_bits.hpp"

namespace mixbeam::modes_test {
namespace {

/// First frequency of a cantilever, EI = m = L = 1; the mesh leaves 1e-12.
constexpr double kFrequency = 1.875104068711961 * 1.875104068711961 / (2.0 * 3.14159265358979323846);

std::string scene(const std::string& section, const std::string& supports, const std::string& modes,
                  const std::string& more = "") {
  return "Scene:\n  Sections: {rod: {EA: 1e9, GA2: 1e9, GA3: 1e9, GIt: 1, EI2: 1, EI3: 1" + section + R"yaml(}}
  Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Members: {beam: {Start: wall, End: tip, Section: rod, Order: 4, Elements: 8}}
)yaml" + supports +
         "Analysis: {Modes: {" + modes + "}}\n" + more;
}

const std::string kClamp = "  Supports: {clamp: {Point: wall}}\n", kMass = ", Mass: 1";

class Modes : public MixbeamTest {
 protected:
  Ended run(const std::string& section, const std::string& supports, const std::string& modes,
            const std::string& more = "") const {
    return run_scene(scene(section, supports, modes, more));
  }
  double number(const std::string& group, const std::string& attribute) const {
    return h5::number(folder_ / "results/scene.h5", group, attribute);
  }
};

TEST_F(Modes, AreInFileTerminalAndQuantities) {
  const std::string quantity =
      "Quantities: {f: {Quantity: natural frequency, Mode: 1}}\nExpected: {f: {Quantity: f, "
      "Relative Tolerance: 1e-6, Source: closed form, Value: ";
  Ended ended = run(kMass, kClamp, "Number: 2, In Plane: true", quantity + std::to_string(kFrequency) + "}}\n");
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  expect_in(ended.out, {"natural modes", "3.516015"});
  EXPECT_EQ(ended.out.find("nothing acts"), std::string::npos);
  EXPECT_EQ(ended.out.find("not confirmed"), std::string::npos);
  EXPECT_NEAR(number("steps/000001/vibration/0", "frequency"), kFrequency, 1e-8 * kFrequency);
  ended = run(kMass, kClamp, "Number: 2, In Plane: true", quantity + std::to_string(1.01 * kFrequency) + "}}\n");
  EXPECT_EQ(ended.exit_code, 1);
}

/// So meshes are chosen for them, and limits count.
TEST_F(Modes, FrequenciesHaveEstimatedErrors) {
  const std::string limit = "Limit: 0.5596";
  const std::string quantity = "Quantities: {f: {Quantity: natural frequency, Mode: 1, " + limit +
                               "}}\nExpected: {f: {" +
                               "Quantity: f, Relative Tolerance: 1e-8, Source: closed form, Value: ";
  std::string text = scene(kMass, kClamp, "Number: 2, In Plane: true", quantity + shortest(kFrequency) + "}}\n");
  text =
      changed(changed(text, ", Order: 4, Elements: 8", ""), "Scene:\n", "Scene:\n  Accuracy: 1e-8\n  Accuracy Of: f\n");
  expect_code(kOk, run_scene(text));
  EXPECT_EQ(run_scene(changed(text, limit, "Limit: 0.5595")).exit_code, 1);  // the value is 0.55959
}

TEST_F(Modes, SupportsMayBeMissingWhereNothingActs) {
  expect_in(expect_code(kOk, run(kMass, "", "Number: 5, In Plane: true")).out,
            {"22.373285"});  // of a slender beam; shear takes 6e-9 of it
  expect_refused(run(kMass, "  Point Loads: {push: {Point: tip, Force: [0, 1, 0]}}\n", "Number: 5"),
                 {"Supports", "no support"});
}

/// A frame in space without supports, whose tangent has pivots that are exactly zero. Its first elastic frequency is
/// that of a spectral program with 6x6 masses, written for this.
TEST_F(Modes, FreeFramesInSpaceHaveTheirOwnFrequencies) {
  const std::string section =
      "GA2: 50, GA3: 40, GIt: 1, EI2: 1.2, EI3: 0.8, Mass: 1.3, "
      "Rotary Inertia: [0.009, 0.004, 0.006], Mass Offset: [0.1, 0]";
  const std::string mesh = "Order: 6, Elements: 3";
  const Ended ended =
      expect_code(kOk, run_scene("Scene:\n  Sections: {rod: {EA: 1000, " + section + R"yaml(}}
  Points: {a: [0, 0, 0], corner: [1, 0, 0], b: [1, 1, 0.5]}
  Members:
    one: {Start: a, End: corner, Second Axis: [0, 1, 0], )yaml" +
                                 mesh + "}\n" + "    two: {Start: b, End: corner, Second Axis: [0, 0, 1], " + mesh +
                                 "}\n" + "Analysis: {Modes: {Number: 7}}\n"));
  expect_in(ended.out, {"7         3.01573025"});
  EXPECT_EQ(ended.out.find("not confirmed"), std::string::npos);
}

/// Of a column under a dead load and one whose load grows by a formula, without and with fixed steps: the path stops at
/// load factors that are listed, and nowhere else are there modes but at its end.
TEST_F(Modes, AreAtTheLoadFactorsAskedFor) {
  const std::string asked = "Number: 1, In Plane: true, Load Factors: [0.6, 0, 0.3]";
  for (const std::string amplitude : {"", ", Amplitude: t^2"})
    for (const std::string solver : {"", "Solver: {Load Path: {Method: fixed, Steps: 2}}\n"}) {
      expect_code(kOk, run(kMass, kClamp + "  Point Loads: {push: {Point: tip, Force: [-2, 0, 0]" + amplitude + "}}\n",
                           asked, solver));
      std::vector<double> with_modes;
      const FileContents contents = contents_of(folder_ / "results/scene.h5");
      for (int step = 0; step < 100; ++step) {
        std::string name = "steps/000000";
        name.replace(name.size() - std::to_string(step).size(), std::string::npos, std::to_string(step));
        if (contents.count(name + "/vibration/0@frequency") > 0) with_modes.push_back(number(name, "load_factor"));
      }
      ASSERT_EQ(with_modes.size(), 4U) << amplitude << solver;
      for (size_t i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(with_modes[i], (std::array<double, 4>{0.0, 0.3, 0.6, 1.0})[i]);
    }
  expect_refused(run(kMass, kClamp, "Number: 1, Load Factors: [0.5, 2]"),
                 {"\"Analysis / Modes / Load Factors\"", "no load factor of the path"});
}

/// Bending falls with the load through the frequency of torsion, pi/2 sqrt(GIt/J1), between load factors 0.5 and 0.6:
/// its column stays that of torsion, also in a run that goes on after the crossing or before it.
TEST_F(Modes, KeepTheirNumbersWhereFrequenciesCross) {
  const std::string supports =
      "  Supports:\n    hinge: {Point: wall, Fixed Displacement: [x, y, z], Fixed Rotation: [x]}\n"
      "    slide: {Point: tip, Fixed Displacement: [y, z], Fixed Rotation: []}\n"
      "  Point Loads: {push: {Point: tip, Force: [-9, 0, 0]}}\n";
  const std::string text =
      changed(scene(kMass + ", Rotary Inertia: [2e-4, 1e-4, 1e-4]", supports, "Number: 3, At: every step",
                    "Solver: {Load Path: {Method: fixed, Steps: 5}}\n"),
              "GIt: 1, EI2: 1, EI3: 1", "GIt: 4e-3, EI2: 1, EI3: 1.1");
  expect_in(expect_code(kOk, run_scene(text)).out, {"frequencies over the path", "motion 3"});
  const fs::path table = folder_ / "results/scene-frequencies.csv";
  const std::string whole = text_of(table);
  const double torsion = 0.5 * 3.14159265358979323846 * std::sqrt(4e-3 / 2e-4);
  std::istringstream lines(whole);
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "step,load_factor,omega_1,omega_2,omega_3,frequency_1,frequency_2,frequency_3");
  for (int step = 0; step <= 5; ++step) {
    ASSERT_TRUE(std::getline(lines, line));
    double number = 0.0, load_factor = 0.0, first = 0.0, second = 0.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &number, &load_factor, &first, &second), 4) << line;
    EXPECT_NEAR(first, torsion, 1e-8 * torsion) << line;
    EXPECT_EQ(second < torsion, step >= 3) << line;  // the twin: by their order the columns would change places
  }
  for (const char* from : {"2", "4"}) {
    expect_code(kOk, mixbeam({"resume", file("results/scene.h5"), "--from", from}));
    EXPECT_EQ(text_of(table), whole) << from;
  }
}

/// Series that a damaged file has lost come from its steps, those of frequencies and jumps too.
TEST_F(Modes, SeriesAreRecomputedFromStoredSteps) {
  const std::string load = "  Point Loads: {push: {Point: tip, Force: [-4, 0, 0]}}\n";
  const std::string plane = "    plane: {Point: tip, Fixed Displacement: [z], Fixed Rotation: [x, y]}\n";
  const std::string clamp = "  Supports:\n    clamp: {Point: wall}\n" + plane;
  const std::string quantities = "Quantities: {f: {Quantity: natural frequency, Mode: 1}, count: {Quantity: jumps}}\n";
  const std::string text =
      changed(changed(scene(kMass, clamp + load, "Number: 1, In Plane: true, At: every step", quantities),
                      "EA: 1e9, GA2: 1e9, GA3: 1e9", "EA: 1e4, GA2: 1e4, GA3: 1e4"),
              "Analysis: {", "Analysis: {Snap: jump, ");
  expect_code(kOk, run_scene(text));
  std::ostringstream said;
  Application app;
  app.communicator = test::this_rank();
  app.terminal = &said;
  read_scene_file(app, file("scene.yaml"), mixbeam_definition());
  Simulation simulation(app.scene, app.solver, app.communicator);
  const StoredRun stored(folder_ / "results/scene.h5");
  EXPECT_GT(stored.steps().back().jumps, 0);
  const StoredRun again = with_all_series(stored, app.scene, &app.quantities, simulation);
  std::size_t compared = 0;
  for (const MonitoredSeries& old : stored.monitor())
    for (std::size_t i = stored.monitor().size(); i < again.monitor().size(); ++i) {
      if (again.monitor()[i].name != old.name) continue;
      ++compared;
      EXPECT_TRUE(test::same_bits(again.monitor()[i].values, old.values)) << old.name;
    }
  EXPECT_EQ(stored.monitor().size() + compared, again.monitor().size());
}

TEST_F(Modes, RefusesWhatHasNoMeaning) {
  expect_refused(run("", kClamp, "Number: 1"), {"\"Scene / Sections / rod / Mass\"", "missing"});
  expect_refused(run(", Mass: -1", kClamp, "Number: 1"), {"\"Scene / Sections / rod / Mass\"", "-1"});
  expect_refused(run(", Mass: 1, Rotary Inertia: [1, 1, 3]", kClamp, "Number: 1"),
                 {"Rotary Inertia", "larger than the sum of the others"});
  EXPECT_EQ(run(", Mass: 1, Rotary Inertia: [1, 1, 3]", kClamp, "Number: 1").err.find("missing"), std::string::npos);
  expect_refused(run(", Rotary Inertia: [2, 1, 1]", kClamp, "Number: 1"), {"given without \"Mass\""});
  expect_refused(
      run(kMass, kClamp + "  Point Masses: {body: {Point: tip, Mass: 1, Inertia: [1, 1, 3]}}\n", "Number: 1"),
      {"\"Scene / Point Masses / body / Inertia\"", "larger than the sum of the others"});
  expect_refused(run(kMass, kClamp, "Number: 900"), {"\"Analysis / Modes / Number\"", "unknowns carry mass"});
  expect_refused(run(kMass + ", Damping: {Beta: -1}", kClamp, "Number: 1"),
                 {"\"Scene / Sections / rod / Damping / Beta\"", "-1"});
  expect_refused(run(kMass, kClamp, "Number: 1", "Quantities: {f: {Quantity: natural frequency, Mode: 2}}\n"),
                 {"\"Quantities / f / Mode\"", "allowed: up to"});
  const std::string twist = "  Point Loads: {twist: {Point: tip, Moment: [1, 0, 0]}}\n";
  expect_refused(run(kMass, kClamp + twist, "Number: 1, In Plane: true"), {"In Plane", "keeps to no plane"});
  expect_refused(run(kMass + ", Mass Offset: [0.1, 0.1]", kClamp, "Number: 1, In Plane: true"),
                 {"In Plane", "inertia of a section is not symmetric"});
}

/// In a plane that is turned about x by 45 degrees as in that of x and y; values of a spectral program.
TEST_F(Modes, BodiesInAnInclinedPlane) {
  const auto frame = [](const std::string& tip, const std::string& normal, const std::string& inertia) {
    const std::string mesh = ", Second Axis: " + normal + ", Order: 4, Elements: 4}\n";
    return "Scene:\n  Sections: {rod: {EA: 1e4, GA2: 1e4, GA3: 1e4, GIt: 10, EI2: 10, EI3: 10, Mass: 1}}\n"
           "  Points: {wall: [0, 0, 0], corner: [1, 0, 0], tip: " +
           tip + R"yaml(}
  Members:
    one: {Start: wall, End: corner)yaml" +
           mesh + "    two: {Start: corner, End: tip" + mesh + R"yaml(  Supports: {wall: {Point: wall}}
  Point Masses: {body: {Point: tip, Mass: 1, Inertia: )yaml" +
           inertia + "}}\nAnalysis: {Modes: {Number: 2, In Plane: true}}\n";
  };
  const std::string tip = "[1, 0.7071067811865476, 0.7071067811865476]", normal = "[0, -1, 1]",
                    ball = "[0.1, 0.1, 0.1]";
  for (const std::string& text : {frame("[1, 1, 0]", "[0, 0, 1]", ball), frame(tip, normal, ball)})
    expect_in(run_scene(text).out, {"2.044734", "6.016521"});
  expect_refused(run_scene(frame(tip, normal, "[0.1, 0.1, 0.15]")), {"In Plane", "inertia of a body is not symmetric"});
}

const std::string kThrust = "  Point Loads: {p: {Point: tip, Member: beam, Frame: follower, Force: [-30, 0, 0]}}\n";

/// Loads along members that follow them have no planar equations; their structures keep to their plane all the same. Of
/// a cantilever under next to no load: 1.8751^2 and 4.6941^2 over 2 pi, each of them twice in space.
TEST_F(Modes, InPlaneUnderLoadsAlongMembersThatFollow) {
  const std::string push = "  Distributed Loads: {p: {Member: beam, Frame: follower, Force: [-1e-6, 0, 0]}}\n";
  const std::string second = "3.50689";
  expect_in(run(kMass, kClamp + push, "Number: 2, In Plane: true").out, {"0.55959", second});
  const Ended in_space = run(kMass, kClamp + push, "Number: 2");
  EXPECT_EQ(in_space.out.find(second), std::string::npos);
  expect_in(in_space.out, {"0.55959"});
  expect_refused(run(kMass, kClamp + changed(push, "-1e-6, 0, 0", "0, -1e-6, 1e-6"), "Number: 2, In Plane: true"),
                 {"In Plane", "keeps to no plane"});
}

/// Beck's column at 20.0509536 EI/L^2, of a section that is not quite rigid.
TEST_F(Modes, ColumnsFlutterUnderLoadsThatFollow) {
  const std::string falls = "Expected: {falls: {Quantity: stable, Value: false, Source: Beck 1952}}\n";
  Ended ended = run(kMass, kClamp + kThrust, "Number: 2, In Plane: true", falls);
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  expect_in(ended.out, {"flutter at load factor 0.66836", "omega 11.0155", "grows as exp(7.10", "stable: false"});
  ended = run(kMass, kClamp + changed(kThrust, "-30", "-20"), "Number: 2, In Plane: true", falls);
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_EQ(ended.out.find("flutter"), std::string::npos) << ended.out;
  expect_in(ended.out, {"stable: true"});
}

/// Seen from a frame that turns about the shaft its frequency is pi^2 less and more the angular velocity; the forces on
/// it are those of rounding.
TEST_F(Modes, ShaftsOnAnInclinedAxis) {
  const std::string axes = "Axes: [1, 2, 2, -2, -1, 2], Fixed Rotation: [x]";
  expect_in(expect_code(kOk, run_scene(R"yaml(Scene:
  Rotating Frame: {Axis: [1, 2, 2], Angular Velocity: 3}
  Sections: {rod: {Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1, Mass: 1}}
  Points: {a: [0, 0, 0], b: [0.3333333333333333, 0.6666666666666666, 0.6666666666666666]}
  Members: {shaft: {Start: a, End: b, Order: 5, Elements: 4}}
  Supports: {a: {Point: a, )yaml" + axes +
                                       "}, b: {Point: b, Fixed Displacement: [y, z], " + axes +
                                       "}}\nAnalysis: {Modes: {Number: 2}}\n"))
                .out,
            {"6.869604", "12.8696"});
  // a disc, m = 1, J = 0.02, on a shaft without mass: |w - 1.5| of z = y + iz with 2 x 2 matrices
  const Ended rotor = run_scene(R"yaml(Scene:
  Rotating Frame: {Axis: [1, 2, 2], Angular Velocity: 1.5}
  Sections: {rod: {Inextensible: true, Shear Rigid: true, GIt: 1000, EI2: 1, EI3: 1}}
  Points: {a: [0, 0, 0], b: [0.3333333333333333, 0.6666666666666666, 0.6666666666666666]}
  Members: {shaft: {Start: a, End: b, Order: 4, Elements: 2}}
  Supports: {a: {Point: a}}
  Point Masses: {disc: {Point: b, Mass: 1, Inertia: [0.02, 0.02, 0.02]}}
Analysis: {Modes: {Number: 4}}
)yaml");
  expect_in(rotor.out, {"0.2269421401", "3.160560689", "13.69925689", "15.26563834"});
}

/// A point mass is heavy where Gravity acts, and bodies may carry all of the mass.
TEST_F(Modes, BodiesAtPoints) {
  const std::string body = "  Point Masses: {body: {Point: tip, Mass: 2}}\n  Gravity: {Acceleration: [0, 0, -0.001]}\n";
  const Ended ended = expect_code(kOk, run("", kClamp + body, "Number: 2"));
  expect_in(ended.out, {"1.22474"});  // sqrt(3 EI / m L^3)
  expect_in(ended.out, {"0.002"});    // the reaction
  // sqrt(GIt / J1 L), sqrt(EI / J2 L) of a body without mass
  const std::string disc = "  Point Masses: {disc: {Point: tip, Inertia: [1, 0.5, 0.5]}}\n";
  expect_in(run("", kClamp + disc, "Number: 3").out, {"0.1591549431", "0.22507907"});
}

}  // namespace
}  // namespace mixbeam::modes_test
