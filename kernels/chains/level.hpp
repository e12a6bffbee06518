/// Chains of links condensed to their two end vertices by theory (45), many side by side: a direct solver for elements
/// in a row. A link is an element or, on the next level, a whole run of links condensed to one. Only the structure
/// determines where runs are cut, so results do not depend on the number of threads.
#pragma once

#include "kernels/execution/pack.hpp"
#include "kernels/loops/block.hpp"

#include <vector>

namespace mixbeam {

/// Matrices of links: elements first, then condensed runs.
template <int N>
struct LinkMatrices {
  static constexpr int kFull = TangentLayout<N>::kFull;  ///< ends as they are stored
  KernelView<const double**> elements;                   ///< (element, kFull or kSymmetric of TangentLayout)
  KernelView<double* [kFull]> runs;                      ///< (run, kFull)

  KOKKOS_INLINE_FUNCTION bool is_element(int link) const { return link < static_cast<int>(elements.extent(0)); }
  KOKKOS_INLINE_FUNCTION bool keeps_symmetric_elements() const { return elements.extent(1) != kFull; }
  /// Full matrix of a link; expanded into `room` (kFull) if it is not stored.
  KOKKOS_INLINE_FUNCTION const double* full(int link, double* room) const {
    if (!is_element(link)) return &runs(link - static_cast<int>(elements.extent(0)), 0);
    if (!keeps_symmetric_elements()) return &elements(link, 0);
    expand_symmetric_tangent<N>(&elements(link, 0), room);
    return room;
  }
};

/// Kind of link matrices at the start of an elimination.
enum class ChainKind {
  free,            ///< symmetric, displacements enter as differences between the ends: kSymmetric of TangentLayout
  symmetric,       ///< symmetric: only lower triangles are read
  symmetric_part,  ///< (K + K^T) / 2
  general,         ///< L U; links in space only
};

/// Numbers stored per eliminated vertex: FreeVertexFactors, VertexFactors or, without symmetry, GeneralVertexFactors of
/// chains/elimination.hpp.
constexpr int free_factor_size(int n) { return n * (n + 1) / 2 + n * (n == kSpatialDofs ? 3 : 1); }
constexpr int vertex_factor_size(int n) { return n * (n + 1) / 2 + 2 * n * n; }
constexpr int general_factor_size(int n) { return 5 * n * n; }

/// Runs of links that are condensed concurrently. kLanes runs make a pack; step s of a pack takes link s of each of its
/// runs. Lanes whose run has ended, or without a run, are idle.
struct ChainLevel {
  int packs = 0;
  KernelView<int*> step_start;             ///< (pack + 1): first step of each pack
  KernelView<int* [kLanes]> link;          ///< (step, lane): 2 * link + 1 where passed from its second end, -1: none
  KernelView<int* [kLanes]> vertex;        ///< (step, lane): local vertex at the far end of the link
  KernelView<int* [kLanes]> first_vertex;  ///< (pack, lane): start of the run
  KernelView<int* [kLanes]> run;           ///< (pack, lane): number of the run, -1: none
  KernelView<int* [kLanes]> links;         ///< (pack, lane): number of links of the run

  int eliminations() const { return static_cast<int>(link.extent(0)) - packs; }
};

/// Complete elimination. Links are the elements, then the runs of all levels.
struct ChainLevels {
  int elements = 0, runs = 0;
  std::vector<ChainLevel> levels;
};

/// Factors of all lanes, for all but the first step of each pack, one after the other: step - pack - 1.
using ChainFactors = KernelView<double*>;
/// (run of all levels): number of negative pivots, those of theory (47), only the sign of the determinant without
/// symmetry; least |pivot| / |diagonal entry of its vertex block|, NaN if a pivot is zero.
using ChainPivots = KernelView<double* [2]>;

/// Right-hand side `rows` (N * vertex + component). At eliminated vertices x, which may be `rows`, becomes V^-1 of the
/// rows summed there; `arrived` (run, 2 N) is the share that each run adds to the rows of its end vertices.
template <int N>
struct ChainRows {
  KernelView<const double*> rows;
  KernelView<double*> x;
  KernelView<double * [2 * N]> arrived;
};

/// Eliminates the vertices inside all runs; writes LinkMatrices::runs, factors and pivots. Condenses `first`, if it has
/// rows, in the same pass: factors and tangents are then read only once.
template <int N>
void condense_runs(ChainKind kind, const ChainLevel& level, const LinkMatrices<N>& matrices,
                   const ChainFactors& factors, const ChainPivots& pivots, const ChainRows<N>& first);

/// Condenses another right-hand side with these factors.
template <int N>
void condense_rows(ChainKind kind, const ChainLevel& level, const LinkMatrices<N>& matrices,
                   const ChainFactors& factors, const ChainRows<N>& rows);

/// Computes eliminated vertices from the solution at the ends of the runs, after condense_rows.
template <int N>
void expand_runs(ChainKind kind, const ChainLevel& level, const LinkMatrices<N>& matrices, const ChainFactors& factors,
                 const KernelView<double*>& x);

/// Storage and operations of an elimination with N unknowns per vertex.
template <int N>
class ChainCondensation {
 public:
  using ElementMatrices = KernelView<const double**>;  ///< LinkMatrices::elements

  /// `chains` must outlive this. `has_general`: reserve memory for ChainKind::general.
  explicit ChainCondensation(const ChainLevels& chains, bool has_general = false)
      : chains_(chains),
        factor_size_((has_general ? general_factor_size(N) : vertex_factor_size(N)) * kLanes),
        run_matrices_(Kokkos::view_alloc("mixbeam::chains::matrices", Kokkos::WithoutInitializing), chains.runs),
        arrived_(Kokkos::view_alloc("mixbeam::chains::arrived", Kokkos::WithoutInitializing), chains.runs),
        pivots_("mixbeam::chains::pivots", chains.runs) {}

  LinkMatrices<N> matrices(const ElementMatrices& element_tangents) const { return {element_tangents, run_matrices_}; }
  /// (run, 2 N): share that condense_rows() adds to the rows of the end vertices of each run; run = link - elements.
  const KernelView<double* [2 * N]>& arrived() const { return arrived_; }

  struct Pivots {
    long negative = 0;      ///< number below zero
    double smallest = 1.0;  ///< least |pivot| / |its diagonal entry|; NaN or zero: singular
  };
  /// Factorizes; later calls refer to these factors and need the matrices unchanged. With `rows` it also does
  /// condense_rows(rows, x).
  Pivots factorize(const ElementMatrices& element_tangents, ChainKind kind = ChainKind::symmetric,
                   const KernelView<const double*>& rows = {}, const KernelView<double*>& x = {}) {
    // not initialised: the first thread to write a page gets it, and what free links do not need takes no memory
    for (size_t l = factors_.size(); l < chains_.levels.size(); ++l)
      factors_.emplace_back(Kokkos::view_alloc("mixbeam::chains::factors", Kokkos::WithoutInitializing),
                            static_cast<size_t>(chains_.levels[l].eliminations()) * factor_size_);
    all_ = matrices(element_tangents);
    kind_ = kind == ChainKind::symmetric && all_.keeps_symmetric_elements() ? ChainKind::free : kind;
    for (size_t l = 0; l < factors_.size(); ++l)
      condense_runs<N>(kind_, chains_.levels[l], all_, factors_[l], pivots_, {rows, x, arrived_});
    Pivots result;
    for (int run = 0; run < chains_.runs; ++run) {
      result.negative += static_cast<long>(pivots_(run, 0));
      const double smallest = pivots_(run, 1);
      if (smallest < result.smallest || smallest != smallest) result.smallest = smallest;  // NaN stays
    }
    return result;
  }
  /// Frees the factors until the next factorize(), and drops the tangents of the elements.
  void release() {
    factors_.clear();
    all_ = {};
  }
  /// First half of a solve: eliminates `rows` (N * local vertex + component) inside runs into x, which may be `rows`.
  void condense_rows(const KernelView<const double*>& rows, const KernelView<double*>& x) {
    for (size_t l = 0; l < factors_.size(); ++l)
      mixbeam::condense_rows<N>(kind_, chains_.levels[l], all_, factors_[l], {rows, x, arrived_});
  }
  /// Second half: computes the eliminated entries of x from the others.
  void expand(const KernelView<double*>& x) const {
    for (size_t l = factors_.size(); l-- > 0;) expand_runs<N>(kind_, chains_.levels[l], all_, factors_[l], x);
  }

 private:
  const ChainLevels& chains_;
  size_t factor_size_;  ///< of all lanes
  ChainKind kind_ = ChainKind::symmetric;
  LinkMatrices<N> all_;
  std::vector<ChainFactors> factors_;  ///< (level)
  KernelView<double * [4 * N * N]> run_matrices_;
  KernelView<double * [2 * N]> arrived_;
  ChainPivots pivots_;
};

}  // namespace mixbeam
