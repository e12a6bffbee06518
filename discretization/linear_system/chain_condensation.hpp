/// Members are chains: every vertex that joins just two elements and carries nothing of its own is eliminated inside
/// the kernels (kernels/chains/level.hpp, theory (45)), level by level, until one link remains of each chain. What
/// sparse solvers see is the graph of junctions, supports and loaded vertices.
#pragma once

#include "kernels/chains/level.hpp"

#include <array>
#include <vector>

namespace mixbeam {

/// A matrix over two local vertices that is left after the elimination: an element, or a run of them.
struct RemainingLink {
  int link = 0;           ///< see LinkMatrices
  int first_element = 0;  ///< lowest local element in it: the order of sums
  std::array<int, 2> vertex{};
};

/// Which vertices are eliminated, and in what order.
class ChainStructure {
 public:
  /// `ends`: local vertices of each local element; `kept`: (local vertex) not to be eliminated.
  ChainStructure(const std::vector<std::array<int, 2>>& ends, std::vector<unsigned char> kept);

  int elements() const { return elements_; }
  /// Condensed runs of all levels; links are the elements, then the runs.
  int runs() const { return runs_; }
  /// (local vertex): 1 where it is eliminated.
  const std::vector<unsigned char>& eliminated() const { return eliminated_; }
  int eliminated_vertices() const { return eliminated_vertices_; }
  const std::vector<RemainingLink>& remaining() const { return remaining_; }
  const std::vector<ChainLevel>& levels() const { return levels_; }

 private:
  struct Chain {
    std::vector<int> links;     ///< 2 * link + 1 where it is passed from its second end
    std::vector<int> vertices;  ///< one more than links
  };
  struct Run {
    int chain = 0, begin = 0, end = 0;  ///< links of that chain
    int length() const { return end - begin; }
  };

  std::vector<Chain> trace(const std::vector<std::array<int, 2>>& ends, std::vector<unsigned char>& kept) const;
  void add_level(std::vector<Chain>& chains);
  ChainLevel pack(const std::vector<Chain>& chains, const std::vector<Run>& runs, int first_run) const;

  int elements_ = 0, runs_ = 0, eliminated_vertices_ = 0;
  std::vector<unsigned char> eliminated_;
  std::vector<RemainingLink> remaining_;
  std::vector<ChainLevel> levels_;
};

/// The numbers of an elimination with N unknowns for each vertex.
template <int N>
class ChainCondensation {
 public:
  using ElementMatrices = KernelView<const double**>;  ///< LinkMatrices::elements

  /// The structure must outlive this.
  explicit ChainCondensation(const ChainStructure& structure);

  LinkMatrices<N> matrices(const ElementMatrices& element_tangents) const { return {element_tangents, run_matrices_}; }
  /// (run, 2 N): what condense_rows() adds to the rows of the end vertices of each run; run = link - elements.
  const KernelView<double* [2 * N]>& arrived() const { return arrived_; }

  struct Pivots {
    long negative = 0;      ///< below zero
    double smallest = 1.0;  ///< least |pivot| / |its diagonal entry|; not a number or zero: singular
  };
  /// Eliminates; the elements' tangents must be symmetric wherever a vertex is eliminated.
  Pivots factorize(const ElementMatrices& element_tangents);
  /// First half of a solve: eliminated rows of `rows` (N * local vertex + component) leave x half done.
  void condense_rows(const KernelView<const double*>& rows, const KernelView<double*>& x);
  /// Second half: eliminated entries of x from the others.
  void expand(const KernelView<double*>& x) const;

 private:
  const ChainStructure& structure_;
  std::vector<ChainFactors> factors_;  ///< (level)
  KernelView<double * [4 * N * N]> run_matrices_;
  KernelView<double * [2 * N]> arrived_;
  ChainPivots pivots_;
};

}  // namespace mixbeam
