/// Variables of a scene and formulas in place of its numbers.
#include "discretization/reading/variables.hpp"
#include "scene_text.hpp"

#include "discretization/text/expression.hpp"

#include <cmath>

namespace mixbeam {
namespace {

const double kPi = std::acos(-1.0);
/// Formulas take a few operations, each rounded once.
constexpr double kRounding = 1e-14;

std::string with_variables(const std::string& variables, const std::string& tip, const std::string& more = "") {
  return "Scene:\n  Variables: {" + variables + "}\n  Sections: {flat: {" + kFlatSection +
         "}}\n  Points: {A: [0, 0, 0], B: " + tip + "}\n  Members: {m: {Start: A, End: B}}\n" +
         "  Supports: {clamp: {Point: A}}\n" + more;
}

TEST(Variables, StandForNumbersEverywhere) {
  const Scene scene = scene_from(with_variables(
      "L: 2, theta: 30 deg, h: \"=L*sin(theta)\", n: \"6/0.3\"", "[\"=L*cos(theta)\", \"=h\", 0.5]",
      "  Point Loads:\n    tip: {Point: B, Force: [0, \"=-x('B')/2\", \"=sqrt(n)\"], Stage: \"=n/20\"}\n"));
  const double angle = 30 * kPi / 180.0;
  expect_at(scene, "B", {2 * std::cos(angle), 2 * std::sin(angle), 0.5}, kRounding);
  EXPECT_NEAR(scene.point_loads[0].force[1], -std::cos(angle), kRounding);
  EXPECT_NEAR(scene.point_loads[0].force[2], std::sqrt(20.0), kRounding);
  EXPECT_EQ(scene.point_loads[0].stage, 1);
  EXPECT_GT(std::abs((*position_in(scene, "B"))[1] - 2 * std::sin(1.1 * angle)), 0.01);  // the twin
  expect_at(scene_from(with_variables("L: 2", "[\"=atan(10)\", 0, 1]")), "B", {std::atan(10.0), 0, 1}, kRounding);
}

TEST(Variables, PointsMayNeedOneAnother) {
  const Scene scene = scene_from(
      "Scene: {Sections: {flat: {" + kFlatSection +
      "}}, Points: {A: [0, 0, 0], C: [\"=2*x('B')\", 0, \"=z('B')+1\"], B: [\"=y('A')+3\", 0, 0]}, Members: {m: "
      "{Start: A, End: B}, n: {Start: B, End: C}}, Supports: {clamp: {Point: A}}}");
  expect_at(scene, "C", {6, 0, 1}, 0.0);
}

TEST(Variables, InXmlTheTypeIsChecked) {
  const auto text = [](const std::string& type, const std::string& formula) {
    return changed(xml_text(*parsed(with_variables("L: 2", "[1, 0, 0]")).list),
                   "<Parameter name=\"End\" type=\"string\" value=\"B\"/>",
                   "<Parameter name=\"End\" type=\"string\" value=\"B\"/>\n<Parameter name=\"Elements\" type=\"" +
                       type + "\" value=\"" + formula + "\"/>");
  };
  EXPECT_EQ(scene_from(text("int", "=4*L")).members[0].elements, 8);
  expect_text_refused(text("int", "=L/4"), {"scene.xml:", "Elements", "=L/4", "0.5", "whole number"});
  expect_text_refused(text("double", "=4*L"), {"Elements", "=4*L", "double", "int"});
  expect_text_refused(text("bool", "=4*L"), {"Elements", "\"true\""});
}

TEST(Variables, FormulasOfLoadsMayNameThemAndThePlace) {
  const Scene scene = scene_from(with_variables(
      "q: -3, T: 2", "[2, 4, 0]",
      "  Distributed Loads:\n    wind: {Member: m, Force Formula: [\"q*(1-x)\", \"Y*X\", \"=Z + s*0\"], Amplitude: "
      "sin(pi*t/T)}\n"));
  const DistributedLoad& load = scene.distributed_loads[0];
  const auto value = [&](int component, double x) {
    return Expression(load.force_formula[component], {"s", "x"})({x * std::sqrt(20.0), x});
  };
  for (const double x : {0.0, 0.25, 1.0}) {
    EXPECT_NEAR(value(0, x), -3.0 * (1.0 - x), kRounding);
    EXPECT_NEAR(value(1, x), 8.0 * x * x, kRounding);
    EXPECT_NEAR(value(2, x), 0.0, kRounding);
  }
  EXPECT_NEAR(Expression(load.amplitude, {"t"})(1.0), 1.0, kRounding);
}

/// A half circle about (1, 0, 0) in the plane of x and z, rising along y.
TEST(Variables, ThePlaceOfFormulasFollowsArcsAndHelices) {
  const auto text = [](const std::string& shape, const std::string& end) {
    return "Scene: {Sections: {flat: {" + kFlatSection +
           "}}, Points: {A: [0, 0, 0]}, Members: {m: {Start: A, End: B, " + "Curve: {" + shape +
           "}}}, Supports: {clamp: {Point: A}}, Distributed Loads: {q: {Member: m, Force Formula: "
           "[X, Y, Z]}}" +
           end + "}";
  };
  for (const double rise : {0.0, 2.0}) {
    const std::string shape = rise == 0.0 ? "Shape: arc" : "Shape: helix, Rise: 2";
    const Scene scene = scene_from(text(shape + ", Center: [1, 0, 0], Axis: [0, 1, 0], Angle: \"=180 deg\"", ""));
    for (const double x : {0.0, 0.3, 1.0}) {
      const Vector3 place{1.0 - std::cos(kPi * x), rise * x, std::sin(kPi * x)};
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(Expression(scene.distributed_loads[0].force_formula[i], {"s", "x"})({0.0, x}), place[i], kRounding);
    }
  }
  expect_text_refused(
      "Scene: {Sections: {flat: {" + kFlatSection +
          "}}, Points: {A: [0, 0, 0], B: [2, 0, 0]}, Members: "
          "{m: {Start: A, End: B, Curve: {Shape: spline, Through: [1, 1, 0]}}}, Supports: {clamp: {Point: A}}, "
          "Distributed Loads: {q: {Member: m, Force Formula: [X, 0, 0]}}}",
      {"Force Formula", "X", "spline", "s and x"});
}

TEST(Variables, FormulasOfLoadsKnowTheirStage) {
  const Scene scene = scene_from(with_variables(
      "q: 3", "[2, 0, 0]",
      "  Distributed Loads:\n    q: {Member: m, Force Formula: [q*stage, 0, 0], Amplitude: sin(pi/2*(t-stage+1)), "
      "Stage: 2}\n  Point Loads: {p: {Point: B, Force: [1, 0, 0]}}\n"));
  const DistributedLoad& load = scene.distributed_loads[0];
  EXPECT_EQ(Expression(load.force_formula[0], {"s", "x"})({0.0, 0.0}), 6.0);
  EXPECT_NEAR(Expression(load.amplitude, {"t"})(1.0), 0.0, kRounding);
  EXPECT_NEAR(Expression(load.amplitude, {"t"})(2.0), 1.0, kRounding);
  expect_text_refused(with_variables("stage: 1", "[1, 0, 0]"), {"Variables / stage", "means something else"});
}

/// Formulas of a wrong variable are not told again, whatever they would give, nor is what follows from them.
TEST(Variables, MistakesDoNotHideThoseOfTheRest) {
  const std::string message = message_of([] {
    const XmlParameters file =
        parsed(with_variables("a: \"=2*b\", c: \"=d\", d: \"=3*c\", t: 4, e2: \"=a^3\"", "[\"=a\", \"=0*a\", \"=1/0\"]",
                              "  Accuracy: \"=e2\"\n  Point Loads:\n    w: {Point: C, Force: [0, 0, \"=e2\"]}\n"));
    read_scene(file.list->sublist("Scene"), file.source);
  });
  expect_in(message, {"5 mistakes", "Variables / a", "\"b\"", "needs itself", "Variables / t", "Points / B", "=1/0",
                      "w / Point", "\"C\""});
  EXPECT_EQ(message.find("Accuracy"), std::string::npos) << message;
  EXPECT_EQ(message.find("e2\":"), std::string::npos) << message;
}

TEST(Variables, ErrorsTellPlaceFormulaAndNearestName) {
  const std::string tip = "[1, 0, 0]";
  expect_text_refused(with_variables("length: 2, h: \"=lenght*2\"", tip),
                      {"scene.yaml:2:", "Scene / Variables / h", "=lenght*2", "lenght", "did you mean \"length\""});
  expect_text_refused(with_variables("a: \"=b\", b: \"=c+1\", c: \"=a\"", tip), {"scene.yaml:2:", "b -> c -> a -> b"});
  expect_text_refused(with_variables("a: \"=x('B')\"", "[\"=a\", 0, 0]"), {"needs itself"});
  expect_text_refused(with_variables("a: \"=1/0\"", tip), {"Variables / a", "=1/0", "inf", "finite"});
  expect_text_refused(with_variables("a: 1", "[\"=a*\", 0, 0]"), {"scene.yaml:4:", "Points / B", "=a*", "no formula"});
  expect_text_refused(with_variables("a: 1", "[\"=x('C')\", 0, 0]"), {"Points / B", "\"C\"", "\"A\", \"B\""});
  expect_text_refused(with_variables("a: 1", "[\"=a\", -a, 0]"), {"Points / B", "\"-a\"", "begins with ="});
  expect_text_refused(with_variables("a: 1, b: \"=x(B)\"", tip), {"Variables / b", "x('B')"});
  expect_text_refused(with_variables("t: 1", tip), {"Variables / t", "means something else", "\"lambda\""});
  expect_text_refused(with_variables("sin: 1", tip), {"Variables / sin", "means something else"});
  expect_text_refused(with_variables("\"span m\": 1", tip), {"Variables / span m", "a letter"});
  expect_text_refused(with_variables("a: 1", tip, "  Accuracy: \"=-a\"\n"), {"Accuracy", "=-a", "value -1"});
  expect_text_refused(with_variables("a: true", tip), {"Variables / a", "bool"});
  expect_text_refused("Scene: {Variables: 3}", {"Variables", "map"});
}

/// As a batch does it.
TEST(Variables, AChangedVariableChangesWhatIsReadNext) {
  XmlParameters file = parsed(with_variables("L: 2, h: \"=L/2\"", "[\"=L\", \"=h\", 0]"));
  Teuchos::ParameterList& list = file.list->sublist("Scene");
  expect_at(read_scene(list, file.source), "B", {2, 1, 0}, 0.0);
  set_number(list.sublist("Variables").getEntry("L"), -1, 6.0);
  expect_at(read_scene(list, file.source), "B", {6, 3, 0}, 0.0);
  set_number(list.sublist("Points").getEntry("B"), 0, 7.0);
  set_number(list.sublist("Variables").getEntry("L"), -1, 8.0);
  expect_at(read_scene(list, file.source), "B", {7, 4, 0}, 0.0);
  set_number(list.sublist("Variables").getEntry("h"), -1, 1.5);
  expect_at(read_scene(list, file.source), "B", {7, 1.5, 0}, 0.0);
}

TEST(Variables, FormulasSurviveTheWayToXmlAndBack) {
  const XmlParameters yaml = parsed(with_variables("L: 2, b: 25 deg, h: \"=L*x('B')\"", "[\"=L\", 0, 1.5]"));
  const XmlParameters xml = parsed(xml_text(*yaml.list));
  expect_in(xml.text, {"type=\"Array(double)\" value=\"{=L, 0, 1.5}\"", "type=\"double\" value=\"=L*x('B')\""});
  const std::string back = yaml_text(xml, scene_file_spec(), "scene.yaml");
  expect_in(back, {"[\"=L\", 0, 1.5]", "\"=L*x('B')\"", "b: \"25 deg\""});
  EXPECT_EQ(scene_from(back).points[1].position, scene_from(yaml.text).points[1].position);
}

}  // namespace
}  // namespace mixbeam
