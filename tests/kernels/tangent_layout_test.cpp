/// Both layouts of the condensed tangent hold the same matrix.
#include "kernels/execution/pack.hpp"
#include "tests/kernels/element_samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace mixbeam::tangent_layout_test {
namespace {

using namespace element_test;

// Products of the same factors, added in another order where the full matrix is computed by itself; in units of the
// largest entry.
constexpr double kLayoutTolerance = 1e-12;

std::vector<ElementSample> random_samples(int order) {
  std::vector<ElementSample> samples;
  for (int e = 0; e < 2 * kLanes + 1; ++e)
    samples.push_back(random_sample({order, ForceIntegration::both_reduced, 500 + static_cast<std::uint64_t>(e)}));
  return samples;
}

/// Largest difference between the tangents of the same elements kept in full and as symmetric numbers.
double difference_of_layouts(const SampleBlock& full, const SampleBlock& symmetric) {
  double worst = 0.0;
  for (int e = 0; e < full.block.count; ++e) {
    const double* expected = &full.equations.condensed_tangent(full.element_row(e), 0);
    const double* numbers = &symmetric.equations.condensed_tangent(symmetric.element_row(e), 0);
    double largest = 0.0, difference = 0.0;
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j) {
        largest = std::max(largest, std::abs(expected[12 * i + j]));
        difference =
            std::max(difference, std::abs(expected[12 * i + j] - symmetric_tangent_entry<kSpatialDofs>(numbers, i, j)));
      }
    worst = std::max(worst, difference / largest);
  }
  return worst;
}

class TangentLayout : public testing::TestWithParam<int> {};

TEST_P(TangentLayout, BothHoldTheSameMatrix) {
  const std::vector<ElementSample> samples = random_samples(GetParam());
  for (const bool with_loads : {false, true}) {  // side by side, and one by one
    SampleBlock full(samples, with_loads), symmetric(samples, with_loads);
    auto& tangents = symmetric.equations.condensed_tangent;
    tangents = KernelView<double**>("symmetric tangents", tangents.extent(0), kSymmetricTangent);
    for (const SampleBlock* block : {&full, &symmetric})
      evaluate_tangent(block->block, block->structure, block->state, block->equations);
    EXPECT_LE(difference_of_layouts(full, symmetric), kLayoutTolerance);
    tangents(symmetric.element_row(kLanes), 7) *= 1.001;
    EXPECT_GT(difference_of_layouts(full, symmetric), kLayoutTolerance) << "a wrong number is seen";
  }
}
INSTANTIATE_TEST_SUITE_P(Orders, TangentLayout, testing::Range(1, 9));

TEST(TangentLayoutNumbers, AreThoseOfTheFullMatrix) {
  double numbers[kSymmetricTangent], matrix[kFullTangent];
  for (int i = 0; i < kSymmetricTangent; ++i) numbers[i] = i + 1.0;
  expand_symmetric_tangent<kSpatialDofs>(numbers, matrix);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) {
      EXPECT_EQ(matrix[12 * i + j], matrix[12 * j + i]);
      EXPECT_EQ(matrix[12 * i + j], symmetric_tangent_entry<kSpatialDofs>(numbers, i, j));
    }
  // A rigid displacement does no work.
  for (int i = 0; i < 12; ++i)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(matrix[12 * i + c] + matrix[12 * i + 6 + c], 0.0);
  EXPECT_EQ(matrix[12 * 9 + 4], numbers[triangle(6, 4)]);  // first moment at b by second spin at a
  EXPECT_EQ(matrix[12 * 3 + 6], numbers[triangle(3, 0)]);  // first moment at a by first displacement of b
}

}  // namespace
}  // namespace mixbeam::tangent_layout_test
