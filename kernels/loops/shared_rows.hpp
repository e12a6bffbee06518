/// Rows of numbers that often repeat in neighbours, such as the elements of a straight member: stored once.
#pragma once

#include "kernels/execution/execution_space.hpp"

#include <Kokkos_Core.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

class SharedRows {
 public:
  using Rows = Kokkos::View<double**, Kokkos::LayoutRight, ExecutionSpace::memory_space>;
  using Places = Kokkos::View<int*, Kokkos::LayoutRight, ExecutionSpace::memory_space>;

  /// `place` (row): its index in `kept`; empty if each row is stored separately.
  SharedRows(Rows kept = {}, Places place = {}) : kept_(std::move(kept)), place_(std::move(place)) {}

  KOKKOS_FORCEINLINE_FUNCTION double& operator()(int row, int i) const {
    return kept_(place_.extent(0) > 0 ? place_(row) : row, i);
  }
  /// Rows in the half-open range [first, second).
  SharedRows part(const std::pair<int, int>& rows) const {
    if (place_.extent(0) > 0) return {kept_, Kokkos::subview(place_, rows)};
    return Rows(Kokkos::subview(kept_, rows, Kokkos::ALL));
  }
  std::size_t kept() const { return kept_.extent(0); }

 private:
  Rows kept_;
  Places place_;
};

/// Collects rows one after the other; a row equal to the previous one is not stored again.
class RowsWithoutRepeats {
 public:
  explicit RowsWithoutRepeats(std::size_t width) : width_(width) {}

  void add(const std::vector<double>& row) {
    if (place_.empty() || !std::equal(row.begin(), row.end(), numbers_.end() - static_cast<std::ptrdiff_t>(width_)))
      numbers_.insert(numbers_.end(), row.begin(), row.end());
    place_.push_back(static_cast<int>(numbers_.size() / width_) - 1);
  }
  SharedRows rows(const std::string& label) const {
    const std::size_t kept = numbers_.size() / width_;
    const SharedRows::Rows rows(label, kept, width_);
    std::copy(numbers_.begin(), numbers_.end(), rows.data());
    if (kept == place_.size()) return rows;
    const SharedRows::Places places(label + "_place", place_.size());
    std::copy(place_.begin(), place_.end(), places.data());
    return {rows, places};
  }

 private:
  std::size_t width_;
  std::vector<double> numbers_;
  std::vector<int> place_;
};

}  // namespace mixbeam
