// Stresses along members from sampled forces: local section of a taper, sections without shape, what a report names.
#include "discretization/state/member_stresses.hpp"
#include "discretization/scene/section_law.hpp"
#include "tests/discretization/stress_sections.hpp"

#include <gtest/gtest.h>

#include <Teuchos_DefaultSerialComm.hpp>

namespace mixbeam::member_stresses_test {
namespace {

constexpr double kRounding = 1e-13;

Section named(const std::string& name, SectionShape shape, std::optional<double> strength = {}) {
  shape.strength = strength;
  return make_section(name, shape);
}

/// Members "m0", "m1", ... of length 2 along x, one after the other, each with its section.
Scene chain_of(const std::vector<Section>& sections) {
  Scene scene;
  scene.sections = sections;
  scene.points.push_back({"p0", {0, 0, 0}});
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const double end = 2.0 * static_cast<double>(i + 1);
    scene.points.push_back({"p" + std::to_string(i + 1), {end, 0, 0}});
    Member member;
    member.name = "m" + std::to_string(i);
    member.start_point = "p" + std::to_string(i);
    member.end_point = "p" + std::to_string(i + 1);
    member.section = sections[i].name;
    scene.members.push_back(member);
  }
  return scene;
}

/// Five samples of each member, moment M2 = forces.moment[1] (1 - s / 2), all else constant.
std::vector<MemberSamples> samples_of(const Scene& scene, const SectionForces& forces) {
  std::vector<MemberSamples> members(scene.members.size());
  for (std::size_t m = 0; m < members.size(); ++m) {
    members[m].name = scene.members[m].name;
    members[m].resize(5);
    for (std::size_t i = 0; i < 5; ++i) {
      members[m].arc_length[i] = 0.5 * static_cast<double>(i);
      members[m].material_force[i] = forces.force;
      members[m].material_moment[i] = forces.moment;
      members[m].material_moment[i][1] *= 1.0 - 0.5 * members[m].arc_length[i];
    }
  }
  return members;
}

StressSummary stresses_of(const Scene& scene, SampledMembers& members) {
  return sample_stresses(scene, build_mesh(scene), Teuchos::rcp(new Teuchos::SerialComm<int>), members);
}

TEST(MemberStresses, AreThoseOfTheSections) {
  Section plain;  // by stiffnesses
  plain.name = "plain";
  set_diagonal(plain, {1, 1, 1, 1, 1, 1});
  const SectionShape circle = test::stress_shape(SectionShapeKind::circle, 0.3, {0.2});
  const Scene scene = chain_of({named("circle", circle, 400.0), plain});
  SectionForces forces;
  forces.force = {3.0, 0.0, 0.0};
  forces.moment = {0.0, 0.5, 0.0};
  SampledMembers members = samples_of(scene, forces);
  const StressSummary summary = stresses_of(scene, members);
  const double axial = 3.0 / (test::kPi * 0.01), bending = 0.5 * 0.1 / (test::kPi * 1e-4 / 4.0);
  EXPECT_NEAR(members[0].largest_normal_stress[0], axial + bending, kRounding * (axial + bending));
  EXPECT_NEAR(members[0].von_mises_stress[2], axial + 0.5 * bending, kRounding * (axial + bending));
  EXPECT_EQ(members[0].largest_shear_stress[4], 0.0);
  EXPECT_TRUE(std::isnan(members[1].von_mises_stress[0]));
  EXPECT_TRUE(members[0].is_complete() && members[1].is_complete());
  ASSERT_EQ(summary.members.size(), 1u);  // nothing is said of the other
  EXPECT_EQ(summary.members[0].member, "m0");
  EXPECT_EQ(summary.members[0].arc_length, 0.0);
  EXPECT_EQ(summary.members[0].length, 2.0);
  EXPECT_NEAR(*summary.members[0].utilisation, (axial + bending) / 400.0, kRounding);
  EXPECT_NEAR(summary.members[0].stresses.von_mises.point[1], 0.1, kRounding);
  EXPECT_NE(*summary.members[0].utilisation, (axial + bending) / 401.0);
}

TEST(MemberStresses, OfATaperAreThoseOfTheLocalSection) {
  const auto circle = [](double d) { return test::stress_shape(SectionShapeKind::circle, 0.3, {d}); };
  Scene scene = chain_of({named("thick", circle(0.4))});
  scene.sections.push_back(named("thin", circle(0.2)));
  scene.members[0].end_section = "thin";
  SectionForces forces;
  forces.moment = {0.0, 1.0, 0.0};
  SampledMembers members = samples_of(scene, forces);
  const StressSummary summary = stresses_of(scene, members);
  for (std::size_t i = 0; i < 5; ++i) {
    const double x = 0.25 * static_cast<double>(i), d = 0.4 - 0.2 * x;
    const double expected = 32.0 * (1.0 - x) / (test::kPi * d * d * d);
    EXPECT_NEAR(members[0].von_mises_stress[i], expected, 1e-12 + kRounding * expected);
  }
  EXPECT_EQ(summary.members[0].arc_length, 1.0);  // (1 - x) / (2 - x)^3 is largest at x = 1/2
}

TEST(MemberStresses, TheFiveMostStressedAreNamedInOrder) {
  std::vector<Section> sections;
  for (int i = 0; i < 8; ++i)
    sections.push_back(named("s" + std::to_string(i),
                             test::stress_shape(SectionShapeKind::circle, 0.3, {0.1 + 0.01 * ((i * 3) % 8)})));
  const Scene scene = chain_of(sections);
  SectionForces forces;
  forces.force = {1.0, 0.0, 0.0};
  SampledMembers members = samples_of(scene, forces);
  const StressSummary summary = stresses_of(scene, members);
  ASSERT_EQ(summary.members.size(), kMostStressed);
  const std::array<const char*, kMostStressed> expected = {"m0", "m3", "m6", "m1", "m4"};  // the thinnest ones
  for (std::size_t i = 0; i < kMostStressed; ++i) EXPECT_EQ(summary.members[i].member, expected[i]);
}

TEST(MemberStresses, StrainsOverTheirLimitAreFound) {
  Section tough = named("tough", test::stress_shape(SectionShapeKind::rectangle, 0.3, {0.1, 0.2}));
  Section soft = tough;
  soft.name = "soft";
  soft.largest_strain = 0.5;
  const Scene scene = chain_of({tough, soft});
  SampledMembers members = samples_of(scene, {});
  members[0].force_strain[3] = {-0.02, 0.0, 0.01};
  members[0].moment_strain[3] = {0.0, 0.3, -0.4};  // 0.02 + 0.3 * 0.1 + 0.4 * 0.05
  members[1].force_strain[2] = {0.3, 0.0, 0.0};
  const StressSummary summary = stresses_of(scene, members);
  EXPECT_EQ(summary.strain.member, "m0");  // 0.07 of 0.05 is more than 0.3 of 0.5
  EXPECT_EQ(summary.strain.arc_length, 1.5);
  EXPECT_NEAR(summary.strain.value, 0.07, kRounding);
  EXPECT_EQ(summary.strain.limit, 0.05);
}

TEST(MemberStresses, CurvedMembersAreJudgedByTheirInnerFibre) {
  const SectionStresses rectangle(test::stress_shape(SectionShapeKind::rectangle, 0.3, {0.1, 0.3}));
  EXPECT_NEAR(rectangle.curvature_error(0.5, 0.0), 0.3 / (3.0 * 2.0), kRounding);  // h / (3 R), about axis 2
  EXPECT_NEAR(rectangle.curvature_error(0.0, -0.5), 0.1 / (3.0 * 2.0), kRounding);
  const SectionStresses circle(test::stress_shape(SectionShapeKind::circle, 0.3, {0.1}));
  EXPECT_NEAR(circle.curvature_error(0.3, -0.4), 3.0 * 0.1 / (8.0 * 2.0), kRounding);  // 3 d / (8 R)
  EXPECT_EQ(circle.curvature_error(0.0, 0.0), 0.0);
}

TEST(MemberStresses, TorsionOfAnOpenSectionIsNoted) {
  const Scene scene = chain_of({named("I", test::walled_shapes()[0].shape)});
  SectionForces forces;
  forces.moment = {0.0, 1.0, 0.0};
  SampledMembers members = samples_of(scene, forces);
  EXPECT_EQ(stresses_of(scene, members).members[0].torsion_share, 0.0);
  forces.moment[0] = 1.0;
  members = samples_of(scene, forces);
  EXPECT_GT(stresses_of(scene, members).members[0].torsion_share, 0.5);
}

}  // namespace
}  // namespace mixbeam::member_stresses_test
