/// What a run says about the mesh that it chose for an accuracy.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Members with the same mesh together, the largest groups first.
std::vector<ChosenMesh::Members> members_by_mesh(const Scene& scene, const MeshChoice& choice);
/// "  members of order 6 with 4 elements each: rod"
void print_members(std::ostream& out, const std::vector<ChosenMesh::Members>& members);

/// Prints the meshes of a run, adds them to the summary and checks the estimated error against the wanted one.
void report_mesh(Application& app, const std::string& run, const AccurateRun& accurate);

}  // namespace mixbeam
