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

double product(const KernelView<const double*>& a, const KernelView<const double*>& b) {
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

/// Bodies of any inertia anywhere in a frame that turns.
Scene scene_of_bodies() {
  Scene scene = portal_of_joints(2, 2);
  scene.point_loads.clear();
  for (Support& support : scene.supports) support.displacement_stiffness = {};
  scene.point_masses = {{"G", 2.0, {0.5, 0.7, 0.9}}, {"C", 1.5, {0.2, 0.3, 0.4}}};
  scene.point_masses[0].axes = {{{0, 0.6, 0.8}, {1, 0, 0}, {0, 0.8, -0.6}}};
  scene.rotating_frames = {{{0.3, -0.2, 0.4}, {0.5, -1.2, 0.8}}};
  return scene;
}

TEST(ExternalEnergy, BodiesInAFrameHaveTheRowsAndTheTangentOfTheirEnergy) {
  constexpr double kSecond = 1e-4, kOfSecond = 1e-6;  // second differences: rounding 1e-16 / 1e-8 of 100, and 1e-8
  const Model model(scene_of_bodies(), this_rank(), {});
  MixedVector start = model.create_vector(), way = start.clone(false);
  fill_at_random(start, 0.5, 5);
  fill_at_random(way, 1.0, 6);
  const State state = model.apply(model.reference_state(), start, 1.0);
  const auto energy = [&](double step) { return energy_of(model, model.apply(state, way, step)); };
  MixedVector rows = model.create_vector(), slopes = rows.clone(false);
  rows.fill(0.0);
  slopes.fill(0.0);
  add_rows(model, state, 0.7, rows);
  const double change = (energy(kStep) - energy(-kStep)) / (2.0 * kStep);
  EXPECT_NEAR(change, product(rows.vertex(), way.vertex()), kLargestValue * kAccuracy);
  EXPECT_GT(std::abs(change), 1e5 * kAccuracy);
  const VertexMatrix matrix = whole_matrix(model);
  const KernelView<double**> none("none", model.structure().local_elements(), kFullTangent);
  matrix.gather(LinkMatrices<kSpatialDofs>{none, {}});
  for (const auto& one : model.external()) one->add_tangent(state, 0.7, matrix.rows());
  DofVector image(model.map());
  matrix.matrix()->apply(way.vertex_dofs(), image);
  const double second = (energy(kSecond) - 2.0 * energy(0.0) + energy(-kSecond)) / (kSecond * kSecond);
  EXPECT_NEAR(image.dot(way.vertex_dofs()), second, kLargestValue * kOfSecond);
  for (const auto& one : model.external()) one->add_slopes(state, 0.7, slopes.vertex());
  slopes.update(-2.0 / 0.7, rows, 1.0);  // they grow with the square of the load factor
  EXPECT_LE(slopes.maximum_norm(), kAccuracy);
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
