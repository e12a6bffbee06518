/// Several numbers side by side in one vector register: what a kernel computes with instead of `double` when it works
/// on several elements at once. Every operation acts on all lanes; where lanes need different branches, both are
/// computed and select() takes one for each lane.
#pragma once

#include <Kokkos_Core.hpp>

#include <cmath>

namespace mixbeam {

/// Lanes of a vector register of the processor that this is compiled for; a GPU has its lanes elsewhere.
#if defined(__CUDACC__) || defined(__HIPCC__)
constexpr int kLanes = 1;
#elif defined(__AVX512F__)
constexpr int kLanes = 8;
#elif defined(__AVX__)
constexpr int kLanes = 4;
#else
constexpr int kLanes = 2;
#endif

/// Registers of W numbers and of W conditions (all bits of a lane set where a comparison holds, none elsewhere).
template <int W>
struct Registers;
#define MIXBEAM_REGISTERS(W)                                                          \
  template <>                                                                         \
  struct Registers<W> {                                                               \
    typedef double Numbers __attribute__((vector_size(W * sizeof(double))));          \
    typedef long long Conditions __attribute__((vector_size(W * sizeof(long long)))); \
  };
MIXBEAM_REGISTERS(1)
MIXBEAM_REGISTERS(2)
MIXBEAM_REGISTERS(4)
MIXBEAM_REGISTERS(8)
#undef MIXBEAM_REGISTERS

template <int W>
struct Pack {
  using Vector = typename Registers<W>::Numbers;
  using Mask = typename Registers<W>::Conditions;

  Vector v;

  Pack() = default;
  // A number stands for the same number in every lane, as in double arithmetic.
  Pack(double x) : v(Vector{} + x) {}  // NOLINT(google-explicit-constructor)
  explicit Pack(const Vector& x) : v(x) {}

  /// One number from each of W places.
  template <class Place>
  static Pack gathered(const Place& place) {
    Vector lanes{};
#pragma GCC unroll 8
    for (int lane = 0; lane < W; ++lane) lanes[lane] = place(lane);
    return Pack(lanes);
  }

  double operator[](int lane) const { return v[lane]; }
  void set(int lane, double x) { v[lane] = x; }

  Pack& operator+=(const Pack& b) { return v += b.v, *this; }
  Pack& operator-=(const Pack& b) { return v -= b.v, *this; }
  Pack& operator*=(const Pack& b) { return v *= b.v, *this; }
  friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.v + b.v); }
  friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.v - b.v); }
  friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.v * b.v); }
  friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v / b.v); }
  friend Pack operator-(const Pack& a) { return Pack(-a.v); }
  friend Mask operator<(const Pack& a, const Pack& b) { return a.v < b.v; }
  friend Mask operator<=(const Pack& a, const Pack& b) { return a.v <= b.v; }
  friend Mask operator>(const Pack& a, const Pack& b) { return a.v > b.v; }
  friend Mask operator>=(const Pack& a, const Pack& b) { return a.v >= b.v; }

  friend Pack sqrt(const Pack& a) {
    Pack r;
    for (int lane = 0; lane < W; ++lane) r.v[lane] = std::sqrt(a.v[lane]);
    return r;
  }
  friend Pack fabs(const Pack& a) { return Pack(a.v < 0.0 ? -a.v : a.v); }
  /// a where the mask is set, else b.
  friend Pack select(const Mask& mask, const Pack& a, const Pack& b) { return Pack(mask ? a.v : b.v); }
};

template <int W>
bool any(const typename Pack<W>::Mask& mask) {
  long long bits = 0;
  for (int lane = 0; lane < W; ++lane) bits |= mask[lane];
  return bits != 0;
}

// The same names for one number, so that a kernel is written once.
KOKKOS_INLINE_FUNCTION double select(bool condition, double a, double b) { return condition ? a : b; }

}  // namespace mixbeam
