// The same answer on all ranks together as on one rank alone. ctest runs these on 1, 2 and 3 ranks.
#include "nonlinear/run/accurate_run.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace {

constexpr double kReactionsAgree = 1e-9;  // relative to the largest force or moment of the scene
constexpr double kRanksAgree = 1e-11;     // relative to the largest displacement of the scene

void expect_same_answer(const Simulation& together, const Simulation& alone) {
  const Scene& scene = alone.scene();
  EXPECT_EQ(together.result().newton_iterations, alone.result().newton_iterations) << scene.name;
  const Mesh& mesh = alone.model().mesh();
  double largest = 0.0;
  std::vector<std::array<double, 6>> expected, actual;
  for (int v = 0; v < mesh.vertices(); ++v) {
    expected.push_back(vertex_motion(alone.model(), alone.state(), v));
    actual.push_back(vertex_motion(together.model(), together.state(), v));
    largest = std::max(largest, largest_component({expected[v][0], expected[v][1], expected[v][2]}));
  }
  for (int v = 0; v < mesh.vertices(); ++v) {
    const auto &a = actual[v], &e = expected[v];
    EXPECT_TRUE(agrees({a[0], a[1], a[2]}, {e[0], e[1], e[2]}, kRanksAgree * largest))
        << scene.name << ", vertex " << v;
    EXPECT_TRUE(agrees({a[3], a[4], a[5]}, {e[3], e[4], e[5]}, kRanksAgree * kPi)) << scene.name << ", vertex " << v;
  }
  const StrainEnergy a = together.strain_energy(), e = alone.strain_energy();
  EXPECT_NEAR(a.moment, e.moment, kRanksAgree * (e.force + e.moment)) << scene.name;
  EXPECT_NEAR(a.force, e.force, kRanksAgree * (e.force + e.moment)) << scene.name;
  const std::vector<Reaction> here = together.reactions(), there = alone.reactions();
  ASSERT_EQ(here.size(), there.size());
  double size = 0.0;
  for (const Reaction& reaction : there)
    size = std::max({size, largest_component(reaction.force), largest_component(reaction.moment)});
  for (size_t i = 0; i < there.size(); ++i)
    EXPECT_TRUE(agrees(here[i].force, there[i].force, kReactionsAgree * size)) << scene.name << ", " << here[i].point;
}

void expect_same_answer(const Scene& scene, const SolverParameters& parameters = {}) {
  expect_same_answer(solved(scene, parameters, all_ranks()), solved(scene, parameters, this_rank()));
}

/// Estimates are differences of displacements, which agree but for rounding; relative to the estimate.
constexpr double kEstimatesAgree = 1e-3;

/// On the way to a wanted accuracy: the same meshes for the same reasons, and at its end the same answer.
void expect_same_choice(Scene scene, double accuracy) {
  scene.accuracy = accuracy;
  const AccurateRun together = run_accurately(scene, {}, all_ranks(), false);
  const AccurateRun alone = run_accurately(scene, {}, this_rank(), false);
  EXPECT_EQ(alone.end, AccuracyEnd::reached);
  EXPECT_EQ(together.end, alone.end);
  ASSERT_EQ(together.rounds.size(), alone.rounds.size());
  for (size_t i = 0; i < alone.rounds.size(); ++i) {
    const MeshRound &a = together.rounds[i], &e = alone.rounds[i];
    EXPECT_EQ(a.mesh, e.mesh) << "mesh " << i;
    EXPECT_EQ(a.followed, e.followed) << "mesh " << i;
    EXPECT_EQ(a.iterations, e.iterations) << "mesh " << i;
    EXPECT_EQ(a.remark, e.remark) << "mesh " << i;
    if (!e.remark.empty()) continue;  // left without an estimate
    EXPECT_NEAR(a.error, e.error, kEstimatesAgree * e.error + kRanksAgree) << "mesh " << i;
  }
  expect_same_answer(together.simulation, alone.simulation);
}

/// Samples are complete on the first rank.
void expect_same_samples(const Scene& scene) {
  const Simulation together = solved(scene, {}, all_ranks()), alone = solved(scene);
  const std::vector<MemberSamples> a = together.samples(3), e = alone.samples(3);
  ASSERT_EQ(a.size(), e.size());
  if (all_ranks()->getRank() != 0) return;
  for (size_t m = 0; m < e.size(); ++m) {
    ASSERT_EQ(a[m].size(), e[m].size()) << e[m].name;
    for (size_t i = 0; i < e[m].size(); ++i) {
      EXPECT_TRUE(agrees(a[m].position[i], e[m].position[i], kRanksAgree * 10)) << e[m].name << ", sample " << i;
      EXPECT_EQ(a[m].element[i], e[m].element[i]);
      EXPECT_EQ(a[m].arc_length[i], e[m].arc_length[i]);
    }
  }
}

// The arc of one element has fewer vertices than ranks: one of three ranks owns nothing.
TEST(MpiProblems, MembersFramesAndJoints) {
  for (const Scene& scene : {arc_segment(1e3, 3, 8), arc_segment(100, 2, 2), arc_segment(100, 4, 1), fork(2, 3),
                             slope_discontinuity(4, 2), angle_frame(6), portal_of_joints(2, 1), portal_of_joints(2, 3)})
    expect_same_answer(scene);
  EXPECT_TRUE(solved(angle_frame(6), {}, all_ranks()).state().in_plane);
}

TEST(MpiProblems, LineLoadsOnMembersOfSeveralOrders) {
  Scene scene = slope_discontinuity(2, 3);
  scene.members[1].order = 4;
  scene.distributed_loads = {{"leg 2", {1, 2, -3}, {0.5, 0, 1}, 1},
                             {"leg 3", {0, 1, 0}, {}, 1},
                             {"leg 1", {0, 1, 2}, {0.5, 0, 0}, 1, LoadFrame::follower}};
  scene.distributed_loads[1].force_formula[2] = "sin(5 * s)";
  scene.eigenstrains = {{"leg 2", {0.01, 0, 0}, {0.1, 0.2, 0}}};
  expect_same_answer(scene);
}

TEST(MpiProblems, AccuracyOfAFrame) { expect_same_choice(slope_discontinuity(1, 1), 1e-6); }

TEST(MpiProblems, AccuracyOfABranchedStructure) { expect_same_choice(fork(1, 1), 1e-3); }

// The start mesh knows nothing of a curvature by formula: the solution is carried over to finer ones.
TEST(MpiProblems, AccuracyOnSeveralMeshes) {
  Scene scene = cantilever(section(1e4, 1e4, 1.0, 1.0), 1.0, 1, 1);
  scene.point_loads = {dead_load("tip", {0, 0, 0.1})};
  scene.eigenstrains = {{"beam"}};
  scene.eigenstrains[0].curvature_formula = {"0", "0", "12 * x"};
  expect_same_choice(scene, 1e-6);
}

// The path of the start mesh is left by what the ranks see of it together.
TEST(MpiProblems, AccuracyWhereElementsTurnTooFar) {
  Scene rod = cantilever(section(1e4, 1e4, 1.0, 4.0), 1.0, 1, 1);
  rod.point_loads = {dead_load("tip", {0, 0.5, 0})};
  rod.supports.push_back(support("tip", {}, kHeld));
  rod.supports.back().prescribed_rotation = {20.0, 0, 0};
  expect_same_choice(rod, 1e-5);
}

// The twin: another accuracy is another choice, which the comparison would notice.
TEST(MpiProblems, AnotherAccuracyIsAnotherChoice) {
  Scene scene = slope_discontinuity(1, 1);
  scene.accuracy = 1e-6;
  const AccurateRun together = run_accurately(scene, {}, all_ranks(), false);
  scene.accuracy = 1e-9;
  const AccurateRun alone = run_accurately(scene, {}, this_rank(), false);
  EXPECT_FALSE(together.rounds.back().mesh == alone.rounds.back().mesh);
}

// Large enough to be factorised on all ranks, with a potential and without.
TEST(MpiProblems, Networks) {
  constexpr int kPoints = 10;
  Scene scene = lattice(kPoints);
  expect_same_answer(scene);
  for (PointLoad& load : scene.point_loads) load.moment = {0.03, 0.01, -0.02};
  expect_same_answer(scene);
}

// By conjugate gradients with two levels.
TEST(MpiProblems, NetworksThatAreIteratedWith) {
  SolverParameters iterative;
  iterative.linear.method = kIterative;
  expect_same_answer(shuffled(lattice(10)), iterative);
}

// Cut by the graph, and through hinges beside others.
TEST(MpiProblems, NetworksInNoOrder) {
  Scene scene = shuffled(lattice(6, 2, 2));
  expect_same_answer(scene);
  expect_same_samples(scene);
  scene.joints = {{"pin", "3,3,3", {"3,3,3 to 4,3,3", "2,3,3 to 3,3,3"}}, {"foot", "2,2,2", {"2,2,2 to 2,2,3"}}};
  expect_same_answer(scene);
}

TEST(MpiProblems, Samples) { expect_same_samples(fork(2, 3)); }

/// Elements that the cuts double, ghost vertices and members that are cut, over an equal share of all: a quarter of it
/// on three ranks.
constexpr double kRoomForCuts = 1.4;

// Memory of a rank falls with the number of ranks only while nothing of size is held on each of them.
TEST(MpiProblems, RanksKeepTheirShare) {
  constexpr int kPoints = 10;
  const Scene scene = lattice(kPoints, 1, 2);
  const Model model(scene, all_ranks(), {});
  const Mesh& mesh = model.mesh();
  const SampledMembers samples = sample_own_elements(scene, model, model.reference_state(), 2);
  const auto most = [](std::size_t all) { return kRoomForCuts * static_cast<double>(all) / all_ranks()->getSize(); };
  EXPECT_LE(mesh.elements.kept(), most(mesh.elements.size()));
  EXPECT_LE(mesh.vertex_position.kept(), most(mesh.vertex_position.size()));
  EXPECT_LE(mesh.members.kept(), most(scene.members.size()));
  EXPECT_LE(samples.size(), most(scene.members.size()));
  EXPECT_EQ(samples.members(), scene.members.size());
  EXPECT_EQ(samples.samples(), 2 * mesh.elements.size());
  EXPECT_EQ(model.structure().views.sections.extent(0), scene.sections.size());  // and not for each member
  if (all_ranks()->getSize() == 1) return;
  // the twin: all of it would be noticed
  EXPECT_GT(model.whole_mesh()->elements.kept(), most(mesh.elements.size()));
  EXPECT_THROW(mesh.elements.whole(), std::logic_error);
}

}  // namespace
}  // namespace mixbeam::test
