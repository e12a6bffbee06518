/// What a run says about itself on the terminal when it has ended.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/common/tables/csv_table.hpp"

namespace mixbeam {

/// Reactions must balance the loads in every run. Newton's method ends at a scaled residual of 1e-11 in each row, and
/// the sums run over the rows of all elements: what is left there adds up like a random walk, the rounding errors of
/// the sums with their number. Along a member in tension what is left points to one side, and adds up to as many times
/// the `residual` of the step as it has elements. `levers`: rounding_of_levers().
double balance_tolerance(double elements, double of_longest_member, double residual, double levers);
/// Rounding of the coordinates of a scene over its size: what moments about its middle are uncertain by.
double rounding_of_levers(const Scene& scene);

/// Watches the balance of loads and reactions over all steps of a run and keeps the last of them.
class RunReport {
 public:
  RunReport() = default;
  /// `quantities`: of the scene; it must outlive this.
  RunReport(const QuantitySet* quantities, const Scene& scene);

  void add(const StepRecord& record);

  /// What a run passed before it was stopped, when it is resumed: critical points, quantities.
  void add(const StoredRun& run);

  /// Adds the checks of the balance to the summary of the run.
  void check_balance(Application& app, const std::string& run) const;

  /// Adds the stability of the last step to the summary of the run; an unstable end is a warning.
  void add_end(Application& app, const std::string& run) const;

  /// Adds the estimated errors of the last step to the summary of the run.
  void add_errors(Application& app, const std::string& run) const;

  /// Where extremes over places are at the end, see QuantitySet::places().
  void add_places(std::vector<std::string> places) { places_ = std::move(places); }
  /// Quantities that are extremes, and where at the end.
  std::vector<std::pair<std::string, std::string>> places() const;

  /// Adds the quantities to the summary of the run, and a check for each that has a limit.
  void add_quantities(Application& app, const std::string& run) const;

  /// Adds the gradients at the end to the summary of the run.
  void add_gradients(Application& app, const std::string& run) const;
  /// Rows of a table: quantity, value, path of the number, derivative.
  std::vector<std::vector<CsvCell>> gradients() const;

  /// Table of natural frequencies over the path, a column for each motion and unit; without rows where modes were
  /// searched for once.
  std::vector<std::vector<CsvCell>> frequencies() const;
  std::vector<std::string> frequency_columns() const;

  /// Adds what stresses and strains of the last step warn of to the summary of the run.
  void add_stresses(Application& app, const std::string& run) const;

  /// Displacements of points and reactions of supports in the last step (a few of them), energies, quantities,
  /// stresses, estimated errors, balance.
  void print(std::ostream& out) const;
  /// The same of one run among several, in a few lines.
  void print_short(std::ostream& out, const std::string& run) const;

 private:
  void print_buckling(std::ostream& out) const;
  void print_modes(std::ostream& out) const;
  void print_frequencies(std::ostream& out) const;
  std::string collapse_text() const;
  void print_critical_points(std::ostream& out) const;
  void print_jumps(std::ostream& out) const;
  void print_errors(std::ostream& out) const;
  void print_quantities(std::ostream& out) const;
  void print_gradients(std::ostream& out) const;
  void print_reactions(std::ostream& out) const;
  void follow(int step, double load_factor, const double* values);
  std::string place_of(std::size_t column) const;

  /// One number of the list "Quantities" over the steps.
  struct Followed {
    double last = 0.0, size = -1.0;  ///< the largest size so far, of `at_size`
    double at_size = 0.0, load_factor_of_size = 0.0;
    int step_of_size = 0;
    double reference = 0.0, limited_size = -1.0;  ///< for a limit: value at the end of a stage, largest change since
  };
  void follow_limit(double load_factor, double value, const Quantity& asked, Followed& one) const;
  /// Of a column at the end; null: no estimate was asked for.
  const EstimatedValue* estimate_of(std::size_t column) const;
  static double error_of_largest(const Followed& one, const EstimatedValue* estimated);

  double length_ = 1.0, bending_ = 0.0;  ///< of the structure; smallest EI: scales of what counts as zero
  double levers_ = 0.0;                  ///< rounding_of_levers()
  const QuantitySet* quantities_ = nullptr;
  std::vector<std::string> member_names_{}, places_{};
  std::vector<Followed> followed_{};             ///< (column of the set)
  StepRecord last_;                              ///< without its members and rows
  std::vector<RecordedCriticalPoint> critical_;  ///< of all steps, without rows
  std::vector<RecordedJump> jumps_;              ///< likewise
  struct Buckling {
    RecordedBucklingMode mode;  ///< without rows
    double base = 0.0;          ///< load factor of the state that it is about
    std::string place;          ///< where it moves most
  };
  std::vector<Buckling> buckling_;
  std::string farthest_;  ///< the largest displacement of the last step and its place
  std::string collapse_;  ///< the first critical point at which the path turns unstable, in words
  /// Natural modes of a step, without rows.
  struct Searched {
    int step = 0;
    double load_factor = 0.0;
    std::vector<RecordedVibrationMode> modes;
    const RecordedVibrationMode* of(int track) const;
  };
  void follow(Searched searched);
  std::vector<Searched> searched_;
  int tracks_ = 0;
  double force_error_ = 0.0, moment_error_ = 0.0;
  double balance_tolerance_ = 0.0;
};

/// The last lines of a run, one for each end (two where a displacement is controlled): "column: stable: true".
void print_ends(std::ostream& out, const Summary& summary, bool controlled);

/// The most stressed members with place, point of the section and utilisation; notes on what the fields leave out.
void print_stresses(std::ostream& out, const StressSummary& stresses);

/// "1.2e-03"; "unknown" where it is not estimated; "-" where that was not asked for (null: likewise).
std::string error_text(const EstimatedValue* value);

/// Strains that the linear law does not mean, members too curved for linear bending stresses; each without its run.
std::vector<std::string> stress_warnings(const StressSummary& stresses);

/// What an unstable end is.
inline constexpr const char* kDoesNotStay = "a real structure does not stay there";

}  // namespace mixbeam
