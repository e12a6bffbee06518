/// The summary of a run: every quantity that was checked against a reference, and what the run cost. Printed for
/// people, written as JSON for scripts.
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

/// How a value is held against its reference.
enum class Comparison {
  absolute,        ///< |value - reference| <= tolerance
  relative,        ///< |value - reference| <= tolerance * |reference|
  upper_bound,     ///< value <= reference; the tolerance is not used
  printed_digits,  ///< equal in every digit that the source prints; the tolerance counts units of the last one
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
  std::string word{};    ///< the value where it is a word
  std::string remark{};  ///< why there is no value
};

/// True when the quantity's value agrees with its reference; false for values that are not finite.
/// Throws std::invalid_argument when the reference is no number, the tolerance negative or not finite.
bool agrees(const CheckedQuantity& quantity);

/// Estimated discretization errors at the end of a run.
struct EstimatedErrors {
  struct Quantity {
    std::string name;  ///< "displacement, any vertex"
    double error = 0.0, relative = 0.0;
  };
  std::string run;            ///< which of several runs
  std::string not_estimated;  ///< why there is no estimate; empty where there is one
  std::vector<Quantity> quantities;
};

/// What it took to reach a wanted accuracy of displacements.
struct ChosenMesh {
  struct Members {
    std::string names;  ///< "rod", "left, right", "left, right and 12 more"
    int count = 0, order = 0, elements = 0;
  };
  struct Round {
    int elements = 0;
    bool followed = false;  ///< the whole path
    int steps = 0, iterations = 0;
    double seconds = 0.0, error = 0.0;
    std::string remark;
  };
  std::string run;  ///< which of several runs
  double wanted = 0.0, estimated = 0.0;
  std::string outcome;           ///< "reached", or why not
  std::vector<Members> members;  ///< those with the same mesh together
  std::vector<Round> rounds;     ///< meshes on the way
};

/// A quantity that the scene asks for, over the completed steps of a run.
struct FollowedQuantity {
  std::string run, name;
  double value = 0.0;  ///< at the end
  double at_largest_size = 0.0, load_factor_of_largest_size = 0.0;
  int step_of_largest_size = 0;
  std::string member{};     ///< where an extreme along members is, at the end; empty for others
  double arc_length = 0.0;  ///< [length]
  int side = 0;             ///< -1, 1: before, after a vertex
  std::string place{};      ///< of an extreme over several places, likewise
  double error = 0.0;       ///< estimated at the end, of the size; NaN: `not_estimated`, or none was asked for
  std::string not_estimated{};
};

/// Derivative of a quantity with respect to a number of the scene, at the end of a run.
struct FoundDerivative {
  std::string run, quantity;
  double value = 0.0;
  std::string number;  ///< its path
  double derivative = 0.0;
};

/// A number of the scene that was searched for, with its standard deviation (NaN, infinite: see SearchedNumber).
struct FoundNumberOfScene {
  std::string parameter, number;
  double start = 0.0, value = 0.0, deviation = 0.0;
  std::vector<double> covariance{};  ///< with all of them; empty without measurements
};

/// Largest and smallest value of a quantity at the ends of several runs, and in which of them.
struct QuantityEnvelope {
  std::string name;
  double largest = 0.0;
  std::string largest_in{};
  double smallest = 0.0;
  std::string smallest_in{};
};

/// Whether the last state of a run is stable, and what was before it.
struct EndOfRun : RecordedStability {
  std::string run{};  ///< which of several runs
  double load_factor = 0.0;
  std::vector<RecordedJump> jumps{};  ///< of its path
  std::string collapse{};  ///< first loss of stability on it, or the least factor of linear buckling, in words
};

/// Collects checks and costs during a run.
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
  std::vector<std::string> warnings;  ///< what should be known of the results
  std::string unchecked;              ///< why nothing is checked, where it is not for want of expected values
  std::vector<EndOfRun> ends;
  std::vector<FollowedQuantity> quantities;
  std::vector<FoundDerivative> gradients;
  std::vector<FoundNumberOfScene> found_numbers;
  std::vector<QuantityEnvelope> envelope;
  std::map<std::string, int> stable_cases;  ///< of a batch: how many cases end with each of the words
  std::vector<EstimatedErrors> estimated_errors;
  std::vector<ChosenMesh> chosen_meshes;
  std::map<std::string, double> rest_shape;  ///< what the list "Inverse" has found, by words
  std::map<std::string, double> seconds;     ///< phase of the run -> wall time

  /// Adds what a run took.
  void add_work(int steps, int iterations, const std::map<std::string, double>& times = {});

  /// Judges the quantity, keeps it and returns whether it passed. A quantity without a source is refused
  /// (std::invalid_argument): a reference that cannot be looked up checks nothing.
  bool check(CheckedQuantity quantity);

  bool check_absolute(const std::string& name, double value, double reference, double tolerance,
                      const std::string& source);
  bool check_relative(const std::string& name, double value, double reference, double tolerance,
                      const std::string& source);
  bool check_expected(const std::string& name, double value, const ExpectedValue& expected);
  bool check_upper_bound(const std::string& name, double value, double bound, const std::string& source);
  /// Of a size with its error; `not_estimated`: why that is not known, which fails the check.
  void check_limit(const std::string& name, const std::string& where, double size, double error,
                   const std::string& not_estimated, double limit);
  /// For a value that is a word.
  bool check_word(const std::string& name, const std::string& word, const std::string& reference,
                  const std::string& source);
  /// A quantity that never got a value: a check that failed. `reference`: what was expected.
  void fail(const std::string& name, const std::string& reference, const std::string& source,
            const std::string& remark);
  bool check_printed_digits(const std::string& name, double value, const std::string& printed,
                            const std::string& source, int units_in_last_place = 1);

  const std::vector<CheckedQuantity>& checks() const { return checks_; }
  /// Takes back all checks but the first ones.
  void keep_checks(std::size_t count) { checks_.resize(count); }

  /// The least certain of all ends: "false" where one is unstable, then "unknown", "neutral", "true"; empty: no run
  /// told.
  std::string stable() const;

  /// True when no check failed and the run did not end early; also when nothing was checked, which `print_checks` says.
  bool all_passed() const;

  /// One line for each check that failed, or for every check if `every_check`, and a closing line with the counts of
  /// checks and warnings.
  void print_checks(std::ostream& stream, bool every_check = true) const;

  /// What runs have added, to be sent to another process.
  std::string packed() const;
  /// Adds what runs of another process have added to the summary that was packed there.
  void append(const std::string& packed);

  /// Writes everything as one JSON object, replacing `path` only when complete. Numbers that are not finite become the
  /// strings "nan", "inf", "-inf". Throws std::runtime_error with path and reason.
  void write_json(const std::filesystem::path& path) const;

 private:
  std::vector<CheckedQuantity> checks_;
};

/// Whether a file is one that Summary::write_json() has written.
bool holds_summary(const std::filesystem::path& file);

}  // namespace mixbeam
