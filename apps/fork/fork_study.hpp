/// The paper's study of the fork structure: what its parts share.
#pragma once

#include "apps/common/studies/study.hpp"

namespace mixbeam {

inline constexpr const char* kForkTableSource = "Humer, Steinbrecher, Pechstein, table \"Fork structure\"";

/// u1, u2, u3 of P1 as printed; empty texts where there is no such value.
using PrintedDisplacement = std::array<std::string, 3>;

/// The paper's values for configurations (1) and (2), as the manuscript gives them; its table shows 6 figures of them.
std::array<PrintedDisplacement, 2> paper_p1_displacement(int order, int elements_per_member);

/// Displacement of P1 under the first force and under both, and what they cost.
struct ForkSolution {
  std::array<Vector3, 2> p1;  ///< configurations (1) and (2)
  int steps = 0, iterations = 0;
};

/// The scene with the program's own choice of load steps.
ForkSolution solve_fork(Application& app, const Scene& scene);

/// Convergence with the exact semicircle and with a polygon in its place; convergence.csv.
void compare_representations(Application& app);

}  // namespace mixbeam
