/// Members that only tension stiffens under their loads: cables.
#pragma once

#include "discretization/assembly/model.hpp"

#include <vector>

namespace mixbeam {

/// Smallest bending stiffness of a section [force x length^2]; infinite for coupled sections.
double bending_of(const Section& section);

/// Whether a member of this section is limp in a structure of this length [length] under this load [force].
bool is_limp(const Section& section, double load, double length);

/// Returns the sections that members have at their start or end.
std::vector<const Section*> sections_of_members(const Scene& scene);

/// Whether some member is limp under the loads that act at a load factor. Collective.
bool has_limp_members(const Model& model, const State& state, double load_factor);

}  // namespace mixbeam
