/// Numbers that many tests need.
#pragma once

#include <limits>

namespace mixbeam::test {

constexpr double kPi = 3.14159265358979323846;

/// Half the distance from 1 to the next number: the largest relative error of one rounding, 1.1e-16.
constexpr double kRounding = 0.5 * std::numeric_limits<double>::epsilon();

}  // namespace mixbeam::test
