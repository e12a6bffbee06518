/// What the paper, and a prototype of its element, found for the fork structure.
#pragma once

#include <array>
#include <string>

namespace mixbeam {

inline constexpr const char* kForkTableSource = "Humer, Steinbrecher, Pechstein, table \"Fork structure\"";

/// u1, u2, u3 of P1 as printed; empty texts where there is no such value.
using PrintedDisplacement = std::array<std::string, 3>;

/// The paper's values for configurations (1) and (2), as the manuscript gives them; its table shows 6 figures of them.
std::array<PrintedDisplacement, 2> paper_p1_displacement(int order, int elements_per_member);

inline constexpr const char* kPrototypeSource =
    "stand-alone prototype of the element with all derivatives by automatic differentiation";

/// The prototype's values, by representation ("exact arc", "polygon"); it was run for k = 1 with 3 elements per member.
std::array<PrintedDisplacement, 2> prototype_p1_displacement(const std::string& representation);

}  // namespace mixbeam
