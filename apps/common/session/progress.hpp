/// One line for each load step, failed attempts included: where the path is, what the step cost, how long the rest may
/// take.
#pragma once

#include "nonlinear/path/load_path.hpp"
#include "nonlinear/stability/vibration.hpp"

#include <chrono>
#include <iosfwd>
#include <string>

namespace mixbeam {

class Progress {
 public:
  /// `from`: share of the path that is behind its start, where it is resumed; see Simulation::share_done().
  Progress(std::ostream& out, std::string label, int stages, double from = 0.0);
  /// `share_done`: of the path. The time to go is that of the steps done, for what is left of the path at their pace;
  /// it is left out where they tell nothing of it: no way was covered, or the rest would take more than a day.
  void report(const StepReport& report, double share_done);
  /// A failed attempt and its cause, in one line.
  void report(const StepFailure& failure);
  /// A search for a stable state, at most one line each second.
  void report(const DescentProgress& descent);
  /// A search for modes, at most one line each second.
  void report(const ModeSearch& search);

 private:
  void report_critical(const CriticalPoint& point);
  std::string time_to_go(double elapsed, double share_done) const;
  bool is_due();

  std::ostream& out_;
  std::string label_;
  int stages_;
  double from_;
  std::chrono::steady_clock::time_point start_, last_search_;
};

/// "jump between load factors 0.05 and 0.0625: energy released 0.0123, vertices move by 0.11 of the length, ...".
std::string jump_text(const RecordedJump& jump);

/// "bifurcation at load factor 1.234: negative eigenvalues 0 before, 1 after". `omega`: of flutter, NaN for others.
std::string critical_text(const std::string& kind, double load_factor, double error, int before, int after,
                          double omega);

/// " 0.50000", and with an exponent where five decimals would hide it or its digits would fill the line: "4.5e-06";
/// "unknown" for what is no number.
std::string load_factor_text(double load_factor);

}  // namespace mixbeam
