/// What acts on a structure, with its places: names, joints, formulas and inner points resolved.
#include "discretization/state/acting.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/scene/section_shape.hpp"

#include "input_text.hpp"

#include <cmath>
#include <stdexcept>

namespace mixbeam {
namespace {

constexpr double kRounding = 1e-14;

Member straight(const std::string& name, const std::string& start, const std::string& end) {
  return {name, start, end, {}, "s", 2, 2};
}

/// Two members of length 2 and 3 that meet in a hinge; the middle of the first has a name.
Scene hinged() {
  Scene scene;
  scene.units = "m, N";
  scene.sections = {{"s", 1, {1, 1}, 1, {1, 1}}};
  scene.points = {{"a", {0, 0, 0}}, {"b", {2, 0, 0}}, {"c", {2, 3, 0}}};
  scene.members = {straight("first", "a", "b"), straight("second", "b", "c")};
  scene.members[0].inner_points = {{"middle", 0.5}};
  scene.joints = {{"pin", "b", {"first"}}};
  scene.supports.resize(1);
  scene.supports[0].point = "middle";
  scene.supports[0].displacement_fixed = {true, true, true};
  return scene;
}

/// A table that must be there.
const ActingTable& table_of(const Acting& acting, const std::string& name) {
  for (const ActingTable& table : acting.tables)
    if (table.name == name) return table;
  throw std::runtime_error("no table " + name);
}

/// Component of a column of three in a row, at one of the places along a member where the column has all of them.
double at(const ActingTable& table, const std::string& column, std::size_t row, std::size_t component,
          std::size_t place = 0) {
  const std::vector<double>& numbers = table.numbers.at(column);
  return numbers.at(numbers.size() / table.rows * row + 3 * place + component);
}

void expect_at(const ActingTable& table, std::size_t row, int member, double s, const Vector3& position) {
  EXPECT_EQ(table.numbers.at("place").at(2 * row), member);
  EXPECT_NEAR(table.numbers.at("place").at(2 * row + 1), s, kRounding);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(at(table, "position", row, i), position[i], kRounding);
}

TEST(ActingOn, PointsLieWhereNoJointMovesThem) {
  Scene scene = hinged();
  scene.point_loads = {{"b", {0, 1, 0}}, {"b", {0, 1, 0}, {}, LoadFrame::follower, "first"}};
  const Acting acting = acting_on(scene, build_mesh(scene));
  EXPECT_EQ(acting.units, "m, N");
  ASSERT_EQ(table_of(acting, "supports").rows, 1U);
  expect_at(table_of(acting, "supports"), 0, 0, 1.0, {1, 0, 0});
  ASSERT_EQ(table_of(acting, "joints").rows, 1U);
  expect_at(table_of(acting, "joints"), 0, 0, 2.0, {2, 0, 0});
  const ActingTable& loads = table_of(acting, "point_loads");
  ASSERT_EQ(loads.rows, 2U);
  expect_at(loads, 0, 1, 0.0, {2, 0, 0});  // on the member that the joint leaves alone
  expect_at(loads, 1, 0, 2.0, {2, 0, 0});  // in the triad of its own member
}

TEST(ActingOn, LineLoadsAreSampledAlongTheirMember) {
  Scene scene = hinged();
  scene.distributed_loads = {{"second", {0, 0, -2}, {}, 1, LoadFrame::dead, {"s", "", "x^2"}}};
  const Acting acting = acting_on(scene, build_mesh(scene));
  const ActingTable& loads = table_of(acting, "line_loads");
  ASSERT_EQ(loads.rows, 1U);
  EXPECT_EQ(loads.numbers.at("member").at(0), 1);
  ASSERT_EQ(loads.numbers.at("force").size(), 3U * kPlacesAlongMember);
  EXPECT_NEAR(at(loads, "force", 0, 0, 4), 1.5, kRounding);
  EXPECT_NEAR(at(loads, "force", 0, 2, 4), 0.25, kRounding);
  EXPECT_NEAR(at(loads, "force", 0, 0, 8), 3.0, kRounding);
  EXPECT_NEAR(at(loads, "force", 0, 2, 8), 1.0, kRounding);
}

TEST(ActingOn, PartialProjectedAndTaperedLineLoadsAsTheyAct) {
  Scene scene = hinged();
  scene.sections[0].mass = 1.0;
  scene.sections.push_back(scene.sections[0]);
  scene.sections[1].name = "t";
  scene.sections[1].mass = 3.0;
  scene.members[0].end_section = "t";
  scene.distributed_loads = {
      {"second", {0, 0, -2}, {}, 1, LoadFrame::dead, {"x", "", ""}}, {"second", {0, -1, -1}}, {"first", {0, 0, -2}}};
  scene.distributed_loads[0].range = {0.25, 0.75};
  scene.distributed_loads[1].is_projected = true;
  scene.distributed_loads[2].is_weight = true;
  const Acting acting = acting_on(scene, build_mesh(scene));
  const ActingTable& loads = table_of(acting, "line_loads");
  EXPECT_EQ(loads.numbers.at("range"), (std::vector<double>{0.25, 0.75, 0, 1, 0, 1}));
  EXPECT_NEAR(at(loads, "force", 0, 0, 0), 0.25, kRounding);
  EXPECT_NEAR(at(loads, "force", 0, 0, 8), 0.75, kRounding);
  EXPECT_NEAR(at(loads, "force", 1, 2, 4), -std::sqrt(0.5), kRounding) << "at 45 degrees";
  EXPECT_NEAR(at(loads, "force", 2, 2, 4), -4.0, kRounding);
  EXPECT_NEAR(at(loads, "force", 2, 2, 8), -6.0, kRounding);
}

TEST(ActingOn, EigenstrainsAreSampledToo) {
  Scene scene = hinged();
  scene.eigenstrains = {{"first", {}, {0, 0.5, 0}, 1, {"1e-3*x", "", ""}}};
  scene.eigenstrains[0].end_turns[1] = {0, 0, 0.2};
  const Acting acting = acting_on(scene, build_mesh(scene));
  const ActingTable& strains = table_of(acting, "eigenstrains");
  ASSERT_EQ(strains.rows, 1U);
  EXPECT_EQ(strains.numbers.at("member").at(0), 0);
  EXPECT_NEAR(at(strains, "strain", 0, 0, 4), 5e-4, kRounding);
  EXPECT_NEAR(at(strains, "curvature", 0, 1), 0.5, kRounding);
  EXPECT_EQ(strains.numbers.at("turns"), (std::vector<double>{0, 0, 0, 0, 0, 0.2}));
}

TEST(ActingOn, SectionsAreSampledOnceForAllMembersThatShareThem) {
  Scene scene = hinged();
  SectionShape thin;
  thin.kind = SectionShapeKind::tube;
  thin.size2 = 2.0;
  thin.wall = 0.5;
  thin.youngs_modulus = 1.0;
  SectionShape thick = thin;
  thick.size2 = 4.0;
  scene.sections = {make_section("s", thin), make_section("t", thick)};
  scene.members.push_back(straight("third", "a", "c"));
  scene.members[1].end_section = "t";
  scene.members[1].taper = "x^2";
  const Acting acting = acting_on(scene, build_mesh(scene));
  EXPECT_EQ(table_of(acting, "members").numbers.at("section"), (std::vector<double>{0, 1, 0}));
  const ActingTable& sections = table_of(acting, "sections");
  ASSERT_EQ(sections.rows, 2U);
  constexpr std::size_t kSizes = 4;
  const std::vector<double>& dimensions = sections.numbers.at("dimensions");
  ASSERT_EQ(dimensions.size(), sections.rows * kSizes * kPlacesAlongMember);
  const auto size = [&](std::size_t section, std::size_t place, std::size_t number) {
    return dimensions[kSizes * (kPlacesAlongMember * section + place) + number];
  };
  EXPECT_NEAR(size(0, 8, 0), 2.0, kRounding);
  EXPECT_NEAR(size(1, 4, 0), 2.5, kRounding);
  EXPECT_NEAR(size(1, 8, 0), 4.0, kRounding);
  EXPECT_NEAR(size(1, 4, 2), 0.5, kRounding);
}

TEST(ActingOn, SectionsGivenByStiffnessesHaveNoShape) {
  const Scene scene = hinged();
  const Acting acting = acting_on(scene, build_mesh(scene));
  EXPECT_EQ(table_of(acting, "sections").lines.at("name"), "s\n");
  EXPECT_EQ(table_of(acting, "sections").lines.at("shape"), "none\n");
}

TEST(ActingOn, SectionsMayBeDrawnAsAShape) {
  Scene scene = hinged();
  scene.sections.push_back(scene.sections[0]);
  scene.sections[1].name = "t";
  scene.sections[0].drawn_as = scene.sections[1].drawn_as = SectionShape{SectionShapeKind::ellipse, 2.0, 0.5};
  scene.sections[1].drawn_as->size2 = 4.0;
  for (Member& member : scene.members) member.end_section = "t";
  const ActingTable sections = table_of(acting_on(scene, build_mesh(scene)), "sections");
  EXPECT_EQ(sections.lines.at("shape"), "drawn as ellipse\n");
  EXPECT_NEAR(sections.numbers.at("dimensions")[4 * 4], 3.0, kRounding);
  scene.sections[1].drawn_as.reset();
  EXPECT_EQ(table_of(acting_on(scene, build_mesh(scene)), "sections").lines.at("shape"), "none\n");
}

}  // namespace
}  // namespace mixbeam
