/// Scenes for tests of the input, put together from short pieces.
#pragma once

#include "input_text.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// A section whose axes 2 and 3 differ.
inline const std::string kFlatSection = "EA: 10, GA2: 4, GA3: 5, GIt: 1, EI2: 2, EI3: 3, ";

inline std::string member(const std::string& name, const std::string& start, const std::string& end,
                          const std::string& more = "") {
  return name + ": {Start: " + start + ", End: " + end + ", Section: flat, " + more + "}, ";
}
inline std::string curve(const std::string& shape, const std::string& more) {
  return "Curve: {Shape: " + shape + ", " + more + "}, ";
}

/// A whole file; a clamp is at `foot`.
inline std::string scene_text(const std::string& points, const std::string& members, const std::string& more = "",
                              const std::string& foot = "A", const std::string& sections = "") {
  return "Scene: {Sections: {flat: {" + kFlatSection + "}, " + sections + "}, Points: {" + points + "}, Members: {" +
         members + "}, Supports: {clamp: {Point: " + foot + "}}, " + more + "}";
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
