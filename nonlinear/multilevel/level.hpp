/// One level of a multilevel preconditioner for networks, theory (62): a symmetric positive definite block matrix
///
///   A = S + sum of links,   A^ = L^-1 A L^-T,   L L^T = blocks of A on the diagonal,
///
/// stored for scaled unknowns x^ = L^T x, in which diagonal blocks are identities and all eigenvalues lie between 0 and
/// 2. S holds one block for each node, a link is a matrix over two nodes. Each row is summed in fixed order by one
/// thread, and sums over all rows in fixed pieces: results do not depend on the number of threads. On several ranks
/// each has the rows of its own nodes, aggregates of those, and all links that touch one of them.
#pragma once

#include "kernels/execution/pack.hpp"
#include "kernels/loops/block.hpp"
#include "nonlinear/linear/inertia_solver.hpp"
#include "nonlinear/multilevel/halo.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace mixbeam {

/// (link): its two nodes.
using LinkEnds = std::vector<std::array<int, 2>>;

/// Thrown if a block or a search direction shows that the matrix has a negative eigenvalue.
class NegativeCurvature : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Blocks of a link, column-major with column strides; the coupling has a row stride too.
struct LinkBlocks {
  const double *first, *coupling, *second;  ///< K00, K01 (rows of the first node), K11
  int first_stride, second_stride, coupling_row, coupling_column;

  /// Views the same link with its end 0 or 1 as the first node.
  LinkBlocks seen_from(int end) const {
    return end == 0 ? *this
                    : LinkBlocks{second, coupling, first, second_stride, first_stride, coupling_column, coupling_row};
  }
};
/// Returns the blocks of a link; `room` (as many numbers as a full link has) is scratch for blocks that are not stored.
using LinkSource = std::function<LinkBlocks(int link, double* room)>;

/// Scaled vectors of a level.
using LevelVector = KernelView<double*>;

namespace multilevel {

/// Allocates uninitialised numbers.
inline KernelView<double*> numbers(size_t count) {
  return KernelView<double*>(Kokkos::view_alloc("mixbeam::multilevel", Kokkos::WithoutInitializing), count);
}

/// Allocates numbers with zeros behind them, for kernels that read whole lanes.
inline KernelView<double*> numbers_for_lanes(size_t count) {
  const KernelView<double*> all = numbers(count + kLanes);
  std::fill_n(all.data() + count, kLanes, 0.0);
  return all;
}

/// Size of the scratch array that a source of links needs for nodes of m and n unknowns.
inline size_t room_of_link(int m, int n) { return 4 * static_cast<size_t>(std::max(m, n)) * std::max(m, n); }

/// Runs an action for each index, in parallel.
template <class Action>
void for_each(size_t count, const Action& action) {
  Kokkos::parallel_for(
      "mixbeam::multilevel", Kokkos::RangePolicy<ExecutionSpace>(0, count), KOKKOS_LAMBDA(int i) { action(i); });
}

/// Sums the first n products a_i b_i in pieces of fixed length: the same bits for any number of threads.
inline double dot(size_t n, const LevelVector& a, const LevelVector& b) {
  constexpr size_t kPiece = 4096;
  const size_t pieces = (n + kPiece - 1) / kPiece;
  std::vector<double> sums(pieces);
  double* to = sums.data();
  const double *x = a.data(), *y = b.data();
  Kokkos::parallel_for(
      "mixbeam::multilevel::dot", Kokkos::RangePolicy<ExecutionSpace>(0, pieces), KOKKOS_LAMBDA(size_t k) {
        double sum = 0.0;
        const size_t end = (k + 1) * kPiece < n ? (k + 1) * kPiece : n;
#pragma omp simd reduction(+ : sum)
        for (size_t i = k * kPiece; i < end; ++i) sum += x[i] * y[i];
        to[k] = sum;
      });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Adds a += s b.
inline void add(double s, const LevelVector& b, const LevelVector& a) {
  double* to = a.data();
  const double* from = b.data();
  for_each(a.extent(0), [=](int i) { to[i] += s * from[i]; });
}

}  // namespace multilevel

class Level {
 public:
  static constexpr int kMostModes = 4096;  ///< limit of unknowns of a node, since rows are summed on the stack

  /// Builds rows and coarse links. `first`: (aggregate, and one more) place of its first node; empty: no aggregates.
  /// `halo`: of the nodes. Collective.
  Level(int nodes, LinkEnds ends, std::vector<int> first, Halo halo);

  int nodes() const { return nodes_; }
  int unknowns() const { return unknown_[nodes_]; }
  /// Size of vectors: unknowns here and of ghosts.
  int room() const { return unknown_.back(); }
  const Halo& halo() const { return halo_; }
  int unknowns_of(int node) const { return unknown_[node + 1] - unknown_[node]; }
  int aggregates() const { return static_cast<int>(first_.size()) - 1; }
  const LinkEnds& ends() const { return ends_; }
  /// Links between aggregates, and their halo.
  const LinkEnds& coarse_ends() const { return coarse_ends_; }
  const Halo& coarse_halo() const { return coarse_halo_; }

  // Collective, except scale_rows(), unscale() and functions on the values of one rank.

  /// Sets new values. `unknown`: (node, then ghost, and one more) first unknown; `self`: S, column-major, one block
  /// after the other. Throws NegativeCurvature.
  void set(std::vector<int> unknown, const KernelView<double*>& self, const LinkSource& links);
  /// Converts off-diagonal blocks to single precision: on coarse levels an iteration reads them most, and only the
  /// preconditioner uses them.
  void round();
  /// Frees arrays that a cycle does not read: factors of nodes on coarse levels, on the coarsest its blocks too.
  void drop_scale() { inverse_ = {}; }
  void drop_values() { value_ = {}; }
  /// Data of the next level.
  struct Coarse {
    std::vector<int> unknown;
    std::vector<size_t> block;        ///< (link): its first number in `links`
    KernelView<double*> self, links;  ///< `links`: lower triangle of first block, coupling, lower triangle of second
    LinkSource source() const;
    LinkEnds ends;
  };
  /// Limit of the eigenvalues of modes: tau, raised by `raise` times the magnitude of the least eigenvalue of the
  /// aggregate, if negative: compressive prestress makes it so.
  struct ModeLimit {
    double tau, raise;
  };
  /// Finds the modes of each aggregate up to the limit: the nodes of the next level. Afterwards round() may be called.
  Coarse find_modes(const ModeLimit& limit, const KernelView<double*>& self, const LinkSource& links);
  /// Projects the links on the next level.
  void project_links(const LinkSource& links, Coarse& coarse) const;
  /// Scales the modes by the factors of the next level, so that they belong to its scaled unknowns.
  void set_coarse_scale(const Level& coarse);

  /// Copies the unknowns of ghosts from their owners.
  void complete(const LevelVector& x) const { halo_.exchange(x.data(), unknown_); }
  /// Computes y = A^ x.
  void apply(const LevelVector& x, const LevelVector& y) const;
  /// Adds x += p(A^) r with Chebyshev's polynomial of degree 3 for eigenvalues from 0.1 to 2. `residual` is that of x
  /// on entry, and on return that of x without the last change, `step`. `other`: scratch.
  void smooth(const LevelVector& residual, const LevelVector& x, const LevelVector& step, const LevelVector& other,
              bool starts_at_zero) const;
  /// Subtracts residual -= A^ x.
  void subtract_product(const LevelVector& x, const LevelVector& residual) const;
  void restrict_to(const LevelVector& fine, const LevelVector& coarse) const;
  void prolong(const LevelVector& coarse, const LevelVector& fine) const;

  /// Scales a right-hand side, L^-1 b; unscales a solution, L^-T x.
  void scale_rows(const KernelView<const double*>& b, const LevelVector& scaled) const;
  void unscale(const LevelVector& scaled, const KernelView<double*>& x) const;

  /// Inner product over all ranks.
  double dot(const LevelVector& a, const LevelVector& b) const { return halo_.sum(multilevel::dot(unknowns(), a, b)); }

  /// Rows of A^ here, for the direct solver of the coarsest level, and their distribution over ranks.
  SparseMatrix matrix() const;
  RowsOfRanks shares() const;

 private:
  void build_rows();
  void find_aggregates();
  size_t number_blocks();
  void build_coarse_links();
  void scale(const KernelView<double*>& self, const LinkSource& links);
  /// Blocks of the link in a slot; resizes `room` for `links`.
  LinkBlocks link_of(int node, int slot, const LinkSource& links, std::vector<double>& room) const;
  /// Adds the block of a link's first node to a diagonal block.
  void add_own(int node, const LinkBlocks& link, std::vector<double>& block) const;
  template <int Size, class Value, class Finish>
  void for_each_row(const Value* value, const LevelVector& x, const Finish& finish) const;
  template <class Finish>
  void multiply(const LevelVector& x, const Finish& finish) const;
  std::vector<double> modes_of(int aggregate, const ModeLimit& limit, const KernelView<double*>& self,
                               const LinkSource& links, std::vector<double>& eigenvalues) const;

  int nodes_;
  Halo halo_;
  LinkEnds ends_;
  std::vector<int> first_;      ///< (aggregate, and one more)
  std::vector<int> aggregate_;  ///< (node, then ghost); aggregates of other ranks are numbered after those here
  std::vector<int> unknown_;    ///< (node, then ghost, and one more): first unknown
  std::vector<size_t> square_;  ///< (node, then ghost, and one more): first number of its diagonal block
  // rows
  std::vector<int> row_;                  ///< (node, and one more): first slot
  std::vector<std::array<int, 3>> slot_;  ///< link, its end here, node at the other end
  std::vector<size_t> block_;             ///< (slot): first number of its block in value_
  std::vector<size_t> summand_;           ///< (slot of the earlier node): first summand of the later node's row from it
  std::vector<size_t> first_summand_;     ///< (node, and one more): first summand of its row
  KernelView<double*> summands_;
  KernelView<double*> value_;    ///< off-diagonal blocks of A^, each once: rows of the earlier node
  KernelView<float*> rounded_;   ///< value_ in single precision; one of the two is empty
  KernelView<double*> inverse_;  ///< L^-1 of the nodes
  // coarse links
  LinkEnds coarse_ends_;
  Halo coarse_halo_;
  std::vector<int> crossing_start_, crossing_;  ///< (coarse link, and one more); 2 * link, plus 1 if it is reversed
  // modes of aggregates, transposed: (mode, unknown of the aggregate), column-major
  std::vector<int> mode_;           ///< (aggregate, then ghost, and one more): first coarse unknown
  std::vector<size_t> mode_block_;  ///< (aggregate, and one more)
  KernelView<double*> modes_;
};

}  // namespace mixbeam
