/// What others computed for the arc: the paper's table, and values from outside of it.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace mixbeam {

/// A row of the paper's table of tip displacements.
struct PaperRow {
  double slenderness;
  int order;
  int elements;
  std::array<std::string, 3> tip;  ///< u1, u2, u3 with 6 significant digits, as printed
};

/// All 24 rows, by slenderness.
const std::vector<PaperRow>& paper_table();
extern const std::string kPaperTable;  ///< source of the rows

/// A tip displacement computed without finite elements.
struct IndependentValue {
  std::string name;
  double slenderness;
  double force_factor;  ///< times the force of the paper
  bool shear_rigid, inextensible;
  std::array<std::string, 3> tip;
};

const std::vector<IndependentValue>& independent_values();
extern const std::string kIndependentSource;

}  // namespace mixbeam
