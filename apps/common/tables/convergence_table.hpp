/// Errors over a sequence of meshes, with the rate at which they fall: printed for people, returned for checks.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

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

  /// One error for each mesh, else std::invalid_argument. Returns the observed rate.
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
