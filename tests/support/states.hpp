/// States and vectors of unknowns at random, and their bits.
#pragma once

#include "discretization/mesh/mixed_vector.hpp"
#include "discretization/state/snapshot.hpp"
#include "tests/support/same_bits.hpp"

#include <random>

namespace mixbeam::test {

inline bool same_bits(const State& a, const State& b) {
  return same_bits(a.views.vertex_displacement, b.views.vertex_displacement) &&
         same_bits(a.views.vertex_rotation, b.views.vertex_rotation) &&
         same_bits(a.views.element_triad, b.views.element_triad) && same_bits(a.views.interior, b.views.interior);
}

inline bool same_bits(const StateSnapshot& a, const StateSnapshot& b) {
  return same_bits(a.vertex_displacement, b.vertex_displacement) && same_bits(a.vertex_rotation, b.vertex_rotation) &&
         same_bits(a.element_triad, b.element_triad) && same_bits(a.interior, b.interior);
}

inline bool same_bits(const MixedVector& a, const MixedVector& b) {
  return same_bits(a.vertex(), b.vertex()) && same_bits(a.interior(), b.interior());
}

/// Entries between -size and size.
inline void fill_at_random(MixedVector& v, double size, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> entry(-size, size);
  const auto vertex = v.vertex();
  for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) = entry(generator);
  const auto interior = v.writable_interior(false);
  for (size_t i = 0; i < interior.extent(0); ++i) interior(i) = entry(generator);
}
/// The same in every run.
inline void fill_at_random(MixedVector& v, double size, unsigned seed) {
  std::mt19937_64 generator(seed);
  fill_at_random(v, size, generator);
}

}  // namespace mixbeam::test
