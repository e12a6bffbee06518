/// Random numbers that are the same on every machine: own generator, no distributions of the standard library. Whoever
/// draws never puts two draws into one expression whose order the language leaves open.
#pragma once

#include "kernels/math/vector_algebra.hpp"

#include <cmath>
#include <cstdint>

namespace mixbeam {

/// splitmix64 (Steele, Lea, Flood 2014).
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(next() >> 11) / 9007199254740992.0);
  }
  /// Ten to a power between two.
  double decades(double low, double high) { return std::pow(10.0, between(low, high)); }
  /// 0 .. count - 1
  int below(int count) { return static_cast<int>(next() % static_cast<std::uint64_t>(count)); }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }
  /// In any direction, of a length between two.
  Vector3 vector(double shortest, double longest) {
    const double size = between(shortest, longest);
    return vector_algebra::scaled(size, direction());
  }
  /// Of length one, in any direction.
  Vector3 direction() {
    for (;;) {
      const Vector3 v = {between(-1, 1), between(-1, 1), between(-1, 1)};
      const double size = vector_algebra::norm(v);
      if (size > 0.1 && size < 1.0) return vector_algebra::scaled(1.0 / size, v);
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace mixbeam
