#include "nonlinear/multilevel/level.hpp"

#include "nonlinear/multilevel/dense.hpp"

#include <atomic>

namespace mixbeam {

namespace {

using multilevel::for_each, multilevel::numbers;
using LevelRange = Kokkos::RangePolicy<ExecutionSpace>;

constexpr int kFine = 6;          ///< unknowns of a node of the finest level
constexpr double kLargest = 2.0;  ///< eigenvalue of A^: a link, being positive, is at most twice its own diagonal
constexpr double kRatio = 20.0;   ///< of the largest to the least eigenvalue that the smoother damps
constexpr int kDegree = 3;        ///< of the smoother

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
  row_.assign(nodes_ + 1, 0);
  const auto for_each_end = [this](const auto& action) {
    for (size_t l = 0; l < ends_.size(); ++l)
      for (int end = 0; end < 2; ++end)
        if (ends_[l][end] < nodes_) action(static_cast<int>(l), end);
  };
  for_each_end([this](int l, int end) { ++row_[ends_[l][end] + 1]; });
  std::partial_sum(row_.begin(), row_.end(), row_.begin());
  slot_.resize(row_.back());
  std::vector<int> next(row_.begin(), row_.end() - 1);
  for_each_end([&](int l, int end) { slot_[next[ends_[l][end]]++] = {l, end, ends_[l][1 - end]}; });
}

/// Aggregates of all nodes: own ones, and behind them those that ghosts belong to.
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

/// Blocks lie in the order in which rows meet them first, summands of a row behind each other, and behind all of them
/// what is computed for rows of other ranks and not used. How many numbers blocks have.
size_t Level::number_blocks() {
  std::vector<int> slot_of_link(ends_.size());  // that of its earlier node
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

/// Factors of the blocks on the diagonal, and the others in scaled unknowns.
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

/// Each block is read once, for both nodes: first what rows sum up themselves and what later nodes owe them, then the
/// sums over both, in the order of the nodes.
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

void Level::add(const LevelVector& step, const LevelVector& x) const {
  double* to = x.data();
  const double* from = step.data();
  for_each(unknowns(), [=](int i) { to[i] += from[i]; });
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
        const bool is_stored = slot_[*s][2] > v;  // else its transpose
        for (int j = 0; j < n; ++j)
          add(first + j,
              value_(block_[*s] + (is_stored ? static_cast<size_t>(m) * j + i : static_cast<size_t>(n) * i + j)));
      }
      matrix.row_start.push_back(static_cast<int>(matrix.column.size()));
    }
  }
  return matrix;
}

SharedRows Level::shares() const {
  SharedRows share;
  share.communicator = halo_.communicator();
  share.rows = GatherPlan(share.communicator, unknowns());
  share.first = halo_.first_of(unknowns());
  share.column_number.resize(room());
  std::iota(share.column_number.begin(), share.column_number.end(), share.first);
  halo_.exchange(share.column_number.data(), unknown_);
  return share;
}

}  // namespace mixbeam
