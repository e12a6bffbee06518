#include "nonlinear/run/needs.hpp"

#include "nonlinear/run/simulation.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>
#include <Tpetra_Core.hpp>

namespace mixbeam {
namespace {

/// What is counted without a mesh beside the mesh; the difference, empty where there is none.
std::string miscounted(const Scene& scene, const Needs& needs) {
  const Simulation simulation(scene, {}, Tpetra::getDefaultComm());
  const Mesh& mesh = simulation.model().mesh();
  std::string text;
  const auto compare = [&](const char* what, long long counted, long long there) {
    if (counted != there)
      text += std::string(what) + ": " + std::to_string(counted) + " for " + std::to_string(there) + "\n";
  };
  compare("members", needs.members, static_cast<long long>(mesh.members.size()));
  compare("elements", needs.elements, static_cast<long long>(mesh.elements.size()));
  compare("vertices", needs.vertices, mesh.vertices());
  compare("interior", needs.interior, static_cast<long long>(simulation.model().structure().increment_size));
  compare("planar", needs.planar, simulation.model().plane().has_value());
  return text;
}

/// A cantilever of two members, the second with an inner point that asks for more elements than it has.
Scene two_members(const Vector3& force) {
  Scene scene;
  scene.sections = {test::section(1.0, 1.0, 1.0, 1.0)};
  scene.points = {{"a", {0, 0, 0}}, {"b", {1, 0, 0}}, {"c", {1, 1, 0}}};
  scene.members = {test::line("first", "a", "b", 3, 5), test::line("second", "b", "c", 1, 1)};
  scene.members[1].inner_points = {{"middle", 0.25}};
  scene.supports = {test::clamp("a")};
  PointLoad load;
  load.point = "c";
  load.force = force;
  scene.point_loads = {load};
  return scene;
}

TEST(Needs, CountsWhatTheMeshHas) {
  for (const Vector3& force : {Vector3{1, 2, 0}, Vector3{1, 2, 3}}) {
    Scene scene = two_members(force);
    EXPECT_EQ(miscounted(scene, needs_of(scene, {})), "");
    EXPECT_EQ(needs_of(scene, {}).planar, force[2] == 0.0);
    scene.joints = {{"pin", "b", {"second"}, JointKind::hinge, {0, 0, 1}}};
    EXPECT_EQ(miscounted(scene, needs_of(scene, {})), "");
    const Needs jointed = needs_of(scene, {});
    scene.members[0].elements += 1;
    EXPECT_NE(miscounted(scene, jointed), "") << "those of another mesh";
  }
}

TEST(Needs, GrowWithElementsAndOrderAndWithWhatIsAsked) {
  Scene scene = two_members({1, 2, 3});
  scene.members[0].elements = 100'000;
  scene.members[0].order = 1;
  SolverParameters plain;
  plain.analysis.stability = false;
  plain.analysis.error_estimate = ErrorEstimation::off;
  const double small = needs_of(scene, plain).memory;
  scene.members[0].elements *= 2;
  EXPECT_NEAR(needs_of(scene, plain).memory / small, 2.0, 0.3);
  SolverParameters asked = plain;
  asked.analysis.error_estimate = ErrorEstimation::on;
  EXPECT_GT(needs_of(scene, asked).memory, needs_of(scene, plain).memory);
  scene.members[0].order = 4;
  EXPECT_GT(needs_of(scene, plain).memory, 1.5 * 2.0 * small);
}

TEST(Needs, ACoarseSceneHasFewElementsAndTheSamePoints) {
  Scene scene = two_members({1, 2, 3});
  EXPECT_EQ(coarse_scene(scene, 100).members[0].elements, 5) << "small ones stay as they are";
  scene.members[0].elements = 1'000'000;
  const Scene coarse = coarse_scene(scene, 100);
  EXPECT_LE(coarse.members[0].elements, 100);
  EXPECT_EQ(coarse.members[1].elements, scene.members[1].elements);
  EXPECT_NO_THROW(build_mesh(coarse));
}

}  // namespace
}  // namespace mixbeam
