/// Bounds of the numbers in a scene.
#pragma once

#include "discretization/parameters/spec.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <string>

namespace mixbeam {

inline constexpr double kLargestCoordinate = 1e100;  ///< squares of lengths must not overflow
/// Beyond this, sine and cosine lose the digits with which ends are compared. [radian]
inline constexpr double kLargestAngle = 1e6;

/// Below this, relative errors of displacements are rounding.
inline constexpr double kBestAccuracy = 1e-12;

/// Array of `count` coordinates; 0: any number.
inline ParameterSpec coordinates(const std::string& name, int count = 0) {
  return array(name, ParameterType::real_array, count).at_least(-kLargestCoordinate).at_most(kLargestCoordinate);
}

/// A position.
inline ParameterSpec bounded_vector(const std::string& name) {
  return vector3(name).at_least(-kLargestCoordinate).at_most(kLargestCoordinate);
}

/// A direction of any length.
inline ParameterSpec direction(const std::string& name) {
  return bounded_vector(name).longer_than(vector_algebra::kShortestLength);
}

}  // namespace mixbeam
