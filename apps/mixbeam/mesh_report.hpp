/// Meshes chosen by the program, and their reports.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Property of a result file: how its mesh was chosen.
inline constexpr const char* kMeshProperty = "mesh chosen";

/// Groups of members with the same mesh, the largest first.
std::vector<ChosenMesh::Members> members_by_mesh(const Scene& scene, const MeshChoice& choice);
/// Prints "  order 6, elements 4: rod", ...
void print_members(std::ostream& out, const std::vector<ChosenMesh::Members>& members);

/// Prints the meshes of a run, adds them to the summary and checks the estimated error against the wanted one.
void report_mesh(Application& app, const std::string& run, const AccurateRun& accurate);

/// Chooses the mesh of a scene that names none and puts it into the application's scene: kAccuracyWithoutMesh is
/// reached in the first and the last of `count` cases (`case_of`: load cases, rows of a batch). Acts once; not if the
/// scene names its mesh.
void choose_mesh(Application& app, std::size_t count, const std::function<Scene(std::size_t)>& case_of);
/// Likewise for the load cases and combinations of the scene.
void choose_mesh(Application& app);

/// Puts a mesh chosen earlier into the application's scene.
void take_mesh(Application& app, const MeshChoice& mesh, const std::string& note);

/// The scene on the mesh of a result file. Throws InputError unless it fits this scene.
Scene on_mesh_of(const StoredRun& run, const Scene& scene);
/// Puts that mesh into an application's scene that names none; does nothing if the file has no steps.
void take_stored_mesh(Application& app, const StoredRun& run);

}  // namespace mixbeam
