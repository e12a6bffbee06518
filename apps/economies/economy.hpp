/// What a scene does not use, and what it would cost to treat it in the general way.
#pragma once

#include "nonlinear/run/simulation.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// One way to get at an answer.
struct Way {
  std::string description;
  Scene scene;
  SolverParameters solver;
  bool estimates = false;  ///< the discretization error at the end
  bool records = false;    ///< a result file
};

/// Two ways to the same answer.
struct Economy {
  std::string name;    ///< snake_case
  Way plain, other;    ///< as shipped, and: the general way
  double tolerance;    ///< of the displacement at the tip, relative: what the two may differ by
  std::string remark;  ///< why they cost the same or differ; may be empty
};

/// Each feature unused as the program ships, against the same scene with the feature at rest in it (a load of zero, a
/// straight line given as a formula, ...). `rod`: a long straight cantilever with a load at its point "tip" that bends
/// and twists it.
std::vector<Economy> unused_features(const Scene& rod, const SolverParameters& solver);

}  // namespace mixbeam
