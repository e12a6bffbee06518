/// The table of sweeps: which quantity, which values, which scene and closed form for a value.
#pragma once

#include "apps/extremes/cantilever.hpp"

#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

/// One value of a sweep: what is solved, and how. The closed form is in the cantilever.
struct Trial {
  Cantilever rod;
  SolverParameters solver;
};

struct Sweep {
  std::string name;       ///< in tables and files: snake_case
  std::string parameter;  ///< what is varied, as a heading
  std::string what;       ///< the scene, one sentence
  std::string source;     ///< of the closed form
  std::vector<double> values;
  std::function<Trial(const Cantilever&, const SolverParameters&, double value)> trial;
  double allowed;     ///< error that is promised ...
  double from, to;    ///< ... for values in this range; the others are recorded only
  std::string limit;  ///< why errors grow or runs end, one or two sentences
};

/// All sweeps in the order of the page. `most_elements`: end of the sweep over the number of elements.
std::vector<Sweep> all_sweeps(int most_elements);

}  // namespace mixbeam
