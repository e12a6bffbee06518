/// Mathematical constants.
#pragma once

namespace mixbeam {

inline constexpr double kPi = 3.14159265358979323846;

}  // namespace mixbeam
