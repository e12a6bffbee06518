/// Tables for the terminal: values of a paper beside our own, with differences; errors on a sequence of meshes, with
/// the observed rate, which is returned for checks.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// Agreement of a value with the paper's.
enum class Agreement {
  agrees,      ///< within the caller's tolerance
  differs,     ///< outside of it: marked in the table
  informative  ///< shown beside the paper's value, not compared
};

/// Value of the paper (or another reference) as printed, and ours. An empty `paper`: no value.
struct ComparedValue {
  std::string paper;
  double own = 0.0;
  Agreement agreement = Agreement::informative;
};

/// Collects rows and prints them aligned. Own values are written with the digits of the paper's, differences with two.
///
///     Arc-segment under out-of-plane force                                              (title)
///                                      u1                                u2             (quantities)
///       k  elements       paper   mixbeam  difference        paper  mixbeam  difference  (labels)
///       slenderness 10                                                                  (group)
///       1         4    -23.7513  -23.7512     5.0e-05      54.0950  54.0950     3.0e-05
class TablePrinter {
 public:
  /// `reference`: heading of the columns with reference values.
  TablePrinter(std::string title, std::vector<std::string> labels, std::vector<std::string> quantities,
               std::string reference = "paper");

  /// Starts a block of rows under a line of its own.
  void add_group(const std::string& heading);

  /// Adds a row; throws std::invalid_argument unless it has one cell per label and quantity.
  void add_row(const std::vector<std::string>& labels, const std::vector<ComparedValue>& values);

  /// Prints the table; rows out of tolerance have `*` after the differing values and `<- differs` at the end.
  void print(std::ostream& stream) const;

 private:
  struct Row {
    std::string heading;  // of a group; otherwise empty
    std::vector<std::string> cells;
    bool differs = false;
  };

  std::vector<std::size_t> column_widths() const;

  std::string title_;
  std::vector<std::string> labels_;
  std::vector<std::string> quantities_;
  std::string reference_;
  std::vector<Row> rows_;
};

/// Rate p of errors ~ elements^-p between two neighbouring meshes: the finest two before the error first falls below
/// `round_off`, where it no longer depends on the mesh. None if there are no two such meshes.
std::optional<double> observed_rate(const std::vector<int>& elements, const std::vector<double>& errors,
                                    double round_off);

/// A row for each element order, a column for each mesh.
///
///     Error of the centerline                                        (title)
///       k        8 el      16 el      32 el   rate
///       slenderness 10                                               (group)
///       1    1.47e-02   3.48e-03   8.59e-04   2.02
class ConvergenceTable {
 public:
  /// `elements`: of the meshes, ascending.
  ConvergenceTable(std::string title, std::vector<int> elements, double round_off);

  /// Starts a block of rows under a line of its own.
  void add_group(const std::string& heading);

  /// Adds one error per mesh, else throws std::invalid_argument. Returns the observed rate.
  std::optional<double> add_row(int order, const std::vector<double>& errors);

  void print(std::ostream& stream) const;

 private:
  struct Row {
    std::string heading;  // of a group; otherwise empty
    int order = 0;
    std::vector<double> errors;
    std::optional<double> rate;
  };

  std::string title_;
  std::vector<int> elements_;
  double round_off_;
  std::vector<Row> rows_;
};

}  // namespace mixbeam
