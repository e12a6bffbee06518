/// The table of sweeps: which quantity, which values, which scene and closed form for a value.
#pragma once

#include "apps/extremes/cantilever.hpp"

#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

/// One value of a sweep: what is solved, and how it is judged.
struct Trial {
  Scene scene;
  SolverParameters solver;
  std::function<double(const Simulation&)> error{};  ///< of the end; empty: critical load factors are judged
  std::vector<double> critical{};                    ///< load factors of all critical points
};

struct Sweep {
  std::string name;  ///< in tables and files: snake_case; what it is about tells apps/plots/extremes.py
  std::vector<double> values;
  double allowed;      ///< error that is promised ...
  double from, to;     ///< ... for values in this range; the others are recorded only
  std::string source;  ///< of the closed form
  std::function<Trial(const Scene&, const SolverParameters&, double value)> trial;
};

/// Sweeps of the cantilever, in the order of the page. `most_elements`: end of the one over the number of elements.
std::vector<Sweep> all_sweeps(int most_elements);
/// Of structures whose critical load factors have a closed form: the rise of a truss of two bars that snaps through,
/// and the axial stiffness of a rail that is heated to three times its critical temperature and followed on its branch.
std::vector<Sweep> critical_sweeps();

}  // namespace mixbeam
