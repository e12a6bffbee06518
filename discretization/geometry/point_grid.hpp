/// Search for the points near a place, in constant time each.
#pragma once

#include "discretization/scene/scene.hpp"

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace mixbeam {

/// Numbers of points by the cell of a regular grid that contains them.
class PointGrid {
 public:
  /// Coordinates must differ by less than 1e17 cells.
  PointGrid(const std::vector<Point>& points, double cell) : cell_(cell), origin_(points.front().position) {
    for (const Point& point : points) insert(point.position);
  }

  /// Adds a point with the next number: 0, 1, 2, ...
  void insert(const Vector3& position) { points_in_[key(cell_of(position, 0.0))].push_back(count_++); }

  /// Calls visit(number) for every point within `reach` of `position` along each axis, and for some others, as
  /// different cells may share a key: visitors must compare positions.
  template <typename Visit>
  void around(const Vector3& position, double reach, const Visit& visit) const {
    const Cell first = cell_of(position, -reach), last = cell_of(position, reach);
    Cell cell{};
    for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0])
      for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
        for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2]) {
          const auto found = points_in_.find(key(cell));
          if (found == points_in_.end()) continue;
          for (const std::size_t point : found->second) visit(point);
        }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell_of(const Vector3& position, double shift) const {
    Cell cell{};
    for (std::size_t i = 0; i < 3; ++i)
      cell[i] = static_cast<std::int64_t>(std::floor((position[i] + shift - origin_[i]) / cell_));
    return cell;
  }
  static std::uint64_t key(const Cell& cell) {
    std::uint64_t hash = 0;
    for (const std::int64_t index : cell) {
      hash ^= static_cast<std::uint64_t>(index) + 0x9e3779b97f4a7c15U + (hash << 6U) + (hash >> 2U);
      hash *= 0xff51afd7ed558ccdU;
      hash ^= hash >> 33U;
    }
    return hash;
  }

  double cell_;
  Vector3 origin_;
  std::size_t count_ = 0;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> points_in_;
};

}  // namespace mixbeam
