#include "discretization/expected_values.hpp"

#include "input_text.hpp"

#include <limits>

namespace mixbeam {
namespace {

const std::string kTip = R"xml(
  <ParameterList name="tip height">
    <Parameter name="Quantity" type="string" value="displacement"/>
    <Parameter name="Point" type="string" value="tip"/>
    <Parameter name="Component" type="string" value="z"/>
    <Parameter name="Value" type="double" value="2.5"/>
    <Parameter name="Relative Tolerance" type="double" value="1e-6"/>
    <Parameter name="Source" type="string" value="by hand"/>
  </ParameterList>)xml";

std::vector<ExpectedValue> expected_from(const std::string& checks, const std::vector<std::string>& own = {}) {
  XmlParameters xml = parse_xml(
      "<ParameterList name=\"root\"><ParameterList name=\"Expected\">" + checks + "</ParameterList></ParameterList>",
      "scene.xml");
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
  const std::string iterations = replaced(replaced(replaced(kTip, "displacement", "iterations"),
                                                   "<Parameter name=\"Point\" type=\"string\" value=\"tip\"/>", ""),
                                          "<Parameter name=\"Component\" type=\"string\" value=\"z\"/>", "");
  EXPECT_EQ(expected_from(iterations, {"iterations"})[0].quantity, "iterations");
  expect_parts(message_of([&] { expected_from(iterations); }), {"Quantity", "\"iterations\"", "\"displacement\""});
}

TEST(ExpectedValues, AreRefusedWithAPlace) {
  const auto refusal = [](const std::string& from, const std::string& to) {
    return message_of([&] { expected_from(replaced(kTip, from, to)); });
  };
  expect_parts(refusal("\"displacement\"", "\"displacment\""),
               {"scene.xml:3: XML path \"Expected / tip height / Quantity\"", "did you mean \"displacement\"?"});
  expect_parts(refusal("<Parameter name=\"Point\" type=\"string\" value=\"tip\"/>", ""), {"Point", "missing"});
  expect_parts(refusal("\"z\"", "\"w\""), {"Component", "\"x\", \"y\", \"z\", \"norm\""});
  expect_parts(refusal("\"2.5\"", "\"0\""), {"relative to the value 0", "Absolute Tolerance"});
  expect_parts(refusal("\"1e-6\"", "\"0\""), {"value > 0"});
  expect_parts(refusal("<Parameter name=\"Relative Tolerance\" type=\"double\" value=\"1e-6\"/>", ""),
               {"neither of", "exactly one"});
  expect_parts(
      refusal("<Parameter name=\"Source\"",
              "<Parameter name=\"Absolute Tolerance\" type=\"double\" value=\"1\"/><Parameter name=\"Source\""),
      {"both of", "exactly one"});
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
