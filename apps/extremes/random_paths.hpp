/// Paths of random imperfect structures, held against the same paths in small steps.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/common/studies/imperfect_structures.hpp"
#include "apps/common/studies/judged_path.hpp"

#include <iosfwd>

namespace mixbeam {

struct RandomPath {
  ImperfectStructure structure{};
  JudgedPath path{};
  FollowedPath plain{};  ///< Newton's method for the whole load at once, without any check
  bool plain_is_right = false;
};

/// Follows this many structures with the solver's parameters of the scene; checks that no end is wrong and that few
/// are refused, of those whose reference is known. Writes random_paths.csv.
std::vector<RandomPath> run_random_paths(Application& app, int count, double reference_step);

/// The section of the page: a table of the families, and each path that is not right.
void write_random_paths(std::ostream& page, const std::vector<RandomPath>& paths);

}  // namespace mixbeam
