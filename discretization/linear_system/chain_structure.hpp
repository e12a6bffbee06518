/// Members are chains: every vertex that joins exactly two elements and adds nothing of its own to the tangent is
/// eliminated inside the kernels (kernels/chains/level.hpp, theory (45)), level by level, until one link of each chain
/// remains. Sparse solvers only see the graph of junctions, supports and vertices with moments or follower loads.
#pragma once

#include "kernels/chains/level.hpp"

#include <array>
#include <vector>

namespace mixbeam {

/// Matrix over two local vertices that remains after the elimination: an element, or a run of them.
struct RemainingLink {
  int link = 0;           ///< see LinkMatrices
  int first_element = 0;  ///< lowest local element in it: determines the order of sums
  std::array<int, 2> vertex{};
};

/// Vertices to be eliminated, and their order.
class ChainStructure {
 public:
  /// `ends`: local vertices of each local element; `kept`: (local vertex) not to be eliminated.
  ChainStructure(const std::vector<std::array<int, 2>>& ends, std::vector<unsigned char> kept);

  const ChainLevels& levels() const { return levels_; }
  /// (local vertex): 1 if eliminated.
  const std::vector<unsigned char>& eliminated() const { return eliminated_; }
  int eliminated_vertices() const { return eliminated_vertices_; }
  const std::vector<RemainingLink>& remaining() const { return remaining_; }

 private:
  struct Chain {
    std::vector<int> links;     ///< 2 * link + 1 if traversed from its second end, else 2 * link
    std::vector<int> vertices;  ///< one more than links
  };
  struct Run {
    int chain = 0, begin = 0, end = 0;  ///< links of that chain
    int length() const { return end - begin; }
  };

  std::vector<Chain> trace(const std::vector<std::array<int, 2>>& ends, std::vector<unsigned char>& kept) const;
  void add_level(std::vector<Chain>& chains);
  ChainLevel pack(const std::vector<Chain>& chains, const std::vector<Run>& runs, int first_run) const;

  int eliminated_vertices_ = 0;
  std::vector<unsigned char> eliminated_;
  std::vector<RemainingLink> remaining_;
  ChainLevels levels_;
};

}  // namespace mixbeam
