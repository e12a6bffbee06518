/// Each warning has a scene that provokes it and only it, and its twin within the limits that does not.
#include "discretization/checks/scene_warnings.hpp"

#include "scene_text.hpp"
#include "tests/support/processor_time.hpp"
#include "tests/support/scenes.hpp"

#include <functional>

namespace mixbeam {
namespace {

/// Diameter 0.1 and E = 100 GPa, in m and N.
Section steel() { return {"steel", 7.85e8, {2.7e8, 2.7e8}, 3.8e5, {4.9e5, 4.9e5}}; }

Member line(const std::string& name, const std::string& start, const std::string& end, int elements = 4) {
  Member member{name, start, end, {}, "steel", 2, elements};
  member.keeps_elements = true;
  return member;
}

/// An L of two rods of 5 m with a force of 1 kN at its end.
Scene frame() {
  Scene scene = test::structure({{"foot", {0, 0, 0}}, {"corner", {0, 0, 5}}, {"end", {5, 0, 5}}},
                                {line("post", "foot", "corner"), line("arm", "corner", "end")}, {test::clamp("foot")},
                                {test::dead_load("end", {0, 0, -1000})});
  scene.sections = {steel()};
  return scene;
}

void expect_only(const Scene& scene, const std::vector<std::string>& parts) {
  const std::vector<std::string> found = warnings(scene);
  ASSERT_EQ(found.size(), 1U) << (found.empty() ? "none" : found[0] + "\n" + found.back());
  expect_in(found[0], parts);
}

template <typename Change>
Scene frame_with(const Change& change) {
  Scene scene = frame();
  change(scene);
  return scene;
}

/// One warning of the frame with a change, which has all `parts`; or none.
template <typename Change>
void expect_warning(const std::vector<std::string>& parts, const Change& change) {
  expect_only(frame_with(change), parts);
}
template <typename Change>
void expect_none(const Change& change) {
  EXPECT_EQ(warnings(frame_with(change)), std::vector<std::string>{});
}

TEST(SceneWarnings, ASoundSceneHasNone) {
  EXPECT_EQ(warnings(frame()), std::vector<std::string>{});
  for (const std::string& text : warnings(scene_from(kBowScene))) ADD_FAILURE() << text;
}

TEST(SceneWarnings, OfUnits) {
  // Stiffnesses against bending in N mm^2, all else in m.
  expect_warning({"Sections / steel", "sqrt(EI/EA) = 25", "size 7.07", "different units"}, [](Scene& s) {
    s.sections[0].bending_stiffness = {4.9e11, 4.9e11};
    s.sections[0].torsional_stiffness = 3.8e11;
    s.point_loads[0].force[2] = -1e6;  // else it would not move visibly
  });
  expect_warning({"EI2 and EI3 differ", "factor 1e+07"}, [](Scene& s) {
    s.sections[0].bending_stiffness[0] = 0.049;
    s.sections[0].torsional_stiffness = 0.1;
  });
  expect_warning({"GA / EA = 3.44e-06"}, [](Scene& s) { s.sections[0].shear_stiffness[1] = 2.7e3; });
  expect_warning({"GIt over", "It is the sum"}, [](Scene& s) { s.sections[0].torsional_stiffness = 3.8e11; });
  expect_warning({"Point Loads / at end", "over EI is 1.02e+08", "units"},
                 [](Scene& s) { s.point_loads[0].force[2] = 1e12; });
  expect_warning({"Distributed Loads / on arm"}, [](Scene& s) { s.distributed_loads = {{"arm", {}, {0, 1e12, 0}}}; });
}

/// F l^2 / EI of the frame is 0.051, its strain 5.1e-4; r = 0.025.
TEST(SceneWarnings, LoadsInOtherUnitsThanStiffnesses) {
  expect_warning(  // elastica: 2 r sqrt(2 F / EI) = 0.143
      {"Point Loads / at end", "about 14.3 %", "units"}, [](Scene& s) { s.point_loads[0].force[2] = -2e6; });
  expect_none([](Scene& s) { s.point_loads[0].force[2] = -1.9e6; });
  expect_warning({"nothing moves visibly", "9.69e-07"}, [](Scene& s) { s.point_loads[0].force[2] = -0.019; });
  expect_none([](Scene& s) { s.point_loads[0].force[2] = -0.02; });
}

/// Neither where a formula says how large they are, nor where something else moves the structure.
TEST(SceneWarnings, LoadsOfUnknownSize) {
  for (const double force : {-2e6, -0.01})
    expect_none([&](Scene& s) {
      s.point_loads[0].force[2] = force;
      s.point_loads[0].amplitude = "1e3*t";
    });
  expect_none([](Scene& s) {
    s.point_loads[0].force[2] = -0.01;
    s.supports[0].prescribed_displacement = {0.1, 0, 0};
  });
}

TEST(SceneWarnings, OfRigidSectionsThereIsNothingToSay) {
  expect_none([](Scene& s) {
    s.sections[0].axial_stiffness = test::kRigid;
    s.sections[0].shear_stiffness = {test::kRigid, test::kRigid};
  });
}

TEST(SceneWarnings, OfStiffnessesTooFarApart) {
  const auto with_spring = [](double stiffness) {
    return frame_with([&](Scene& s) {
      s.supports[0].rotation_fixed = {true, false, true};
      s.supports[0].rotation_stiffness = {0, stiffness, 0};
    });
  };
  // 4.9e5 over the size of sqrt(50) and the spring
  expect_only(with_spring(4.9e5 / std::sqrt(50.0) / 1.1e12),
              {"section \"steel\" is 1.1e+12 times as stiff as the spring at point \"foot\"", "1e12", "scenes.md"});
  EXPECT_TRUE(warnings(with_spring(4.9e5 / std::sqrt(50.0) / 0.9e12)).empty());
}

TEST(SceneWarnings, OfElements) {
  expect_warning({"Points / corner", "length 1.25 (\"arm\")", "0.01 (\"post\")", "more elements"},
                 [](Scene& s) { s.members[0].elements = 500; });
  expect_warning({"Members / post", "3 element(s) of order 1"}, [](Scene& s) {
    s.members[0].order = 1;
    s.members[0].elements = 3;
  });
  expect_warning({"Members / arm", "11.2 radian", "degrees"}, [](Scene& s) { s.members[1].twist = 45; });
  expect_warning({"Members / arm", "from 0.045 to 4.85", "Stations"}, [](Scene& s) {
    s.members[1].stations = {0, 0.009, 0.02, 0.03, 1};
  });
  const std::vector<std::string> many = warnings(frame_with([](Scene& s) {
    for (Member& member : s.members) member.elements = 600000;
  }));
  ASSERT_EQ(many.size(), 4U);  // of each member: shorter than thick, many
  expect_in(many[0], {"elements of length 8.33e-06", "more elements than needed"});
  expect_in(many[2], {"600000 elements of order 2"});
}

/// Elements that the program chooses are no slip of the user.
TEST(SceneWarnings, OfElementsThatAreChosenThereIsNothingToSay) {
  const auto leave_mesh = [](Scene& s) {
    for (Member& member : s.members) member.keeps_elements = false;
  };
  expect_none([&](Scene& s) {
    leave_mesh(s);
    s.members[0].elements = 500;
    s.members[1].stations = {0, 0.009, 0.02, 0.03, 1};
  });
  expect_warning({"Members / arm", "45 radian", "degrees"}, [&](Scene& s) {
    leave_mesh(s);
    s.members[1].twist = 45;
  });
  expect_warning({"Members / arm", "1 element(s) turns by 3 radian"},
                 [&](Scene& s) { s.members[1].twist = 3, s.members[1].elements = 1; });
  for (const bool has_accuracy : {false, true})
    expect_none([&](Scene& s) {
      leave_mesh(s);
      s.members[1].twist = 3;
      s.members[1].elements = 1;
      s.members[0].keeps_elements = has_accuracy;
      if (has_accuracy) s.accuracy = 1e-4;
    });
}

TEST(SceneWarnings, OfForgottenConnections) {
  expect_warning({"Points / corner 2", "1e-07 from \"corner\"", "should be one point"},
                 [](Scene& s) {  // two points at the corner
                   s.points.push_back({"corner 2", {1e-7, 0, 5}});
                   s.members[1].start_point = "corner 2";
                 });
  expect_none([](Scene& s) {
    s.points.push_back({"corner 2", {1e-4, 0, 5}});
    s.members[1].start_point = "corner 2";
  });
  expect_warning({"Points / middle", "lies on \"arm\", 0.4 of its length", "inner point"},
                 [](Scene& s) {  // a strut that ends on the arm
                   s.points.push_back({"middle", {2, 0, 5}});
                   s.members.push_back(line("strut", "foot", "middle"));
                 });
  expect_none([](Scene& s) {  // the same, connected
    s.points.push_back({"middle", {2, 0, 5}});
    s.members.push_back(line("strut", "foot", "middle"));
    s.members[1].inner_points = {{"middle", 0.4}};
  });
  expect_warning({"Members / again", "lies on \"post\" all along"},
                 [](Scene& s) { s.members.push_back(line("again", "corner", "foot")); });
}

TEST(SceneWarnings, OfPointsOnArcs) {
  Scene scene = scene_from(kBowScene);
  scene.points.push_back({"on the arc", {10 + 3, 5 - 4, 0}});  // radius 5 about (10, 5, 0)
  scene.members.push_back(line("chord", "foot", "on the arc"));
  expect_only(scene, {"Points / on the arc", "lies on \"arch\""});
  scene.points.back().position[0] += 0.01;
  EXPECT_TRUE(warnings(scene).empty());
}

TEST(SceneWarnings, OfWhatActs) {
  expect_warning({"nothing acts"}, [](Scene& s) { s.point_loads.clear(); });
  expect_warning({"Point Loads", "\"cos(t)\" is 1 at t = 0"}, [](Scene& s) { s.point_loads[0].amplitude = "cos(t)"; });
  expect_none([](Scene& s) { s.point_loads[0].amplitude = "sin(t)"; });
  expect_warning({"Load Cases / wind", "nothing belongs to it"}, [](Scene& s) {
    s.load_cases = {"wind", "snow"};
    s.point_loads[0].load_case = "snow";
  });
  expect_warning({"Sections / spare", "no member has it"}, [](Scene& s) {
    s.sections.push_back(steel());
    s.sections[1].name = "spare";
  });
}

TEST(SceneWarnings, OfMembersThatGravityPassesOver) {
  const auto told = [&](const std::string& section) {
    const std::string members = member("light", "A", "B") + "beam: {Start: B, End: C, Section: heavy}";
    return warnings(
        scene_from(scene_text("A: [0, 0, 0], B: [1, 0, 0], C: [2, 0, 0]", changed(members, "flat", section),
                              "Gravity: {Acceleration: [0, 0, -1]}", "A", "heavy: {" + kFlatSection + "Mass: 3}")));
  };
  const auto of_gravity = [](const std::vector<std::string>& all) {
    return std::count_if(all.begin(), all.end(),
                         [](const std::string& text) { return text.rfind("Gravity: no weight of 1 of 2", 0) == 0; });
  };
  EXPECT_EQ(of_gravity(told("flat")), 1);
  EXPECT_EQ(of_gravity(told("heavy")), 0);
  const std::string arm = "beam: {Start: A, End: B, Section: heavy, Start Offset: [0, 0, 0.1]}";
  for (const std::string& text :
       warnings(scene_from(scene_text("A: [0, 0, 0], B: [1, 0, 0]", arm, "Gravity: {Acceleration: [0, 0, -1]}", "A",
                                      "heavy: {" + kFlatSection + "Mass: 3}"))))
    EXPECT_NE(text.rfind("Gravity", 0), 0U) << text;
}

TEST(SceneWarnings, OfDensitiesInOtherUnits) {
  const auto told = [](double modulus, double density, double gravity, double of_another = 0.0) {
    const auto found = warnings(frame_with([&](Scene& s) {
      SectionShape shape;
      shape.youngs_modulus = modulus;
      shape.density = density;
      s.sections[0].shape = shape;
      s.sections[0].mass = 1e-3 * density;
      s.gravity = gravity;
      if (of_another == 0.0) return;
      s.sections.push_back(s.sections[0]);
      s.sections[1].name = "other";
      s.sections[1].shape->density = of_another;
      s.members[0].section = "other";
    }));
    return std::count_if(found.begin(), found.end(), [](const std::string& text) {
      return text.find("Density") != std::string::npos && text.find("no solid is so light") != std::string::npos;
    });
  };
  struct Material {
    double modulus, density;  // in N/m2, kg/m3
  };
  for (const Material& one :
       {Material{206e9, 7850}, {70e9, 2700}, {11e9, 500}, {30e9, 2400}, {140e9, 1600}, {3e9, 1100}}) {
    EXPECT_EQ(told(one.modulus, 1e-3 * one.density, 9.81), 1) << one.density;
    EXPECT_EQ(told(one.modulus, one.density, 9.81), 0) << one.density;
    EXPECT_EQ(told(1e-3 * one.modulus, 1e-3 * one.density, 9.81), 0) << "in kN and t";
    EXPECT_EQ(told(1e-6 * one.modulus, 1e-9 * one.density, 9.81), 0) << "in mm and kg, with gravity in m/s2";
    EXPECT_EQ(told(1e-6 * one.modulus, 1e-12 * one.density, 9810), 0) << "in mm and t";
  }
  EXPECT_EQ(told(1050e9, 3500, 9.81), 0) << "diamond";
  EXPECT_EQ(told(206e9, 7.85, 0.0), 0) << "nothing weighs";
  EXPECT_EQ(told(206e9, 7.85, 9.81, 7.85), 1);
  EXPECT_EQ(told(206e9, 7.85, 9.81, 7850), 0) << "one alone may be meant to be rigid";
}

TEST(SceneWarnings, OfFormulasBetweenGaussPoints) {
  const auto with_load = [](const std::string& formula) {
    return frame_with([&](Scene& s) {
      s.distributed_loads = {{"arm", {}, {}}};
      s.distributed_loads[0].force_formula[2] = formula;
    });
  };
  expect_only(with_load("-1e3 * exp(-((x - 0.503) / 0.001)^2)"), {"arm", "misses", "x = 0.5 to 0.75", "Stations"});
  EXPECT_TRUE(warnings(with_load("-1e3 * exp(-((x - 0.503) / 0.3)^2)")).empty());  // wide enough
}

// Of each kind of formula one that is over between the points of the elements, which misses all of it, and its twin
// that four elements resolve.
TEST(SceneWarnings, OfNarrowFormulasOfAnyKind) {
  const std::string narrow = "exp(-((x - 0.503) / 0.001)^2)", wide = "exp(-((x - 0.503) / 0.3)^2)";
  const std::vector<std::function<void(Scene&, const std::string&)>> kinds = {
      [](Scene& s, const std::string& bump) {
        s.distributed_loads = {{"arm", {}, {}}};
        s.distributed_loads[0].couple_formula[1] = bump;
      },
      [](Scene& s, const std::string& bump) {
        s.eigenstrains = {{"arm"}};
        s.eigenstrains[0].curvature_formula[1] = "1e-3 * " + bump;
      },
      [](Scene& s, const std::string& bump) {
        s.sections.push_back(s.sections[0]);
        s.sections[1].name = "notch";
        const double left = bump.find("0.001") != std::string::npos ? 1e-4 : 0.5;  // a deep wide one has narrow flanks
        for (double& stiffness : s.sections[1].bending_stiffness) stiffness *= left;
        s.sections[1].torsional_stiffness *= left;
        s.members[1].end_section = "notch";
        s.members[1].taper = bump;
      },
      [](Scene& s, const std::string& bump) {
        std::string of_t = bump;
        of_t.replace(of_t.find("((x"), 3, "((t");
        s.members[1].curve.shape = CurveShape::parametric;
        s.members[1].curve.formula = {"5 * t", "0", "5 + 0.08 * t * (1 - t) * " + of_t};
      }};
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    const auto with_bump = [&](const std::string& bump) { return frame_with([&](Scene& s) { kinds[kind](s, bump); }); };
    expect_only(with_bump(narrow), {"arm", "misses", "x = 0.5 to 0.75", "Stations"});
    for (const std::string& text : warnings(with_bump(wide))) ADD_FAILURE() << kind << text;
    Scene chosen = with_bump(narrow);
    chosen.accuracy = 1e-6;
    for (Member& member : chosen.members) member.keeps_elements = false;
    for (const std::string& text : warnings(chosen)) ADD_FAILURE() << kind << text;
  }
}

TEST(SceneWarnings, OfPointsThatNoMemberTouches) {
  expect_warning({"Points / far", "no member"}, [](Scene& scene) { scene.points.push_back({"far", {9, 9, 9}}); });
  expect_none([](Scene& scene) {
    scene.points.push_back({"far", {9, 0, 5}});
    scene.members.push_back(line("more", "end", "far"));
  });
}

TEST(SceneWarnings, OfAKindAreCounted) {
  Scene scene = frame();
  for (int i = 0; i < 20; ++i) {
    const std::string name = "corner " + std::to_string(i);
    scene.points.push_back({name, {0.001 * (i + 1), 0, 5}});
    scene.members.push_back(line("rod " + name, "foot", name));
  }
  const std::vector<std::string> found = warnings(scene);
  ASSERT_EQ(found.size(), 6U);
  EXPECT_EQ(found.back(), "... and 15 more points on members");
}

/// A lattice of 20 x 20 x 20 points: comparing each point with each member would be 2e8 comparisons.
TEST(SceneWarnings, TakeTimeInProportionToTheScene) {
  Scene scene = frame(), lattice = test::lattice(20);
  scene.points = lattice.points;
  scene.members = lattice.members;
  for (Member& member : scene.members) member.section = "steel", member.elements = 4;
  scene.supports = lattice.supports;
  scene.point_loads[0].point = lattice.points.back().name;
  EXPECT_LT(processor_seconds([&] { EXPECT_TRUE(warnings(scene).empty()); }), 20.0);  // takes half a second
}

}  // namespace
}  // namespace mixbeam
