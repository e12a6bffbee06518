/// Load cases and their combinations: alternatives that are solved one by one.
#pragma once

#include "discretization/scene/what_acts.hpp"

namespace mixbeam {

/// Names of all load cases, then of all combinations.
std::vector<std::string> alternatives(const Scene& scene);

/// The scene of one case or combination: its loads and prescribed motions and those without a case, no names of cases,
/// and the number of stages that these loads use. Supports stay, without motions prescribed in other cases. An empty
/// name keeps only loads of all cases. A combination scales loads, eigenstrains and prescribed motions of its cases.
/// Throws std::invalid_argument, with the nearest name, for a case the scene does not have.
Scene scene_of_case(const Scene& scene, const std::string& name);

/// Whether a support prescribes a motion other than zero.
inline bool prescribes_motion(const Support& support) { return ActingKind<Support>::acts(support); }

/// Largest stage of any load, eigenstrain or prescribed motion, at least 1.
int stages_in_use(const Scene& scene);

}  // namespace mixbeam
