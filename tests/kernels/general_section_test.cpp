/// Elements with coupled and varying sections: residual, condensed tangent and recovery against the derivatives of
/// their energy, and the plain element as a special case.
#include "tests/kernels/general_section_energy.hpp"

#include <gtest/gtest.h>

namespace mixbeam::element_test::general_section_test {
namespace {

/// Far above every stiffness of random_sample: the tangent is that of the energy.
constexpr double kNoLimit = 1e300;

/// Condensing a large stiffness loses digits in proportion to it, as in ElementAd.CappedForceStiffness; 2.5e-16 without
/// fused multiplications.
constexpr double kLossPerStiffness = 5e-16;

struct GeneralDifference {
  double gradient;
  CondensedDifference condensed;
};

/// `law`: of the energy; the block has general.law. `capped`: law of the tangent.
GeneralDifference compare(const GeneralSample& general, const SampleBlock& samples, const GeneralLaw& law,
                          const GeneralLaw& capped) {
  const EnergyElement& element = general.sample.element;
  const EnergyState<double>& state = general.sample.state;
  const std::vector<double> gradient = general_gradient(element, law, state);
  evaluate_residual(samples.block, samples.structure, samples.state, samples.equations);
  GeneralDifference d;
  d.gradient = difference(weighted_rows(samples, 0, element), gradient, kinds_of(state));
  evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
  d.condensed = condensed_difference(samples, general.sample, general_hessian(element, capped, state), gradient);
  return d;
}

class GeneralSectionAd : public testing::TestWithParam<int> {};

TEST_P(GeneralSectionAd, GradientAndHessianOfTheEnergy) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    GeneralSample general = general_sample(GetParam(), seed);
    if (seed == 1) general.law.growth = {};  // constant; the others vary along the element
    if (seed == 2) uncouple(general.law);
    const SampleBlock samples = general_block(general, kNoLimit, kNoLimit);
    const GeneralDifference d = compare(general, samples, general.law, general.law);
    EXPECT_LE(d.gradient, kGradientTolerance) << "order " << GetParam() << ", seed " << seed;
    EXPECT_LE(d.condensed.largest(), kTangentTolerance) << d.condensed << ", order " << GetParam() << ", seed " << seed;
  }
}

/// Rigid components: compliance zero in the gradient, 1/limit in the tangent.
TEST_P(GeneralSectionAd, RigidComponents) {
  for (const std::vector<int>& rigid : {std::vector<int>{0}, {1, 2}, {0, 1, 2}, {0, 4}, {3}})
    for (const double limit : {1e4, 1e7}) {
      GeneralSample general = general_sample(GetParam(), 11);
      set_rigid(general.law, rigid);
      const SampleBlock samples = general_block(general, limit, 0.1 * limit);
      const GeneralDifference d = compare(general, samples, general.law, capped_law(general.law, limit, 0.1 * limit));
      const std::string text = "order " + std::to_string(GetParam()) + ", first rigid component " +
                               std::to_string(rigid.front()) + " of " + std::to_string(rigid.size());
      EXPECT_LE(d.gradient, kGradientTolerance) << text;
      EXPECT_LE(d.condensed.largest(), kTangentTolerance + kLossPerStiffness * limit) << d.condensed << ", " << text;
    }
}

/// The twin that must fail: each compliance of the block in turn is off by a part in a million.
TEST_P(GeneralSectionAd, EveryComplianceCounts) {
  GeneralSample general = general_sample(GetParam(), 21);
  SampleBlock samples = general_block(general, kNoLimit, kNoLimit);
  const int k = GetParam(), size = GeneralSectionLayout{k, k}.size();
  const std::vector<double> gradient = general_gradient(general.sample.element, general.law, general.sample.state);
  for (int i = 0; i < size; ++i) {
    double& entry = samples.block.compliance(0, i);
    const double right = entry;
    entry *= 1.0 + 1e-6;
    evaluate_residual(samples.block, samples.structure, samples.state, samples.equations);
    EXPECT_GT(difference(weighted_rows(samples, 0, general.sample.element), gradient, kinds_of(general.sample.state)),
              10.0 * kGradientTolerance)
        << "order " << k << ", entry " << i;
    entry = right;
  }
}

/// A tangent of another compliance is not that of this one.
TEST_P(GeneralSectionAd, TangentOfAnotherSectionDiffers) {
  const GeneralSample general = general_sample(GetParam(), 21);
  GeneralLaw other = general.law;
  for (const auto& [i, j] : {std::pair<int, int>{0, 0}, {1, 2}, {0, 4}, {2, 3}, {3, 5}, {4, 4}}) {
    other = general.law;
    other.at_start[i][j] *= 1.0 + 1e-5;
    if (i != j) other.at_start[j][i] = other.at_start[i][j];
    const SampleBlock samples = general_block(general, kNoLimit, kNoLimit);
    EXPECT_GT(compare(general, samples, general.law, other).condensed.largest(), 10.0 * kTangentTolerance)
        << "order " << GetParam() << ", entry " << i << ", " << j;
  }
}

/// Diagonal and constant compliances: the numbers of the plain element, but for rounding.
TEST_P(GeneralSectionAd, DiagonalConstantSectionIsThePlainOne) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    GeneralSample general{random_sample({GetParam(), ForceIntegration::both_reduced, seed}), {}};
    for (int i = 0; i < 3; ++i) {
      general.law.at_start[i][i] = general.sample.element.force_compliance[i];
      general.law.at_start[3 + i][3 + i] = general.sample.element.moment_compliance[i];
    }
    const SampleBlock plain({general.sample}), with_law = general_block(general, kNoLimit, kNoLimit);
    for (const SampleBlock* samples : {&plain, &with_law}) {
      evaluate_residual(samples->block, samples->structure, samples->state, samples->equations);
      evaluate_tangent(samples->block, samples->structure, samples->state, samples->equations);
    }
    const std::vector<Kind> kinds = kinds_of(general.sample.state);
    EXPECT_LE(difference(weighted_rows(with_law, 0, general.sample.element),
                         weighted_rows(plain, 0, general.sample.element), kinds),
              kGradientTolerance);
    Difference tangent, response;
    for (size_t i = 0; i < plain.equations.condensed_tangent.size(); ++i) {
      const int row = static_cast<int>(i / 12 % 12) / 3 % 2, column = static_cast<int>(i % 12) / 3 % 2;
      tangent.add(2 * row + column, with_law.equations.condensed_tangent.data()[i],
                  plain.equations.condensed_tangent.data()[i]);
    }
    for (int c = 0; c <= kVertexIncrements; ++c) {  // each vertex increment alone, and none
      const KernelView<double* [6]> one("vertex_increment", 2);
      if (c < kVertexIncrements) one.data()[c] = 1.0;
      const KernelView<double*> found = with_law.constants(), expected = plain.constants();
      recover_interior(with_law.block, with_law.structure, with_law.state, with_law.equations, one, found);
      recover_interior(plain.block, plain.structure, plain.state, plain.equations, one, expected);
      for (int row = 0; row < plain.increments(); ++row)
        response.add(kinds[kVertexIncrements + row], found(with_law.interior_row(0) + row),
                     expected(plain.interior_row(0) + row));
    }
    EXPECT_LE(tangent.relative(), kTangentTolerance) << "order " << GetParam() << ", seed " << seed;
    EXPECT_LE(response.relative(), kTangentTolerance) << "order " << GetParam() << ", seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, GeneralSectionAd, testing::Range(1, kMaximumOrder + 1));

}  // namespace
}  // namespace mixbeam::element_test::general_section_test
