// Elements between inner points and at stations, and the points that follow from curves.
#include "discretization/mesh/mesh.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/text/errors.hpp"
#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <stdexcept>

namespace mixbeam::test {
namespace {

Member divided(int elements, const std::vector<double>& inner, const std::vector<double>& stations = {}) {
  Member member = line("beam", "clamp", "tip", 2, elements);
  for (const double position : inner)
    member.inner_points.push_back({"inner " + std::to_string(member.inner_points.size() + 1), position});
  member.stations = stations;
  return member;
}

/// Number of elements before, between and after the inner points.
std::vector<int> elements_of_pieces(const ElementDivision& division) {
  std::vector<int> ends = {0};
  ends.insert(ends.end(), division.inner_vertex.begin(), division.inner_vertex.end());
  ends.push_back(division.elements());
  std::vector<int> count(ends.size());
  std::adjacent_difference(ends.begin(), ends.end(), count.begin());
  count.erase(count.begin());
  return count;
}

void expect_refusal(const std::function<void()>& action, const std::string& words) {
  try {
    action();
    ADD_FAILURE() << "accepted; expected words: " << words;
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(ElementDivision, EqualElementsWithoutInnerPoints) {
  const ElementDivision division = divide(divided(4, {}));
  EXPECT_TRUE(division.is_equal);
  EXPECT_EQ(division.station, (std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0}));
}

TEST(ElementDivision, ElementsAreSharedOutInProportionToLength) {
  EXPECT_EQ(elements_of_pieces(divide(divided(10, {0.3}))), (std::vector<int>{3, 7}));
  EXPECT_EQ(elements_of_pieces(divide(divided(8, {0.25, 0.5}))), (std::vector<int>{2, 2, 4}));
  // a short piece takes one element, the rest goes where elements are longest
  EXPECT_EQ(elements_of_pieces(divide(divided(4, {0.01}))), (std::vector<int>{1, 3}));
  EXPECT_EQ(elements_of_pieces(divide(divided(3, {0.01, 0.02}))), (std::vector<int>{1, 1, 1}));
}

TEST(ElementDivision, EveryPieceHasAnElement) {
  EXPECT_EQ(elements_of_pieces(divide(divided(1, {0.1, 0.2, 0.7}))), (std::vector<int>{1, 1, 1, 1}));
}

TEST(ElementDivision, LongestElementIsAsShortAsPossible) {
  // no other distribution of the same number of elements has a shorter longest element: found by trying all of them
  const std::vector<double> length = {0.17, 0.4, 0.08, 0.35};
  for (int elements = 4; elements < 30; ++elements) {
    const std::vector<int> count = elements_of_pieces(divide(divided(elements, {0.17, 0.57, 0.65})));
    const auto longest = [&](const std::vector<int>& n) {
      double largest = 0.0;
      for (std::size_t i = 0; i < length.size(); ++i) largest = std::max(largest, length[i] / n[i]);
      return largest;
    };
    double best = 1.0;
    for (int a = 1; a < elements; ++a)
      for (int b = 1; a + b < elements; ++b)
        for (int c = 1; a + b + c < elements; ++c) best = std::min(best, longest({a, b, c, elements - a - b - c}));
    EXPECT_EQ(std::accumulate(count.begin(), count.end(), 0), elements);
    EXPECT_NEAR(longest(count), best, 1e-15) << elements << " elements";
  }
}

TEST(ElementDivision, InnerPointsAreAmongTheStations) {
  const ElementDivision division = divide(divided(3, {0.7 + 1e-12}, {0.0, 0.1, 0.7, 1.0}));
  EXPECT_FALSE(division.is_equal);
  EXPECT_EQ(division.station, (std::vector<double>{0.0, 0.1, 0.7, 1.0}));
  EXPECT_EQ(division.inner_vertex, std::vector<int>{2});
}

TEST(ElementDivision, RefusesWhatDoesNotAscend) {
  const auto refused = [](const Member& member, const std::string& words) {
    expect_refusal([&] { divide(member); }, words);
  };
  refused(divided(0, {}), "at least one element");
  refused(divided(2, {0.0}), "between 0 and 1");
  refused(divided(2, {1.0}), "between 0 and 1");
  refused(divided(2, {0.5, 0.5}), "between 0 and 1");
  refused(divided(2, {std::nan("")}), "between 0 and 1");
  refused(divided(2, {}, {0.0, 1.0}), "There are 2 stations; 2 elements have 3");
  refused(divided(2, {}, {0.0, 0.5, 0.9}), "last one 1");
  refused(divided(3, {}, {0.0, 0.5, 0.5, 1.0}), "Station 3");
  refused(divided(2, {0.4}, {0.0, 0.5, 1.0}), "none of the stations");
  refused(divided(2, {0.5, 0.5 + 1e-12}, {0.0, 0.5, 1.0}), "of the one before it");
}

/// A beam of length 6 with the given division.
Scene divided_cantilever(const Member& member) {
  Scene scene = cantilever(section(1, 1, 1, 1), 6.0, 1, 1);
  scene.members = {member};
  return scene;
}

TEST(UnequalMesh, ArcLengthsOfVerticesAndElements) {
  const Mesh mesh = build_mesh(divided_cantilever(divided(3, {}, {0.0, 0.1, 0.7, 1.0})));
  const double start[3] = {0.0, 0.6, 4.2}, length[3] = {0.6, 3.6, 1.8};
  for (int e = 0; e < 3; ++e) {
    constexpr double kRounded = 6.0 * 1e-15;
    EXPECT_NEAR(mesh.element_length(mesh.elements[e]), length[e], kRounded);
    EXPECT_NEAR(mesh.arc_length(mesh.elements[e], -1.0), start[e], kRounded);
    EXPECT_NEAR(mesh.arc_length(mesh.elements[e], 0.5), start[e] + 0.75 * length[e], kRounded);
    EXPECT_NEAR(mesh.vertex_position[mesh.elements[e].vertex[0]][0], start[e], kRounded);
    EXPECT_EQ(arc_length_of_vertex(mesh, 0, mesh.elements[e].vertex[0]), mesh.members[0].vertex_arc_length(e));
  }
  EXPECT_EQ(arc_length_of_vertex(mesh, 0, vertex_of(mesh, "tip")), 6.0);
}

TEST(UnequalMesh, InnerPointsAreVerticesThatOtherMembersMayUse) {
  Scene scene = divided_cantilever(divided(4, {0.25, 0.5}));
  scene.points.push_back({"side", {3, 2, 0}});
  scene.members.insert(scene.members.begin(), line("branch", "inner 2", "side", 1, 1));
  const Mesh mesh = build_mesh(scene);
  const int inner = vertex_of(mesh, "inner 2");
  EXPECT_EQ(mesh.elements[0].vertex[0], inner);
  EXPECT_EQ(mesh.elements[mesh.members[1].first_element + 1].vertex[1], inner);
  EXPECT_NEAR(mesh.vertex_position[inner][0], 3.0, 1e-15 * 6.0);
  EXPECT_EQ(arc_length_of_vertex(mesh, 1, inner), 3.0);
  EXPECT_EQ(mesh.vertices(), 6);
}

TEST(UnequalMesh, InnerPointOfTheSceneMustLieOnTheMember) {
  Scene scene = divided_cantilever(divided(2, {0.5}));
  scene.points.push_back({"inner 1", {3, 0, 0}});
  EXPECT_EQ(build_mesh(scene).vertices(), 3);
  scene.points.back().position[1] = 1e-6;
  expect_refusal([&] { build_mesh(scene); }, "point \"inner 1\" is at (3, 1e-06, 0), but member \"beam\" passes it at");
}

TEST(UnequalMesh, PointWithoutAPositionIsNamed) {
  Scene scene = divided_cantilever(divided(2, {}));
  scene.members.push_back(line("branch", "tip", "nowhere", 1, 1));
  expect_refusal([&] { build_mesh(scene); }, "member \"branch\": the position of its point \"nowhere\" is not known");
}

}  // namespace
}  // namespace mixbeam::test
