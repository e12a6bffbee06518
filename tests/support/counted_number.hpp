/// A number that counts what is done with it, in place of a pack: a kernel that runs on it tells how many operations it
/// takes for one element or vertex. Lanes that need a rare branch are treated one by one in loops over W = 0 lanes, so
/// that what is counted is the usual way. To be included before the kernels.
#pragma once

#include "kernels/execution/pack.hpp"

namespace mixbeam {

/// Floating-point operations of a piece of code. Comparisons, changes of sign and absolute values are not counted.
struct OperationCount {
  long sums = 0, products = 0;
  long divisions = 0, functions = 0;  ///< functions: roots, sine, cosine, atan2, one each
  /// As a machine's peak is counted: one for each operation, so that a fused multiply-add makes two.
  long flops() const { return sums + products + divisions + functions; }
};

template <>
struct Pack<0, true> {
  using Mask = Pack<1>::Mask;

  double v = 0.0;

  Pack() = default;
  Pack(double x) : v(x) {}  // NOLINT(google-explicit-constructor): stands for double
  template <class Value>
  static Pack loaded(const Value* number) {
    return static_cast<double>(*number);
  }
  template <class Place>
  static Pack gathered(const Place& place) {
    return place(0);
  }
  double operator[](int) const { return v; }
  void set(int, double x) { v = x; }

  /// All operations of this thread since it was set.
  static OperationCount& count() {
    static thread_local OperationCount operations;
    return operations;
  }

  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }
  Pack& operator*=(const Pack& b) { return *this = *this * b; }
  friend Pack operator+(const Pack& a, const Pack& b) { return ++count().sums, a.v + b.v; }
  friend Pack operator-(const Pack& a, const Pack& b) { return ++count().sums, a.v - b.v; }
  friend Pack operator*(const Pack& a, const Pack& b) { return ++count().products, a.v * b.v; }
  friend Pack operator/(const Pack& a, const Pack& b) { return ++count().divisions, a.v / b.v; }
  friend Pack operator-(const Pack& a) { return -a.v; }
  friend Mask operator<(const Pack& a, const Pack& b) { return Pack<1>(a.v) < Pack<1>(b.v); }
  friend Mask operator<=(const Pack& a, const Pack& b) { return Pack<1>(a.v) <= Pack<1>(b.v); }
  friend Mask operator>(const Pack& a, const Pack& b) { return Pack<1>(a.v) > Pack<1>(b.v); }
  friend Mask operator>=(const Pack& a, const Pack& b) { return Pack<1>(a.v) >= Pack<1>(b.v); }
  friend Pack sqrt(const Pack& a) { return ++count().functions, std::sqrt(a.v); }
  friend Pack sin(const Pack& a) { return ++count().functions, std::sin(a.v); }
  friend Pack cos(const Pack& a) { return ++count().functions, std::cos(a.v); }
  friend Pack atan2(const Pack& y, const Pack& x) { return ++count().functions, std::atan2(y.v, x.v); }
  friend Pack fabs(const Pack& a) { return std::fabs(a.v); }
  friend Pack select(const Mask& mask, const Pack& a, const Pack& b) { return mask.bits != 0 ? a : b; }
};

using CountedNumber = Pack<0>;

/// Operations of one call of `work`.
template <class Work>
OperationCount operations_of(const Work& work) {
  CountedNumber::count() = OperationCount();
  work();
  return CountedNumber::count();
}

}  // namespace mixbeam
