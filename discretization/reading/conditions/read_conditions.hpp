/// The part of a scene that acts on the structure: supports, joints, loads, eigenstrains, load cases. Their parameters,
/// and reading them with every check that needs more than one parameter at a time.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>
#include <vector>

namespace mixbeam {

/// Declares the lists "Supports", "Joints", "Point Loads", ... inside the list "Scene".
void add_condition_lists(ListSpec& scene_spec);

/// Reads those lists from a validated list "Scene" that stands at `path`, into a scene that has all its points and
/// members. Throws InputError.
void read_conditions(const Teuchos::ParameterList& scene_list, const ParameterSource& source, const ParameterPath& path,
                     Scene& scene);

}  // namespace mixbeam
