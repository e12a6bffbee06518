/// The paper's study of the fork structure, in four parts.
#pragma once

#include "apps/common/studies/study.hpp"

namespace mixbeam {

/// Displacement of P1 under the first force and under both, and what they cost.
struct ForkSolution {
  std::array<Vector3, 2> p1;  ///< configurations (1) and (2)
  int steps = 0, iterations = 0;
};

/// The scene with the program's own choice of load steps.
ForkSolution solve_fork(Application& app, const Scene& scene);

/// Orders and meshes beside the paper's table; table.csv.
void compare_with_table(Application& app);

/// Convergence with the exact semicircle and with a polygon in its place; convergence.csv.
void compare_representations(Application& app);

/// Both orders of loading are mirror images on the way and agree at the end; load_displacement.csv.
void compare_load_orders(Application& app);

}  // namespace mixbeam
