/// Patterns: copies of members and their points, so that lattices are short to write.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

namespace mixbeam {

/// Declaration of the list "Patterns".
ListSpec patterns_spec();

/// Applies the patterns of the validated list that stands at `path`, in their order, to a scene whose members are
/// complete and checked; a later pattern acts on the copies that earlier ones made.
///
/// Copy number i of "strut" is "strut (i)", that of a copy "strut (i, j)"; points likewise. A point of a copy that
/// coincides (to 1e-9 of the size of the structure) with a point that was there before this copy is that point, and a
/// member of a copy that coincides with a member that was there is not added again. Two such members must agree in
/// section, order and elements, and in the direction of axis 2 up to sign where the section has one.
/// Throws InputError.
void apply_patterns(const Teuchos::ParameterList& patterns, const ParameterSource& source, const ParameterPath& path,
                    Scene& scene);

}  // namespace mixbeam
