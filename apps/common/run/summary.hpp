/// The summary of a run: all quantities checked against a reference, and the cost of the run. Printed for people,
/// written as JSON for scripts.
#pragma once

#include "discretization/checks/expected_values.hpp"
#include "discretization/state/member_samples.hpp"

#include <filesystem>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace mixbeam {

/// Source of the checks of limits.
inline constexpr const char* kLimitOfScene = "limit of the scene";

/// Criterion by which a value agrees with its reference.
enum class Comparison {
  absolute,        ///< |value - reference| <= tolerance
  relative,        ///< |value - reference| <= tolerance * |reference|
  upper_bound,     ///< value <= reference; no tolerance
  printed_digits,  ///< equal in all printed digits of the source; the tolerance counts units of the last one
  word             ///< the word and the reference are the same
};

/// "absolute", "relative", "upper bound", "printed digits", "word": the names used in scenes, prints and JSON.
std::string name_of(Comparison comparison);

/// A value beside its reference. `pass` is set by `Summary::check`.
struct CheckedQuantity {
  std::string name;  ///< "arc rho=10 k=3 n=32: u3"
  double value = 0.0;
  std::string reference;  ///< decimal text as the source prints it
  std::string source;     ///< where the reference comes from; never empty
  double tolerance = 0.0;
  Comparison comparison = Comparison::absolute;
  bool pass = false;
  std::string word{};    ///< the value if it is a word
  std::string remark{};  ///< why there is no value
};

/// True if the value agrees with its reference; false for values that are not finite. Throws std::invalid_argument if
/// the reference is no number or the tolerance negative or not finite.
bool agrees(const CheckedQuantity& quantity);

/// Estimated discretization errors at the end of a run.
struct EstimatedErrors {
  struct Quantity {
    std::string name;  ///< "displacement, any vertex"
    double error = 0.0, relative = 0.0;
  };
  std::string run;            ///< which of several runs
  std::string not_estimated;  ///< reason if there is no estimate
  std::vector<Quantity> quantities;
};

/// Meshes and cost of reaching a given accuracy.
struct ChosenMesh {
  struct Members {
    std::string names;  ///< "rod", "left, right", "left, right and 12 more"
    int count = 0, order = 0, elements = 0;
  };
  struct Round {
    int elements = 0;
    bool followed = false;  ///< whole path followed
    int steps = 0, iterations = 0;
    double seconds = 0.0, error = 0.0;
    std::string remark;
  };
  std::string run;  ///< which of several runs
  double wanted = 0.0, estimated = 0.0;
  std::string outcome;           ///< "reached", or why not
  std::vector<Members> members;  ///< grouped by mesh
  std::vector<Round> rounds;     ///< all meshes, in order
};

/// A requested quantity over the completed steps of a run.
struct FollowedQuantity {
  std::string run, name;
  double value = 0.0;  ///< at the end
  double at_largest_size = 0.0, load_factor_of_largest_size = 0.0;
  int step_of_largest_size = 0;
  std::string member{};     ///< location of an extreme along members, at the end; empty for others
  double arc_length = 0.0;  ///< [length]
  int side = 0;             ///< -1, 1: before, after a vertex
  std::string place{};      ///< location of an extreme over several places, at the end
  double error = 0.0;       ///< estimated error of |value| at the end; NaN: `not_estimated`, or not requested
  std::string not_estimated{};
};

/// Derivative of a quantity with respect to a number of the scene, at the end of a run.
struct FoundDerivative {
  std::string run, quantity;
  double value = 0.0;
  std::string number;  ///< its path
  double derivative = 0.0;
};

/// A number found by identification or design, with its standard deviation (NaN, infinite: see SearchedNumber).
struct FoundNumberOfScene {
  std::string parameter, number;
  double start = 0.0, value = 0.0, deviation = 0.0;
  std::vector<double> covariance{};  ///< row of the covariance matrix; empty without measurements
};

/// Largest and smallest value of a quantity at the ends of several runs, with the runs.
struct QuantityEnvelope {
  std::string name;
  double largest = 0.0;
  std::string largest_in{};
  double smallest = 0.0;
  std::string smallest_in{};
};

/// Stability of the last state of a run, and earlier jumps and losses of stability.
struct EndOfRun : RecordedStability {
  std::string run{};  ///< which of several runs
  double load_factor = 0.0;
  std::vector<RecordedJump> jumps{};  ///< jumps on its path
  std::string collapse{};  ///< first loss of stability on the path, or lowest linear buckling factor, in words
};

/// Checks and costs, collected during a run.
class Summary {
 public:
  std::string program;
  std::string version;
  std::string compiler;
  int threads = 1;
  int ranks = 1;
  int load_steps = 0;
  int newton_iterations = 0;
  std::string failure;                ///< why the run ended early; empty if it did not
  std::vector<std::string> warnings;  ///< warnings about scene and results
  std::string unchecked;              ///< why nothing is checked, unless there are no expected values
  std::vector<EndOfRun> ends;
  std::vector<FollowedQuantity> quantities;
  std::vector<FoundDerivative> gradients;
  std::vector<FoundNumberOfScene> found_numbers;
  std::vector<QuantityEnvelope> envelope;
  std::map<std::string, int> stable_cases;  ///< of a batch: number of cases that end "true", "false", ...
  std::vector<EstimatedErrors> estimated_errors;
  std::vector<ChosenMesh> chosen_meshes;
  std::map<std::string, double> rest_shape;  ///< results of the list "Inverse", by name
  std::map<std::string, double> seconds;     ///< phase of the run -> wall time

  /// Adds the cost of a run.
  void add_work(int steps, int iterations, const std::map<std::string, double>& times = {});

  /// Checks the quantity, stores it and returns whether it passed. Throws std::invalid_argument for a quantity without
  /// a source: a reference that cannot be looked up checks nothing.
  bool check(CheckedQuantity quantity);

  bool check_absolute(const std::string& name, double value, double reference, double tolerance,
                      const std::string& source);
  bool check_relative(const std::string& name, double value, double reference, double tolerance,
                      const std::string& source);
  bool check_expected(const std::string& name, double value, const ExpectedValue& expected);
  bool check_upper_bound(const std::string& name, double value, double bound, const std::string& source);
  /// Checks an absolute value plus its error; `not_estimated`: why the error is unknown, which fails the check.
  void check_limit(const std::string& name, const std::string& where, double size, double error,
                   const std::string& not_estimated, double limit);
  /// Compares a word.
  bool check_word(const std::string& name, const std::string& word, const std::string& reference,
                  const std::string& source);
  /// Adds a failed check for a quantity without a value. `reference`: the expected one.
  void fail(const std::string& name, const std::string& reference, const std::string& source,
            const std::string& remark);
  bool check_printed_digits(const std::string& name, double value, const std::string& printed,
                            const std::string& source, int units_in_last_place = 1);

  const std::vector<CheckedQuantity>& checks() const { return checks_; }
  /// Keeps the first `count` checks and discards the rest.
  void keep_checks(std::size_t count) { checks_.resize(count); }

  /// The worst stability of all ends: "false" if one is unstable, then "unknown", "neutral", "true"; empty: none known.
  std::string stable() const;

  /// True if no check failed and no run ended early; also if nothing was checked, which `print_checks` says.
  bool all_passed() const;

  /// Prints one line for each failed check, or for all if `every_check`, and the numbers of checks and warnings.
  void print_checks(std::ostream& stream, bool every_check = true) const;

  /// The additions of runs, serialized for another process.
  std::string packed() const;
  /// Adds the packed() additions of another process.
  void append(const std::string& packed);

  /// Writes everything as one JSON object; replaces `path` only when complete. Non-finite numbers become the strings
  /// "nan", "inf", "-inf". Throws std::runtime_error with path and reason.
  void write_json(const std::filesystem::path& path) const;

 private:
  std::vector<CheckedQuantity> checks_;
};

/// Whether Summary::write_json() has written this file.
bool holds_summary(const std::filesystem::path& file);

}  // namespace mixbeam
