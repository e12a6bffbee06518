/// Elements side by side in the lanes of packs give what elements one by one give.
#include "kernels/condensation/interior_factor.hpp"
#include "kernels/loops/element_loops.hpp"
#include "kernels/math/rotation.hpp"
#include "kernels/vibration/vibration.hpp"
#include "tests/kernels/general_section_energy.hpp"
#include "tests/support/worst_error.hpp"

#include <cstring>
#include <iterator>

namespace mixbeam::element_test {
namespace {

using Lanes = Pack<kLanes>;

/// Both ways round differently. Residuals are sums of a few hundred products.
constexpr double kResidualTolerance = 1e-13;
/// Condensation multiplies rounding by the condition of the interior matrix; the two ways eliminate in different
/// orders.
constexpr double kCondensedTolerance = 1e-11;

/// What the elements of a block have. Lanes side by side have sections of their own and, with line fields, other kinds
/// of them or none.
struct Variant {
  bool general_section, fields;
};
constexpr Variant kVariants[] = {{false, false}, {false, true}, {true, false}, {true, true}};

std::ostream& operator<<(std::ostream& out, const Variant& variant) {
  return out << (variant.general_section ? "general" : "plain") << " sections, "
             << (variant.fields ? "line fields" : "no line fields");
}

/// Line fields of one element after the other.
constexpr unsigned kFieldsInTurn[] = {
    0,          bit(LineField::dead_force),      bit(LineField::follower_force), bit(LineField::dead_couple),   0,
    kAllFields, bit(LineField::follower_couple), bit(LineField::eigenstrain),    bit(LineField::eigencurvature)};
/// An element of the first pack with a follower force.
constexpr int kFollower = kLanes > 2 ? 2 : 1;

SampleBlock random_block(const Variant& variant, int order, ForceIntegration rule, int count) {
  std::vector<GeneralSample> samples;
  for (int e = 0; e < count; ++e) {
    const std::uint64_t seed = 300 + static_cast<std::uint64_t>(e);
    samples.push_back(variant.general_section ? general_sample(order, seed)
                                              : GeneralSample{random_sample({order, rule, seed}), {}});
    if (e % 3 == 1) uncouple(samples.back().law);  // beside coupled ones in a pack, not alone
    const unsigned kinds = kFieldsInTurn[(e + 2 - kFollower) % std::size(kFieldsInTurn)];
    if (variant.fields) add_fields(samples.back().sample.element, kinds, seed);
  }
  if (!variant.general_section) {
    std::vector<ElementSample> plain;
    for (const GeneralSample& sample : samples) plain.push_back(sample.sample);
    return SampleBlock(plain, variant.fields);
  }
  const SampleBlock block = general_block(samples, 0.0, 0.0, variant.fields);
  for (int e = 0; e < count; ++e) {  // as stiff as the sections, so that some entries are capped and some are not
    SectionConstants& constants = block.structure.sections(block.block.section(e));
    constants.force_stiffness_limit = 300.0 + 50.0 * e;
    constants.moment_stiffness_limit = 3.0 + 0.5 * e;
  }
  return block;
}

/// One block and its copy, of which one element at a time is computed: alone in the first lane of a pack.
struct BothWays {
  SampleBlock lanes, one_by_one;
  BothWays(const Variant& variant, int order, ForceIntegration rule, int room, int count)
      : lanes(random_block(variant, order, rule, room)), one_by_one(random_block(variant, order, rule, room)) {
    lanes.block.count = one_by_one.block.count = count;
  }
  /// Interior increments for random increments of the vertices.
  KernelView<double*> recovered(const SampleBlock& samples) const {
    const KernelView<double* [6]> vertex_increment("vertex_increment", samples.state.vertex_rotation.extent(0));
    RandomNumbers random(3);
    for (size_t i = 0; i < vertex_increment.size(); ++i) vertex_increment.data()[i] = random.between(-1.0, 1.0);
    const KernelView<double*> increment = samples.constants();
    for_each_part(samples, [&](const ElementBlock& part) {
      recover_interior(part, samples.structure, samples.state, samples.equations, vertex_increment, increment);
    });
    return increment;
  }
  void evaluate() {
    for (const SampleBlock* s : {&lanes, &one_by_one})
      for_each_part(*s, [s](const ElementBlock& part) {
        evaluate_residual(part, s->structure, s->state, s->equations);
        evaluate_tangent(part, s->structure, s->state, s->equations);
      });
  }

 private:
  template <class Action>
  void for_each_part(const SampleBlock& samples, const Action& action) const {
    const int at_once = &samples == &lanes ? samples.block.count : 1;
    for (int e = 0; e < samples.block.count; e += at_once) action(part_of(samples.block, e, at_once));
  }
};

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
  for (const Variant& variant : kVariants)
    for (const ForceIntegration rule : kAllRules) {
      if (variant.general_section && rule != ForceIntegration::both_reduced) continue;  // they have no other
      for (int count = kLanes; count <= 2 * kLanes; ++count) {                          // every length of the last pack
        BothWays both(variant, GetParam(), rule, room, count);
        both.evaluate();
        const Differences d = differences(both);
        EXPECT_LE(d.residual, kResidualTolerance) << variant << ", rule " << static_cast<int>(rule) << ", " << count;
        EXPECT_LE(d.condensed, kCondensedTolerance) << variant << ", rule " << static_cast<int>(rule) << ", " << count;
        for (int e = count; e < room; ++e)
          for (int i = 0; i < 144; ++i)
            EXPECT_EQ(both.lanes.equations.condensed_tangent(both.lanes.element_row(e), i), 0.0) << "behind the block";
      }
    }
}

/// Twins of SameAsOneByOne: one number of one element that differs is seen, be it of its state, its line field, its
/// section or the cap of its section.
TEST_P(ElementLanes, AChangedNumberIsNotTheSame) {
  constexpr double kChange = 1.0 + 1e-4;  // fields and sections are a small part of the condensed tangent
  const auto expect_seen = [&](const Variant& variant, bool in_residual, const auto& change) {
    BothWays both(variant, GetParam(), ForceIntegration::both_reduced, kLanes, kLanes);
    change(both.lanes);
    both.evaluate();
    EXPECT_EQ(differences(both).residual > kResidualTolerance, in_residual) << variant;
    EXPECT_GT(differences(both).condensed, kCondensedTolerance) << variant;
  };
  const auto section_of = [](const SampleBlock& s, int e) -> SectionConstants& {
    return s.structure.sections(s.block.section(e));
  };
  for (const Variant& variant : kVariants) {
    expect_seen(variant, true, [](SampleBlock& s) { s.interior(kLanes - 1)[0] *= 1.0 + 1e-8; });
    if (variant.fields)
      expect_seen(variant, true, [](SampleBlock& s) {
        const int row = s.block.field_row(kFollower, static_cast<int>(LineField::follower_force));
        s.structure.field_value(row, 0) *= kChange;
      });
    if (variant.general_section)
      expect_seen(variant, true, [](SampleBlock& s) { s.block.compliance(kLanes - 1, 0) *= kChange; });
    else
      expect_seen(variant, false, [&](SampleBlock& s) { section_of(s, 0).tangent_force_stiffness[0] *= kChange; });
  }
}

/// Whether a loop reads them or not. What packs load is the same text for any number of lanes.
TEST(ElementPacks, HoldEveryNumberOfTheirSections) {
  constexpr int kOrder = 2, kElements = 3;
  const SampleBlock samples = random_block(kVariants[0], kOrder, ForceIntegration::both_reduced, kElements);
  const auto section_of = [&](int e) { return samples.structure.sections(samples.block.section(e)).numbers(); };
  for (int e = 0; e < kElements; ++e)
    for (int i = 0; i < SectionConstants::kCount; ++i) section_of(e)[i] = 1.0 + e * SectionConstants::kCount + i;
  const ElementGather<kOrder, false, 1> gather(samples.block, samples.structure, samples.state);
  for (int e = 0; e < kElements; ++e) {
    const ElementPack<kOrder, false, 1> pack(gather, e);
    for (int i = 0; i < SectionConstants::kCount; ++i)
      EXPECT_EQ(pack.section.numbers()[i][0], section_of(e)[i]) << "element " << e << ", number " << i;
  }
}

/// NaN in the state of one element arrives in its own numbers and in no others.
TEST_P(ElementLanes, NaNStaysInItsElement) {
  const auto make = [] { return random_block(kVariants[0], GetParam(), ForceIntegration::both_reduced, kLanes + 1); };
  const SampleBlock healthy = make(), sick = make();
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
  solve_with_row_pivoting(FullSystem<2>(system, [&](const auto& x) { return x[lane]; }), response, expected);
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

/// Unsymmetric systems; the first lane is not wanted, the last one may have no first pivot, or one so small that the
/// entries of its factors grow.
TEST(SolveInLanes, WithoutSymmetry) {
  constexpr double a_few_roundings = 1e-13;  // of systems whose condition is about ten
  for (const double first_pivot : {20.0, 0.0, 1e-9}) {
    const ReducedSystem<2, Lanes> symmetric = systems(false);
    FullSystem<2, Lanes> system(symmetric, [](const Lanes& x) { return x; });
    RandomNumbers random(7);
    for (auto& row : system.matrix)
      for (Lanes& entry : row)
        for (int lane = 0; lane < kLanes; ++lane) entry.set(lane, entry[lane] + random.between(-1.0, 1.0));
    system.matrix[0][0].set(kLanes - 1, first_pivot);
    Lanes::Mask wanted = Lanes(0.0) <= Lanes(0.0);
    wanted[0] = 0;
    InteriorResponse<2, Lanes> response;
    VertexSystem<Lanes> condensed;
    condensed.gradient[0][0] = 7.0;
    InteriorSigns signs[kLanes];
    solve_general_in_lanes<2, kLanes>([&] { return system; }, wanted, response, condensed, signs);
    EXPECT_EQ(condensed.gradient[0][0][0], 7.0);
    for (int lane = 1; lane < kLanes; ++lane) {
      const FullSystem<2> one(system, [lane](const Lanes& x) { return x[lane]; });
      InteriorResponse<2> expected_response;
      VertexSystem<> expected;
      solve_with_row_pivoting(one, expected_response, expected);
      Difference difference;
      for (int i = 0; i < 9; ++i) {
        difference.add(0, condensed.gradient[i / 3][i % 3][lane], expected.gradient[i / 3][i % 3]);
        for (int j = 0; j < 9; ++j) {
          difference.add(0, condensed.matrix[i / 3][j / 3](i % 3, j % 3)[lane],
                         expected.matrix[i / 3][j / 3](i % 3, j % 3));
          difference.add(1, response.by[i / 3][j / 3](i % 3, j % 3)[lane],
                         expected_response.by[i / 3][j / 3](i % 3, j % 3));
        }
        difference.add(1, response.constant[i / 3][i % 3][lane], expected_response.constant[i / 3][i % 3]);
      }
      EXPECT_LE(difference.relative(), a_few_roundings) << "lane " << lane << ", " << first_pivot;
      EXPECT_EQ(signs[lane].negative, interior_signs(one, false).negative);
    }
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
