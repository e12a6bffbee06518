/// Scenes whose members, loads and supports keep to one plane: they are solved with three unknowns per vertex.
#pragma once

#include "discretization/assembly/line_fields.hpp"
#include "discretization/constraints/conditions.hpp"
#include "discretization/mesh/tpetra_types.hpp"
#include "kernels/loops/planar_block.hpp"

#include <optional>

namespace mixbeam {

/// The plane that everything keeps to, with the normal along g2 or g3 of the first element: members lie in it and have
/// g2 or g3 along its normal; forces and prescribed displacements are in it, moments and prescribed rotations about its
/// normal, axes of supports and joints in it or along its normal. Sections are plain and constant, force strains
/// integrated with k points, and there are no line loads or eigenstrains. None otherwise. Collective.
std::optional<PlaneAxes> plane_of(const Teuchos::Comm<int>& comm, const Mesh& mesh, const Structure& structure,
                                  const LineFields& line_fields, const Conditions& conditions);

}  // namespace mixbeam
