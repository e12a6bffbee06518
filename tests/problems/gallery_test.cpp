// Every scene of the gallery, whatever it uses, and some that use more: turned and shifted in space, in other units and
// by another linear solver, it gives the turned, the scaled and the same answer.
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/scene/load_cases.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/solve.hpp"

#include <filesystem>

namespace mixbeam::test {
namespace {

// Both sides are solved to a scaled residual of 1e-11; lengths relative to the size of the structure.
constexpr double kSameAnswer = 1e-10;

struct GalleryScene {
  Scene scene;
  SolverParameters solver;
};

std::vector<std::filesystem::path> gallery_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(MIXBEAM_SOURCE_DIR "/apps/gallery"))
    if (entry.path().extension() == ".xml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The first load case of a scene that has several.
GalleryScene read_gallery_scene(const std::filesystem::path& file) {
  XmlParameters xml = read_parameters(file.string(), {});
  import_entries(xml.list->sublist("Scene"), xml.source);
  Scene scene = read_scene(xml.list->sublist("Scene"), xml.source);
  if (!scene.load_cases.empty()) scene = scene_of_case(scene, scene.load_cases.front());
  SolverParameters solver = read_solver_parameters(xml.list->sublist("Solver"), xml.source);
  // branches are chosen by global axes, which do not turn with the scene
  if (xml.list->isSublist("Analysis"))
    solver.analysis.snap = read_analysis_parameters(xml.list->sublist("Analysis"), scene, xml.source).snap;
  return {scene, solver};
}

Mat3<double> vertex_turn(const Simulation& simulation, const std::string& point) {
  const Vector3 theta = simulation.rotation(point);
  return exp_matrix(Vec3<double>{{theta[0], theta[1], theta[2]}});
}

double largest_difference(const Mat3<double>& a, const Mat3<double>& b) {
  double largest = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(a(i, j) - b(i, j)));
  return largest;
}

/// Displacements of `there`, divided by `length`, and rotations are those of `here` turned by `rotation`.
void expect_same_answer(const Simulation& here, const Simulation& there, const Mat3<double>& rotation, double length) {
  const double size = characteristic_length(here.model().mesh());
  for (const auto& [point, vertex] : here.model().mesh().vertex_of_point) {
    Vector3 u = there.displacement(point);
    for (double& x : u) x /= length;
    EXPECT_TRUE(agrees(u, scene_change::turned(rotation, here.displacement(point)), kSameAnswer * size)) << point;
    const Mat3<double> expected = rotation * vertex_turn(here, point) * transpose(rotation);
    EXPECT_LE(largest_difference(vertex_turn(there, point), expected), kSameAnswer) << point;
  }
}

/// `apart`: iterations that rounding may decide about where springs stand beside rigid joints.
void expect_no_frame_no_units_and_no_solver(const Scene& scene, SolverParameters solver, int apart = 0) {
  const Simulation here = solved(scene, solver);
  const double size = characteristic_length(here.model().mesh());
  const Mat3<double> rotation = exp_matrix(Vec3<double>{{0.7, -1.9, 1.3}});
  const Simulation turned = solved(moved(rotation, {0.3 * size, -1.2 * size, 0.8 * size}, scene), solver);
  expect_same_answer(here, turned, rotation, 1.0);
  for (const double factor : {1e-6, 1e6}) {
    SCOPED_TRACE(factor);
    const Simulation scaled = solved(in_other_units(scene, factor, factor * factor * factor), solver);
    expect_same_answer(here, scaled, identity_matrix<double>(), factor);
    EXPECT_NEAR(scaled.result().newton_iterations, here.result().newton_iterations, apart);
  }
  solver.linear.method = kSparseSolver;  // the whole matrix, in place of condensed chains
  expect_same_answer(here, solved(scene, solver), identity_matrix<double>(), 1.0);
}

class Gallery : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(Gallery, KnowsNoFrameNoUnitsAndNoSolver) {
  const auto [scene, solver] = read_gallery_scene(GetParam());
  expect_no_frame_no_units_and_no_solver(scene, solver);
}

/// A frame with a kink, unequal bending stiffnesses and every kind of load that turns with the scene.
Scene frame_with_all_loads() {
  Scene scene = slope_discontinuity(3, 2);
  scene.sections[0].bending_stiffness = {20.0, 8.0};
  scene.members[0].second_axis = {0, 0.6, 0.8};
  scene.members[1].second_axis = {0, 0, 1};
  scene.members[2].second_axis = {1, 0, 0};
  scene.point_loads = {dead_load("tip", {-2, 0, -3}, {1, 0.5, 0}), follower_load("second corner", "leg 2", {1, 0, 2})};
  scene.distributed_loads = {{"leg 2", {0.5, 1.0, -1.5}, {0.3, 0, 0.2}, 1},
                             {"leg 3", {0, 1.0, -0.5}, {0.3, 0, 0.2}, 1, LoadFrame::follower}};
  scene.distributed_loads[1].force_formula[0] = "sin(3 * x)";
  scene.eigenstrains = {{"leg 1", {0.02, 0, 0}, {0.1, 0.2, -0.1}}};
  scene.eigenstrains[0].curvature_formula[0] = "0.2 * x";
  scene.supports[0].prescribed_displacement = {0.1, 0, -0.05};
  scene.supports[0].prescribed_rotation = {0.2, 0.3, -0.1};
  return scene;
}

/// Coupled across forces and moments.
Scene coupled_cantilever() {
  Scene scene = cantilever(section(1e4, 5e3, 100, 150), 3.0, 2, 8);
  scene.sections[0].matrix = Matrix6{{{1e4, 4e2, 0, 2e2, -1e2, 3e2},
                                      {4e2, 5e3, 1e3, 0, 2e2, 1e2},
                                      {0, 1e3, 4e3, 1e2, 3e2, 0},
                                      {2e2, 0, 1e2, 100, 30, -10},
                                      {-1e2, 2e2, 3e2, 30, 150, 20},
                                      {3e2, 1e2, 0, -10, 20, 200}}};
  scene.point_loads = {dead_load("tip", {10, 20, 30})};
  return scene;
}

TEST(OtherScenes, KnowNoFrameNoUnitsAndNoSolver) {
  for (const Scene& scene :
       {frame_with_all_loads(), portal_of_joints(2, 3, 2.0), arc_segment(1e6, 2, 8), coupled_cantilever()}) {
    SCOPED_TRACE(scene.name);
    expect_no_frame_no_units_and_no_solver(scene, {}, scene.joints.empty() ? 0 : 1);
  }
}

TEST(GalleryTwin, AnotherLoadGivesAnotherAnswer) {
  const auto [scene, solver] = read_gallery_scene(MIXBEAM_SOURCE_DIR "/apps/gallery/elastica.xml");
  const Simulation here = solved(scene, solver);
  Scene other = scene;
  for (PointLoad& load : other.point_loads) scene_change::scale(load.force, 1.001);
  const Simulation there = solved(other, solver);
  double largest = 0.0;
  for (const auto& [point, vertex] : here.model().mesh().vertex_of_point)
    largest = std::max(largest, distance(here.displacement(point), there.displacement(point)));
  EXPECT_GT(largest, kSameAnswer * characteristic_length(here.model().mesh()));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Gallery, testing::ValuesIn(gallery_files()), [](const auto& scene) {
  std::string name = scene.param.stem().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
});

}  // namespace
}  // namespace mixbeam::test
