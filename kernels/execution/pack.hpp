/// Several numbers side by side in one vector register: replaces `double` in kernels that process several elements at
/// once. Every operation acts on all lanes; where lanes need different branches, both are computed and select() picks
/// one for each lane.
#pragma once

#include <Kokkos_Core.hpp>

#include <cmath>
#include <type_traits>

namespace mixbeam {

/// Lanes of a vector register of the target processor; a GPU has its lanes elsewhere.
#if defined(__CUDACC__) || defined(__HIPCC__)
constexpr int kLanes = 1;
#elif defined(__AVX512F__)
constexpr int kLanes = 8;
#elif defined(__AVX__)
constexpr int kLanes = 4;
#else
constexpr int kLanes = 2;
#endif

/// Registers of W numbers and of W conditions (all bits of a lane set if a comparison holds, else none), and the
/// numbers as stored in an array of double or single precision.
template <int W>
struct Registers;
#define MIXBEAM_REGISTERS(W)                                                                         \
  template <>                                                                                        \
  struct Registers<W> {                                                                              \
    typedef double Numbers __attribute__((vector_size(W * sizeof(double))));                         \
    typedef long long Conditions __attribute__((vector_size(W * sizeof(long long))));                \
    typedef double InMemory __attribute__((vector_size(W * sizeof(double)), aligned(8), may_alias)); \
    typedef float Rounded __attribute__((vector_size(W * sizeof(float)), aligned(4), may_alias));    \
  };
MIXBEAM_REGISTERS(2)
MIXBEAM_REGISTERS(4)
MIXBEAM_REGISTERS(8)
#undef MIXBEAM_REGISTERS

/// W numbers side by side. Pack<1>, for processors without lanes and for tests, is a single number (below), and so is
/// Pack<0>, which counts operations (tests/support/counted_number.hpp).
template <int W, bool IsSingle = (W < 2)>
struct Pack {
  using Vector = typename Registers<W>::Numbers;
  using Mask = typename Registers<W>::Conditions;

  Vector v;

  Pack() = default;
  // Broadcasts a number to all lanes, as in double arithmetic. x - 0 is x for every x, also for -0 and NaN, so it costs
  // no instruction; 0 + x would.
  Pack(double x) : v(x - Vector{}) {}  // NOLINT(google-explicit-constructor)
  explicit Pack(const Vector& x) : v(x) {}

  /// Loads W consecutive numbers (in one instruction: GCC 12 makes two of a memcpy, which stalls the next access).
  static Pack loaded(const double* numbers) {
    return Pack(Vector(*reinterpret_cast<const typename Registers<W>::InMemory*>(numbers)));
  }
  static Pack loaded(const float* numbers) {
    return Pack(__builtin_convertvector(*reinterpret_cast<const typename Registers<W>::Rounded*>(numbers), Vector));
  }
  void store(double* numbers) const { *reinterpret_cast<typename Registers<W>::InMemory*>(numbers) = v; }

  /// Collects one number from each of W places.
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

/// Single number with the interface of a pack.
template <int W>
struct Pack<W, true> {
  /// Result of comparisons: all bits set or none, as in a lane.
  struct Mask {
    long long bits = 0;
    KOKKOS_FORCEINLINE_FUNCTION explicit operator bool() const { return bits != 0; }
    KOKKOS_FORCEINLINE_FUNCTION long long& operator[](int) { return bits; }
    KOKKOS_FORCEINLINE_FUNCTION long long operator[](int) const { return bits; }
    KOKKOS_FORCEINLINE_FUNCTION Mask operator~() const { return {~bits}; }
    KOKKOS_FORCEINLINE_FUNCTION Mask& operator|=(const Mask& b) { return bits |= b.bits, *this; }
  };

  double v = 0.0;

  Pack() = default;
  KOKKOS_FORCEINLINE_FUNCTION Pack(double x) : v(x) {}  // NOLINT(google-explicit-constructor): stands for double
  template <class Value>
  KOKKOS_FORCEINLINE_FUNCTION static Pack loaded(const Value* number) {
    return static_cast<double>(*number);
  }
  template <class Place>
  KOKKOS_FORCEINLINE_FUNCTION static Pack gathered(const Place& place) {
    return place(0);
  }
  KOKKOS_FORCEINLINE_FUNCTION void store(double* number) const { *number = v; }
  KOKKOS_FORCEINLINE_FUNCTION double operator[](int) const { return v; }
  KOKKOS_FORCEINLINE_FUNCTION void set(int, double x) { v = x; }

  KOKKOS_FORCEINLINE_FUNCTION Pack& operator+=(const Pack& b) { return *this = *this + b; }
  KOKKOS_FORCEINLINE_FUNCTION Pack& operator-=(const Pack& b) { return *this = *this - b; }
  KOKKOS_FORCEINLINE_FUNCTION Pack& operator*=(const Pack& b) { return *this = *this * b; }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack operator+(const Pack& a, const Pack& b) { return a.v + b.v; }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack operator-(const Pack& a, const Pack& b) { return a.v - b.v; }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack operator*(const Pack& a, const Pack& b) { return a.v * b.v; }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack operator/(const Pack& a, const Pack& b) { return a.v / b.v; }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack operator-(const Pack& a) { return -a.v; }
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator<(const Pack& a, const Pack& b) { return mask(a.v < b.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator<=(const Pack& a, const Pack& b) { return mask(a.v <= b.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator>(const Pack& a, const Pack& b) { return mask(a.v > b.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Mask operator>=(const Pack& a, const Pack& b) { return mask(a.v >= b.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack sqrt(const Pack& a) { return std::sqrt(a.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack sin(const Pack& a) { return std::sin(a.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack cos(const Pack& a) { return std::cos(a.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack atan2(const Pack& y, const Pack& x) { return std::atan2(y.v, x.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack fabs(const Pack& a) { return std::fabs(a.v); }
  KOKKOS_FORCEINLINE_FUNCTION friend Pack select(const Mask& mask, const Pack& a, const Pack& b) {
    return mask.bits != 0 ? a : b;
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION static Mask mask(bool holds) { return {holds ? -1 : 0}; }
};

template <int W>
bool any(const typename Pack<W>::Mask& mask) {
  long long bits = 0;
  for (int lane = 0; lane < W; ++lane) bits |= mask[lane];
  return bits != 0;
}

// Same function for a plain number, so that a kernel is written once.
template <class Scalar>
KOKKOS_FORCEINLINE_FUNCTION Scalar select(bool condition, const Scalar& a, const Scalar& b) {
  return condition ? a : b;
}

/// Exchanges the off-diagonal parts of every 2 x 2 block of blocks of D lanes: steps D = 1, 2, .., W/2 transpose.
template <int W, int D>
inline __attribute__((always_inline)) void exchange(Pack<W>* rows) {
  typename Pack<W>::Mask low, high;
  for (int lane = 0; lane < W; ++lane) {
    low[lane] = (lane & D) != 0 ? W + lane - D : lane;
    high[lane] = (lane & D) != 0 ? W + lane : lane + D;
  }
  for (int i = 0; i < W; ++i)
    if ((i & D) == 0) {
      const auto a = rows[i].v, b = rows[i + D].v;
      rows[i].v = __builtin_shuffle(a, b, low);
      rows[i + D].v = __builtin_shuffle(a, b, high);
    }
  if constexpr (2 * D < W) exchange<W, 2 * D>(rows);
}

/// numbers[i] = rows[lane][i] for i < count: W rows of memory, one per lane.
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void gather_lanes(const double* const* rows, int count, Pack<W>* numbers) {
  if (W < 2 || count < W) {
    for (int i = 0; i < count; ++i) numbers[i] = Pack<W>::gathered([&](int lane) { return rows[lane][i]; });
    return;
  }
  if constexpr (W > 1)
    for (int i = 0; i < count; i += W) {
      const int first = i + W <= count ? i : count - W;  // the last group overlaps the previous one
      Pack<W> square[W];
      for (int lane = 0; lane < W; ++lane) square[lane] = Pack<W>::loaded(rows[lane] + first);
      exchange<W, 1>(square);
      for (int j = 0; j < W; ++j) numbers[first + j] = square[j];
    }
}

/// rows[lane][offset + i] = numbers[i] for i < count and lane < active.
template <int W>
inline void scatter_lanes(const Pack<W>* numbers, int count, int offset, int active, double* const* rows) {
  if (W < 2 || count < W) {
    for (int lane = 0; lane < active; ++lane)
      for (int i = 0; i < count; ++i) rows[lane][offset + i] = numbers[i][lane];
    return;
  }
  if constexpr (W > 1)
    for (int i = 0; i < count; i += W) {
      const int first = i + W <= count ? i : count - W;
      Pack<W> square[W];
      for (int j = 0; j < W; ++j) square[j] = numbers[first + j];
      exchange<W, 1>(square);
      for (int lane = 0; lane < W; ++lane)
        if (lane < active) square[lane].store(rows[lane] + offset + first);
    }
}

/// Prefetches the cache lines of `count` numbers, for writing unless they are const.
template <class Number>
KOKKOS_FORCEINLINE_FUNCTION void fetch(Number* numbers, int count) {
#if !defined(__CUDACC__) && !defined(__HIPCC__)
  constexpr int line = 8;
  for (int i = 0; i < count; i += line) __builtin_prefetch(numbers + i, std::is_const_v<Number> ? 0 : 1);
#endif
}

/// Rows (elements, vertices) processed side by side, from W * pack on. The last of `count` rows fills the lanes beyond
/// it, which are not written. Rows of the next pack are prefetched: hardware does not predict as many streams as there
/// are lanes.
template <int W>
struct RowsInLanes {
  static constexpr int kCount = W > 0 ? W : 1;
  int active;  ///< lanes that are written
  int row[kCount], next[kCount];
  KOKKOS_FORCEINLINE_FUNCTION RowsInLanes(int pack, int count)
      : active(count - pack * kCount < kCount ? count - pack * kCount : kCount) {
    for (int lane = 0; lane < kCount; ++lane) {
      row[lane] = pack * kCount + (lane < active ? lane : active - 1);
      next[lane] = row[lane] + kCount < count ? row[lane] + kCount : row[lane];
    }
  }
  static int packs(int count) { return (count + kCount - 1) / kCount; }

  /// numbers[i] = at(row)[i] for i < count.
  template <class At>
  KOKKOS_FORCEINLINE_FUNCTION void load(const At& at, int count, Pack<W>* numbers) const {
    const double* rows[kCount];
    for (int lane = 0; lane < kCount; ++lane) rows[lane] = at(row[lane]);
    for (int lane = 0; lane < kCount; ++lane) fetch(at(next[lane]), count);
    gather_lanes(rows, count, numbers);
  }
  /// at(row)[first + i] = numbers[i] for i < count, in the active lanes.
  template <class At>
  KOKKOS_FORCEINLINE_FUNCTION void store(const Pack<W>* numbers, int first, int count, const At& at) const {
    double* rows[kCount];
    for (int lane = 0; lane < kCount; ++lane) rows[lane] = at(row[lane]);
    for (int lane = 0; lane < kCount; ++lane) fetch(at(next[lane]) + first, count);
    scatter_lanes(numbers, count, first, active, rows);
  }
};
using LaneRows = RowsInLanes<kLanes>;

}  // namespace mixbeam
