// The algebra that NOX and LOCA ask of a vector, against loops over the entries.
#include "nonlinear/newton/beam_group.hpp"

#include "tests/nonlinear/beam_fixture.hpp"
#include "tests/support/worst_error.hpp"

namespace mixbeam::test {
namespace {

std::vector<double> entries(const NOX::Abstract::Vector& vector) {
  const MixedVector& v = BeamVector::of(vector);
  std::vector<double> all;
  for (size_t i = 0; i < v.vertex().extent(0); ++i) all.push_back(v.vertex()(i));
  for (size_t i = 0; i < v.interior().extent(0); ++i) all.push_back(v.interior()(i));
  return all;
}

class BeamVectorTest : public testing::Test {
 protected:
  BeamVectorTest() : fixture(fork(2, 3), 0.0) {}

  /// Entry by entry; equal but for the rounding of fused multiplications.
  template <class Expected>
  void expect(const NOX::Abstract::Vector& actual, const Expected& expected) {
    const std::vector<double> a = entries(actual);
    for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], expected(i), 8 * kRounding) << "entry " << i;
  }

  BeamFixture fixture;
  BeamVector x = fixture.random_vector(1.0, 1), y = fixture.random_vector(1.0, 2), z = fixture.random_vector(1.0, 3);
  const std::vector<double> xs = entries(x), ys = entries(y), zs = entries(z);
};

TEST_F(BeamVectorTest, Updates) {
  BeamVector v = z;
  v.update(2.0, x, -0.5);
  expect(v, [&](size_t i) { return 2.0 * xs[i] - 0.5 * zs[i]; });
  v = z;
  v.update(2.0, x, 3.0, y, 0.25);
  expect(v, [&](size_t i) { return 2.0 * xs[i] + 3.0 * ys[i] + 0.25 * zs[i]; });
}

TEST_F(BeamVectorTest, UpdateOfItself) {
  BeamVector v = x;
  v.update(2.0, v, 3.0, v, 1.0);
  expect(v, [&](size_t i) { return 6.0 * xs[i]; });
}

// A vector may hold anything before it is set.
TEST_F(BeamVectorTest, ZeroFactorsDoNotSpreadWhatIsNotANumber) {
  BeamVector broken = fixture.create_vector();
  broken.init(std::numeric_limits<double>::quiet_NaN());
  BeamVector v = broken;
  v.update(2.0, x, 0.0, broken, 0.0);
  expect(v, [&](size_t i) { return 2.0 * xs[i]; });
  v = broken;
  v.update(1.0, x, 0.0);
  EXPECT_TRUE(same_bits(v, x));
}

TEST_F(BeamVectorTest, EntryByEntry) {
  BeamVector v = fixture.create_vector();
  v.abs(x);
  expect(v, [&](size_t i) { return std::abs(xs[i]); });
  v.reciprocal(x);
  const std::vector<double> reciprocals = entries(v);
  for (size_t i = 0; i < xs.size(); ++i) EXPECT_NEAR(reciprocals[i] * xs[i], 1.0, 4 * kRounding);
  v = x;
  v.scale(y);
  expect(v, [&](size_t i) { return xs[i] * ys[i]; });
  v = x;
  v.scale(-3.0);
  expect(v, [&](size_t i) { return -3.0 * xs[i]; });
  v.init(0.25);
  expect(v, [](size_t) { return 0.25; });
}

TEST_F(BeamVectorTest, NormsAndInnerProduct) {
  double one = 0.0, square = 0.0, largest = 0.0, product = 0.0, weighted = 0.0;
  for (size_t i = 0; i < xs.size(); ++i) {
    one += std::abs(xs[i]);
    square += xs[i] * xs[i];
    largest = std::max(largest, std::abs(xs[i]));
    product += xs[i] * ys[i];
    weighted += zs[i] * xs[i] * xs[i];
  }
  const double rounding = static_cast<double>(xs.size()) * kRounding * one;
  EXPECT_NEAR(x.norm(NOX::Abstract::Vector::OneNorm), one, rounding);
  EXPECT_NEAR(x.norm(NOX::Abstract::Vector::TwoNorm), std::sqrt(square), rounding);
  EXPECT_EQ(x.norm(NOX::Abstract::Vector::MaxNorm), largest);
  EXPECT_NEAR(x.innerProduct(y), product, rounding);
  BeamVector positive = fixture.create_vector();
  positive.abs(z);
  weighted = 0.0;
  for (size_t i = 0; i < xs.size(); ++i) weighted += std::abs(zs[i]) * xs[i] * xs[i];
  EXPECT_NEAR(x.norm(positive), std::sqrt(weighted), rounding);
  EXPECT_EQ(static_cast<size_t>(x.length()), xs.size());
}

TEST_F(BeamVectorTest, NormOfWhatIsNotANumberIsNotFinite) {
  for (size_t part : {0, 1}) {
    BeamVector v = x;
    if (part == 0)
      v.values().vertex()(3) = std::nan("");
    else
      v.values().writable_interior(true)(5) = std::nan("");
    for (auto type : {NOX::Abstract::Vector::OneNorm, NOX::Abstract::Vector::TwoNorm, NOX::Abstract::Vector::MaxNorm})
      EXPECT_FALSE(std::isfinite(v.norm(type))) << "part " << part << ", norm " << type;
  }
}

// The interior is shared until written to: no writing may show in the other vector.
TEST_F(BeamVectorTest, CopiesDoNotKnowEachOther) {
  BeamVector copy = x;
  const Teuchos::RCP<NOX::Abstract::Vector> clone = x.clone(NOX::DeepCopy);
  BeamVector assigned = y;
  assigned = x;
  EXPECT_TRUE(same_bits(copy, x));
  copy.scale(2.0);
  clone->update(1.0, y, 1.0);
  assigned.values().writable_interior(true)(0) = 17.0;
  assigned.values().vertex()(0) = 17.0;
  EXPECT_EQ(entries(x), xs);
  BeamVector source = x;
  const BeamVector kept = source;
  source.init(1.0);
  EXPECT_EQ(entries(kept), xs);
  EXPECT_EQ(x.clone(NOX::ShapeCopy)->length(), x.length());
}

TEST_F(BeamVectorTest, ComparesValues) {
  BeamVector v = x;
  EXPECT_TRUE(v.values().same_values(x.values()));
  v.values().writable_interior(true)(7) += 1e-15;
  EXPECT_FALSE(v.values().same_values(x.values()));
  BeamVector broken = fixture.create_vector();
  broken.init(std::nan(""));
  EXPECT_FALSE(broken.values().same_values(BeamVector(broken).values().clone(true)) &&
               std::isfinite(broken.norm(NOX::Abstract::Vector::MaxNorm)));
}

TEST_F(BeamVectorTest, LargestSpin) {
  BeamVector v = fixture.create_vector();
  v.init(0.0);
  v.values().vertex()(0) = 100.0;  // a displacement
  v.values().writable_interior(true)(0) = 100.0;
  for (int i : {0, 1, 2}) v.values().vertex()(2 * kVertexDofs + 3 + i) = i == 0 ? 2.0 : (i == 1 ? -3.0 : 6.0);
  EXPECT_EQ(v.values().largest_vertex_spin(), 7.0);
  v.values().vertex()(4) = std::nan("");
  EXPECT_FALSE(std::isfinite(v.values().largest_vertex_spin()));
}

// Sums and maxima count elements that are cut by the partition once: the same on any number of ranks.
TEST(MpiBeamVector, NormsDoNotDependOnRanks) {
  const auto norms = [](const Communicator& comm) {
    const Model model(fork(2, 3), comm, {});
    MixedVector v = model.create_vector();
    const Structure& s = model.structure();
    for (int i = 0; i < s.owned_vertices; ++i)
      for (int c = 0; c < kVertexDofs; ++c)
        v.vertex()(kVertexDofs * i + c) = std::sin(kVertexDofs * s.local_vertex_to_global[i] + c);
    const auto interior = v.writable_interior(false);
    for (const ElementBlock& block : s.blocks)
      for (int e = 0; e < block.count; ++e)
        for (int i = 0; i < block.interior.increments(); ++i)
          interior(block.increment_offset + e * block.interior.increments() + i) =
              std::cos(100.0 * s.local_element_to_mesh[block.first_element + e] + i);
    return std::vector<double>{v.maximum_norm(), v.one_norm(), v.inner_product(v), v.largest_vertex_spin(),
                               static_cast<double>(v.global_length())};
  };
  const std::vector<double> together = norms(all_ranks()), alone = norms(this_rank());
  for (size_t i = 0; i < alone.size(); ++i)
    EXPECT_NEAR(together[i], alone[i], 1000 * kRounding * alone[i]) << "norm " << i;  // sums of some hundred entries
}

}  // namespace
}  // namespace mixbeam::test
