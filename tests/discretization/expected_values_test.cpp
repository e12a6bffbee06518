#include "discretization/checks/expected_values.hpp"

#include "scene_text.hpp"

#include <limits>

namespace mixbeam {
namespace {

const std::string kTip =
    "tip height: {Quantity: displacement, Point: tip, Component: z, Value: 2.5, Relative Tolerance: 1e-6, "
    "Source: by hand}";

std::vector<ExpectedValue> expected_from(const std::string& checks, const std::vector<std::string>& own = {}) {
  XmlParameters xml = parsed("Expected: {" + checks + "}");
  return read_expected_values(xml.list->sublist("Expected"), xml.source, own);
}

ExpectedValue expecting(double value, double tolerance, ToleranceKind kind) {
  ExpectedValue expected;
  expected.value = value;
  expected.tolerance = tolerance;
  expected.kind = kind;
  return expected;
}

TEST(ExpectedValues, AreRead) {
  const std::vector<ExpectedValue> expected = expected_from(kTip);
  ASSERT_EQ(expected.size(), 1U);
  EXPECT_EQ(expected[0].name, "tip height");
  EXPECT_EQ(expected[0].quantity, "displacement");
  EXPECT_EQ(expected[0].point, "tip");
  EXPECT_EQ(expected[0].component, "z");
  EXPECT_FALSE(expected[0].load_factor.has_value());
  EXPECT_EQ(expected[0].value, 2.5);
  EXPECT_EQ(expected[0].tolerance, 1e-6);
  EXPECT_EQ(expected[0].kind, ToleranceKind::relative);
  EXPECT_EQ(expected[0].source, "by hand");
}

TEST(ExpectedValues, KnowTheQuantitiesOfTheApplication) {
  const std::string iterations =
      changed(changed(changed(kTip, "displacement", "iterations"), "Point: tip, ", ""), "Component: z, ", "");
  EXPECT_EQ(expected_from(iterations, {"iterations"})[0].quantity, "iterations");
  expect_in(message_of([&] { expected_from(iterations); }), {"Quantity", "\"iterations\"", "\"displacement\""});
}

TEST(ExpectedValues, AreRefusedWithAPlace) {
  const auto refusal = [](const std::string& from, const std::string& to) {
    return message_of([&] { expected_from(changed(kTip, from, to)); });
  };
  expect_in(refusal("displacement", "displacment"),
            {"scene.yaml:1:25: YAML path \"Expected / tip height / Quantity\"", "did you mean \"displacement\"?"});
  expect_in(refusal("Point: tip, ", ""), {"Point", "missing"});
  expect_in(refusal("z,", "w,"), {"Component", "\"x\", \"y\", \"z\""});
  expect_in(refusal("2.5", "0"), {"relative to the value 0", "Absolute Tolerance"});
  expect_in(refusal("1e-6", "0"), {"value > 0"});
  expect_in(refusal("by hand", "''"), {"tip height / Source", "where the value comes from"});
  expect_in(refusal("Relative Tolerance: 1e-6, ", ""), {"neither of", "exactly one"});
  expect_in(refusal("Source", "Absolute Tolerance: 1, Source"), {"both of", "exactly one"});
}

std::string check_of(const std::string& description) {
  return "check: {Value: 1, Absolute Tolerance: 1, Source: by hand, " + description + "}";
}
const std::string kMiddle = "Position: 0.5, ";

TEST(ExpectedValues, KnowTheQuantitiesOfSectionsAndOfTheStructure) {
  const ExpectedValue moment =
      expected_from(check_of("Quantity: material moment, Member: shaft, " + kMiddle + "Component: 3"))[0];
  EXPECT_EQ(moment.member, "shaft");
  EXPECT_EQ(moment.position, 0.5);
  EXPECT_EQ(moment.component, "3");
  EXPECT_EQ(expected_from(check_of("Quantity: strain energy"))[0].component, "");
  const auto refusal = [](const std::string& description) {
    return message_of([&] { expected_from(check_of(description)); });
  };
  expect_in(refusal("Quantity: strain energy, Component: x"),
            {"check / Component", "has no meaning", "\"strain energy\""});
  expect_in(refusal("Quantity: material moment, Member: shaft, Component: 3"), {"check / Position", "missing"});
  expect_in(refusal("Quantity: material moment, Member: shaft, " + kMiddle + "Component: z"),
            {"check / Component", "\"z\"", "\"1\", \"2\", \"3\", \"norm\""});
  expect_in(refusal("Quantity: reaction force, Point: foot, Component: 1"),
            {"check / Component", "\"1\"", "\"x\", \"y\", \"z\", \"norm\""});
}

TEST(ExpectedValues, MayBelongToACriticalPoint) {
  const std::string second = "Critical Point: 2, ";
  const ExpectedValue load = expected_from(check_of("Quantity: load factor, " + second))[0];
  EXPECT_EQ(load.critical_point, 2);
  EXPECT_FALSE(load.load_factor.has_value());
  EXPECT_FALSE(expected_from(kTip)[0].critical_point.has_value());
  const auto refusal = [&](const std::string& description) {
    return message_of([&] { expected_from(check_of("Quantity: load factor, " + description)); });
  };
  expect_in(refusal(second + "Load Factor: 1"), {"Load Factor", "Critical Point", "one of them"});
  expect_in(refusal("Critical Point: 0"), {"value >= 1"});
  expect_in(refusal("Critical Piont: 1"), {"did you mean \"Critical Point\"?"});
}

TEST(ExpectedValues, MayAskWhetherTheStateIsStable) {
  const auto stable = [](const std::string& value, const std::string& more = "") {
    return "end: {Quantity: stable, Source: by hand, " + value + more + "}";
  };
  const ExpectedValue neutral = expected_from(stable("Value: neutral"))[0];
  EXPECT_EQ(neutral.quantity, kStableName);
  EXPECT_EQ(neutral.word, "neutral");
  EXPECT_EQ(expected_from(stable("Value: false"))[0].word, "false");
  EXPECT_EQ(expected_from(kTip)[0].word, "");
  const auto refusal = [&](const std::string& value, const std::string& more = "") {
    return message_of([&] { expected_from(stable(value, more)); });
  };
  expect_in(refusal("Value: perhaps"), {"end / Value", "\"perhaps\"", "\"neutral\""});
  expect_in(refusal("Value: 1"), {"end / Value", "a number"});
  expect_in(refusal("Value: true, ", "Absolute Tolerance: 1"), {"Absolute Tolerance", "has no meaning"});
  expect_in(refusal("Value: true, ", "Critical Point: 1"), {"Critical Point", "has no meaning"});
  const std::string load_factor = "end: {Quantity: load factor, Value: true, Source: by hand}, ";
  expect_in(message_of([&] { expected_from(load_factor); }), {"end / Value", "\"true\"", "a number"});
}

TEST(ExpectedValues, MustBelongToTheScene) {
  const Scene scene = scene_from(kBowScene);
  Scene with_cases = scene;
  with_cases.load_cases = {"wind", "snow"};
  const auto check = [](const Scene& checked, const std::string& description) {
    check_expected_values(expected_from(check_of(description)), checked, ParameterSource("scene.xml"));
  };
  const std::string reaction = "Quantity: reaction force, Component: x, ";
  const std::string moment = "Quantity: material moment, " + kMiddle + "Component: 3, ";
  EXPECT_NO_THROW(check(scene, reaction + "Point: foot"));
  EXPECT_NO_THROW(check(scene, moment + "Member: arch"));
  EXPECT_NO_THROW(check(with_cases, moment + "Member: arch, Case: snow"));
  const auto refusal = [&](const Scene& checked, const std::string& description) {
    return message_of([&] { check(checked, description); });
  };
  expect_in(refusal(scene, reaction + "Point: top"), {"check / Point", "has no support", "\"foot\""});
  expect_in(refusal(scene, reaction + "Point: fot"), {"check / Point", "did you mean \"foot\"?"});
  expect_in(refusal(scene, moment + "Member: arhc"), {"check / Member", "did you mean \"arch\"?"});
  expect_in(refusal(scene, moment + "Member: arch, Case: wind"), {"check / Case", "(none)"});
  expect_in(refusal(with_cases, moment + "Member: arch"), {"check / Case", "missing", "\"wind\", \"snow\""});
  const std::string late = "Load Factor: 2.5, ";
  expect_in(refusal(scene, moment + "Member: arch, " + late), {"check / Load Factor", "2.5", "at most 2"});
}

TEST(ExpectedValues, PassWithinTheTolerance) {
  EXPECT_TRUE(compare(expecting(100.0, 0.01, ToleranceKind::relative), 100.9).pass);
  EXPECT_TRUE(compare(expecting(-100.0, 0.01, ToleranceKind::relative), -99.1).pass);
  EXPECT_TRUE(compare(expecting(0.0, 0.01, ToleranceKind::absolute), -0.009).pass);
  EXPECT_DOUBLE_EQ(compare(expecting(-100.0, 0.01, ToleranceKind::relative), -98.0).difference, 0.02);
  EXPECT_DOUBLE_EQ(compare(expecting(4.0, 0.01, ToleranceKind::absolute), 3.5).difference, -0.5);
}

/// The twin that must fail: a comparison that never fails would pass the test above.
TEST(ExpectedValues, FailBeyondTheTolerance) {
  EXPECT_FALSE(compare(expecting(100.0, 0.01, ToleranceKind::relative), 101.1).pass);
  EXPECT_FALSE(compare(expecting(-100.0, 0.01, ToleranceKind::relative), 100.0).pass);
  EXPECT_FALSE(compare(expecting(0.0, 0.01, ToleranceKind::absolute), 0.011).pass);
  // Small absolutely but not relatively, and the other way round: only the kind asked for counts.
  EXPECT_FALSE(compare(expecting(1e-9, 0.01, ToleranceKind::relative), 2e-9).pass);
  EXPECT_FALSE(compare(expecting(1e9, 0.01, ToleranceKind::absolute), 1e9 + 1.0).pass);
}

TEST(ExpectedValues, NeverPassWithoutANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const ToleranceKind kind : {ToleranceKind::absolute, ToleranceKind::relative}) {
    EXPECT_FALSE(compare(expecting(1.0, 1.0, kind), nan).pass);
    EXPECT_FALSE(compare(expecting(1.0, 1.0, kind), infinity).pass);
  }
}

}  // namespace
}  // namespace mixbeam
