/// What acts on vertices beside the elements: rows against energy, tangent against rows.
#include "discretization/constraints/external_energy.hpp"
#include "discretization/assembly/model.hpp"

#include "tests/support/constrained_scenes.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/states.hpp"

#include <gtest/gtest.h>

#include <set>

namespace mixbeam::test {
namespace {

/// Central differences: rounding of the energy over the step is 1e-16 / 1e-6, of values up to 200 (the spring's
/// stiffness); their own error is of second order, 1e-12. A hundred times that is allowed.
constexpr double kStep = 1e-6, kAccuracy = 1e-8, kLargestValue = 200.0;

/// A spring in skew axes, loads in space without moments: all of it has a potential.
Scene scene_with_potential() {
  Scene scene = portal_of_joints(2, 2);
  scene.point_loads.pop_back();
  for (PointLoad& load : scene.point_loads) load.moment = {};
  scene.supports[1].displacement_stiffness = {0, 200.0, 0};
  return scene;
}

/// Of an increment of displacements alone.
MixedVector some_motion(const Model& model, unsigned seed) {
  MixedVector motion = model.create_vector();
  fill_at_random(motion, 1.0, seed);
  const auto rows = motion.vertex();
  for (size_t i = 0; i < rows.extent(0); ++i)
    if (i % kVertexDofs >= 3) rows(i) = 0.0;
  return motion;
}

double product(const KernelView<double*>& a, const KernelView<double*>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.extent(0); ++i) sum += a(i) * b(i);
  return sum;
}

void add_rows(const Model& model, const State& state, double load_factor, MixedVector& rows) {
  for (const auto& energy : model.external()) energy->add_rows(state, load_factor, rows.vertex());
}
double energy_of(const Model& model, const State& state) {
  double sum = 0.0;
  for (const auto& energy : model.external()) sum += energy->energy(state, 0.7);
  return sum;
}

TEST(ExternalEnergy, RowsAreItsGradient) {
  const Model model(scene_with_potential(), this_rank(), {});
  const State state = model.apply(model.reference_state(), some_motion(model, 1), 0.3);
  MixedVector rows = model.create_vector();
  rows.fill(0.0);
  add_rows(model, state, 0.7, rows);
  const MixedVector way = some_motion(model, 2);
  const double change =
      energy_of(model, model.apply(state, way, kStep)) - energy_of(model, model.apply(state, way, -kStep));
  EXPECT_NEAR(change / (2.0 * kStep), product(rows.vertex(), way.vertex()), kLargestValue * kAccuracy);
  EXPECT_GT(std::abs(change / kStep), 1.0);
}

TEST(ExternalEnergy, SlopesAreTheDerivativeWithRespectToTheLoadFactor) {
  const Model model(portal_of_joints(2, 2), this_rank(), {});
  const State state = model.apply(model.reference_state(), some_motion(model, 3), 0.3);
  MixedVector slopes = model.create_vector(), change = slopes.clone(false), before = slopes.clone(false);
  slopes.fill(0.0);
  change.fill(0.0);
  before.fill(0.0);
  for (const auto& energy : model.external()) energy->add_slopes(state, 0.5, slopes.vertex());
  add_rows(model, state, 0.5 + kStep, change);
  add_rows(model, state, 0.5 - kStep, before);
  change.update(-1.0, before, 1.0);
  change.scale(1.0 / (2.0 * kStep));
  change.update(-1.0, slopes, 1.0);
  EXPECT_LE(change.maximum_norm(), kAccuracy);
  EXPECT_GT(slopes.maximum_norm(), 1.0);
}

/// Forces of supports are reactions, not loads. Vertices of springs, of moments and of followers stay in the condensed
/// system, those of dead forces need not.
TEST(ExternalEnergy, SupportsAreNoLoads) {
  const Model model(scene_with_potential(), this_rank(), {});
  const State state = model.apply(model.reference_state(), some_motion(model, 4), 0.3);
  std::set<int> kept, expected;
  for (const auto& energy : model.external()) {
    MixedVector rows = model.create_vector();
    rows.fill(0.0);
    energy->add_rows(state, 0.0, rows.vertex());
    EXPECT_EQ(rows.maximum_norm() > 1.0, energy->is_support());
    for (const int vertex : energy->vertices()) kept.insert(vertex);
  }
  expected.insert(vertex_of(model.mesh(), "E"));
  EXPECT_EQ(kept, expected);
}

}  // namespace
}  // namespace mixbeam::test
