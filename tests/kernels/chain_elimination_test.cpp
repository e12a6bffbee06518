/// Links that see displacements as differences between their ends are eliminated as all symmetric ones.
#include "kernels/chains/elimination.hpp"
#include "kernels/loops/shared_rows.hpp"
#include "tests/support/random_numbers.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace mixbeam::chain_elimination_test {
namespace {

constexpr double kRounding = 1e-13;  // of numbers of the size of one, in a matrix of condition 10

/// Full matrix of a link, positive over (u_b - u_a, theta_a, theta_b).
template <int N>
void random_link(RandomNumbers& random, double* full) {
  using Layout = TangentLayout<N>;
  double numbers[Layout::kSymmetric];
  for (int i = 0; i < Layout::kReduced; ++i)
    for (int j = 0; j <= i; ++j) numbers[triangle(i, j)] = random.between(-1.0, 1.0) + (i == j ? 8.0 : 0.0);
  expand_symmetric_tangent<N>(numbers, full);
}

template <int N>
LinkMatrix<N, double> symmetric_link(const double* full) {
  LinkMatrix<N, double> link;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      link.first[triangle(i, j)] = full[2 * N * i + j];
      link.second[triangle(i, j)] = full[2 * N * (N + i) + N + j];
    }
    for (int j = 0; j < N; ++j) link.coupling[i][j] = full[2 * N * (N + i) + j];
  }
  return link;
}

template <int N>
FreeLinkMatrix<N, double> free_link(const LinkMatrix<N, double>& all) {
  FreeLinkMatrix<N, double> link;
  constexpr int moved = link.kMoved;
  for (int i = 0; i < link.kTurned; ++i)
    for (int j = 0; j <= i; ++j) link.first[triangle(i, j)] = all.first[triangle(moved + i, moved + j)];
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < link.kTurned; ++j) link.coupling[i][j] = all.coupling[i][moved + j];
  std::copy_n(all.second, triangle_size(N), link.second);
  return link;
}

/// Largest difference between both ways: the link that remains, rows that are passed on, and the vertex between.
/// `spring`: on the displacements of the vertex, which no longer enter as differences.
template <int N>
double difference(double spring) {
  RandomNumbers random(7);
  double first[4 * N * N], second[4 * N * N], x[2][N], neighbours[2][2 * N];
  random_link<N>(random, first);
  random_link<N>(random, second);
  LinkMatrix<N, double> chain = symmetric_link<N>(first), next = symmetric_link<N>(second);
  for (int i = 0; i < TangentLayout<N>::kMoved; ++i) next.first[triangle(i, i)] += spring;
  FreeLinkMatrix<N, double> free_chain = free_link<N>(chain), free_next = free_link<N>(next);
  VertexFactors<N, double> factors;
  FreeVertexFactors<N, double> free_factors;
  PivotWatch<double> watch, free_watch;
  eliminate_vertex<N>(chain, next, factors, watch);
  eliminate_vertex<N>(free_chain, free_next, free_factors, free_watch);
  for (int i = 0; i < N; ++i) x[0][i] = x[1][i] = random.between(-1.0, 1.0);
  for (int i = 0; i < 2 * N; ++i) neighbours[0][i] = neighbours[1][i] = random.between(-1.0, 1.0);
  eliminate_rows<N>(factors, x[0], neighbours[0], neighbours[0] + N);
  eliminate_rows<N>(free_factors, free_next, x[1], neighbours[1], neighbours[1] + N);
  follow_neighbours(factors, neighbours[0], neighbours[0] + N, x[0]);
  follow_neighbours(free_factors, free_next, neighbours[1], neighbours[1] + N, x[1]);
  double worst = 0.0;
  const auto compare = [&](double a, double c) { worst = std::max(worst, std::abs(a - c)); };
  for (int i = 0; i < N; ++i) compare(x[0][i], x[1][i]);
  for (int i = 0; i < 2 * N; ++i) compare(neighbours[0][i], neighbours[1][i]);
  const FreeLinkMatrix<N, double> expected = free_link<N>(chain);
  for (int i = 0; i < triangle_size(N); ++i) compare(expected.second[i], free_chain.second[i]);
  for (int i = 0; i < triangle_size(expected.kTurned); ++i) compare(expected.first[i], free_chain.first[i]);
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < expected.kTurned; ++j) compare(expected.coupling[i][j], free_chain.coupling[i][j]);
  return worst;
}

TEST(ChainElimination, FreeLinksAreEliminatedAsSymmetricOnes) {
  EXPECT_LE(difference<kSpatialDofs>(0.0), kRounding);
  EXPECT_LE(difference<kPlanarDofs>(0.0), kRounding);
}
TEST(ChainElimination, LinksWithASpringAreNotFree) {  // the test above can fail
  EXPECT_GE(difference<kSpatialDofs>(1e-6), 1e3 * kRounding);
  EXPECT_GE(difference<kPlanarDofs>(1e-6), 1e3 * kRounding);
}

TEST(RowsWithoutRepeats, KeepWhatNeighboursShareOnce) {
  const std::vector<double> a = {1.0, 2.0}, b = {1.0, std::nextafter(2.0, 3.0)};
  RowsWithoutRepeats rows(2);
  for (const auto& row : {a, a, b, b, a}) rows.add(row);
  const SharedRows kept = rows.rows("rows");
  EXPECT_EQ(kept.kept(), 3U);
  EXPECT_EQ(kept(1, 1), a[1]);
  EXPECT_EQ(kept(3, 1), b[1]) << "the last bit counts";
  EXPECT_EQ(kept.part({2, 5})(2, 1), a[1]);
  RowsWithoutRepeats different(2);
  for (const auto& row : {a, b}) different.add(row);
  EXPECT_EQ(different.rows("rows")(1, 1), b[1]);
}

}  // namespace
}  // namespace mixbeam::chain_elimination_test
