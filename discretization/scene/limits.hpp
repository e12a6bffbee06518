/// Bounds of the numbers in a scene.
#pragma once

#include "discretization/parameters/spec.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <string>

namespace mixbeam {

inline constexpr double kLargestCoordinate = 1e100;  ///< squares of lengths must not overflow
/// Beyond that sine and cosine lose the digits that ends are compared with. [radian]
inline constexpr double kLargestAngle = 1e6;

/// Below that relative errors of displacements are those of rounding.
inline constexpr double kBestAccuracy = 1e-12;

/// Coordinates, a fixed number of them or any.
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
