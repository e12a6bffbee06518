/// Elements side by side in the lanes of packs give what elements one by one give.
#include "kernels/condensation/interior_factor.hpp"
#include "kernels/loops/dispatch.hpp"
#include "kernels/loops/recovery.hpp"
#include "kernels/loops/residual.hpp"
#include "kernels/loops/tangent.hpp"
#include "kernels/math/rotation.hpp"
#include "tests/kernels/element_comparison.hpp"
#include "tests/support/worst_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace mixbeam::element_test {
namespace {

using Lanes = Pack<kLanes>;

/// Both ways round differently. Residuals are sums of a few hundred products.
constexpr double kResidualTolerance = 1e-13;
/// Condensation multiplies rounding by the condition of the interior matrix; the two ways eliminate in different
/// orders.
constexpr double kCondensedTolerance = 1e-11;

/// One block and its copy, of which one element at a time is computed: by the loops with packs of one lane.
struct BothWays {
  SampleBlock lanes, one_by_one;
  BothWays(const std::vector<ElementSample>& samples, int count) : lanes(samples), one_by_one(samples) {
    lanes.block.count = one_by_one.block.count = count;
  }
  /// Interior increments for random increments of the vertices.
  KernelView<double*> recovered(const SampleBlock& samples) const {
    const KernelView<double* [6]> vertex_increment("vertex_increment", samples.state.vertex_rotation.extent(0));
    RandomNumbers random(3);
    for (size_t i = 0; i < vertex_increment.size(); ++i) vertex_increment.data()[i] = random.between(-1.0, 1.0);
    const KernelView<double*> increment("increment", samples.interior_row(samples.block.count));
    if (&samples == &lanes)
      recover_interior(samples.block, samples.state, samples.equations, vertex_increment, increment);
    else
      for_order(samples.block.order, [&](auto k) {
        recover_loop<k.value, false, 1>(samples.block, samples.state, samples.equations, vertex_increment, increment);
      });
    return increment;
  }
  void evaluate() {
    evaluate_residual(lanes.block, lanes.structure, lanes.state, lanes.equations);
    evaluate_tangent(lanes.block, lanes.structure, lanes.state, lanes.equations);
    const SampleBlock& s = one_by_one;
    for_order(s.block.order, [&](auto k) {
      residual_loop<k.value, false, 1>(s.block, s.structure, s.state, s.equations);
      tangent_loop<k.value, false, 1>(s.block, s.structure, s.state, {}, s.equations);
    });
  }
};

std::vector<ElementSample> random_samples(int order, ForceIntegration rule, int count) {
  std::vector<ElementSample> samples;
  for (int e = 0; e < count; ++e) samples.push_back(random_sample({order, rule, 300 + static_cast<std::uint64_t>(e)}));
  return samples;
}

/// Largest difference in units of the largest number of the same element.
template <class View>
double difference(const View& found, const View& expected, size_t offset, size_t row) {
  double worst = 0.0;
  for (size_t first = offset; first + row <= expected.size(); first += row) {
    Difference d;
    for (size_t i = first; i < first + row; ++i) d.add(0, found.data()[i], expected.data()[i]);
    worst = std::max(worst, d.relative());
  }
  return worst;
}

struct Differences {
  double residual, condensed;
};

Differences differences(const BothWays& both) {
  const ElementEquations &a = both.lanes.equations, &b = both.one_by_one.equations;
  const ElementBlock& block = both.lanes.block;
  const size_t increments = block.interior.increments();
  return {std::max({difference(a.residual, b.residual, 0, 12),
                    difference(a.interior_residual, b.interior_residual, block.increment_offset, increments),
                    difference(a.largest_end_angle, b.largest_end_angle, 0, 1)}),
          std::max({difference(a.condensed_tangent, b.condensed_tangent, 0, 144),
                    difference(a.condensed_residual, b.condensed_residual, 0, 12),
                    difference(a.response, b.response, block.response_offset, block.response_size()),
                    difference(both.recovered(both.lanes), both.recovered(both.one_by_one), block.increment_offset,
                               increments)})};
}

class ElementLanes : public testing::TestWithParam<int> {};

TEST_P(ElementLanes, SameAsOneByOne) {
  constexpr int room = 2 * kLanes + 1;
  for (const ForceIntegration rule : kAllRules) {
    const std::vector<ElementSample> samples = random_samples(GetParam(), rule, room);
    for (int count = kLanes; count <= 2 * kLanes; ++count) {  // every length of the last pack
      BothWays both(samples, count);
      both.evaluate();
      const Differences d = differences(both);
      EXPECT_LE(d.residual, kResidualTolerance) << "rule " << static_cast<int>(rule) << ", " << count << " elements";
      EXPECT_LE(d.condensed, kCondensedTolerance) << "rule " << static_cast<int>(rule) << ", " << count << " elements";
      for (int e = count; e < room; ++e)
        for (int i = 0; i < 144; ++i)
          EXPECT_EQ(both.lanes.equations.condensed_tangent(both.lanes.element_row(e), i), 0.0) << "behind the block";
    }
  }
}

/// Twin of SameAsOneByOne: a state that differs in one number of one element is seen.
TEST_P(ElementLanes, AChangedStateIsNotTheSame) {
  BothWays both(random_samples(GetParam(), ForceIntegration::both_reduced, kLanes), kLanes);
  both.lanes.interior(kLanes - 1)[0] *= 1.0 + 1e-8;
  both.evaluate();
  EXPECT_GT(differences(both).residual, kResidualTolerance);
  EXPECT_GT(differences(both).condensed, kCondensedTolerance);
}

/// NaN in the state of one element arrives in its own numbers and in no others.
TEST_P(ElementLanes, NaNStaysInItsElement) {
  const std::vector<ElementSample> samples = random_samples(GetParam(), ForceIntegration::both_reduced, kLanes + 1);
  const SampleBlock healthy(samples), sick(samples);
  const int e = kLanes / 2;
  for (int i = 0; i < sick.block.interior.unknowns(); ++i)
    sick.interior(e)[i] = std::numeric_limits<double>::quiet_NaN();
  for (const SampleBlock* block : {&healthy, &sick}) {
    evaluate_residual(block->block, block->structure, block->state, block->equations);
    evaluate_tangent(block->block, block->structure, block->state, block->equations);
  }
  for (int other = 0; other <= kLanes; ++other) {
    const int row = sick.element_row(other);
    const double *a = &sick.equations.condensed_tangent(row, 0), *b = &healthy.equations.condensed_tangent(row, 0);
    if (other == e) {
      EXPECT_TRUE(std::isnan(a[0]));
      EXPECT_TRUE(std::isnan(sick.equations.residual(row, 0)));
      EXPECT_TRUE(std::isnan(sick.equations.condensed_residual(row, 0)));
    } else {
      EXPECT_EQ(std::memcmp(a, b, 144 * sizeof(double)), 0) << "element " << other;
      for (int i = 0; i < 12; ++i) EXPECT_EQ(sick.equations.residual(row, i), healthy.equations.residual(row, i));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, ElementLanes, testing::Range(1, kMaximumOrder + 1));

/// Symmetric systems of order 2; in the last lane the first unknown has nothing on the diagonal, but is coupled.
ReducedSystem<2, Lanes> systems(bool zero_pivot) {
  RandomNumbers random(5);
  ReducedSystem<2, Lanes> system;
  for (int lane = 0; lane < kLanes; ++lane)
    for (int I = 0; I < system.kBlocks; ++I)
      for (int i = 0; i < 3; ++i) {
        system.rhs[I][i].set(lane, random.between(-1.0, 1.0));
        for (int J = 0; J <= I; ++J)
          for (int j = 0; j < 3; ++j)
            system(I, J)(i, j).set(lane, random.between(-1.0, 1.0) + (I == J && i == j ? 20.0 : 0.0));
      }
  if (zero_pivot) system(0, 0)(0, 0).set(kLanes - 1, 0.0);
  return system;
}

double tangent_difference(const VertexSystem<Lanes>& found, const ReducedSystem<2, Lanes>& system, int lane) {
  InteriorResponse<2> response;
  VertexSystem<> expected;
  solve_with_row_pivoting(FullSystem<2>(system, lane), response, expected);
  Difference d;
  for (int I = 0; I < 3; ++I)
    for (int i = 0; i < 3; ++i) {
      d.add(0, found.gradient[I][i][lane], expected.gradient[I][i]);
      for (int J = 0; J < I; ++J)
        for (int j = 0; j < 3; ++j) d.add(0, found.matrix[I][J](i, j)[lane], expected.matrix[I][J](i, j));
    }
  return d.relative();
}

TEST(SolveInLanes, LaneWithAZeroPivotIsDoneWithRowPivoting) {
  constexpr double a_few_roundings = 1e-13;
  for (const bool zero_pivot : {false, true}) {
    const ReducedSystem<2, Lanes> system = systems(zero_pivot);
    InteriorResponse<2, Lanes> response;
    VertexSystem<Lanes> condensed;
    solve_in_lanes(system, response, condensed);
    for (int lane = 0; lane < kLanes; ++lane)
      EXPECT_LE(tangent_difference(condensed, system, lane), a_few_roundings) << "lane " << lane;
  }
}

/// Twin: without row pivoting that lane, and that lane alone, is useless.
TEST(SolveInLanes, WithoutRowPivotingAZeroPivotSpoilsItsLane) {
  const ReducedSystem<2, Lanes> system = systems(true);
  ReducedSystem<2, Lanes> factored = system;
  VertexSystem<Lanes> condensed;
  const InteriorFactor<2, kLanes> factor(factored, condensed);
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool last = lane == kLanes - 1;
    EXPECT_EQ(factor.suspicious[lane] != 0, last) << "lane " << lane;
    EXPECT_EQ(!(tangent_difference(condensed, system, lane) <= 1e-3), last) << "lane " << lane;
  }
}

/// Lanes on both sides of the limits of the series, each as the number alone.
TEST(RotationInLanes, BranchesAreTakenLaneByLane) {
  constexpr double a_few_roundings = 1e-15;
  for (const double angle : {0.0, 1e-9, 0.09, 0.11, 1.0, 3.1})
    for (int other = 0; other < kLanes; ++other) {
      Lanes x = 0.5, w = 1.0, nn = 1e-4;
      const double large = 3.2 + angle, nn_of_angle = std::pow(std::sin(angle / 2), 2);
      x.set(other, large * large);
      w.set(other, std::cos(angle / 2));
      nn.set(other, nn_of_angle);
      const StumpffValues<Lanes> lanes = stumpff(x);
      const Lanes factor = log_factor(nn, w);
      for (int lane = 0; lane < kLanes; ++lane) {
        const StumpffValues<double> one = stumpff(x[lane]);
        for (int k = 0; k < 8; ++k) EXPECT_NEAR(lanes[k][lane], one[k], a_few_roundings) << "c_" << k;
        EXPECT_NEAR(factor[lane], log_factor(nn[lane], w[lane]), 2 * a_few_roundings);
      }
    }
}

}  // namespace
}  // namespace mixbeam::element_test
