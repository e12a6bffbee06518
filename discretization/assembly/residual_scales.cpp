#include "discretization/assembly/residual_scales.hpp"

#include <algorithm>
#include <limits>

namespace mixbeam {

namespace {

/// Strains and relative rotations are differences of numbers of size one (and of u/h): a few roundings each.
constexpr double kRoundings = 16.0;

/// Without any load the internal forces must vanish; a force of this fraction of EI/L^2 times the tolerance moves
/// nothing by more than a rounding error of the length.
constexpr double kUnloadedForce = 1e-6;

/// Of the structure's length: beyond it a path has gone astray, and rounding would excuse any strain.
constexpr double kLargestDisplacement = 1e6;

}  // namespace

ResidualScales residual_scales(const StateMagnitude& state, double length, double shortest_element,
                               double bending_stiffness, double tolerance) {
  ResidualScales scales;
  const bool loaded = state.load_force > 0.0 || state.load_moment > 0.0;
  const double floor = loaded ? 0.0 : kUnloadedForce * bending_stiffness / (length * length);
  const double moment = std::max(state.moment, state.load_moment);
  scales.force = std::max({state.force, state.load_force, moment / length, floor});
  scales.moment = std::max(moment, scales.force * shortest_element);
  const double noise = kRoundings * std::numeric_limits<double>::epsilon() / tolerance;
  const double amplitude = std::min(1.0, std::max({state.rotation, state.displacement / length, state.eigenstrain}));
  scales.rotation = std::max(amplitude, noise);
  scales.strain = std::max(amplitude, noise);
  scales.displacement_noise = noise * std::min(state.displacement, kLargestDisplacement * length);
  scales.length = length;
  scales.amplitude = amplitude;
  return scales;
}

}  // namespace mixbeam
