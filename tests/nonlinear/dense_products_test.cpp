// Products of small blocks in tiles and lanes, against sums of products.
#include "nonlinear/multilevel/dense.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace mixbeam::test {

/// Sizes around all widths of lanes and tiles, and some that go to BLAS.
TEST(Dense, ProductsOfAllSizes) {
  constexpr double kSumsOfSixty = 1e-13;  // rounding of products below one
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto numbers = [&](size_t count) {
    std::vector<double> all(count);
    for (double& x : all) x = number(random);
    return all;
  };
  for (int m : {1, 2, 3, 5, 6, 7, 8, 13, 16, 21, 60})
    for (int n : {1, 3, 4, 6, 11, 60})
      for (int k : {1, 6, 60})
        for (bool transposed : {false, true}) {
          const std::vector<double> a = numbers(m * k), b = numbers(k * n), start = numbers(m * n);
          std::vector<double> c = start;
          const int b_row = transposed ? n : 1, b_column = transposed ? 1 : k;
          dense::add_product(m, k, n, a.data(), m, b.data(), b_row, b_column, c.data(), m);
          for (int i = 0; i < m; ++i)
            for (int j = 0; j < n; ++j) {
              double sum = start[m * j + i];
              for (int p = 0; p < k; ++p) sum += a[m * p + i] * b[b_row * p + b_column * j];
              ASSERT_NEAR(c[m * j + i], sum, kSumsOfSixty) << m << " x " << k << " x " << n;
            }
        }
  for (int m : {1, 2, 3, 5, 6, 7, 8, 13, 16, 21})
    for (int n : {1, 2, 3, 7, 8, 15}) {
      std::vector<double> a = numbers(m * n), z = numbers(m), y = numbers(m), sums(n);
      const std::vector<double> x = numbers(n), start = y;
      for (std::vector<double>* behind : {&a, &z, &y}) behind->resize(behind->size() + kLanes, 0.0);
      dense::multiply_both_ways<true>(m, n, a.data(), z.data(), sums.data(), x.data(), y.data());
      for (int i = 0; i < m; ++i) {
        double sum = start[i];
        for (int j = 0; j < n; ++j) sum += a[m * j + i] * x[j];
        ASSERT_NEAR(y[i], sum, kSumsOfSixty) << m << " x " << n;
      }
      for (int j = 0; j < n; ++j) {
        double sum = 0.0;
        for (int i = 0; i < m; ++i) sum += a[m * j + i] * z[i];
        ASSERT_NEAR(sums[j], sum, kSumsOfSixty) << m << " x " << n << " transposed";
      }
    }
}

}  // namespace mixbeam::test
