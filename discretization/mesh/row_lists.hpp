/// Lists of entries per vertex (row of a matrix, node of a graph), all in one array; neighbours in a graph.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace mixbeam {

template <class Entry>
struct RowLists {
  std::vector<int> start{};      ///< entries of row r: [start[r], start[r + 1])
  std::vector<Entry> entries{};  ///< those of each row in the order of insertion
};

/// Builds the lists. for_each(add) calls add(row, entry) for every entry; it is called twice, to count and to place
/// them.
template <class Entry, class ForEach>
RowLists<Entry> row_lists(int rows, const ForEach& for_each) {
  RowLists<Entry> lists{std::vector<int>(static_cast<std::size_t>(rows) + 1, 0)};
  for_each([&](int row, const Entry&) { ++lists.start[row + 1]; });
  std::partial_sum(lists.start.begin(), lists.start.end(), lists.start.begin());
  lists.entries.resize(lists.start.back());
  std::vector<int> next(lists.start.begin(), lists.start.end() - 1);
  for_each([&](int row, const Entry& entry) { lists.entries[next[row]++] = entry; });
  return lists;
}

/// Neighbours of each node, ascending, and weights of the links to them.
template <class Weight>
struct Graph {
  std::vector<int> start{0}, neighbour{};  ///< of node v: [start[v], start[v + 1])
  std::vector<Weight> weight{};
  int nodes() const { return static_cast<int>(start.size()) - 1; }
};

/// Merges all links between two nodes into one with the sum of their weights; self-links are dropped. for_each(add)
/// calls add(node, {neighbour, weight}) for each end of every link, as in row_lists().
template <class Weight, class ForEach>
Graph<Weight> joined_links(int nodes, const ForEach& for_each) {
  RowLists<std::pair<int, Weight>> links = row_lists<std::pair<int, Weight>>(nodes, for_each);
  Graph<Weight> graph;
  for (int v = 0; v < nodes; ++v) {
    const auto begin = links.entries.begin() + links.start[v], end = links.entries.begin() + links.start[v + 1];
    std::sort(begin, end);
    for (auto link = begin; link != end; ++link) {
      if (link->first == v) continue;
      if (static_cast<int>(graph.neighbour.size()) > graph.start.back() && graph.neighbour.back() == link->first) {
        graph.weight.back() += link->second;
        continue;
      }
      graph.neighbour.push_back(link->first);
      graph.weight.push_back(link->second);
    }
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

}  // namespace mixbeam
