/// Meshes that the program chooses, and what a run says about them.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Of a result file: how its mesh was chosen.
inline constexpr const char* kMeshProperty = "mesh chosen";

/// Members with the same mesh together, the largest groups first.
std::vector<ChosenMesh::Members> members_by_mesh(const Scene& scene, const MeshChoice& choice);
/// "  members of order 6 with 4 elements each: rod"
void print_members(std::ostream& out, const std::vector<ChosenMesh::Members>& members);

/// Prints the meshes of a run, adds them to the summary and checks the estimated error against the wanted one.
void report_mesh(Application& app, const std::string& run, const AccurateRun& accurate);

/// The mesh of a scene that names none: for kAccuracyWithoutMesh in the first and the last of `count` cases that share
/// it, `case_of`: load cases, rows of a batch. The scene of the application takes it. Once; nothing where the scene
/// names its mesh.
void choose_mesh(Application& app, std::size_t count, const std::function<Scene(std::size_t)>& case_of);
/// The same for the load cases and combinations of the scene.
void choose_mesh(Application& app);

/// A mesh that was chosen before, for the scene of an application.
void take_mesh(Application& app, const MeshChoice& mesh, const std::string& note);

/// The scene on the mesh of a result file. Throws InputError where it is not one of this scene.
Scene on_mesh_of(const StoredRun& run, const Scene& scene);
/// That mesh for the scene of an application which names none; nothing where the file has no steps.
void take_stored_mesh(Application& app, const StoredRun& run);

}  // namespace mixbeam
