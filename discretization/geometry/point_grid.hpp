/// Finding points that coincide, each in constant time.
#pragma once

#include "discretization/scene/scene.hpp"

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace mixbeam {

class PointGrid {
 public:
  /// Points closer than `tolerance` coincide; coordinates are at least those of `low`, and less than 1e17 tolerances
  /// above it.
  PointGrid(const Vector3& low, double tolerance) : low_(low), tolerance_(tolerance), cell_(4.0 * tolerance) {}

  /// The point gets the next number: 0, 1, 2, ...
  void insert(const Vector3& position);

  /// The first point of those with a number below `end` that coincides with `position`; `preferred` goes before all
  /// others.
  std::optional<std::size_t> find(const Vector3& position, std::size_t end, std::size_t preferred) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Vector3& position) const;
  static std::uint64_t key(const Cell& cell);
  bool coincide(std::size_t point, const Vector3& position) const;

  Vector3 low_;
  double tolerance_, cell_;
  std::vector<Vector3> positions_;
  std::unordered_multimap<std::uint64_t, std::size_t> points_in_;
};

}  // namespace mixbeam
