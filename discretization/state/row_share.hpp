/// Tables whose rows lie on several ranks.
#pragma once

#include <cstddef>
#include <vector>

namespace mixbeam {

/// Consecutive rows of a table.
struct RowRun {
  std::size_t first = 0, count = 0;
};

/// Which rows of a table a rank holds. The ranks of a run together hold every row, and each of them once.
struct RowShare {
  std::size_t rows = 0;        ///< of the whole table
  std::vector<RowRun> runs{};  ///< held here, ascending; neighbours are joined

  std::size_t held() const {
    std::size_t sum = 0;
    for (const RowRun& run : runs) sum += run.count;
    return sum;
  }

  /// Adds rows behind those that are held already.
  void hold(std::size_t first, std::size_t count) {
    if (count == 0) return;
    if (!runs.empty() && runs.back().first + runs.back().count == first)
      runs.back().count += count;
    else
      runs.push_back({first, count});
  }
};

/// Every row on one rank.
inline RowShare all_rows(std::size_t rows) {
  RowShare share{rows};
  share.hold(0, rows);
  return share;
}

/// As many rows for each rank, but for rounding: for tables that every rank knows.
inline RowShare even_share(std::size_t rows, int rank, int ranks) {
  const auto bound = [&](int r) { return rows / ranks * r + rows % ranks * r / ranks; };
  RowShare share{rows};
  share.hold(bound(rank), bound(rank + 1) - bound(rank));
  return share;
}

}  // namespace mixbeam
