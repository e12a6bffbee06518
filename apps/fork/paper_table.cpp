#include "apps/fork/paper_table.hpp"

namespace mixbeam {

namespace {

struct Row {
  int order, elements_per_member;
  std::array<std::array<const char*, 3>, 2> displacement;  // configurations (1) and (2), digits of the manuscript
};

// Humer, Steinbrecher, Pechstein, table "Fork structure: components of the tip-displacement at tine P1"
constexpr std::array<Row, 8> kRows = {{
    {1, 3, {{{"-1.084348", "-0.759430", "1.981360"}, {"-0.599783", "-0.731959", "1.465554"}}}},
    {2, 3, {{{"-1.088565", "-0.746239", "1.978099"}, {"-0.598926", "-0.727164", "1.479676"}}}},
    {3, 3, {{{"-1.088609", "-0.746318", "1.978403"}, {"-0.598811", "-0.727135", "1.479965"}}}},
    {4, 3, {{{"-1.088614", "-0.746307", "1.978303"}, {"-0.598829", "-0.727134", "1.479862"}}}},
    {1, 10, {{{"-1.088214", "-0.747378", "1.978359"}, {"-0.598936", "-0.727541", "1.478570"}}}},
    {2, 10, {{{"-1.088613", "-0.746306", "1.978299"}, {"-0.598830", "-0.727134", "1.479858"}}}},
    {3, 10, {{{"-1.088614", "-0.746307", "1.978302"}, {"-0.598829", "-0.727134", "1.479861"}}}},
    {4, 10, {{{"-1.088614", "-0.746307", "1.978301"}, {"-0.598829", "-0.727134", "1.479860"}}}},
}};

}  // namespace

std::array<PrintedDisplacement, 2> paper_p1_displacement(int order, int elements_per_member) {
  std::array<PrintedDisplacement, 2> printed;
  for (const Row& row : kRows) {
    if (row.order != order || row.elements_per_member != elements_per_member) continue;
    for (std::size_t c = 0; c < 2; ++c)
      for (std::size_t i = 0; i < 3; ++i) printed[c][i] = row.displacement[c][i];
  }
  return printed;
}

std::array<PrintedDisplacement, 2> prototype_p1_displacement(const std::string& representation) {
  if (representation == "polygon")
    return {{{"-1.083302", "-0.753566", "1.981053"}, {"-0.590690", "-0.728401", "1.463117"}}};
  return {{{"-1.095829", "-0.764450", "1.998650"}, {"-0.603967", "-0.740340", "1.483168"}}};
}

}  // namespace mixbeam
