#include "nonlinear/multilevel/level.hpp"

#include "discretization/mesh/row_lists.hpp"
#include "nonlinear/linear/blas_setup.hpp"
#include "nonlinear/multilevel/dense.hpp"

#include <atomic>

extern "C" {
void dsytrd_(const char*, const int*, double*, const int*, double*, double*, double*, double*, const int*, int*);
void dsterf_(const int*, double*, double*, int*);
void dstein_(const int*, const double*, const double*, const int*, const double*, const int*, const int*, double*,
             const int*, double*, int*, int*, int*);
void dormtr_(const char*, const char*, const char*, const int*, const int*, const double*, const int*, const double*,
             double*, const int*, double*, const int*, int*);
void dsyevd_(const char*, const char*, const int*, double*, const int*, double*, double*, const int*, int*, const int*,
             int*);
}

namespace mixbeam {

namespace {

using multilevel::for_each, multilevel::numbers;
using LevelRange = Kokkos::RangePolicy<ExecutionSpace>;

constexpr int kFine = 6;          ///< unknowns of a node of the finest level
constexpr double kLargest = 2.0;  ///< bound of eigenvalues of A^: a positive link is at most twice its block diagonal
constexpr double kRatio = 20.0;   ///< of the largest to the least eigenvalue that the smoother damps
constexpr int kDegree = 3;        ///< of the smoother's polynomial

}  // namespace

Level::Level(int nodes, LinkEnds ends, std::vector<int> first, Halo halo)
    : nodes_(nodes), halo_(std::move(halo)), ends_(std::move(ends)), first_(std::move(first)) {
  build_rows();
  if (first_.empty()) {
    first_.push_back(0);
    return;
  }
  find_aggregates();
  build_coarse_links();
}

void Level::build_rows() {
  auto rows = row_lists<std::array<int, 3>>(nodes_, [this](const auto& add) {
    for (size_t l = 0; l < ends_.size(); ++l)
      for (int end = 0; end < 2; ++end)
        if (ends_[l][end] < nodes_) add(ends_[l][end], {static_cast<int>(l), end, ends_[l][1 - end]});
  });
  row_ = std::move(rows.start);
  slot_ = std::move(rows.entries);
}

/// Numbers the aggregates of all nodes: those here first, then those that ghosts belong to.
void Level::find_aggregates() {
  aggregate_.resize(nodes_ + halo_.ghosts());
  for (int i = 0; i < aggregates(); ++i) std::fill(&aggregate_[first_[i]], &aggregate_[0] + first_[i + 1], i);
  if (!halo_.has_several_ranks()) return;
  const int first = halo_.first_of(aggregates());
  std::vector<int> number(aggregate_.size()), one_each(aggregate_.size() + 1);
  for (int v = 0; v < nodes_; ++v) number[v] = first + aggregate_[v];
  std::iota(one_each.begin(), one_each.end(), 0);
  halo_.exchange(number.data(), one_each);
  std::vector<int> others(number.begin() + nodes_, number.end());
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  for (size_t g = nodes_; g < number.size(); ++g)
    aggregate_[g] =
        aggregates() + static_cast<int>(std::lower_bound(others.begin(), others.end(), number[g]) - others.begin());
  coarse_halo_ = Halo(halo_.communicator(), aggregates(), others);
}

void Level::build_coarse_links() {
  crossing_start_ = {0};
  std::vector<std::array<int, 2>> of_aggregate;  // {aggregate at the other end, 2 * link + end here}
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
  square_.assign(unknown_.size(), 0);
  for (int v = 0; v < nodes_ + halo_.ghosts(); ++v) {
    const size_t m = unknowns_of(v);
    square_[v + 1] = square_[v] + m * m;
  }
  const size_t numbers_of_blocks = number_blocks();
  if (inverse_.extent(0) != square_.back()) inverse_ = numbers(square_.back());
  rounded_ = {};
  if (value_.extent(0) != numbers_of_blocks + kLanes)
    value_ = {}, value_ = multilevel::numbers_for_lanes(numbers_of_blocks);
  scale(self, links);
}

/// Places blocks in the order in which rows first meet them, and summands of a row consecutively; those computed for
/// rows of other ranks, and not used, come last. Returns the number of entries of all blocks.
size_t Level::number_blocks() {
  std::vector<int> slot_of_link(ends_.size());  // at its earlier node
  block_.resize(slot_.size());
  summand_.resize(slot_.size());
  first_summand_.resize(nodes_ + 1);
  size_t count = 0, summands = 0;
  for (int v = 0; v < nodes_; ++v) {
    const size_t m = unknowns_of(v);
    first_summand_[v] = summands;
    summands += m;
    for (int s = row_[v]; s < row_[v + 1]; ++s) {
      const auto& [link, end, other] = slot_[s];
      if (other > v) {
        slot_of_link[link] = s;
        block_[s] = count;
        count += m * unknowns_of(other);
        continue;
      }
      block_[s] = block_[slot_of_link[link]];
      summand_[slot_of_link[link]] = summands;
      summands += m;
    }
  }
  first_summand_[nodes_] = summands;
  for (size_t s = 0; s < slot_.size(); ++s)
    if (slot_[s][2] >= nodes_) {
      summand_[s] = summands;
      summands += unknowns_of(slot_[s][2]);
    }
  if (summands_.extent(0) != summands) summands_ = {}, summands_ = numbers(summands);
  return count;
}

LinkBlocks Level::link_of(int node, int slot, const LinkSource& links, std::vector<double>& room) const {
  const auto& [link, end, other] = slot_[slot];
  room.resize(multilevel::room_of_link(unknowns_of(node), unknowns_of(other)));
  return links(link, room.data()).seen_from(end);
}

void Level::add_own(int node, const LinkBlocks& link, std::vector<double>& block) const {
  const int m = unknowns_of(node);
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) block[m * j + i] += link.first[link.first_stride * j + i];
}

/// Factorises the diagonal blocks and transforms the others to scaled unknowns.
void Level::scale(const KernelView<double*>& self, const LinkSource& links) {
  std::atomic<bool> definite{true};
  for_each(nodes_, [&](int v) {
    std::vector<double> block(self.data() + square_[v], self.data() + square_[v + 1]), room;
    for (int s = row_[v]; s < row_[v + 1]; ++s) add_own(v, link_of(v, s, links, room), block);
    if (!dense::inverse_cholesky(unknowns_of(v), block.data(), inverse_.data() + square_[v])) definite = false;
  });
  if (halo_.largest(definite ? 0.0 : 1.0) > 0.0)
    throw NegativeCurvature("a block on the diagonal is not positive definite");
  halo_.exchange(inverse_.data(), square_);
  for_each(nodes_, [&](int v) {
    const int m = unknowns_of(v);
    std::vector<double> room, product;
    for (int s = row_[v]; s < row_[v + 1]; ++s) {
      const int other = slot_[s][2], n = unknowns_of(other);
      if (other < v) continue;
      product.assign(static_cast<size_t>(m) * n, 0.0);
      const LinkBlocks link = link_of(v, s, links, room);
      // product (m x n) = L^-1 K
      double* to = value_.data() + block_[s];
      std::fill(to, to + static_cast<size_t>(m) * n, 0.0);
      dense::add_product(m, m, n, inverse_.data() + square_[v], m, link.coupling, link.coupling_row,
                         link.coupling_column, product.data(), m);
      // times L^-T of the other node
      dense::add_product(m, n, n, product.data(), m, inverse_.data() + square_[other], n, 1, to, m);
    }
  });
}

void Level::round() {
  const size_t count = value_.extent(0);
  rounded_ = KernelView<float*>(Kokkos::view_alloc("mixbeam::multilevel", Kokkos::WithoutInitializing), count);
  const double* from = value_.data();
  float* to = rounded_.data();
  Kokkos::parallel_for(
      "mixbeam::multilevel::round", Kokkos::RangePolicy<ExecutionSpace>(0, count),
      KOKKOS_LAMBDA(size_t i) { to[i] = static_cast<float>(from[i]); });
  value_ = {};
}

/// Multiplies with A^, reading each block once for both nodes: the first loop computes each row's own products and its
/// contributions to rows of later nodes, the second sums up both in the order of nodes.
template <int Size, class Value, class Finish>
void Level::for_each_row(const Value* value, const LevelVector& x, const Finish& finish) const {
  const double* from = x.data();
  const auto* slot = slot_.data();
  const int *row = row_.data(), *unknown = unknown_.data();
  const size_t *block = block_.data(), *place = summand_.data(), *first = first_summand_.data();
  double* summands = summands_.data();
  Kokkos::parallel_for(
      "mixbeam::multilevel::blocks", LevelRange(0, nodes_), KOKKOS_LAMBDA(int v) {
        double own[(Size > 0 ? Size : kMostModes) + kLanes], sum[(Size > 0 ? Size : kMostModes) + kLanes];
        const int at = unknown[v], m = Size > 0 ? Size : unknown[v + 1] - at;
        for (int i = 0; i < m; ++i) own[i] = sum[i] = from[at + i];
        for (int i = m; i < m + kLanes; ++i) own[i] = sum[i] = 0.0;
        for (int s = row[v]; s < row[v + 1]; ++s) {
          if (slot[s][2] < v) continue;
          const int other = unknown[slot[s][2]], n = Size > 0 ? Size : unknown[slot[s][2] + 1] - other;
          if constexpr (Size > 0)
            dense::add_columns<Size, true>(Size, value + block[s], own, summands + place[s], from + other, sum);
          else
            dense::multiply_both_ways<true>(m, n, value + block[s], own, summands + place[s], from + other, sum);
        }
        for (int i = 0; i < m; ++i) summands[first[v] + i] = sum[i];
      });
  Kokkos::parallel_for(
      "mixbeam::multilevel::rows", LevelRange(0, nodes_), KOKKOS_LAMBDA(int v) {
        const int at = unknown[v], m = Size > 0 ? Size : unknown[v + 1] - at;
        double* sum = summands + first[v];
        for (size_t k = first[v] + m; k < first[v + 1]; k += m)
          for (int i = 0; i < m; ++i) sum[i] += summands[k + i];
        finish(at, m, sum);
      });
}

template <class Finish>
void Level::multiply(const LevelVector& x, const Finish& finish) const {
  complete(x);
  if (rounded_.extent(0) > 0)
    for_each_row<0>(rounded_.data(), x, finish);
  else if (unknowns() == kFine * nodes_)
    for_each_row<kFine>(value_.data(), x, finish);
  else
    for_each_row<0>(value_.data(), x, finish);
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

SparseMatrix Level::matrix() const {
  SparseMatrix matrix;
  matrix.row_start.reserve(unknowns() + 1);
  matrix.row_start.push_back(0);
  matrix.column.reserve(unknowns() + 2 * value_.extent(0));
  matrix.value.reserve(unknowns() + 2 * value_.extent(0));
  std::vector<int> slots;
  const auto add = [&matrix](int column, double value) {
    matrix.column.push_back(column);
    matrix.value.push_back(value);
  };
  for (int v = 0; v < nodes_; ++v) {
    slots.resize(row_[v + 1] - row_[v]);
    std::iota(slots.begin(), slots.end(), row_[v]);
    std::stable_sort(slots.begin(), slots.end(), [&](int s, int t) { return slot_[s][2] < slot_[t][2]; });
    const auto behind = std::find_if(slots.begin(), slots.end(), [&](int s) { return slot_[s][2] > v; });
    const int m = unknowns_of(v);
    for (int i = 0; i < m; ++i) {
      for (auto s = slots.begin();; ++s) {
        if (s == behind) add(unknown_[v] + i, 1.0);
        if (s == slots.end()) break;
        const int first = unknown_[slot_[*s][2]], n = unknowns_of(slot_[*s][2]);
        const bool is_stored = slot_[*s][2] > v;  // otherwise its transpose is
        for (int j = 0; j < n; ++j)
          add(first + j,
              value_(block_[*s] + (is_stored ? static_cast<size_t>(m) * j + i : static_cast<size_t>(n) * i + j)));
      }
      matrix.row_start.push_back(static_cast<int>(matrix.column.size()));
    }
  }
  return matrix;
}

RowsOfRanks Level::shares() const {
  RowsOfRanks share;
  share.communicator = halo_.communicator();
  share.rows = GatherPlan(share.communicator, unknowns());
  share.first = halo_.first_of(unknowns());
  share.column_number.resize(room());
  std::iota(share.column_number.begin(), share.column_number.end(), share.first);
  halo_.exchange(share.column_number.data(), unknown_);
  return share;
}

// The next level: soft modes of aggregates, projection, and transfer of vectors.

namespace {

/// Off-diagonal entries of a tridiagonal form that count as zero: rounding of its eigenvalues, which lie in [0, 2].
constexpr double kNoLink = 1e-16;

/// Eigenvalues of a symmetric matrix (lower triangle read) up to a limit, with eigenvectors in the columns of
/// `vectors`: finds all values of the tridiagonal form, then the wanted vectors by inverse iteration. LAPACK's dsyevx,
/// which finds only the wanted values by bisection, takes 25 % more time for the spaces of a cubic lattice.
struct SoftModes {
  std::vector<double> values, vectors;

  SoftModes(int n, std::vector<double> matrix, const Level::ModeLimit& limit) : vectors(matrix.size()) {
    std::vector<double> form = matrix, diagonal(n), beside(n), reflectors(n), work(40 * static_cast<size_t>(n));
    const int size = static_cast<int>(work.size());
    int info = 0;
    const auto turn = turn_for_blas();
    dsytrd_("L", &n, form.data(), &n, diagonal.data(), beside.data(), reflectors.data(), work.data(), &size, &info);
    std::vector<int> block, last;  // (mode): its block of the tridiagonal form; (block): last row; both count from one
    for (int begin = 0; begin < n && info == 0;) {
      int end = begin + 1;
      while (end < n && std::abs(beside[end - 1]) > kNoLink) ++end;
      std::vector<double> all(&diagonal[begin], &diagonal[0] + end), off(&beside[begin], &beside[0] + end);
      const int rows = end - begin;
      dsterf_(&rows, all.data(), off.data(), &info);
      last.push_back(end);
      values.insert(values.end(), all.begin(), all.end());
      block.resize(values.size(), static_cast<int>(last.size()));
      begin = end;
    }
    double least = 0.0;
    for (const double value : values) least = std::min(least, value);
    const double most = limit.tau - limit.raise * least;
    int found = 0;
    for (size_t i = 0; i < values.size(); ++i)
      if (values[i] <= most) values[found] = values[i], block[found++] = block[i];
    values.resize(found);
    std::vector<int> integers(n), failed(found);
    last.resize(n);
    if (info == 0 && found > 0) {
      dstein_(&n, diagonal.data(), beside.data(), &found, values.data(), block.data(), last.data(), vectors.data(), &n,
              work.data(), integers.data(), failed.data(), &info);
      int other = 0;
      dormtr_("L", "L", "N", &n, &found, form.data(), &n, reflectors.data(), vectors.data(), &n, work.data(), &size,
              &other);
    }
    if (info != 0) values.resize(among_all(n, std::move(matrix), limit));
  }

 private:
  /// Finds all pairs by divide and conquer, and returns the number of those wanted. Inverse iteration misses a vector
  /// of a cluster in about one of thousands of aggregates.
  int among_all(int n, std::vector<double> matrix, const Level::ModeLimit& limit) {
    std::vector<double> work(1 + (6 + 2 * static_cast<size_t>(n)) * n);
    std::vector<int> integers(3 + 5 * static_cast<size_t>(n));
    const int size = static_cast<int>(work.size()), integer_size = static_cast<int>(integers.size());
    int info = 0;
    values.resize(n);
    dsyevd_("V", "L", &n, matrix.data(), &n, values.data(), work.data(), &size, integers.data(), &integer_size, &info);
    if (info != 0) return 0;  // a coarse space that is too poor shows in the iterations; threads must not throw
    vectors = std::move(matrix);
    return static_cast<int>(
        std::upper_bound(values.begin(), values.end(), limit.tau - limit.raise * std::min(0.0, values[0])) -
        values.begin());
  }
};

}  // namespace

std::vector<double> Level::modes_of(int aggregate, const ModeLimit& limit, const KernelView<double*>& self,
                                    const LinkSource& links, std::vector<double>& eigenvalues) const {
  const int begin = first_[aggregate], end = first_[aggregate + 1], origin = unknown_[begin];
  const int n = unknown_[end] - origin;
  eigenvalues.clear();
  if (n == 0) return {};
  std::vector<double> matrix(static_cast<size_t>(n) * n, 0.0), room, block, product;
  for (int v = begin; v < end; ++v) {
    const int m = unknowns_of(v), at = unknown_[v] - origin;
    block.assign(self.data() + square_[v], self.data() + square_[v + 1]);
    for (int s = row_[v]; s < row_[v + 1]; ++s) {
      const int other = slot_[s][2];
      if (other < begin || other >= end) continue;
      add_own(v, link_of(v, s, links, room), block);
      if (other > v) continue;  // lower triangle only: rows of the later node
      const int column = unknown_[other] - origin, mo = unknowns_of(other);
      for (int i = 0; i < m; ++i)
        for (int j = 0; j < mo; ++j)
          matrix[static_cast<size_t>(n) * (column + j) + at + i] += value_(block_[s] + static_cast<size_t>(mo) * i + j);
    }
    product.assign(static_cast<size_t>(m) * m, 0.0);
    const double* inverse = inverse_.data() + square_[v];
    dense::add_product(m, m, m, inverse, m, block.data(), 1, m, product.data(), m);
    dense::add_product(m, m, m, product.data(), m, inverse, m, 1, &matrix[static_cast<size_t>(n) * at + at], n);
  }
  const SoftModes soft(n, std::move(matrix), limit);
  eigenvalues = soft.values;
  const size_t found = eigenvalues.size();
  std::vector<double> modes(found * n);
  for (int j = 0; j < n; ++j)
    for (size_t q = 0; q < found; ++q) modes[found * j + q] = soft.vectors[n * q + j];
  return modes;
}

namespace {

/// Limits for slender struts, for which a block of n^3 nodes of a cubic lattice has 3 n^2 soft modes on every level. If
/// the next level would have more unknowns than kManyUnknowns, aggregates with more than kManyModes keep the softest.
/// Measured with 2e4 junctions of slenderness 100: 25 iterations in place of 19, half as many unknowns.
constexpr int kManyUnknowns = 20000;
constexpr size_t kManyModes = 64;
constexpr double kVerySoft = 0.01;

/// Drops the stiffer of too many modes. `modes`: (mode, unknown), column-major.
void keep_softest(std::vector<double>& modes, std::vector<double>& eigenvalues) {
  const size_t m = eigenvalues.size();
  if (m <= kManyModes) return;
  std::vector<double> sorted = eigenvalues;
  std::nth_element(sorted.begin(), sorted.begin() + kManyModes, sorted.end());
  const double most = std::max(sorted[kManyModes], kVerySoft);
  const size_t unknowns = modes.size() / m;
  size_t kept = 0;
  for (size_t j = 0; j < unknowns; ++j)
    for (size_t q = 0; q < m; ++q)
      if (eigenvalues[q] <= most) modes[kept++] = modes[m * j + q];
  modes.resize(kept);
  eigenvalues.erase(std::remove_if(eigenvalues.begin(), eigenvalues.end(), [most](double e) { return e > most; }),
                    eigenvalues.end());
}

/// Number of entries of the lower triangle of a matrix of m rows, which is packed column by column.
size_t triangle(size_t m) { return m * (m + 1) / 2; }

void pack_triangle(int m, const double* full, double* lower) {
  for (int j = 0; j < m; ++j) lower = std::copy_n(full + static_cast<size_t>(m) * j + j, m - j, lower);
}

void unpack_triangle(int m, const double* lower, double* full) {
  for (int j = 0; j < m; ++j)
    for (int i = j; i < m; ++i) full[static_cast<size_t>(m) * j + i] = full[static_cast<size_t>(m) * i + j] = *lower++;
}

}  // namespace

Level::Coarse Level::find_modes(const ModeLimit& limit, const KernelView<double*>& self, const LinkSource& links) {
  const int count = aggregates();
  std::vector<std::vector<double>> modes(count), eigenvalues(count);
  for_each(count, [&](int a) { modes[a] = modes_of(a, limit, self, links, eigenvalues[a]); });
  size_t all = 0;
  for (const std::vector<double>& of_aggregate : eigenvalues) all += of_aggregate.size();
  if (halo_.sum(static_cast<double>(all)) > kManyUnknowns)
    for_each(count, [&](int a) { keep_softest(modes[a], eigenvalues[a]); });
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
  const int others = coarse_halo_.ghosts();
  std::vector<int> modes_of_each(count + others), one_each(count + others + 1);
  std::iota(one_each.begin(), one_each.end(), 0);
  std::adjacent_difference(coarse.unknown.begin() + 1, coarse.unknown.end(), modes_of_each.begin());
  coarse_halo_.exchange(modes_of_each.data(), one_each);
  for (int a = count; a < count + others; ++a) coarse.unknown.push_back(coarse.unknown.back() + modes_of_each[a]);
  mode_ = coarse.unknown;
  modes_ = {};
  modes_ = multilevel::numbers_for_lanes(mode_block_.back());
  coarse.self = numbers(square.back());
  for_each(count, [&](int a) {
    std::copy(modes[a].begin(), modes[a].end(), modes_.data() + mode_block_[a]);
    std::vector<double>().swap(modes[a]);
    const int m = mode_[a + 1] - mode_[a];
    double* block = coarse.self.data() + square[a];
    std::fill(block, block + static_cast<size_t>(m) * m, 0.0);
    for (int q = 0; q < m; ++q) block[m * q + q] = eigenvalues[a][q];
  });
  return coarse;
}

void Level::project_links(const LinkSource& links, Coarse& coarse) const {
  // Modes in unscaled unknowns of this level: V^T L^-1.
  std::vector<size_t> part(aggregate_.size() + 1, 0);  // (node, then ghost, and one more): first number of its part
  for (size_t v = 0; v < aggregate_.size(); ++v)
    part[v + 1] = part[v] + static_cast<size_t>(mode_[aggregate_[v] + 1] - mode_[aggregate_[v]]) * unknowns_of(v);
  const KernelView<double*> unscaled = numbers(part.back());
  for_each(aggregates(), [&](int a) {
    const int m = mode_[a + 1] - mode_[a];
    const double* modes = modes_.data() + mode_block_[a];
    std::fill(unscaled.data() + part[first_[a]], unscaled.data() + part[first_[a + 1]], 0.0);
    for (int v = first_[a]; v < first_[a + 1]; ++v) {
      const int n = unknowns_of(v);
      const size_t at = static_cast<size_t>(m) * (unknown_[v] - unknown_[first_[a]]);
      dense::add_product(m, n, n, modes + at, m, inverse_.data() + square_[v], 1, n, unscaled.data() + part[v], m);
    }
  });
  halo_.exchange(unscaled.data(), part);
  coarse.ends = coarse_ends_;
  coarse.block.assign(coarse_ends_.size() + 1, 0);
  for (size_t l = 0; l < coarse_ends_.size(); ++l) {
    const size_t m = mode_[coarse_ends_[l][0] + 1] - mode_[coarse_ends_[l][0]];
    const size_t n = mode_[coarse_ends_[l][1] + 1] - mode_[coarse_ends_[l][1]];
    coarse.block[l + 1] = coarse.block[l] + triangle(m) + m * n + triangle(n);
  }
  coarse.links = numbers(coarse.block.back());
  for_each(static_cast<int>(coarse_ends_.size()), [&](int l) {
    const int a = coarse_ends_[l][0], b = coarse_ends_[l][1];
    const int m = mode_[a + 1] - mode_[a], n = mode_[b + 1] - mode_[b];
    double* triangles = coarse.links.data() + coarse.block[l];
    double* coupling = triangles + triangle(m);
    std::fill_n(coupling, static_cast<size_t>(m) * n, 0.0);
    std::vector<double> room, product, first(static_cast<size_t>(m) * m, 0.0), second(static_cast<size_t>(n) * n, 0.0);
    for (int k = crossing_start_[l]; k < crossing_start_[l + 1]; ++k) {
      const int fine = crossing_[k] / 2;
      const int end = crossing_[k] % 2, va = ends_[fine][end], vb = ends_[fine][1 - end];
      const int na = unknowns_of(va), nb = unknowns_of(vb);
      room.resize(multilevel::room_of_link(na, nb));
      const LinkBlocks link = links(fine, room.data()).seen_from(end);
      const double *wa = unscaled.data() + part[va], *wb = unscaled.data() + part[vb];
      product.assign(static_cast<size_t>(m) * na, 0.0);
      dense::add_product(m, na, na, wa, m, link.first, 1, link.first_stride, product.data(), m);
      dense::add_lower_product(m, na, product.data(), m, wa, m, 1, first.data());
      product.assign(static_cast<size_t>(m) * nb, 0.0);
      dense::add_product(m, na, nb, wa, m, link.coupling, link.coupling_row, link.coupling_column, product.data(), m);
      dense::add_product(m, nb, n, product.data(), m, wb, n, 1, coupling, m);
      product.assign(static_cast<size_t>(n) * nb, 0.0);
      dense::add_product(n, nb, nb, wb, n, link.second, 1, link.second_stride, product.data(), n);
      dense::add_lower_product(n, nb, product.data(), n, wb, n, 1, second.data());
    }
    pack_triangle(m, first.data(), triangles);
    pack_triangle(n, second.data(), coupling + static_cast<size_t>(m) * n);
  });
}

LinkSource Level::Coarse::source() const {
  return [this](int link, double* room) {
    const int m = unknown[ends[link][0] + 1] - unknown[ends[link][0]];
    const int n = unknown[ends[link][1] + 1] - unknown[ends[link][1]];
    const double* first = links.data() + block[link];
    const double* coupling = first + triangle(m);
    double* second = room + static_cast<size_t>(m) * m;
    unpack_triangle(m, first, room);
    unpack_triangle(n, coupling + static_cast<size_t>(m) * n, second);
    return LinkBlocks{room, coupling, second, m, n, 1, m};
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
    double own[kMostModes + kLanes];
    std::fill(std::copy_n(from + mode_[a], m, own), own + m + kLanes, 0.0);
    dense::multiply_both_ways<false>(m, n, modes + mode_block_[a], own, to + at);
  });
}

}  // namespace mixbeam
