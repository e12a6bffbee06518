/// The largest error of a sweep and where it occurred: one statement for many cases, with a message that reproduces it.
#pragma once

#include "tests/support/numbers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace mixbeam::test {

class WorstError {
 public:
  /// `where...` is streamed into the message when this error is the largest so far. NaN is worse than any number.
  template <class... Parts>
  void see(double error, const Parts&... where) {
    if (std::isnan(largest_) || error <= largest_) return;
    largest_ = error;
    std::ostringstream text;
    text.precision(17);
    (text << ... << where);
    where_ = text.str();
  }

  double largest() const { return largest_; }

  /// Whether there was a case and no error exceeds `bound`; says where the largest one is.
  testing::AssertionResult at_most(double bound) const {
    if (std::getenv("MIXBEAM_PRINT_ERRORS") != nullptr) print(bound);
    const bool holds = largest_ >= 0.0 && largest_ <= bound;
    return testing::AssertionResult(holds)
           << "largest error " << largest_ << (holds ? " <= " : " > ") << bound << ", at " << where_;
  }

 private:
  /// The numbers behind the bounds of the tests, to measure them again on another machine.
  void print(double bound) const {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::printf("%s.%s: %.3g = %.3g roundings, bound %.3g, at %s\n", test->test_suite_name(), test->name(), largest_,
                largest_ / kRounding, bound, where_.c_str());
  }

  double largest_ = -1.0;
  std::string where_ = "no case at all";
};

}  // namespace mixbeam::test
