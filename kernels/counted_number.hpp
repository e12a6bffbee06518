/// A number that counts what is done with it: run a kernel on it in place of `double` to learn how many floating-point
/// operations the kernel takes for one element or vertex.
#pragma once

#include <cmath>

namespace mixbeam {

/// Floating-point operations of a piece of code. Comparisons, changes of sign and absolute values are not counted.
struct OperationCount {
  long sums = 0, products = 0;
  long divisions = 0, functions = 0;  ///< functions: roots, sine, cosine, atan2, one each
  /// As a machine's peak is counted: one for each operation, so that a fused multiply-add makes two.
  long flops() const { return sums + products + divisions + functions; }
};

class CountedNumber {
 public:
  CountedNumber() = default;
  CountedNumber(double x) : value_(x) {}  // NOLINT(google-explicit-constructor): stands in place of double

  double value() const { return value_; }
  /// All operations of this thread since it was set.
  static OperationCount& count() {
    static thread_local OperationCount operations;
    return operations;
  }

  friend CountedNumber operator+(const CountedNumber& a, const CountedNumber& b) {
    ++count().sums;
    return a.value_ + b.value_;
  }
  friend CountedNumber operator-(const CountedNumber& a, const CountedNumber& b) {
    ++count().sums;
    return a.value_ - b.value_;
  }
  friend CountedNumber operator*(const CountedNumber& a, const CountedNumber& b) {
    ++count().products;
    return a.value_ * b.value_;
  }
  friend CountedNumber operator/(const CountedNumber& a, const CountedNumber& b) {
    ++count().divisions;
    return a.value_ / b.value_;
  }
  friend CountedNumber operator-(const CountedNumber& a) { return -a.value_; }
  CountedNumber& operator+=(const CountedNumber& b) { return *this = *this + b; }
  CountedNumber& operator-=(const CountedNumber& b) { return *this = *this - b; }
  CountedNumber& operator*=(const CountedNumber& b) { return *this = *this * b; }

  friend bool operator<(const CountedNumber& a, const CountedNumber& b) { return a.value_ < b.value_; }
  friend bool operator<=(const CountedNumber& a, const CountedNumber& b) { return a.value_ <= b.value_; }
  friend bool operator>(const CountedNumber& a, const CountedNumber& b) { return a.value_ > b.value_; }
  friend bool operator>=(const CountedNumber& a, const CountedNumber& b) { return a.value_ >= b.value_; }

  friend CountedNumber sqrt(const CountedNumber& a) { return function(std::sqrt(a.value_)); }
  friend CountedNumber sin(const CountedNumber& a) { return function(std::sin(a.value_)); }
  friend CountedNumber cos(const CountedNumber& a) { return function(std::cos(a.value_)); }
  friend CountedNumber atan2(const CountedNumber& y, const CountedNumber& x) {
    return function(std::atan2(y.value_, x.value_));
  }
  friend CountedNumber fabs(const CountedNumber& a) { return std::fabs(a.value_); }
  friend CountedNumber select(bool condition, const CountedNumber& a, const CountedNumber& b) {
    return condition ? a : b;
  }

 private:
  static CountedNumber function(double value) {
    ++count().functions;
    return value;
  }

  double value_ = 0.0;
};

/// Operations of one call of `work`.
template <class Work>
OperationCount operations_of(const Work& work) {
  CountedNumber::count() = OperationCount();
  work();
  return CountedNumber::count();
}

}  // namespace mixbeam
