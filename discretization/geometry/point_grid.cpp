#include "discretization/geometry/point_grid.hpp"

#include "discretization/geometry/vector_algebra.hpp"

#include <cmath>

namespace mixbeam {

using namespace vector_algebra;

PointGrid::Cell PointGrid::cell_of(const Vector3& position) const {
  Cell cell{};
  for (std::size_t i = 0; i < 3; ++i) cell[i] = static_cast<std::int64_t>(std::floor((position[i] - low_[i]) / cell_));
  return cell;
}

/// Cells with equal keys are told apart by the distances of their points.
std::uint64_t PointGrid::key(const Cell& cell) {
  std::uint64_t mixed = 0;
  for (const std::int64_t index : cell) {
    mixed ^= static_cast<std::uint64_t>(index) + 0x9e3779b97f4a7c15U + (mixed << 6U) + (mixed >> 2U);
    mixed *= 0xff51afd7ed558ccdU;
    mixed ^= mixed >> 33U;
  }
  return mixed;
}

bool PointGrid::coincide(std::size_t point, const Vector3& position) const {
  return norm(difference(positions_[point], position)) <= tolerance_;
}

void PointGrid::insert(const Vector3& position) {
  points_in_.emplace(key(cell_of(position)), positions_.size());
  positions_.push_back(position);
}

std::optional<std::size_t> PointGrid::find(const Vector3& position, std::size_t end, std::size_t preferred) const {
  if (preferred < end && coincide(preferred, position)) return preferred;
  const Vector3 reach = {tolerance_, tolerance_, tolerance_};
  const Cell first = cell_of(difference(position, reach)), last = cell_of(sum(position, reach));
  std::optional<std::size_t> found;
  Cell cell{};
  for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0])
    for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
      for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2]) {
        const auto [begin, past] = points_in_.equal_range(key(cell));
        for (auto entry = begin; entry != past; ++entry) {
          const std::size_t point = entry->second;
          if (point < end && (!found || point < *found) && coincide(point, position)) found = point;
        }
      }
  return found;
}

}  // namespace mixbeam
