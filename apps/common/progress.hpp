/// One line for each load step, failed attempts included: where the path is, what the step cost, how long the rest may
/// take.
#pragma once

#include "nonlinear/load_path.hpp"

#include <chrono>
#include <iosfwd>
#include <string>

namespace mixbeam {

class Progress {
 public:
  /// `from`: load factor at which the path starts or is resumed.
  Progress(std::ostream& out, std::string label, int stages, double from = 0.0);
  void report(const StepReport& report);
  /// A failed attempt and its cause, in one line.
  void report(const StepFailure& failure);

 private:
  void report_critical(const CriticalPoint& point);

  std::ostream& out_;
  std::string label_;
  int stages_;
  double from_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace mixbeam
