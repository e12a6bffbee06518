/// Compliances of elements with coupled or varying sections, where the kernels read them.
#pragma once

#include "discretization/mesh/mesh.hpp"
#include "discretization/scene/section_law.hpp"
#include "kernels/loops/block.hpp"

#include <memory>
#include <vector>

namespace mixbeam {

/// (member): the section of those that need general elements, null for all others.
using MemberLaws = std::vector<std::shared_ptr<const SectionLaw>>;

/// Throws InputError that names the member for what SectionLaw rejects, and where a general section meets another
/// integration rule than "both reduced", the only one whose force points see M exactly.
MemberLaws member_laws(const Scene& scene);

/// Fills ElementBlock::compliance of a block with general sections; `mesh_element`: of each element of the block.
/// Throws InputError that names the member where a taper has no compliance.
void fill_compliance(const Scene& scene, const Mesh& mesh, const MemberLaws& laws, const int* mesh_element,
                     ElementBlock& block);

}  // namespace mixbeam
