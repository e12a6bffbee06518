/// Lists of things at each vertex (row of a matrix, node of a graph), all in one array.
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace mixbeam {

template <class Entry>
struct RowLists {
  std::vector<int> start{};      ///< entries of row r: [start[r], start[r + 1])
  std::vector<Entry> entries{};  ///< of each row in the order in which they were added
};

/// for_each(add) calls add(row, entry) for every entry, each time it is called: once to count them and once to place
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

}  // namespace mixbeam
