/// Weights, combinations, projected loads and loads on a part of a member: their sums, exactly, and what they bend.
#include "discretization/scene/load_cases.hpp"
#include "discretization/scene/section_shape.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace {

constexpr double kCoarseQuadrature = 1e-6, kQuadrature = 1e-9;  // of a curved load by 4 and 16 elements of order 4
constexpr double kOfPart = 1e-6;  // share of a moment that belongs to the deflection of a load this small
constexpr double kSum = 1e-10;    // of the largest force: loads and reactions balance to that

Vector3 sum_of_reactions(const Simulation& simulation) {
  Vector3 sum{};
  for (const Reaction& reaction : simulation.reactions())
    for (int i = 0; i < 3; ++i) sum[i] += reaction.force[i];
  return sum;
}

/// A quarter circle of radius 2 that rises from the clamp at the origin along e1 to a level end.
Scene quarter() {
  Scene scene;
  scene.name = "quarter";
  scene.sections = {section(1e6, kRigid, 50.0, 50.0)};
  scene.points = {{"foot", {0, 0, 0}}};
  scene.members = {arc("arch", "foot", "top", {2, 0, 0}, {0, 1, 0}, kPi / 2.0, 4, 4)};
  scene.supports = {clamp("foot")};
  return scene;
}

DistributedLoad line_load(const Vector3& force) {
  DistributedLoad load;
  load.member = "arch";
  load.force = force;
  return load;
}

TEST(PartsOfLineLoads, SnowWeighsWhatLiesBelowIt) {
  Scene scene = quarter();
  scene.distributed_loads = {line_load({0, 0, -3.0})};
  const double along = sum_of_reactions(solved(scene))[2];
  EXPECT_NEAR(along, 3.0 * kPi, kQuadrature);  // the twin: along the arc
  scene.distributed_loads[0].is_projected = true;
  EXPECT_NEAR(sum_of_reactions(solved(scene))[2], 3.0 * 2.0,
              kCoarseQuadrature);  // over its horizontal projection, by quadrature
  scene.members[0].elements = 16;
  EXPECT_NEAR(sum_of_reactions(solved(scene))[2], 3.0 * 2.0, kQuadrature);
}

TEST(PartsOfLineLoads,
     APartBendsAsIntegralsTell) {  // cantilever, load q on the outer half: M = q/8 L^2 * 3 at the clamp
  const double q = 1e-3, length = 2.0;
  Scene scene = cantilever(section(1e6, kRigid, 50.0, 50.0), length, 3, 4);
  DistributedLoad load = line_load({0, q, 0});
  load.member = "beam";
  load.range = {0.5, 1.0};
  scene.distributed_loads = {load};
  const Simulation half = solved(scene);
  EXPECT_NEAR(sum_of_reactions(half)[1], -q * 0.5 * length, kSum);
  EXPECT_NEAR(half.reactions()[0].moment[2], -q * 0.5 * length * 0.75 * length, kOfPart * q);
  EXPECT_NEAR(half.sample("beam", 0.6).force[1], q * 0.4 * length, kOfPart * q);
}

/// Truncated cone of length 3 and density 100 between diameters 0.4 and 0.1, in which `taper` goes from one to the
/// other.
Scene heavy_cone(const std::string& taper) {
  SectionShape wide, narrow;
  wide.kind = narrow.kind = SectionShapeKind::circle;
  wide.youngs_modulus = narrow.youngs_modulus = 1e9;
  wide.density = narrow.density = 100.0;
  wide.size2 = 0.4;
  narrow.size2 = 0.1;
  Scene scene = cantilever(make_section("wide", wide), 3.0, 3, 4);
  scene.sections.push_back(make_section("narrow", narrow));
  scene.members[0].section = "wide";
  scene.members[0].end_section = "narrow";
  scene.members[0].taper = taper;
  EXPECT_NEAR(scene.sections[0].mass, 100.0 * kPi * 0.04, 1e-12);
  DistributedLoad weight = line_load({0, 0, -10.0 * scene.sections[0].mass});
  weight.member = "beam";
  weight.is_weight = true;
  scene.distributed_loads = {weight};
  return scene;
}

TEST(PartsOfLineLoads, WeightOfATaperIsThatOfItsVolume) {  // V = pi L (R^2 + R r + r^2) / 3
  const auto volume = [](double R, double r) { return kPi * 3.0 * (R * R + R * r + r * r) / 3.0; };
  const auto weight = [](const Scene& scene) { return sum_of_reactions(solved(scene))[2]; };
  const double whole = volume(0.2, 0.05);
  EXPECT_NEAR(weight(heavy_cone("")), 1000.0 * whole, kSum * 1e3 * whole);
  EXPECT_NEAR(weight(heavy_cone("1 - x")), 1000.0 * whole, kSum * 1e3 * whole);  // the start section stands at the end
  EXPECT_NEAR(weight(heavy_cone("0.5 + 0.5 * x")), 1000.0 * volume(0.125, 0.05), kSum * 1e3 * whole);
}

TEST(PartsOfLineLoads, WeightOfATaperFromASectionWithoutMass) {
  Scene scene = heavy_cone("");
  for (Section& part : scene.sections) part.shape.reset();
  scene.sections[0].mass = 0.0;
  scene.sections[1].mass = 2.0;
  scene.distributed_loads[0].force = {0, 0, -10.0 * 2.0};
  EXPECT_NEAR(sum_of_reactions(solved(scene))[2], 10.0 * 0.5 * 2.0 * 3.0, kSum * 30.0);
}

TEST(Combinations, ScaleCasesAndStagesAndAreSolvedByThemselves) {
  Scene scene = cantilever(section(1e6, kRigid, 50.0, 50.0), 2.0, 3, 4);
  scene.load_cases = {"push", "lift"};
  PointLoad push = dead_load("tip", {0, 2.0, 0}), lift = dead_load("tip", {0, 0, 3.0}),
            always = dead_load("tip", {-1, 0, 0});
  push.load_case = "push";
  lift.load_case = "lift";
  scene.point_loads = {push, lift, always};
  scene.distributed_loads = {line_load({0, 0, 0})};
  scene.distributed_loads[0].member = "beam";
  scene.distributed_loads[0].load_case = "lift";
  scene.distributed_loads[0].force_formula = {"0", "0", "x"};
  scene.combinations = {{"both", {{"push", 1.5}, {"lift", -0.5}}, {}}, {"staged", {{"push", 1.0}}, {{1, 4.0}}}};
  EXPECT_EQ(alternatives(scene), (std::vector<std::string>{"push", "lift", "both", "staged"}));
  const Simulation both = solved(scene_of_case(scene, "both"));
  EXPECT_LE(distance(sum_of_reactions(both), {1.0, -3.0, 0.5 * (3.0 + 0.5 * 2.0)}), kSum);
  EXPECT_LE(distance(sum_of_reactions(solved(scene_of_case(scene, "staged"))), {4.0, -8.0, 0}), kSum);
  EXPECT_LE(distance(sum_of_reactions(solved(scene_of_case(scene, "lift"))), {1.0, 0, -4.0}), kSum);
  // no superposition: displacements of the combination are not the sums of those of its cases
  const double added = 1.5 * solved(scene_of_case(scene, "push")).displacement("tip")[1];
  EXPECT_GT(std::abs(both.displacement("tip")[1] - added), 1e-3);
}

}  // namespace
}  // namespace mixbeam::test
