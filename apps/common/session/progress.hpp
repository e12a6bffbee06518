/// One line for each load step, failed attempts included: position on the path, cost of the step, estimated time to go.
#pragma once

#include "nonlinear/path/load_path.hpp"
#include "nonlinear/stability/vibration.hpp"

#include <chrono>
#include <iosfwd>
#include <string>

namespace mixbeam {

class Progress {
 public:
  /// `from`: share of the path done before a resumed run; see Simulation::share_done().
  Progress(std::ostream& out, std::string label, int stages, double from = 0.0);
  /// Prints a step. `share_done`: of the path. The time to go extrapolates the pace of the steps done; it is omitted if
  /// no part of the path was covered or if it exceeds a day.
  void report(const StepReport& report, double share_done);
  /// Prints a failed attempt and its cause in one line.
  void report(const StepFailure& failure);
  /// Prints a search for a stable state, at most one line per second.
  void report(const DescentProgress& descent);
  /// Prints a search for modes, at most one line per second.
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

/// "jump between load factors 0.05 and 0.0625: energy released 0.0123, mean motion 0.11, ...".
std::string jump_text(const RecordedJump& jump);

/// "bifurcation at load factor 1.234: negative eigenvalues 0 before, 1 after". `omega`: of flutter; NaN otherwise.
std::string critical_text(const std::string& kind, double load_factor, double error, int before, int after,
                          double omega);

/// " 0.50000"; with an exponent ("4.5e-06") if five decimals would hide the value or it would be too wide; "unknown"
/// for NaN and infinity.
std::string load_factor_text(double load_factor);

}  // namespace mixbeam
