/// Numbers of a page in few bytes, as viewer/packed.js reads them: whole multiples of a unit, the difference of each
/// one to what its neighbours let expect, deflated.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mixbeam {

/// Bits of a number.
inline constexpr int kForReading = 15,  ///< those that the page shows: 16,000 units up to the largest of a column
    kForDrawing = 13,                   ///< directions and modes
    kForPlaces = 22;                    ///< undeformed positions and the path: six digits

/// PageRows of numbers.
struct PageRows {
  std::vector<double> values{};
  std::size_t columns = 1;
  std::size_t count() const { return values.size() / columns; }
  const double* row(std::size_t i) const { return values.data() + columns * i; }
};

struct PackedNumbers {
  std::string bytes{};
  std::vector<double> units{};   ///< of each column
  std::vector<double> values{};  ///< as a reader gets them
};

/// NaN stays NaN for a reader. `later`: the same quantity in the step behind, from which this one is extrapolated, and
/// in the one behind that; null: there is none.
PackedNumbers packed(const PageRows& rows, int bits, const PackedNumbers* later = nullptr,
                     const PackedNumbers* behind = nullptr);

/// Without the header of zlib.
std::string deflated(const std::string& bytes);

std::string base64(const std::string& bytes);

}  // namespace mixbeam
