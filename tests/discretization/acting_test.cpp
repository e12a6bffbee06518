/// What acts on a structure, with its places: names, joints, formulas and inner points resolved.
#include "discretization/state/acting.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/scene/section_shape.hpp"

#include "input_text.hpp"

namespace mixbeam {
namespace {

constexpr double kRounding = 1e-14;

Member straight(const std::string& name, const std::string& start, const std::string& end) {
  Member member;
  member.name = name;
  member.start_point = start;
  member.end_point = end;
  member.section = "s";
  member.elements = 2;
  return member;
}

/// Two members of length 2 and 3 that meet in a hinge; the middle of the first has a name.
Scene hinged() {
  Scene scene;
  scene.units = "m, N";
  scene.sections = {Section{}};
  scene.sections[0].name = "s";
  set_diagonal(scene.sections[0], {1, 1, 1, 1, 1, 1});
  scene.points = {{"a", {0, 0, 0}}, {"b", {2, 0, 0}}, {"c", {2, 3, 0}}};
  scene.members = {straight("first", "a", "b"), straight("second", "b", "c")};
  scene.members[0].inner_points = {{"middle", 0.5}};
  Joint joint;
  joint.name = "pin";
  joint.point = "b";
  joint.members = {"first"};
  scene.joints = {joint};
  Support support;
  support.point = "middle";
  support.displacement_fixed = {true, true, true};
  scene.supports = {support};
  return scene;
}

void expect_at(const PlaceOnMember& place, int member, double s, const Vector3& position) {
  EXPECT_EQ(place.member, member);
  EXPECT_NEAR(place.arc_length, s, kRounding);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(place.position[i], position[i], kRounding);
}

TEST(ActingOn, PointsLieWhereNoJointMovesThem) {
  Scene scene = hinged();
  PointLoad load;
  load.point = "b";
  load.force = {0, 1, 0};
  scene.point_loads = {load, load};
  scene.point_loads[1].frame = LoadFrame::follower;
  scene.point_loads[1].member = "first";
  const Acting acting = acting_on(scene, build_mesh(scene));
  EXPECT_EQ(acting.units, "m, N");
  ASSERT_EQ(acting.supports.size(), 1U);
  expect_at(acting.supports[0].place, 0, 1.0, {1, 0, 0});
  ASSERT_EQ(acting.joints.size(), 1U);
  expect_at(acting.joints[0].place, 0, 2.0, {2, 0, 0});
  ASSERT_EQ(acting.point_loads.size(), 2U);
  expect_at(acting.point_loads[0].place, 1, 0.0, {2, 0, 0});  // on the member that the joint leaves alone
  expect_at(acting.point_loads[1].place, 0, 2.0, {2, 0, 0});  // in the triad of its own member
}

TEST(ActingOn, LineLoadsAreSampledAlongTheirMember) {
  Scene scene = hinged();
  DistributedLoad load;
  load.member = "second";
  load.force = {0, 0, -2};
  load.force_formula = {"s", "", "x^2"};
  scene.distributed_loads = {load};
  const Acting acting = acting_on(scene, build_mesh(scene));
  ASSERT_EQ(acting.line_loads.size(), 1U);
  EXPECT_EQ(acting.line_loads[0].member, 1);
  const std::vector<Vector3>& force = acting.line_loads[0].force;
  ASSERT_EQ(force.size(), static_cast<std::size_t>(kPlacesAlongMember));
  EXPECT_NEAR(force[4][0], 1.5, kRounding);
  EXPECT_NEAR(force[4][2], 0.25, kRounding);
  EXPECT_NEAR(force[8][0], 3.0, kRounding);
  EXPECT_NEAR(force[8][2], 1.0, kRounding);
}

TEST(ActingOn, EigenstrainsAreSampledToo) {
  Scene scene = hinged();
  Eigenstrain strain;
  strain.member = "first";
  strain.curvature = {0, 0.5, 0};
  strain.strain_formula = {"1e-3*x", "", ""};
  scene.eigenstrains = {strain};
  const Acting acting = acting_on(scene, build_mesh(scene));
  ASSERT_EQ(acting.eigenstrains.size(), 1U);
  EXPECT_EQ(acting.eigenstrains[0].member, 0);
  EXPECT_NEAR(acting.eigenstrains[0].strain[4][0], 5e-4, kRounding);
  EXPECT_NEAR(acting.eigenstrains[0].curvature[0][1], 0.5, kRounding);
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
  EXPECT_EQ(acting.section_of_member, (std::vector<int>{0, 1, 0}));
  ASSERT_EQ(acting.sections.size(), 2U);
  ASSERT_EQ(acting.sections[1].shape.size(), static_cast<std::size_t>(kPlacesAlongMember));
  EXPECT_NEAR(acting.sections[0].shape[8].size2, 2.0, kRounding);
  EXPECT_NEAR(acting.sections[1].shape[4].size2, 2.5, kRounding);
  EXPECT_NEAR(acting.sections[1].shape[8].size2, 4.0, kRounding);
  EXPECT_NEAR(acting.sections[1].shape[4].wall, 0.5, kRounding);
}

TEST(ActingOn, SectionsGivenByStiffnessesHaveNoShape) {
  const Scene scene = hinged();
  const Acting acting = acting_on(scene, build_mesh(scene));
  ASSERT_EQ(acting.sections.size(), 1U);
  EXPECT_EQ(acting.sections[0].name, "s");
  EXPECT_TRUE(acting.sections[0].shape.empty());
}

}  // namespace
}  // namespace mixbeam
