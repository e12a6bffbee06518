// A state carried over to other orders and meshes: what the new elements can express comes over to rounding.
#include "discretization/state/transfer.hpp"

#include "discretization/state/sampling.hpp"
#include "kernels/element/layout.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/states.hpp"

#include <gtest/gtest.h>

namespace mixbeam::test {
namespace {

/// Fields of a size of one, and forces up to a hundred.
constexpr double kRounding = 1e-12;

/// Any state: every unknown drawn at random, so that nothing happens to fit.
State moved_at_random(const Model& model, double size) {
  MixedVector increment = model.create_vector();
  std::mt19937_64 generator(1234);
  std::uniform_real_distribution<double> entry(-size, size);
  const auto vertex = increment.vertex();
  for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) = entry(generator);
  const auto interior = increment.writable_interior(false);
  for (size_t i = 0; i < interior.extent(0); ++i) interior(i) = entry(generator);
  return model.apply(model.reference_state(), increment, 1.0);
}

enum class Rotations { compared, left_out };

/// Largest difference of displacements, rotations, forces and moments at points of all members.
double largest_difference(const Model& a, const State& in_a, const Model& b, const State& in_b,
                          Rotations rotations = Rotations::compared) {
  double largest = 0.0;
  const auto note = [&largest](double value) { largest = std::max(largest, value); };
  for (size_t m = 0; m < a.scene().members.size(); ++m)
    for (double position : {0.013, 0.21, 0.37, 0.48, 0.66, 0.79, 0.987}) {
      const PointSample p = sample_member(a, in_a, static_cast<int>(m), position);
      const PointSample q = sample_member(b, in_b, static_cast<int>(m), position);
      note(norm(p.displacement - q.displacement));
      note(norm(p.force - q.force));
      note(norm(p.moment - q.moment));
      if (rotations == Rotations::compared) note(norm(log_quaternion(conjugate(p.triad) * q.triad)));
    }
  return largest;
}

double largest_vertex_difference(const Model& a, const State& in_a, const Model& b, const State& in_b) {
  double largest = 0.0;
  for (const auto& [point, vertex] : a.mesh().vertex_of_point) {
    const auto p = vertex_motion(a, in_a, vertex), q = vertex_motion(b, in_b, vertex_of(b.mesh(), point));
    for (int i = 0; i < 6; ++i) largest = std::max(largest, std::abs(p[i] - q[i]));
  }
  return largest;
}

Scene with_orders(Scene scene, int order) {
  for (Member& member : scene.members) member.order = order;
  return scene;
}

Scene with_elements(Scene scene, int elements) {
  for (Member& member : scene.members) member.elements = elements;
  return scene;
}

Scene spline(int order, int elements) {
  Scene scene = cantilever(section(1e3, 1e3, 1.0, 1.0), 1.0, order, elements);
  scene.members[0].curve.shape = CurveShape::spline;
  scene.members[0].curve.through = {{0.3, 0.2, 0.0}, {0.7, -0.1, 0.2}};
  return scene;
}

TEST(StateTransfer, HigherOrderReproducesEveryField) {
  for (const Scene& scene : {fork(1, 3), portal_of_joints(1, 2)})
    for (int order : {2, 3, 5, 7}) {
      const Model low(with_orders(scene, order), this_rank(), {}), high(with_orders(scene, order + 1), this_rank(), {});
      const State state = moved_at_random(low, 0.2);
      const State carried = transfer(low, state, high);
      EXPECT_LT(largest_difference(low, state, high, carried), kRounding) << scene.name << ", order " << order;
      EXPECT_LT(largest_vertex_difference(low, state, high, carried), kRounding) << scene.name;
    }
}

TEST(StateTransfer, DifferencesAreSeen) {
  const Model low(fork(3, 3), this_rank(), {}), high(fork(4, 3), this_rank(), {});
  const State carried = transfer(low, moved_at_random(low, 0.2), high);
  EXPECT_GT(largest_difference(low, moved_at_random(low, 0.2 + 1e-9), high, carried), kRounding);
}

TEST(StateTransfer, OneRuleOfIntegrationToAnother) {
  Scene full = with_orders(fork(3, 2), 3);
  for (Member& member : full.members) member.force_integration = ForceIntegration::shear_reduced;
  const Model low(full, this_rank(), {}), high(fork(5, 2), this_rank(), {});
  const State state = moved_at_random(low, 0.2);
  EXPECT_LT(largest_difference(low, state, high, transfer(low, state, high)), kRounding);
}

TEST(StateTransfer, UndeformedStaysUndeformed) {
  for (const Scene& scene : {spline(1, 4), fork(1, 2)})
    for (int order : {1, 2, 4, 8})
      for (int elements : {3, 4, 7}) {
        const Model from(scene, this_rank(), {}),
            to(with_elements(with_orders(scene, order), elements), this_rank(), {});
        const State carried = transfer(from, from.reference_state(), to);
        EXPECT_LT(largest_difference(to, to.reference_state(), to, carried), kRounding) << order << " " << elements;
      }
}

TEST(StateTransfer, FinerMeshReproducesPolynomials) {
  for (const Scene& scene : {fork(1, 2), portal_of_joints(1, 1), spline(1, 2)})
    for (int order : {1, 3, 8}) {
      const Model coarse(with_orders(scene, order), this_rank(), {});
      const Model fine(with_elements(with_orders(scene, order), 3 * scene.members[0].elements), this_rank(), {});
      const State state = moved_at_random(coarse, 0.1);
      const State carried = transfer(coarse, state, fine);
      EXPECT_LT(largest_difference(coarse, state, fine, carried, Rotations::left_out), kRounding) << scene.name;
      EXPECT_LT(largest_vertex_difference(coarse, state, fine, carried), kRounding) << scene.name;
      const State back = transfer(fine, carried, coarse);
      EXPECT_LT(largest_difference(coarse, state, coarse, back, Rotations::left_out), kRounding) << scene.name;
    }
}

// psi of the parts is not that of the whole, which is a polynomial: the more degrees there are, the nearer it comes.
TEST(StateTransfer, RotationsConvergeInFinerElements) {
  const Model coarse(fork(3, 2), this_rank(), {});
  const State state = moved_at_random(coarse, 0.2);
  std::vector<double> difference;
  for (int order : {3, 5, 7}) {
    const Model fine(fork(order, 4), this_rank(), {});
    difference.push_back(largest_difference(coarse, state, fine, transfer(coarse, state, fine)));
  }
  EXPECT_LT(difference[1], 0.2 * difference[0]);
  EXPECT_LT(difference[2], 0.5 * difference[1]);
}

TEST(StateTransfer, MeshesThatShareNoVertex) {
  Scene scene = spline(4, 5);
  const Model from(scene, this_rank(), {});
  MixedVector increment = from.create_vector();
  increment.fill(0.0);
  const auto vertex = increment.vertex();
  for (int v = 0; v < from.mesh().vertices(); ++v)  // smooth: it bends by the square of the arc length
    vertex(kVertexDofs * v + 2) = 0.04 * v * v / 25.0;
  const State state = from.apply(from.reference_state(), increment, 1.0);
  const Model to(with_elements(scene, 7), this_rank(), {});
  const State carried = transfer(from, state, to);
  constexpr double kKinks = 2e-3;  // of the slope, at the old vertices
  EXPECT_LT(largest_difference(from, state, to, carried, Rotations::left_out), kKinks);
}

TEST(StateTransfer, OtherSceneIsRefused) {
  const Model from(fork(2, 2), this_rank(), {}), to(spline(2, 2), this_rank(), {});
  EXPECT_THROW(transfer(from, from.reference_state(), to), std::invalid_argument);
}

TEST(MpiStateTransfer, SameBitsOnAllRanks) {
  const Scene scene = fork(2, 5), finer = with_elements(with_orders(scene, 3), 7);
  const Model from(scene, this_rank(), {}), from_together(scene, all_ranks(), {});
  const Model to(finer, this_rank(), {}), to_together(finer, all_ranks(), {});
  const State state = moved_at_random(from, 0.1);
  const StateSnapshot expected = snapshot_of(to, transfer(from, state, to));
  const State shared = restore(from_together, snapshot_of(from, state));
  const StateSnapshot actual = snapshot_of(to_together, transfer(from_together, shared, to_together));
  if (all_ranks()->getRank() != 0) return;
  EXPECT_EQ(actual.vertex_displacement, expected.vertex_displacement);
  EXPECT_EQ(actual.vertex_rotation, expected.vertex_rotation);
  EXPECT_EQ(actual.element_triad, expected.element_triad);
  EXPECT_EQ(actual.interior, expected.interior);
}

}  // namespace
}  // namespace mixbeam::test
