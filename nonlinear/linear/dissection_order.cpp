#include "nonlinear/linear/dissection_order.hpp"

#include <metis.h>

#include <algorithm>

namespace mixbeam {

namespace {

/// Below this many groups of rows minimum degree is as good as nested dissection, and METIS costs more than it saves.
constexpr int kLeastGroups = 50;

/// Rows with the same columns: those of one junction, as a rule. A graph of such groups is ordered in a few per cent of
/// the time that the matrix would take.
struct RowGroups {
  std::vector<int> group;          ///< (row)
  std::vector<idx_t> start, next;  ///< neighbours of each group, itself not among them
  explicit RowGroups(const SparseMatrix& a);
  int count() const { return static_cast<int>(start.size()) - 1; }
};

RowGroups::RowGroups(const SparseMatrix& a) : group(a.rows()), start{0} {
  std::vector<int> first;
  const auto begin_of = [&a](int i) { return a.column.begin() + a.row_start[i]; };
  for (int i = 0; i < a.rows(); ++i) {
    const bool joins = i > 0 && std::equal(begin_of(i), begin_of(i + 1), begin_of(i - 1), begin_of(i)) &&
                       std::find(begin_of(i), begin_of(i + 1), i - 1) != begin_of(i + 1);
    if (!joins) first.push_back(i);
    group[i] = static_cast<int>(first.size()) - 1;
  }
  // the graph of a and its transpose
  std::vector<std::vector<int>> neighbours(first.size());
  for (size_t g = 0; g < first.size(); ++g)
    for (auto column = begin_of(first[g]); column != begin_of(first[g] + 1); ++column)
      if (const int other = group[*column]; other != static_cast<int>(g)) {
        neighbours[g].push_back(other);
        neighbours[other].push_back(static_cast<int>(g));
      }
  for (std::vector<int>& of_group : neighbours) {
    std::sort(of_group.begin(), of_group.end());
    of_group.erase(std::unique(of_group.begin(), of_group.end()), of_group.end());
    next.insert(next.end(), of_group.begin(), of_group.end());
    start.push_back(static_cast<idx_t>(next.size()));
  }
}

}  // namespace

std::vector<int> dissection_order(const SparseMatrix& a) {
  RowGroups groups(a);
  if (groups.count() < kLeastGroups || groups.next.empty()) return {};
  idx_t count = groups.count();
  std::vector<idx_t> weight(count, 0), order(count), place(count);
  for (int g : groups.group) ++weight[g];
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  if (METIS_NodeND(&count, groups.start.data(), groups.next.data(), weight.data(), options, order.data(),
                   place.data()) != METIS_OK)
    return {};
  std::vector<int> first(count), result(a.rows());
  for (idx_t k = 0, rows = 1; k < count; rows += weight[order[k++]]) first[order[k]] = rows;
  for (int i = 0; i < a.rows(); ++i) result[i] = first[groups.group[i]]++;
  return result;
}

}  // namespace mixbeam
