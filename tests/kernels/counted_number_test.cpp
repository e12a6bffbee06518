// Operations are counted as a reader of the formulas counts them.
#include "tests/support/counted_number.hpp"

#include "kernels/chains/elimination.hpp"
#include "kernels/math/rotation.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

/// By hand: three products and two sums of a scalar product; nine products and six sums of matrix times vector.
TEST(CountedNumber, CountsProductsAndSums) {
  const Vec3<CountedNumber> v{{1.0, 2.0, 3.0}};
  const OperationCount of_dot = operations_of([&] { dot(v, v); });
  EXPECT_EQ(of_dot.products, 3);
  EXPECT_EQ(of_dot.sums, 2);
  const Mat3<CountedNumber> m = identity_matrix<CountedNumber>();
  EXPECT_EQ(operations_of([&] { m* v; }).flops(), 15);
  EXPECT_EQ(operations_of([&] { sqrt(dot(v, v)) / v[0]; }).flops(), 7);
  EXPECT_EQ(operations_of([&] { v[0] < v[1] ? v[0] : -v[1]; }).flops(), 0);
}

/// Numbers are those of double arithmetic.
TEST(CountedNumber, ComputesWhatDoubleComputes) {
  const Vec3<double> psi{{0.3, -0.7, 0.2}};
  const Vec3<CountedNumber> counted{{psi[0], psi[1], psi[2]}};
  const Quaternion<double> expected = exp_quaternion(psi);
  const Quaternion<CountedNumber> q = exp_quaternion(counted);
  EXPECT_NEAR(q.w[0], expected.w, 1e-15);
  EXPECT_NEAR(q.z[0], expected.z, 1e-15);
}

/// L D L^T of an n x n block: n divisions beside those of the n ratios that are watched, and sum_k k products for the
/// columns, sum_k k (k + 1) / 2 multiply-subtracts, k = 1 .. n - 1.
TEST(CountedNumber, CountsTheFactorisationOfABlock) {
  constexpr int n = 6;
  CountedNumber a[triangle_size(n)];
  for (int i = 0; i < n; ++i) a[triangle(i, i)] = 1.0;
  PivotWatch<CountedNumber> watch;
  const OperationCount count = operations_of([&] { factorize_block<n>(a, watch); });
  int columns = 0, updates = 0;
  for (int k = 1; k < n; ++k) {
    columns += k;
    updates += k * (k + 1) / 2;
  }
  EXPECT_EQ(count.divisions, 2 * n);
  EXPECT_EQ(count.products, columns + updates);
  EXPECT_EQ(count.sums, updates + n);  // one for each pivot: whether it is negative
}

}  // namespace
}  // namespace mixbeam
