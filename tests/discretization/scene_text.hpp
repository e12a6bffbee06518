/// Scenes for tests of the input, put together from short pieces.
#pragma once

#include "input_text.hpp"

#include <string>
#include <vector>

namespace mixbeam {

inline std::string parameter(const std::string& name, const std::string& type, const std::string& value) {
  return "<Parameter name=\"" + name + "\" type=\"" + type + "\" value=\"" + value + "\"/>\n";
}
inline std::string number(const std::string& name, const std::string& value) {
  return parameter(name, "double", value);
}
inline std::string integer_of(const std::string& name, int value) {
  return parameter(name, "int", std::to_string(value));
}
inline std::string word(const std::string& name, const std::string& value) { return parameter(name, "string", value); }
inline std::string numbers(const std::string& name, const std::string& value) {
  return parameter(name, "Array(double)", value);
}
inline std::string words(const std::string& name, const std::string& value) {
  return parameter(name, "Array(string)", value);
}
inline std::string list(const std::string& name, const std::string& inside) {
  return "<ParameterList name=\"" + name + "\">\n" + inside + "</ParameterList>\n";
}

/// A section whose axes 2 and 3 differ.
inline const std::string kFlatSection = number("EA", "10") + number("GA2", "4") + number("GA3", "5") +
                                        number("GIt", "1") + number("EI2", "2") + number("EI3", "3");

inline std::string member(const std::string& name, const std::string& start, const std::string& end,
                          const std::string& more = "") {
  return list(name, word("Start", start) + word("End", end) + word("Section", "flat") + more);
}
inline std::string curve(const std::string& shape, const std::string& more) {
  return list("Curve", word("Shape", shape) + more);
}

/// A whole file; a clamp is at `foot`.
inline std::string scene_text(const std::string& points, const std::string& members, const std::string& more = "",
                              const std::string& foot = "A", const std::string& sections = "") {
  return list("test", list("Scene", list("Sections", list("flat", kFlatSection) + sections) + list("Points", points) +
                                        list("Members", members) + more +
                                        list("Supports", list("clamp", word("Point", foot)))));
}

inline const Vector3* position_in(const Scene& scene, const std::string& point) {
  for (const Point& candidate : scene.points)
    if (candidate.name == point) return &candidate.position;
  return nullptr;
}
inline const Member* member_in(const Scene& scene, const std::string& name) {
  for (const Member& candidate : scene.members)
    if (candidate.name == name) return &candidate;
  return nullptr;
}

inline void expect_at(const Scene& scene, const std::string& point, const Vector3& expected, double tolerance) {
  const Vector3* const position = position_in(scene, point);
  ASSERT_NE(position, nullptr) << "no point " << point;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR((*position)[i], expected[i], tolerance) << point << ", " << i;
}

inline void expect_text_refused(const std::string& text, const std::vector<std::string>& parts) {
  expect_in(message_of([&] { scene_from(text); }), parts);
}

}  // namespace mixbeam
