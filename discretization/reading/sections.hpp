/// Cross sections of a scene: their parameters, and reading them.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <vector>

namespace mixbeam {

/// Declaration of one section: stiffness values, or a shape with a material, or a stiffness matrix.
ListSpec section_spec();

/// All sections of the validated list "Sections" that stands at `path`. Throws InputError.
std::vector<Section> read_sections(const Teuchos::ParameterList& sections, const ParameterSource& source,
                                   const ParameterPath& path);

}  // namespace mixbeam
