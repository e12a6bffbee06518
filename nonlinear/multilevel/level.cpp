#include "nonlinear/multilevel/level.hpp"

#include "nonlinear/multilevel/dense.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>

extern "C" {
void dsyevx_(const char*, const char*, const char*, const int*, double*, const int*, const double*, const double*,
             const int*, const int*, const double*, int*, double*, double*, const int*, double*, const int*, int*, int*,
             int*);
}

namespace mixbeam {

namespace {

using LevelRange = Kokkos::RangePolicy<ExecutionSpace>;

constexpr int kFine = 6;          ///< unknowns of a node of the finest level
constexpr double kLargest = 2.0;  ///< eigenvalue of A^: a link, being positive, is at most twice its own diagonal
constexpr double kRatio = 20.0;   ///< of the largest to the least eigenvalue that the smoother damps
constexpr int kMostModes = 1024;  ///< of a node
constexpr int kDegree = 3;        ///< of the smoother
/// Absolute, of eigenvalues in modes: against those of slender struts, 1e-6 and more.
constexpr double kEigenvalueError = 1e-10;

KernelView<double*> numbers(size_t count) {
  return KernelView<double*>(Kokkos::view_alloc("mixbeam::multilevel", Kokkos::WithoutInitializing), count);
}

/// Runs an action for each index on threads; the first exception of the lowest thread comes out.
template <class Action>
void for_each(int count, const Action& action) {
  Kokkos::parallel_for(
      "mixbeam::multilevel", LevelRange(0, count), KOKKOS_LAMBDA(int i) { action(i); });
}

}  // namespace

Level::Level(int nodes, LinkEnds ends, std::vector<int> first)
    : nodes_(nodes), ends_(std::move(ends)), first_(std::move(first)) {
  if (first_.empty()) first_.push_back(0);
  build_rows();
  build_coarse_links();
}

void Level::build_rows() {
  row_.assign(nodes_ + 1, 0);
  for (const auto& [a, b] : ends_) {
    ++row_[a + 1];
    ++row_[b + 1];
  }
  std::partial_sum(row_.begin(), row_.end(), row_.begin());
  slot_.resize(row_.back());
  std::vector<int> next(row_.begin(), row_.end() - 1);
  for (size_t l = 0; l < ends_.size(); ++l)
    for (int end = 0; end < 2; ++end) slot_[next[ends_[l][end]]++] = {static_cast<int>(l), end, ends_[l][1 - end]};
}

void Level::build_coarse_links() {
  if (aggregates() == 0) return;
  aggregate_.resize(nodes_);
  for (int i = 0; i < aggregates(); ++i) std::fill(&aggregate_[first_[i]], &aggregate_[0] + first_[i + 1], i);
  crossing_start_ = {0};
  std::vector<std::array<int, 2>> of_aggregate;  // aggregate at the other end, link and its direction
  for (int i = 0; i < aggregates(); ++i) {
    of_aggregate.clear();
    for (int s = row_[first_[i]]; s < row_[first_[i + 1]]; ++s)
      if (const int other = aggregate_[slot_[s][2]]; other > i)
        of_aggregate.push_back({other, 2 * slot_[s][0] + slot_[s][1]});
    std::sort(of_aggregate.begin(), of_aggregate.end());
    for (size_t k = 0; k < of_aggregate.size(); ++k) {
      if (k == 0 || of_aggregate[k][0] != of_aggregate[k - 1][0]) {
        if (!coarse_ends_.empty()) crossing_start_.push_back(static_cast<int>(crossing_.size()));
        coarse_ends_.push_back({i, of_aggregate[k][0]});
      }
      crossing_.push_back(of_aggregate[k][1]);
    }
  }
  crossing_start_.push_back(static_cast<int>(crossing_.size()));
}

void Level::set(std::vector<int> unknown, const KernelView<double*>& self, const LinkSource& links) {
  unknown_ = std::move(unknown);
  for (int v = 0; v < nodes_; ++v)
    if (unknown_[v + 1] - unknown_[v] > kMostModes)
      throw std::runtime_error("an aggregate of the network has more than " + std::to_string(kMostModes) +
                               " soft modes");
  square_.assign(nodes_ + 1, 0);
  for (int v = 0; v < nodes_; ++v) {
    const size_t m = unknown_[v + 1] - unknown_[v];
    square_[v + 1] = square_[v] + m * m;
  }
  block_.resize(slot_.size() + 1);
  block_[0] = 0;
  for (int v = 0; v < nodes_; ++v)
    for (int s = row_[v]; s < row_[v + 1]; ++s) {
      const int other = slot_[s][2];
      block_[s + 1] =
          block_[s] + static_cast<size_t>(unknown_[v + 1] - unknown_[v]) * (unknown_[other + 1] - unknown_[other]);
    }
  if (inverse_.extent(0) != square_.back()) inverse_ = numbers(square_.back());
  if (value_.extent(0) != block_.back()) value_ = {}, value_ = numbers(block_.back());
  std::atomic<bool> definite{true};
  for_each(nodes_, [&](int v) {
    const int m = unknown_[v + 1] - unknown_[v];
    std::vector<double> block(self.data() + square_[v], self.data() + square_[v + 1]);
    std::vector<double> room;
    for (int s = row_[v]; s < row_[v + 1]; ++s) {
      const int mo = unknown_[slot_[s][2] + 1] - unknown_[slot_[s][2]];
      room.resize(4 * static_cast<size_t>(std::max(m, mo)) * std::max(m, mo));
      const LinkBlocks link = links(slot_[s][0], room.data());
      const double* own = slot_[s][1] == 0 ? link.first : link.second;
      const int stride = slot_[s][1] == 0 ? link.first_stride : link.second_stride;
      for (int j = 0; j < m; ++j)
        for (int i = 0; i < m; ++i) block[m * j + i] += own[stride * j + i];
    }
    if (!dense::inverse_cholesky(m, block.data(), inverse_.data() + square_[v])) definite = false;
  });
  if (!definite) throw NegativeCurvature("a block on the diagonal is not positive definite");
  for_each(nodes_, [&](int v) {
    const int m = unknown_[v + 1] - unknown_[v];
    std::vector<double> room, product;
    for (int s = row_[v]; s < row_[v + 1]; ++s) {
      const int other = slot_[s][2], n = unknown_[other + 1] - unknown_[other];
      room.resize(4 * static_cast<size_t>(std::max(m, n)) * std::max(m, n));
      product.assign(static_cast<size_t>(m) * n, 0.0);
      const LinkBlocks link = links(slot_[s][0], room.data());
      // K01 from the first node: its rows; from the second one: its columns
      const bool turned = slot_[s][1] == 1;
      // product (m x n) = L^-1 K
      double* to = value_.data() + block_[s];
      std::fill(to, to + static_cast<size_t>(m) * n, 0.0);
      dense::add_product(m, m, n, inverse_.data() + square_[v], m, link.coupling, turned ? link.coupling_stride : 1,
                         turned ? 1 : link.coupling_stride, product.data(), m);
      // times L^-T of the other node
      dense::add_product(m, n, n, product.data(), m, inverse_.data() + square_[other], n, 1, to, m);
    }
  });
}

std::vector<double> Level::modes_of(int aggregate, double tau, const KernelView<double*>& self, const LinkSource& links,
                                    std::vector<double>& eigenvalues) const {
  const int begin = first_[aggregate], end = first_[aggregate + 1], origin = unknown_[begin];
  const int n = unknown_[end] - origin;
  eigenvalues.clear();
  if (n == 0) return {};
  std::vector<double> matrix(static_cast<size_t>(n) * n, 0.0), room, block, product;
  for (int v = begin; v < end; ++v) {
    const int m = unknown_[v + 1] - unknown_[v], at = unknown_[v] - origin;
    block.assign(self.data() + square_[v], self.data() + square_[v + 1]);
    for (int s = row_[v]; s < row_[v + 1]; ++s) {
      const int other = slot_[s][2];
      if (other < begin || other >= end) continue;
      const int mo = unknown_[other + 1] - unknown_[other];
      room.resize(4 * static_cast<size_t>(std::max(m, mo)) * std::max(m, mo));
      const LinkBlocks link = links(slot_[s][0], room.data());
      const double* own = slot_[s][1] == 0 ? link.first : link.second;
      const int stride = slot_[s][1] == 0 ? link.first_stride : link.second_stride;
      for (int j = 0; j < m; ++j)
        for (int i = 0; i < m; ++i) block[m * j + i] += own[stride * j + i];
      if (other > v) continue;  // lower triangle: rows of the later node
      const int column = unknown_[other] - origin;
      for (int j = 0; j < mo; ++j)
        for (int i = 0; i < m; ++i)
          matrix[static_cast<size_t>(n) * (column + j) + at + i] += value_(block_[s] + static_cast<size_t>(m) * j + i);
    }
    product.assign(static_cast<size_t>(m) * m, 0.0);
    const double* inverse = inverse_.data() + square_[v];
    dense::add_product(m, m, m, inverse, m, block.data(), 1, m, product.data(), m);
    dense::add_product(m, m, m, product.data(), m, inverse, m, 1, &matrix[static_cast<size_t>(n) * at + at], n);
  }
  std::vector<double> values(n), vectors(static_cast<size_t>(n) * n), work(40 * static_cast<size_t>(n));
  std::vector<int> integers(5 * static_cast<size_t>(n)), failed(n);
  const double none = -1e300, tolerance = kEigenvalueError;
  const int unused = 0, size = static_cast<int>(work.size());
  int found = 0, info = 0;
  dsyevx_("V", "V", "L", &n, matrix.data(), &n, &none, &tau, &unused, &unused, &tolerance, &found, values.data(),
          vectors.data(), &n, work.data(), &size, integers.data(), failed.data(), &info);
  if (info != 0) throw std::runtime_error("LAPACK's dsyevx did not find the modes of an aggregate");
  eigenvalues.assign(values.begin(), values.begin() + found);
  std::vector<double> modes(static_cast<size_t>(found) * n);
  for (int j = 0; j < n; ++j)
    for (int q = 0; q < found; ++q) modes[static_cast<size_t>(found) * j + q] = vectors[static_cast<size_t>(n) * q + j];
  return modes;
}

Level::Coarse Level::coarsen(double tau, const KernelView<double*>& self, const LinkSource& links) {
  const int count = aggregates();
  std::vector<std::vector<double>> modes(count), eigenvalues(count);
  for_each(count, [&](int a) { modes[a] = modes_of(a, tau, self, links, eigenvalues[a]); });
  Coarse coarse;
  coarse.unknown.assign(count + 1, 0);
  mode_block_.assign(count + 1, 0);
  std::vector<size_t> square(count + 1, 0);
  for (int a = 0; a < count; ++a) {
    const size_t m = eigenvalues[a].size();
    coarse.unknown[a + 1] = coarse.unknown[a] + static_cast<int>(m);
    mode_block_[a + 1] = mode_block_[a] + modes[a].size();
    square[a + 1] = square[a] + m * m;
  }
  mode_ = coarse.unknown;
  modes_ = {};
  modes_ = numbers(mode_block_.back());
  coarse.self = numbers(square.back());
  // modes in unscaled unknowns of this level, for the links: V^T L^-1
  const KernelView<double*> unscaled = numbers(mode_block_.back());
  for_each(count, [&](int a) {
    std::copy(modes[a].begin(), modes[a].end(), modes_.data() + mode_block_[a]);
    const int m = mode_[a + 1] - mode_[a];
    double* block = coarse.self.data() + square[a];
    std::fill(block, block + static_cast<size_t>(m) * m, 0.0);
    for (int q = 0; q < m; ++q) block[m * q + q] = eigenvalues[a][q];
    double* to = unscaled.data() + mode_block_[a];
    std::fill(to, to + modes[a].size(), 0.0);
    for (int v = first_[a]; v < first_[a + 1]; ++v) {
      const int n = unknown_[v + 1] - unknown_[v];
      const size_t at = static_cast<size_t>(m) * (unknown_[v] - unknown_[first_[a]]);
      dense::add_product(m, n, n, modes[a].data() + at, m, inverse_.data() + square_[v], 1, n, to + at, m);
    }
    modes[a] = {};
  });
  coarse.ends = coarse_ends_;
  coarse.block.assign(coarse_ends_.size() + 1, 0);
  for (size_t l = 0; l < coarse_ends_.size(); ++l) {
    const size_t m = mode_[coarse_ends_[l][0] + 1] - mode_[coarse_ends_[l][0]];
    const size_t n = mode_[coarse_ends_[l][1] + 1] - mode_[coarse_ends_[l][1]];
    coarse.block[l + 1] = coarse.block[l] + m * m + m * n + n * n;
  }
  coarse.links = numbers(coarse.block.back());
  for_each(static_cast<int>(coarse_ends_.size()), [&](int l) {
    const int a = coarse_ends_[l][0], b = coarse_ends_[l][1];
    const int m = mode_[a + 1] - mode_[a], n = mode_[b + 1] - mode_[b];
    double* first = coarse.links.data() + coarse.block[l];
    double* coupling = first + static_cast<size_t>(m) * m;
    double* second = coupling + static_cast<size_t>(m) * n;
    std::fill(first, second + static_cast<size_t>(n) * n, 0.0);
    std::vector<double> room, product;
    for (int k = crossing_start_[l]; k < crossing_start_[l + 1]; ++k) {
      const int fine = crossing_[k] / 2;
      const bool turned = crossing_[k] % 2 == 1;
      const int va = ends_[fine][turned ? 1 : 0], vb = ends_[fine][turned ? 0 : 1];
      const int na = unknown_[va + 1] - unknown_[va], nb = unknown_[vb + 1] - unknown_[vb];
      room.resize(4 * static_cast<size_t>(std::max(na, nb)) * std::max(na, nb));
      const LinkBlocks link = links(fine, room.data());
      const double* wa =
          unscaled.data() + mode_block_[a] + static_cast<size_t>(m) * (unknown_[va] - unknown_[first_[a]]);
      const double* wb =
          unscaled.data() + mode_block_[b] + static_cast<size_t>(n) * (unknown_[vb] - unknown_[first_[b]]);
      const double* kaa = turned ? link.second : link.first;
      const double* kbb = turned ? link.first : link.second;
      const int saa = turned ? link.second_stride : link.first_stride;
      const int sbb = turned ? link.first_stride : link.second_stride;
      product.assign(static_cast<size_t>(m) * std::max(na, nb), 0.0);
      dense::add_product(m, na, na, wa, m, kaa, 1, saa, product.data(), m);
      dense::add_product(m, na, m, product.data(), m, wa, m, 1, first, m);
      std::fill(product.begin(), product.end(), 0.0);
      dense::add_product(m, na, nb, wa, m, link.coupling, turned ? link.coupling_stride : 1,
                         turned ? 1 : link.coupling_stride, product.data(), m);
      dense::add_product(m, nb, n, product.data(), m, wb, n, 1, coupling, m);
      product.assign(static_cast<size_t>(n) * nb, 0.0);
      dense::add_product(n, nb, nb, wb, n, kbb, 1, sbb, product.data(), n);
      dense::add_product(n, nb, n, product.data(), n, wb, n, 1, second, n);
    }
  });
  return coarse;
}

LinkSource Level::Coarse::source() const {
  return [this](int link, double*) {
    const int m = unknown[ends[link][0] + 1] - unknown[ends[link][0]];
    const int n = unknown[ends[link][1] + 1] - unknown[ends[link][1]];
    const double* first = links.data() + block[link];
    const double* coupling = first + static_cast<size_t>(m) * m;
    return LinkBlocks{first, coupling, coupling + static_cast<size_t>(m) * n, m, m, n};
  };
}

void Level::set_coarse_scale(const Level& coarse) {
  for_each(aggregates(), [&](int a) {
    const int m = mode_[a + 1] - mode_[a];
    if (m == 0) return;
    const int n = static_cast<int>((mode_block_[a + 1] - mode_block_[a]) / m);
    double* modes = modes_.data() + mode_block_[a];
    const std::vector<double> old(modes, modes + static_cast<size_t>(m) * n);
    std::fill(modes, modes + static_cast<size_t>(m) * n, 0.0);
    dense::add_product(m, m, n, coarse.inverse_.data() + coarse.square_[a], m, old.data(), 1, m, modes, m);
  });
}

template <int Size, class Finish>
void Level::for_each_row(const LevelVector& x, const Finish& finish) const {
  const double *from = x.data(), *value = value_.data();
  const auto* slot = slot_.data();
  const int *row = row_.data(), *unknown = unknown_.data();
  const size_t* block = block_.data();
  Kokkos::parallel_for(
      "mixbeam::multilevel::rows", LevelRange(0, nodes_), KOKKOS_LAMBDA(int v) {
        double sum[Size > 0 ? Size : kMostModes];
        const int at = unknown[v], m = Size > 0 ? Size : unknown[v + 1] - at;
        for (int i = 0; i < m; ++i) sum[i] = from[at + i];
        for (int s = row[v]; s < row[v + 1]; ++s) {
          const int other = unknown[slot[s][2]];
          dense::add_times_vector<Size>(m, Size > 0 ? Size : unknown[slot[s][2] + 1] - other, value + block[s],
                                        from + other, sum);
        }
        finish(at, m, sum);
      });
}

template <class Finish>
void Level::multiply(const LevelVector& x, const Finish& finish) const {
  if (unknowns() == kFine * nodes_)
    for_each_row<kFine>(x, finish);
  else
    for_each_row<0>(x, finish);
}

void Level::apply(const LevelVector& x, const LevelVector& y) const {
  double* to = y.data();
  multiply(x, [to](int at, int m, const double* sum) {
    for (int i = 0; i < m; ++i) to[at + i] = sum[i];
  });
}

void Level::subtract_product(const LevelVector& x, const LevelVector& residual) const {
  double* to = residual.data();
  multiply(x, [to](int at, int m, const double* sum) {
    for (int i = 0; i < m; ++i) to[at + i] -= sum[i];
  });
}

void Level::smooth(const LevelVector& residual, const LevelVector& x, const LevelVector& step, const LevelVector& other,
                   bool starts_at_zero) const {
  constexpr double least = kLargest / kRatio, center = 0.5 * (kLargest + least), half = 0.5 * (kLargest - least);
  double *r = residual.data(), *to = x.data(), *d = step.data(), *next = other.data();
  const bool zero = starts_at_zero;
  Kokkos::parallel_for(
      "mixbeam::multilevel::first_step", LevelRange(0, unknowns()), KOKKOS_LAMBDA(int i) {
        d[i] = r[i] / center;
        to[i] = zero ? d[i] : to[i] + d[i];
      });
  double rho = half / center;
  LevelVector now = step;
  for (int k = 1; k < kDegree; ++k) {
    const double rho_next = 1.0 / (2.0 * center / half - rho), keep = rho_next * rho, add = 2.0 * rho_next / half;
    rho = rho_next;
    multiply(now, [=](int at, int m, const double* sum) {
      for (int i = at; i < at + m; ++i) {
        r[i] -= sum[i - at];
        next[i] = keep * d[i] + add * r[i];
        to[i] += next[i];
      }
    });
    std::swap(d, next);
    now = k % 2 == 1 ? other : step;
  }
}

void Level::add(const LevelVector& step, const LevelVector& x) const {
  double* to = x.data();
  const double* from = step.data();
  for_each(unknowns(), [=](int i) { to[i] += from[i]; });
}

void Level::restrict_to(const LevelVector& fine, const LevelVector& coarse) const {
  const double *from = fine.data(), *modes = modes_.data();
  double* to = coarse.data();
  for_each(aggregates(), [&](int a) {
    const int m = mode_[a + 1] - mode_[a], at = unknown_[first_[a]], n = unknown_[first_[a + 1]] - at;
    for (int q = 0; q < m; ++q) to[mode_[a] + q] = 0.0;
    dense::add_times_vector(m, n, modes + mode_block_[a], from + at, to + mode_[a]);
  });
}

void Level::prolong(const LevelVector& coarse, const LevelVector& fine) const {
  const double *from = coarse.data(), *modes = modes_.data();
  double* to = fine.data();
  for_each(aggregates(), [&](int a) {
    const int m = mode_[a + 1] - mode_[a], at = unknown_[first_[a]], n = unknown_[first_[a + 1]] - at;
    const double *column = modes + mode_block_[a], *y = from + mode_[a];
    for (int j = 0; j < n; ++j, column += m) {
      double sum = 0.0;
#pragma omp simd reduction(+ : sum)
      for (int q = 0; q < m; ++q) sum += column[q] * y[q];
      to[at + j] = sum;
    }
  });
}

void Level::scale_rows(const KernelView<const double*>& b, const LevelVector& scaled) const {
  for_each(nodes_, [&](int v) {
    const int at = unknown_[v], m = unknown_[v + 1] - at;
    const double* inverse = inverse_.data() + square_[v];
    for (int i = 0; i < m; ++i) {
      double sum = 0.0;
      for (int j = 0; j <= i; ++j) sum += inverse[m * j + i] * b.data()[at + j];
      scaled.data()[at + i] = sum;
    }
  });
}

void Level::unscale(const LevelVector& scaled, const KernelView<double*>& x) const {
  for_each(nodes_, [&](int v) {
    const int at = unknown_[v], m = unknown_[v + 1] - at;
    const double* inverse = inverse_.data() + square_[v];
    for (int i = 0; i < m; ++i) {
      double sum = 0.0;
      for (int j = i; j < m; ++j) sum += inverse[m * i + j] * scaled.data()[at + j];
      x.data()[at + i] = sum;
    }
  });
}

void Level::each_block(const std::function<void(int, int, const double*)>& action) const {
  for (int v = 0; v < nodes_; ++v)
    for (int s = row_[v]; s < row_[v + 1]; ++s) action(v, slot_[s][2], value_.data() + block_[s]);
}

}  // namespace mixbeam
