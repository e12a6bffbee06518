/// Residual, condensed tangent and recovery of the interior against the derivatives of the element's energy.
#include "tests/kernels/element_comparison.hpp"
#include "tests/support/numbers.hpp"

#include <gtest/gtest.h>

namespace mixbeam::element_test {
namespace {

/// Some roundings of quaternions; the logarithm loses nothing at zero or pi.
constexpr double kAngleTolerance = 1e-14;
/// Condensing a large force stiffness loses digits in proportion to it (section and length are of order 1; measured:
/// 2e-17).
constexpr double kLossPerStiffness = 2e-16;

void expect_derivatives_of_the_energy(const SampleRecipe& recipe) {
  const ElementSample sample = random_sample(recipe);
  const SampleBlock samples({sample});
  const std::vector<double> gradient = energy_gradient(sample.element, sample.state);
  evaluate_residual(samples.block, samples.structure, samples.state, samples.equations);
  if (recipe.exact_end_angle) {
    EXPECT_NEAR(samples.equations.largest_end_angle(samples.element_row(0)), recipe.end_angle, kAngleTolerance)
        << recipe;
  }
  EXPECT_LE(difference(weighted_rows(samples, 0, sample.element), gradient, kinds_of(sample.state)), kGradientTolerance)
      << recipe;
  const Dense hessian = energy_hessian(sample.element, sample.state);
  evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
  const CondensedDifference d = condensed_difference(samples, sample, hessian, gradient);
  EXPECT_LE(d.largest(), kTangentTolerance) << d << "\n" << recipe;
}

class ElementAd : public testing::TestWithParam<int> {};

TEST_P(ElementAd, GradientAndHessianOfTheEnergy) {
  for (const ForceIntegration rule : kAllRules)
    for (std::uint64_t seed = 1; seed <= 2; ++seed) expect_derivatives_of_the_energy({GetParam(), rule, seed});
}

/// The relative rotation inside the element and the one between element and vertex, each in all of its regimes. The
/// formulas are those of a point or an end, the same at every order: all pairs for low orders, where they are cheap.
TEST_P(ElementAd, EveryRegimeOfRotation) {
  constexpr int regimes = 5, highest_order_of_all_pairs = 4;
  constexpr double psi[regimes] = {0.0, 1e-12, 1e-4, 0.8, 3.5};  // 3.5: beyond the series of the Stumpff functions
  constexpr double end_angle[regimes] = {0.0, 1e-12, 1e-4, 1.0, test::kPi - 1e-6};
  for (int i = 0; i < regimes; ++i)
    for (int j = 0; j < regimes; ++j) {
      if (GetParam() > highest_order_of_all_pairs && i != j) continue;
      SampleRecipe recipe{GetParam(), ForceIntegration::both_reduced, 11, psi[i], end_angle[j]};
      recipe.exact_end_angle = true;
      expect_derivatives_of_the_energy(recipe);
    }
}

/// A rigid section: compliance zero in the gradient, -1 / (capped stiffness) in the N-N block of the tangent.
TEST_P(ElementAd, CappedForceStiffness) {
  for (const double cap : {1e3, 1e6, 1e9}) {
    // another rule for each order: all of them are seen
    const SampleRecipe recipe{GetParam(), kAllRules[GetParam() % 4], 21};
    ElementSample sample = random_sample(recipe);
    sample.element.force_compliance = Vec3<double>{{0.0, 0.0, 1e-3}};
    sample.tangent_force_stiffness = Vec3<double>{{cap, 0.5 * cap, 1e3}};
    ElementSample capped = sample;
    for (int i = 0; i < 3; ++i) capped.element.force_compliance[i] = 1.0 / capped.tangent_force_stiffness[i];
    const SampleBlock samples({sample});
    evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
    const CondensedDifference d = condensed_difference(samples, sample, energy_hessian(capped.element, capped.state),
                                                       energy_gradient(sample.element, sample.state));
    EXPECT_LE(d.largest(), kTangentTolerance + kLossPerStiffness * cap) << d << "\n" << recipe << ", cap " << cap;
  }
}

/// The response to any interior right-hand side: what solvers of bordered systems ask for. Vertex rows are not in it.
TEST_P(ElementAd, GivenRightHandSide) {
  for (const ForceIntegration rule : kAllRules) {
    const SampleRecipe recipe{GetParam(), rule, 31};
    const ElementSample sample = random_sample(recipe);
    const SampleBlock samples({sample});
    RandomNumbers random(32);
    const KernelView<double*> rhs("rhs", samples.interior_row(1));  // as the kernels have it: N rows without weight
    std::vector<double> gradient(number_of_increments(sample.state), 0.0);
    const std::vector<double> weights = force_weights(sample.element);
    for (int i = 0; i < samples.increments(); ++i) {
      const double weight = i < static_cast<int>(weights.size()) ? weights[i] : 1.0;
      rhs(samples.interior_row(0) + i) = random.between(-1.0, 1.0);
      gradient[kVertexIncrements + i] = weight * rhs(samples.interior_row(0) + i);
    }
    condense_right_hand_side(samples.block, samples.structure, samples.state, rhs, samples.equations);
    const CondensedDifference d =
        condensed_difference(samples, sample, energy_hessian(sample.element, sample.state), gradient);
    EXPECT_LE(d.largest(), kTangentTolerance) << d << "\n" << recipe;
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, ElementAd, testing::Range(1, kMaximumOrder + 1));

}  // namespace
}  // namespace mixbeam::element_test
