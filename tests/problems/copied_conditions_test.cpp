/// What patterns copy along with members: the answer of a copy is the image of the answer of the original.
#include "discretization/geometry/isometry.hpp"
#include "discretization/parameters/xml_reader.hpp"
#include "discretization/reading/read_scene.hpp"
#include "tests/support/solve.hpp"
#include "tests/support/text.hpp"

namespace mixbeam::test::copied_conditions {
namespace {

constexpr double kRounding = 1e-11;  // of displacements of size 0.1: components are turned before they are added

std::string parameter(const std::string& name, const std::string& value) {
  const bool is_array = value.front() == '{';
  const bool is_number = value.find_first_not_of("0123456789.e-{}, ") == std::string::npos;
  const std::string type = is_number ? "double" : "string";
  return "<Parameter name=\"" + name + "\" type=\"" + (is_array ? "Array(" + type + ")" : type) + "\" value=\"" +
         value + "\"/>";
}
std::string list(const std::string& name, const std::string& inside) {
  return "<ParameterList name=\"" + name + "\">" + inside + "</ParameterList>";
}

/// A bent cantilever "a", "b" with a hinge between them that has a spring, an elastic support at its end, loads of
/// every kind and eigenstrains; and one pattern.
std::string frame(const std::string& pattern) {
  const std::string section = parameter("EA", "1e3") + parameter("GA2", "4e2") + parameter("GA3", "5e2") +
                              parameter("GIt", "1") + parameter("EI2", "2") + parameter("EI3", "3");
  const auto member = [](const std::string& start, const std::string& end) {
    return parameter("Start", start) + parameter("End", end) + parameter("Section", "s") +
           "<Parameter name=\"Elements\" type=\"int\" value=\"4\"/><Parameter name=\"Order\" type=\"int\" "
           "value=\"3\"/>";
  };
  const std::string springs =
      parameter("Point", "C") + "<Parameter name=\"Fixed Displacement\" type=\"Array(string)\" " +
      "value=\"{}\"/><Parameter name=\"Fixed Rotation\" type=\"Array(string)\" value=\"{}\"/>" +
      parameter("Displacement Stiffness", "{1, 2, 0.5}") + parameter("Axes", "{1, 1, 0, 0, 1, 1}");
  const std::string loads = list("dead", parameter("Point", "C") + parameter("Force", "{0.02, 0.03, -0.05}") +
                                             parameter("Moment", "{0.01, 0.02, 0.03}")) +
                            list("follower", parameter("Point", "C") + parameter("Force", "{0.01, 0.02, 0.04}") +
                                                 parameter("Moment", "{0.02, -0.01, 0.03}") +
                                                 parameter("Frame", "follower") + parameter("Member", "b"));
  const std::string lines =
      list("part",
           parameter("Member", "a") + parameter("Force", "{0.1, -0.2, 0.1}") + parameter("Range", "{0.3, 0.8}")) +
      list("formula", parameter("Member", "b") + parameter("Force Formula", "{0.1*x, 0.2*sin(x), 0.05}") +
                          parameter("Couple Formula", "{0.02, 0.01*x, 0}")) +
      list("wind",
           parameter("Member", "b") + parameter("Force", "{0.03, 0.02, 0.05}") + parameter("Frame", "follower"));
  return list(
      "frame",
      list("Scene", list("Sections", list("s", section)) +
                        list("Points", parameter("A", "{0.3, 0.2, 0.1}") + parameter("B", "{1.3, 0.4, 0.3}") +
                                           parameter("C", "{1.5, 1.4, 0.5}")) +
                        list("Members", list("a", member("A", "B")) + list("b", member("B", "C"))) +
                        list("Patterns", list("p", pattern)) +
                        list("Supports", list("foot", parameter("Point", "A")) + list("springs", springs)) +
                        list("Joints", list("hinge", parameter("Point", "B") + parameter("Members", "{b}") +
                                                         parameter("Kind", "hinge") + parameter("Axis", "{0, 1, 1}") +
                                                         parameter("Stiffness", "2"))) +
                        list("Point Loads", loads) + list("Distributed Loads", lines) +
                        list("Eigenstrains",
                             list("growth", parameter("Member", "a") + parameter("Strain", "{0.01, 0.02, 0.03}") +
                                                parameter("Curvature", "{0.02, 0.1, 0.2}")))));
}

Scene scene_of(const std::string& text) {
  XmlParameters xml = parse_xml(text, "scene.xml");
  return read_scene(xml.list->sublist("Scene"), xml.source);
}

const std::string kCount = "<Parameter name=\"Count\" type=\"int\" value=\"2\"/>";

TEST(CopiedConditions, AnswersAreImages) {
  const Vector3 center{-0.5, 0.2, 0.1}, axis{1, 2, 3};
  const double angle = 1.1;
  const std::string turned = parameter("Kind", "rotate") + parameter("Center", "{-0.5, 0.2, 0.1}") +
                             parameter("Axis", "{1, 2, 3}") + parameter("Angle", "1.1") + kCount;
  const std::string mirrored =
      parameter("Kind", "mirror") + parameter("Point", "{-0.5, 0.2, 0.1}") + parameter("Normal", "{1, 2, 3}");
  const std::string shifted = parameter("Kind", "repeat") + parameter("Vector", "{-4, 0, 1}") + kCount;
  const std::vector<std::pair<std::string, Isometry>> cases = {{turned, Isometry::rotation(center, axis, angle)},
                                                               {mirrored, Isometry::reflection(center, axis)},
                                                               {shifted, Isometry::shift({-4, 0, 1})}};
  for (const auto& [pattern, motion] : cases) {
    const Simulation both = solved(scene_of(frame(pattern + parameter("Copy", "all"))));
    const Vector3 original = both.displacement("C");
    EXPECT_GT(largest_component(original), 0.02);
    EXPECT_TRUE(agrees(both.displacement("C (1)"), motion.direction(original), kRounding)) << pattern;
    EXPECT_TRUE(agrees(both.displacement("B (1)"), motion.direction(both.displacement("B")), kRounding)) << pattern;
  }
}

/// The twin: nothing holds copies that bring no supports.
TEST(CopiedConditions, StayBehindByDefault) {
  try {
    scene_of(frame(parameter("Kind", "repeat") + parameter("Vector", "{-4, 0, 1}") + kCount));
    FAIL() << "held by nothing";
  } catch (const InputError& error) {
    expect_in(error.what(), {"a (1)"});
  }
}

}  // namespace
}  // namespace mixbeam::test::copied_conditions
