#include "discretization/scene/field_table.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Rounding of an arc length that was written and read, or recomputed, relative to the largest one.
constexpr double kSamePointOfTable = 1e-13;

}  // namespace

Vector3 FieldTable::at(double s) const {
  const auto is_before = [](double place, const Piece& piece) { return place < piece.s.front(); };
  auto piece = std::upper_bound(pieces.begin(), pieces.end(), s, is_before);
  if (piece != pieces.begin()) --piece;
  if (const auto next = piece + 1; next != pieces.end() && next->s.front() - s < s - piece->s.back()) piece = next;
  const std::vector<double>& at = piece->s;
  Vector3 sum{};
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (std::abs(s - at[i]) <= kSamePointOfTable * pieces.back().s.back()) return piece->value[i];
    double weight = 1.0;
    for (std::size_t j = 0; j < at.size(); ++j)
      if (j != i) weight *= (s - at[j]) / (at[i] - at[j]);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * piece->value[i][c];
  }
  return sum;
}

}  // namespace mixbeam
