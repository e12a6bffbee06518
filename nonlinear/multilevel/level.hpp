/// One level of a multilevel preconditioner for networks, theory (62): a symmetric positive definite block matrix
///
///   A = S + sum of links,   A^ = L^-1 A L^-T,   L L^T = blocks of A on the diagonal,
///
/// kept in scaled unknowns x^ = L^T x, in which the blocks on the diagonal are one and all eigenvalues lie between 0
/// and 2. S are blocks of nodes alone, a link is a matrix over two nodes. Each row is summed in one order by one
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

/// Two nodes for each link.
using LinkEnds = std::vector<std::array<int, 2>>;

/// A block or a direction was met that says that the matrix has an eigenvalue below zero.
class NegativeCurvature : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Blocks of a link, column-major with the distance between columns; of the coupling that between rows too.
struct LinkBlocks {
  const double *first, *coupling, *second;  ///< K00, K01 (rows of the first node), K11
  int first_stride, second_stride, coupling_row, coupling_column;

  /// Views the same link with that end of it, 0 or 1, as its first node.
  LinkBlocks seen_from(int end) const {
    return end == 0 ? *this
                    : LinkBlocks{second, coupling, first, second_stride, first_stride, coupling_column, coupling_row};
  }
};
/// Blocks of a link; `room` (as many numbers as a full link has) is for those that are not kept.
using LinkSource = std::function<LinkBlocks(int link, double* room)>;

/// Scaled vectors of a level.
using LevelVector = KernelView<double*>;

namespace multilevel {

/// Numbers without values yet.
inline KernelView<double*> numbers(size_t count) {
  return KernelView<double*>(Kokkos::view_alloc("mixbeam::multilevel", Kokkos::WithoutInitializing), count);
}

/// Allocates numbers with zeros behind them, for kernels that read in whole lanes.
inline KernelView<double*> numbers_for_lanes(size_t count) {
  const KernelView<double*> all = numbers(count + kLanes);
  std::fill_n(all.data() + count, kLanes, 0.0);
  return all;
}

/// Room that a source of links needs for one between nodes of so many unknowns.
inline size_t room_of_link(int m, int n) { return 4 * static_cast<size_t>(std::max(m, n)) * std::max(m, n); }

/// An action for each index, on threads.
template <class Action>
void for_each(size_t count, const Action& action) {
  Kokkos::parallel_for(
      "mixbeam::multilevel", Kokkos::RangePolicy<ExecutionSpace>(0, count), KOKKOS_LAMBDA(int i) { action(i); });
}

/// Sum of the first n products a_i b_i in pieces of fixed length: the same bits for any number of threads.
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

/// a += s b
inline void add(double s, const LevelVector& b, const LevelVector& a) {
  double* to = a.data();
  const double* from = b.data();
  for_each(a.extent(0), [=](int i) { to[i] += s * from[i]; });
}

}  // namespace multilevel

class Level {
 public:
  static constexpr int kMostModes = 4096;  ///< of a node: what set() takes; rows are summed up on the stack

  /// `first`: (aggregate, and one more) place of its first node; empty: no aggregates. `halo`: of the nodes.
  /// Collective.
  Level(int nodes, LinkEnds ends, std::vector<int> first, Halo halo);

  int nodes() const { return nodes_; }
  int unknowns() const { return unknown_[nodes_]; }
  /// With those of ghosts, for which vectors have room.
  int room() const { return unknown_.back(); }
  const Halo& halo() const { return halo_; }
  int unknowns_of(int node) const { return unknown_[node + 1] - unknown_[node]; }
  int aggregates() const { return static_cast<int>(first_.size()) - 1; }
  const LinkEnds& ends() const { return ends_; }
  /// Links between aggregates, and of those the halo.
  const LinkEnds& coarse_ends() const { return coarse_ends_; }
  const Halo& coarse_halo() const { return coarse_halo_; }

  // Collective, except scale_rows(), unscale() and the functions of one rank's numbers.

  /// New values. `unknown`: (node, ghosts too, and one more) first unknown; `self`: S, column-major, one block after
  /// the other. Throws NegativeCurvature.
  void set(std::vector<int> unknown, const KernelView<double*>& self, const LinkSource& links);
  /// Blocks off the diagonal from now on as single precision: of coarse levels they are the most that an iteration
  /// reads, and the preconditioner alone uses them.
  void round();
  /// Frees numbers that a cycle does not read: of coarse levels the factors of nodes, of the coarsest its blocks too.
  void drop_scale() { inverse_ = {}; }
  void drop_values() { value_ = {}; }
  /// Data that the next level is made of.
  struct Coarse {
    std::vector<int> unknown;
    std::vector<size_t> block;        ///< (link): of its first number in `links`
    KernelView<double*> self, links;  ///< of a link the lower triangles of its symmetric blocks, the coupling between
    LinkSource source() const;
    LinkEnds ends;
  };
  /// Eigenvalues of an aggregate up to tau, and higher by `raise` times the size of its least one below zero: prestress
  /// that softens makes it negative.
  struct ModeLimit {
    double tau, raise;
  };
  /// Modes of each aggregate up to the limit, and the next level's nodes from them. Afterwards round() may be called.
  Coarse find_modes(const ModeLimit& limit, const KernelView<double*>& self, const LinkSource& links);
  /// The next level's links.
  void project_links(const LinkSource& links, Coarse& coarse) const;
  /// The modes span what the next level's scaled unknowns stand for; its factors.
  void set_coarse_scale(const Level& coarse);

  /// Unknowns of ghosts from their owners.
  void complete(const LevelVector& x) const { halo_.exchange(x.data(), unknown_); }
  /// y = A^ x
  void apply(const LevelVector& x, const LevelVector& y) const;
  /// x += p(A^) r with Chebyshev's polynomial of degree 3 for eigenvalues from 0.1 to 2. `residual` belongs to x
  /// before, and afterwards to x without `step`, the last change. `other`: scratch.
  void smooth(const LevelVector& residual, const LevelVector& x, const LevelVector& step, const LevelVector& other,
              bool starts_at_zero) const;
  /// residual -= A^ x
  void subtract_product(const LevelVector& x, const LevelVector& residual) const;
  void restrict_to(const LevelVector& fine, const LevelVector& coarse) const;
  void prolong(const LevelVector& coarse, const LevelVector& fine) const;

  /// Unscaled to scaled right-hand side, L^-1 b; scaled to unscaled solution, L^-T x.
  void scale_rows(const KernelView<const double*>& b, const LevelVector& scaled) const;
  void unscale(const LevelVector& scaled, const KernelView<double*>& x) const;

  /// a . b
  double dot(const LevelVector& a, const LevelVector& b) const { return halo_.sum(multilevel::dot(unknowns(), a, b)); }

  /// Rows of A^ here, for the direct solver of the coarsest level; and how ranks share them.
  SparseMatrix matrix() const;
  RowsOfRanks shares() const;

 private:
  void build_rows();
  void find_aggregates();
  size_t number_blocks();
  void build_coarse_links();
  void scale(const KernelView<double*>& self, const LinkSource& links);
  /// Blocks of the link in a slot; `room` is made large enough for `links`.
  LinkBlocks link_of(int node, int slot, const LinkSource& links, std::vector<double>& room) const;
  /// A block on the diagonal += that of a link's first node.
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
  std::vector<int> aggregate_;  ///< (node, ghosts too); those of other ranks are numbered behind the own ones
  std::vector<int> unknown_;    ///< (node, ghosts too, and one more)
  std::vector<size_t> square_;  ///< (node, ghosts too, and one more): first number of its block
  // rows
  std::vector<int> row_;                  ///< (node, and one more): first slot
  std::vector<std::array<int, 3>> slot_;  ///< link, its end here, node at the other end
  std::vector<size_t> block_;             ///< (slot): first number of its block in value_
  std::vector<size_t> summand_;           ///< (slot of the earlier node): what the later one's row gets from it
  std::vector<size_t> first_summand_;     ///< (node, and one more): what its row sums up
  KernelView<double*> summands_;
  KernelView<double*> value_;    ///< blocks of A^ off the diagonal, each once: rows of the earlier node
  KernelView<float*> rounded_;   ///< the same; one of both is empty
  KernelView<double*> inverse_;  ///< L^-1 of the nodes
  // coarse links
  LinkEnds coarse_ends_;
  Halo coarse_halo_;
  std::vector<int> crossing_start_, crossing_;  ///< (coarse link, and one more); 2 * link + 1 where it is turned round
  // modes of aggregates, transposed: (mode, unknown of the aggregate), column-major
  std::vector<int> mode_;           ///< (aggregate, ghosts too, and one more): first coarse unknown
  std::vector<size_t> mode_block_;  ///< (aggregate, and one more)
  KernelView<double*> modes_;
};

}  // namespace mixbeam
