/// What a run says about itself on the terminal when it has ended.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Reactions must balance the loads in every run. Newton's method ends at a scaled residual of 1e-11 in each row, and
/// the sums run over the rows of all elements: what is left there adds up like a random walk, the rounding errors of
/// the sums with their number.
double balance_tolerance(double elements);

/// Watches the balance of loads and reactions over all steps of a run and keeps the last of them.
class RunReport {
 public:
  void add(const StepRecord& record);

  /// Critical points that a run passed before it was stopped, when it is resumed.
  void add_critical_points(const StoredRun& run);

  /// Adds the checks of the balance to the summary of the run.
  void check_balance(Application& app, const std::string& run) const;

  /// Adds the stability of the last step to the summary of the run; an unstable end is a warning.
  void add_end(Application& app, const std::string& run) const;

  /// Adds the estimated errors of the last step to the summary of the run.
  void add_errors(Application& app, const std::string& run) const;

  /// Displacements of points and reactions of supports in the last step (a few of them), energies, estimated errors,
  /// balance.
  void print(std::ostream& out) const;

 private:
  void print_buckling(std::ostream& out) const;
  void print_critical_points(std::ostream& out) const;
  void print_errors(std::ostream& out) const;

  StepRecord last_;                              ///< without its members and rows
  std::vector<RecordedCriticalPoint> critical_;  ///< of all steps, without rows
  std::vector<RecordedBucklingMode> buckling_;   ///< without rows
  double force_error_ = 0.0, moment_error_ = 0.0;
  double balance_tolerance_ = 0.0;
};

/// The last lines of a run, one for each end (two where a displacement is controlled): "column: stable: true".
void print_ends(std::ostream& out, const Summary& summary, bool controlled);

/// What an unstable end is.
inline constexpr const char* kDoesNotStay = "a real structure does not stay there";

}  // namespace mixbeam
