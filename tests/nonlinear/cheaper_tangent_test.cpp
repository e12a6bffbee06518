// Cheaper arithmetic in the tangent changes the way to an equilibrium, never the equilibrium.
#include "kernels/execution_space.hpp"
#include "nonlinear/chain_solver.hpp"
#include "tests/nonlinear/beam_fixture.hpp"

#include <vector>

namespace mixbeam::test::cheaper_tangent_test {
namespace {

/// Both solutions have residuals below 1e-11; the softest motion of these structures answers to 1e-11 with 1e-9.
constexpr double kSameSolution = 1e-8;

/// A cantilever bent in its plane far beyond what one linear step sees.
Scene planar_scene(double force = 4.0) {
  Scene scene = cantilever(section(1e4, 5e3, 2.0, 1.0), 1.0, 2, 40);
  scene.point_loads = {dead_load("tip", {0, force, 0})};
  return scene;
}

/// Along the member, in space: what has no potential.
Scene scene_without_potential(double size = 1.0) {
  Scene scene = cantilever(section(1100.0, 700.0, 5.0, 3.0), 2.0, 2, 40);
  DistributedLoad load;
  load.member = "beam";
  load.force = {0.3 * size, 1.0 * size, -0.7 * size};
  load.couple = {0.5 * size, -0.2 * size, 0.4 * size};
  load.frame = LoadFrame::follower;
  scene.distributed_loads = {load};
  load.force = {};
  load.couple = {0.0, 0.3 * size, 0.2 * size};
  load.frame = LoadFrame::dead;
  scene.distributed_loads.push_back(load);
  return scene;
}

std::vector<Scene> scenes() {
  Scene follower = planar_scene(0.0);
  follower.point_loads = {follower_load("tip", "beam", {0, 1.5, 0.5}, {0.2, 0, 0.1})};
  return {planar_scene(), arc_segment(100.0, 2, 40), scene_without_potential(), follower, fork(2, 12)};
}

SolverParameters symmetric() {
  SolverParameters parameters;
  parameters.symmetric_tangent = true;
  return parameters;
}

/// Largest difference of displacements of vertices, relative to the largest displacement.
double difference(const Simulation& a, const Simulation& b) {
  const auto x = a.state().views.vertex_displacement, y = b.state().views.vertex_displacement;
  double worst = 0.0, largest = 0.0;
  for (size_t v = 0; v < x.extent(0); ++v)
    for (int i = 0; i < 3; ++i) {
      worst = std::max(worst, std::abs(x(v, i) - y(v, i)));
      largest = std::max(largest, std::abs(y(v, i)));
    }
  return worst / largest;
}

void expect_same_solutions(const SolverParameters& parameters) {
  for (const Scene& scene : scenes())
    EXPECT_LE(difference(solved(scene, parameters), solved(scene)), kSameSolution) << scene.name;
}

void expect_same_bits_for_any_number_of_threads(SolverParameters parameters) {
  const int before = number_of_threads();
  for (const Scene& scene : scenes()) {
    parameters.threads = 1;
    const Simulation alone = solved(scene, parameters);
    for (int threads : {2, 4}) {
      parameters.threads = threads;
      EXPECT_TRUE(same_bits(alone.state(), solved(scene, parameters).state())) << scene.name << ", " << threads;
    }
  }
  set_number_of_threads(before);
}

// The twin that must fail: another load is another solution.
TEST(CheaperTangent, AnotherSolutionWouldBeSeen) {
  EXPECT_GT(difference(solved(planar_scene(4.0 * (1.0 + 1e-6)), symmetric()), solved(planar_scene())),
            10.0 * kSameSolution);
}

TEST(SymmetricTangent, SameSolution) { expect_same_solutions(symmetric()); }
TEST(SymmetricTangent, SameBitsForAnyNumberOfThreads) { expect_same_bits_for_any_number_of_threads(symmetric()); }

// Members under loads without a potential become chains of symmetric tangents, and more iterations are needed.
TEST(SymmetricTangent, CondensesMembersUnderLoadsWithoutPotential) {
  const Scene scene = scene_without_potential();
  const Simulation exact = solved(scene), simpler = solved(scene, symmetric());
  EXPECT_EQ(CondensedSystem(exact.assembler()).eliminated_vertices(), 0);
  EXPECT_EQ(CondensedSystem(simpler.assembler()).eliminated_vertices(), simpler.assembler().mesh().vertices() - 2);
  EXPECT_GT(simpler.work().newton_iterations, exact.work().newton_iterations);
}

// Stability is that of the tangent as it is: a follower load that a column carries far beyond Euler's load.
TEST(SymmetricTangent, LeavesTheTangentForStabilityAlone) {
  const Scene scene = scene_without_potential();
  BeamFixture exact(scene, 1.0), simpler(scene, 1.0, [] {
    SolverParameters parameters = without_cap();
    parameters.symmetric_tangent = true;
    return parameters;
  }());
  for (BeamFixture* fixture : {&exact, &simpler}) {
    fixture->group().computeF();
    fixture->group().computeJacobian();
  }
  const auto norm_of_difference = [&] {
    const Teuchos::RCP<DofMatrix> a = exact.problem().assembler.matrix(), b = simpler.problem().assembler.matrix();
    double worst = 0.0;
    const auto x = a->getLocalMatrixHost(), y = b->getLocalMatrixHost();
    for (size_t k = 0; k < x.values.extent(0); ++k) worst = std::max(worst, std::abs(x.values(k) - y.values(k)));
    return worst;
  };
  EXPECT_GT(norm_of_difference(), 1e-3);
  for (BeamFixture* fixture : {&exact, &simpler}) {
    const BeamGroup& group = fixture->group();
    fixture->problem().assembler.tangent(group.state(), group.load_factor());
  }
  EXPECT_EQ(norm_of_difference(), 0.0);
}

}  // namespace
}  // namespace mixbeam::test::cheaper_tangent_test
