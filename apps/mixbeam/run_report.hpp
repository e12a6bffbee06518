/// What a run says about itself on the terminal when it has ended.
#pragma once

#include "apps/common/application.hpp"

namespace mixbeam {

/// Reactions must balance the loads in every run. Newton's method ends at a scaled residual of 1e-11 in each row, and
/// the sums run over all rows; those of very many elements carry a rounding error each.
inline constexpr double kBalanceTolerance = 1e-10;

/// Watches the balance of loads and reactions over all steps of a run and keeps the last of them.
class RunReport {
 public:
  void add(const StepRecord& record);

  /// Critical points that a run passed before it was stopped, when it is resumed.
  void add_critical_points(const StoredRun& run);

  /// Adds the checks of the balance to the summary of the run.
  void check_balance(Application& app, const std::string& run) const;

  /// Adds the estimated errors of the last step to the summary of the run.
  void add_errors(Application& app, const std::string& run) const;

  /// Displacements of points and reactions of supports in the last step (a few of them), energies, estimated errors,
  /// balance.
  void print(std::ostream& out) const;

 private:
  void print_buckling(std::ostream& out) const;
  void print_stability(std::ostream& out) const;
  void print_errors(std::ostream& out) const;

  StepRecord last_;                              ///< without its members and rows
  std::vector<RecordedCriticalPoint> critical_;  ///< of all steps, without rows
  std::vector<double> buckling_;                 ///< load factors of linear buckling
  double force_error_ = 0.0, moment_error_ = 0.0;
  double balance_tolerance_ = 0.0;
};

}  // namespace mixbeam
