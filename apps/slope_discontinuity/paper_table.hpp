/// What the paper prints about the structure with slope discontinuity.
#pragma once

#include <array>
#include <string>

namespace mixbeam {

inline constexpr const char* kSlopeTableSource =
    "Humer, Steinbrecher, Pechstein, table \"Structure with slope discontinuity\"";

/// Displacement of the free end as printed, to 6 significant digits; empty texts where the table has no such row.
std::array<std::string, 3> paper_tip_displacement(int order, int elements_per_member);

}  // namespace mixbeam
