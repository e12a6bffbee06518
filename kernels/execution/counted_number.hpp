/// A number that counts what is done with it: run a kernel on it in place of `double` or of lanes to learn how many
/// floating-point operations the kernel takes for one element or vertex.
#pragma once

#include "kernels/execution/pack.hpp"

#include <cmath>

namespace mixbeam {

/// Floating-point operations of a piece of code. Comparisons, changes of sign and absolute values are not counted.
struct OperationCount {
  long sums = 0, products = 0;
  long divisions = 0, functions = 0;  ///< functions: roots, sine, cosine, atan2, one each
  /// As a machine's peak is counted: one for each operation, so that a fused multiply-add makes two.
  long flops() const { return sums + products + divisions + functions; }
};

/// One number in no lane: kernels take it for a pack. Where lanes that need a rare branch are treated one by one there
/// is none to treat, so that what is counted is the usual way.
template <>
struct Pack<0> {
 public:
  /// What comparisons give.
  struct Mask {
    bool holds = false;
    explicit operator bool() const { return holds; }
    long long operator[](int) const { return holds ? -1 : 0; }
    Mask operator~() const { return {!holds}; }
    Mask& operator|=(const Mask& b) { return holds = holds || b.holds, *this; }
  };

  Pack() = default;
  Pack(double x) : value_(x) {}  // NOLINT(google-explicit-constructor): stands in place of double

  double operator[](int) const { return value_; }
  void set(int, double x) { value_ = x; }

  double value() const { return value_; }
  /// All operations of this thread since it was set.
  static OperationCount& count() {
    static thread_local OperationCount operations;
    return operations;
  }

  friend Pack operator+(const Pack& a, const Pack& b) {
    ++count().sums;
    return a.value_ + b.value_;
  }
  friend Pack operator-(const Pack& a, const Pack& b) {
    ++count().sums;
    return a.value_ - b.value_;
  }
  friend Pack operator*(const Pack& a, const Pack& b) {
    ++count().products;
    return a.value_ * b.value_;
  }
  friend Pack operator/(const Pack& a, const Pack& b) {
    ++count().divisions;
    return a.value_ / b.value_;
  }
  friend Pack operator-(const Pack& a) { return -a.value_; }
  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }
  Pack& operator*=(const Pack& b) { return *this = *this * b; }

  friend Mask operator<(const Pack& a, const Pack& b) { return {a.value_ < b.value_}; }
  friend Mask operator<=(const Pack& a, const Pack& b) { return {a.value_ <= b.value_}; }
  friend Mask operator>(const Pack& a, const Pack& b) { return {a.value_ > b.value_}; }
  friend Mask operator>=(const Pack& a, const Pack& b) { return {a.value_ >= b.value_}; }

  friend Pack sqrt(const Pack& a) { return function(std::sqrt(a.value_)); }
  friend Pack sin(const Pack& a) { return function(std::sin(a.value_)); }
  friend Pack cos(const Pack& a) { return function(std::cos(a.value_)); }
  friend Pack atan2(const Pack& y, const Pack& x) { return function(std::atan2(y.value_, x.value_)); }
  friend Pack fabs(const Pack& a) { return std::fabs(a.value_); }
  friend Pack select(const Mask& condition, const Pack& a, const Pack& b) { return condition.holds ? a : b; }

 private:
  static Pack function(double value) {
    ++count().functions;
    return value;
  }

  double value_ = 0.0;
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
