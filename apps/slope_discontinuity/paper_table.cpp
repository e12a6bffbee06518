#include "apps/slope_discontinuity/paper_table.hpp"

#include "apps/common/tables/printed_digits.hpp"

namespace mixbeam {

namespace {

struct Row {
  int order, elements_per_member;
  std::array<const char*, 3> displacement;  // digits of the manuscript, some more than its table shows
};

// Humer, Steinbrecher, Pechstein, table "Structure with slope discontinuity: components of the tip-displacement"
constexpr std::array<Row, 8> kRows = {{{1, 1, {"-1.519637", "-0.1870366", "-2.607832"}},
                                       {2, 1, {"-1.528034", "-0.1713543", "-2.470063"}},
                                       {3, 1, {"-1.535102", "-0.175832", "-2.484094"}},
                                       {4, 1, {"-1.535068", "-0.1758733", "-2.484223"}},
                                       {1, 8, {"-1.534489", "-0.1759337", "-2.485712"}},
                                       {2, 8, {"-1.53507", "-0.1758742", "-2.484215"}},
                                       {3, 8, {"-1.535072", "-0.1758755", "-2.484219"}},
                                       {4, 8, {"-1.535072", "-0.1758755", "-2.484219"}}}};

constexpr int kPrintedFigures = 6;

}  // namespace

std::array<std::string, 3> paper_tip_displacement(int order, int elements_per_member) {
  std::array<std::string, 3> printed;
  for (const Row& row : kRows) {
    if (row.order != order || row.elements_per_member != elements_per_member) continue;
    for (std::size_t i = 0; i < 3; ++i) printed[i] = rounded_to_figures(row.displacement[i], kPrintedFigures);
  }
  return printed;
}

}  // namespace mixbeam
