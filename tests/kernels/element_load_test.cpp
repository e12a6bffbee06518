/// Dead and follower line loads and eigenstrains, linear along the element: residual against virtual work, and the
/// tangent of the loads that have no energy.
#include "tests/kernels/element_comparison.hpp"

#include <gtest/gtest.h>

#include <Teuchos_LAPACK.hpp>

namespace mixbeam::element_test {
namespace {

/// Residual of an element with loads and section of order 1 to 10 in equilibrium (measured: 6e-15).
constexpr double kEquilibriumTolerance = 1e-13;
/// One step of Newton's method squares a residual; the factor in these units is at most 1.3.
constexpr double kQuadraticFactor = 5.0;
/// From the first step on: residuals of 1, 0.1, 1e-3, 1e-7, 1e-14, and one to spare.
constexpr int kNewtonSteps = 6;

ElementSample loaded_sample(const SampleRecipe& recipe) {
  ElementSample sample = random_sample(recipe);
  add_fields(sample.element, kAllFields, recipe.seed);
  return sample;
}

/// Energy of the element minus the virtual work of its loads.
std::vector<double> total_gradient(const EnergyElement& element, const EnergyState<double>& state) {
  return gradient_at_zero(number_of_increments(state), [&](const Fad* x) {
    const EnergyState<Fad> after = perturbed(state, x);
    return Fad(element_energy(element, after) - line_load_work(element, converted<Fad>(state), after));
  });
}

/// d(row)/d(increment), where the rows of the changed state belong to spins on top of the changed rotations: the
/// residual as the kernels evaluate it there. Not symmetric.
Dense residual_derivative(const EnergyElement& element, const EnergyState<double>& state) {
  return mixed_derivatives_at_zero(
      number_of_increments(state), false, [&](const FadOfFad* variation, const FadOfFad* increment) {
        const EnergyState<FadOfFad> before = perturbed(state, increment), after = perturbed(before, variation);
        return FadOfFad(element_energy(element, after) - line_load_work(element, before, after));
      });
}

/// matrix += factor hat(moment) in the spin block that begins at `row`.
void add_hat(Dense& matrix, int row, double factor, const double* moment) {
  const Mat3<double> h = hat(Vec3<double>{{moment[0], moment[1], moment[2]}});
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) matrix(row + i, row + j) += factor * h(i, j);
}

/// The matrix the kernels condense. The derivative D of the residual along a spin is, with R the whole row of that spin
/// (loads included), D + hat(R)/2 for the vertices (spins from the left) and D - hat(R)/2 for the element (from the
/// right): without couples that is the symmetric Hessian of the energy, and where the row is in equilibrium it is D
/// itself. The row of a vertex is in equilibrium with the other elements and the loads at this vertex.
Dense kernel_matrix(const EnergyElement& element, const EnergyState<double>& state,
                    const std::vector<double>& gradient) {
  Dense matrix = residual_derivative(element, state);
  add_hat(matrix, 3, 0.5, &gradient[3]);
  add_hat(matrix, 9, 0.5, &gradient[9]);
  add_hat(matrix, matrix.size - 3, -0.5, &gradient[matrix.size - 3]);
  return matrix;
}

class ElementLoad : public testing::TestWithParam<int> {};

TEST_P(ElementLoad, ResidualIsTheVirtualWork) {
  for (const ForceIntegration rule : kAllRules)
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const SampleRecipe recipe{GetParam(), rule, seed};
      const ElementSample sample = loaded_sample(recipe);
      const SampleBlock samples({sample}, true);
      evaluate_residual(samples.block, samples.structure, samples.state, samples.equations);
      EXPECT_LE(difference(weighted_rows(samples, 0, sample.element), total_gradient(sample.element, sample.state),
                           kinds_of(sample.state)),
                kGradientTolerance)
          << recipe;
    }
}

TEST_P(ElementLoad, TangentIsTheDerivativeOfTheResidual) {
  const SampleRecipe recipe{GetParam(), kAllRules[GetParam() % 4], 41};  // another rule for each order: all are seen
  const ElementSample sample = loaded_sample(recipe);
  const SampleBlock samples({sample}, true);
  evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
  const std::vector<double> gradient = total_gradient(sample.element, sample.state);
  const CondensedDifference d =
      condensed_difference(samples, sample, kernel_matrix(sample.element, sample.state, gradient), gradient);
  EXPECT_LE(d.largest(), kTangentTolerance) << d << "\n" << recipe;
}

/// With the couple that balances the element's moments the element block needs no correction.
TEST_P(ElementLoad, TangentInEquilibriumOfMoments) {
  const SampleRecipe recipe{GetParam(), ForceIntegration::both_reduced, 51};
  ElementSample sample = random_sample(recipe);
  const std::vector<double> internal = energy_gradient(sample.element, sample.state);
  const double* spin = &internal[internal.size() - 3];
  sample.element.line_couple = (1.0 / sample.element.curve.length) * (rotation_matrix(sample.state.element_triad) *
                                                                      Vec3<double>{{spin[0], spin[1], spin[2]}});
  const SampleBlock samples({sample}, true);
  evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
  const std::vector<double> gradient = total_gradient(sample.element, sample.state);
  Dense derivative = residual_derivative(sample.element, sample.state);
  add_hat(derivative, 3, 0.5, &gradient[3]);
  add_hat(derivative, 9, 0.5, &gradient[9]);
  const CondensedDifference d = condensed_difference(samples, sample, derivative, gradient);
  EXPECT_LE(d.largest(), kTangentTolerance) << d << "\n" << recipe;
}

/// Must fail: the Hessian of the energy alone is not the tangent under any load without energy.
TEST_P(ElementLoad, LoadsWithoutEnergyChangeTheTangent) {
  const ElementSample loaded = loaded_sample({GetParam(), ForceIntegration::both_reduced, 61});
  for (LinearField EnergyElement::*field :
       {&EnergyElement::line_couple, &EnergyElement::follower_force, &EnergyElement::follower_couple}) {
    ElementSample sample = random_sample({GetParam(), ForceIntegration::both_reduced, 61});
    sample.element.*field = loaded.element.*field;
    const SampleBlock samples({sample}, true);
    evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
    const CondensedDifference d = condensed_difference(samples, sample, energy_hessian(sample.element, sample.state),
                                                       total_gradient(sample.element, sample.state));
    EXPECT_GT(d.tangent, 1e-3);
  }
}

/// Must fail: without the rows of the mean displacement a follower force turns nothing for the vertices.
TEST_P(ElementLoad, FollowerForcesTurnInTheRowsOfTheVertices) {
  ElementSample sample = random_sample({GetParam(), ForceIntegration::both_reduced, 71});
  sample.element.follower_force = Vec3<double>{{4.0, -3.0, 2.0}};
  const SampleBlock samples({sample}, true);
  evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
  double largest = 0.0;  // of the sum of both vertices, which is zero for any internal force
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 12; ++j)
      largest =
          std::max(largest, std::fabs(samples.equations.condensed_tangent(samples.element_row(0), 12 * i + j) +
                                      samples.equations.condensed_tangent(samples.element_row(0), 12 * (6 + i) + j)));
  EXPECT_GT(largest, 1e-2);
}

/// Largest entry of the residual of an element whose left vertex is clamped.
double clamped_residual(const SampleBlock& samples) {
  evaluate_residual(samples.block, samples.structure, samples.state, samples.equations);
  double largest = 0.0;
  for (int i = 6; i < kVertexIncrements; ++i)
    largest = std::max(largest, std::fabs(samples.equations.residual(samples.element_row(0), i)));
  for (int i = 0; i < samples.increments(); ++i)
    largest = std::max(largest, std::fabs(samples.equations.interior_residual(samples.interior_row(0) + i)));
  return largest;
}

/// Solves the condensed equations of the right vertex, recovers the interior and applies both.
void newton_step(const SampleBlock& samples) {
  constexpr int n = 6;
  evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
  std::array<double, n * n> matrix;  // column-major
  std::array<double, n> increment;
  std::array<int, n> pivots;
  for (int i = 0; i < n; ++i) {
    increment[i] = -samples.equations.condensed_residual(samples.element_row(0), n + i);
    for (int j = 0; j < n; ++j)
      matrix[i + n * j] = samples.equations.condensed_tangent(samples.element_row(0), 12 * (n + i) + n + j);
  }
  int info = 0;
  Teuchos::LAPACK<int, double>().GESV(n, 1, matrix.data(), n, pivots.data(), increment.data(), n, &info);
  ASSERT_EQ(info, 0);
  const KernelView<double* [6]> vertex_increment("vertex_increment", 2);
  const KernelView<double*> interior_increment = samples.constants();
  const int right = samples.vertex(0, 1);
  for (int i = 0; i < n; ++i) vertex_increment(right, i) = increment[i];
  recover_interior(samples.block, samples.structure, samples.state, samples.equations, vertex_increment,
                   interior_increment);
  apply_interior_increment(samples.block, samples.state, interior_increment, 1.0, samples.state);
  for (int i = 0; i < 3; ++i) samples.state.vertex_displacement(right, i) += increment[i];
  const Quaternion<double> turn = exp_quaternion(Vec3<double>{{increment[3], increment[4], increment[5]}});
  samples.set_vertex_rotation(right, normalized(turn * samples.state_of(0).vertex_rotation[1]));
}

/// An element clamped at its left vertex under all line loads and eigenstrains: the tangent is exact in equilibrium, so
/// Newton's method squares the residual, with the triads updated as the kernels do it.
TEST_P(ElementLoad, NewtonConvergesQuadratically) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SampleRecipe recipe{GetParam(), ForceIntegration::both_reduced, seed};
    ElementSample sample = stress_free_sample(recipe);
    RandomNumbers random(seed);
    sample.element.line_force = {random.vector(2.0), random.vector(1.0)};
    sample.element.line_couple = {random.vector(2.0), random.vector(1.0)};
    sample.element.follower_force = {random.vector(2.0), random.vector(1.0)};
    sample.element.follower_couple = {random.vector(2.0), random.vector(1.0)};
    sample.element.eigenstrain = {random.vector(0.1), random.vector(0.1)};
    sample.element.eigencurvature = {random.vector(0.3), random.vector(0.3)};
    const SampleBlock samples({sample}, true);
    newton_step(samples);
    double residual = clamped_residual(samples);
    for (int step = 2; step <= kNewtonSteps; ++step) {
      const double before = residual;
      newton_step(samples);
      residual = clamped_residual(samples);
      EXPECT_LE(residual, kQuadraticFactor * before * before + kEquilibriumTolerance) << recipe << ", step " << step;
    }
    EXPECT_LE(residual, kEquilibriumTolerance) << recipe;
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, ElementLoad, testing::Range(1, kMaximumOrder + 1));

}  // namespace
}  // namespace mixbeam::element_test
