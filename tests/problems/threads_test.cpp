// The number of threads does not change a single bit of the answer.
#include "discretization/scene/section_law.hpp"
#include "kernels/execution/execution_space.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/solve.hpp"
#include "tests/support/states.hpp"

namespace mixbeam::test {
namespace {

void expect_same_with_any_number_of_threads(const Scene& scene, SolverParameters parameters = {}) {
  const int threads_before = number_of_threads();
  parameters.threads = 1;
  const Simulation alone = solved(scene, parameters);
  for (int threads : {2, 4}) {
    parameters.threads = threads;
    const Simulation together = solved(scene, parameters);
    EXPECT_TRUE(same_bits(alone.state(), together.state())) << scene.name << ", threads " << threads;
    EXPECT_EQ(alone.result().newton_iterations, together.result().newton_iterations) << scene.name;
    EXPECT_EQ(alone.strain_energy().moment, together.strain_energy().moment) << scene.name;
  }
  set_number_of_threads(threads_before);
}

TEST(Threads, MembersFramesAndJoints) {
  EXPECT_TRUE(solved(angle_frame(11)).state().in_plane);
  for (const Scene& scene : {arc_segment(1e3, 3, 37), fork(2, 11), angle_frame(11), portal_of_joints(2, 7)})
    expect_same_with_any_number_of_threads(scene);
}

TEST(Threads, CoupledSections) {
  Scene scene = arc_segment(1e3, 3, 23);
  Matrix6 matrix{};
  for (int i = 0; i < 6; ++i) matrix[i][i] = diagonal(scene.sections[0])[i];
  matrix[3][4] = matrix[4][3] = 0.3 * matrix[4][4];
  scene.sections[0].matrix = matrix;
  expect_same_with_any_number_of_threads(scene);
}

TEST(Threads, HelicalRod) {
  SolverParameters parameters = careful_path();
  parameters.load_path.method = LoadPathMethod::fixed;
  parameters.load_path.steps = 2;
  expect_same_with_any_number_of_threads(helical_rod(3, 30, 0.1), parameters);
}

TEST(Threads, LineLoadsOnMembersOfSeveralOrders) {
  Scene scene = slope_discontinuity(2, 7);
  scene.members[1].order = 5;
  scene.members[2].force_integration = ForceIntegration::axial_reduced;
  scene.distributed_loads = {{"leg 2", {1, 2, -3}, {0.5, 0, 1}, 1},
                             {"leg 3", {0, 1, 0}, {}, 1},
                             {"leg 1", {0, 1, 2}, {0.5, 0, 0}, 1, LoadFrame::follower}};
  scene.distributed_loads[1].force_formula[2] = "sin(5 * s)";
  scene.eigenstrains = {{"leg 2", {0.01, 0, 0}, {0.1, 0.2, 0}}};
  expect_same_with_any_number_of_threads(scene);
}

// The twin that must fail: another load is another answer, in many bits.
TEST(Threads, ADifferenceWouldBeSeen) {
  const Simulation one = solved(arc_segment(arc_section(100), 600.0, 1.0, 2, 4));
  const Simulation other = solved(arc_segment(arc_section(100), 600.0 * (1.0 + 1e-14), 1.0, 2, 4));
  EXPECT_FALSE(same_bits(one.state(), other.state()));
}

}  // namespace
}  // namespace mixbeam::test
