#include "apps/trade/benchmark.hpp"

#include "apps/common/run/scene_file.hpp"
#include "apps/common/studies/asked_path.hpp"
#include "apps/common/studies/variants.hpp"
#include "discretization/scene/load_cases.hpp"

#include <algorithm>
#include <filesystem>

namespace mixbeam {

namespace {

/// The finest row of the paper's table, to half a unit of the last digit.
std::vector<ExpectedValue> limit_of_the_helical_rod() {
  const auto tip = [](const std::string& component, double value, double tolerance) {
    return ExpectedValue{"tip, " + component,
                         "position",
                         "tip",
                         component,
                         {},
                         value,
                         tolerance,
                         ToleranceKind::absolute,
                         "Humer, Steinbrecher, Pechstein, table of the rod bent to helical shape, k = 4"};
  };
  return {tip("x", 4.803e-3, 5.1e-7), tip("y", 7.250e-5, 5.1e-9), tip("z", -7.644e-2, 5.1e-6)};
}

std::vector<Benchmark> list_benchmarks() {
  std::vector<Benchmark> list;
  const auto add = [&list](const char* name, const char* file, const char* kind, const char* point) -> Benchmark& {
    list.push_back({name, file, kind, point});
    return list.back();
  };
  add("thick_cantilever", "", "plane, smooth, thick", "").rates = true;
  add("elastica", "elastica.xml", "plane, smooth, rigid in force strains", "tip").load_case = "alpha 10";
  add("rollup", "rollup.xml", "plane, two full circles, slender", "tip").integrations = true;
  add("follower_force", "follower_force.xml", "plane, smooth, unsymmetric tangent", "tip").load_case = "alpha 10";
  Benchmark& column = add("euler_column", "euler_column.xml", "plane, smooth, behind a bifurcation", "tip");
  column.load_case = "100 degrees";
  column.branch = Branch::positive;
  add("lee_frame", "lee_frame.xml", "plane, kinked", "loaded").load_share = 0.5;  // first limit point at 0.6186
  add("deep_arch", "deep_arch.xml", "plane, arch of 215 degrees", "crown").load_share = 0.5;  // limit point at 0.8973
  add("arc_45_slender", "arc_45_slender.xml", "space, curved, slenderness 10,000", "tip").integrations = true;
  add("arc_45_thick", "arc_45_thick.xml", "space, curved, slenderness 10", "tip").rates = true;
  add("helix", "helix.xml", "space, two coils, constant strains", "tip");
  add("helical_rod", "helical_rod.xml", "space, ten turns, many load steps", "tip").limit = limit_of_the_helical_rod();
  add("composite_cantilever", "gallery/composite_cantilever.xml", "space, smooth, coupled section", "tip");
  add("slope_discontinuity", "slope_discontinuity.xml", "space, kinked", "tip");
  add("fork", "fork.xml", "space, branched, two stages", "P1");
  add("lateral_buckling", "lateral_buckling_positive.xml", "space, kinked strip, behind a bifurcation", "tip").branch =
      Branch::positive;
  add("narrow_cantilever", "narrow_cantilever.xml", "space, strip, behind a bifurcation", "tip").branch =
      Branch::positive;
  return list;
}

/// Elements of order 8 for each one of the file: what bends everywhere needs few, thin layers of bending many.
constexpr int kSmooth = 4, kLayers = 64;

std::vector<Benchmark> list_scenes() {
  std::vector<Benchmark> list;
  const auto add = [&list](const std::string& name, const char* kind, int refinement = kSmooth) {
    Benchmark scene{name, "gallery/" + name + ".xml", kind, ""};
    scene.in_gallery = true;
    scene.refinement = refinement;
    list.push_back(scene);
  };
  add("elastica", "plane, smooth, rigid in force strains");
  add("follower_cantilever", "plane, a force that turns with the section");
  add("composite_cantilever", "space, coupled section");
  add("deployable_ring", "space, closed loop, turned by its support");
  add("coil_spring", "space, helix of six turns, guided");
  add("shallow_arch", "plane, two arcs, hinged");
  add("bistable_strip", "plane, two arcs, through a snap");
  add("lees_frame", "plane, kinked, close to its limit load");
  add("snap_back", "plane, kinked, two limit points");
  add("lateral_buckling", "space, kinked strip, behind a bifurcation");
  add("catenary", "plane, cable, layers at the hooks", kLayers);
  add("gripper", "space, branched, eigencurvature");
  add("parallel_linkage", "plane, hinges, free of stress");
  add("star_dome", "space frame of 24 members");
  add("cable_net", "space, 60 ropes, prestressed, two stages", kLayers);
  add("tree", "space, branched, two stages");
  add("twisted_blade", "space, pre-twist, coupled section, two stages");
  add("honeycomb", "plane, lattice");
  return list;
}

/// The scenes belong to applications with studies of their own, which do not matter here.
Application read_scene_of(const Application& app, const std::string& file) {
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "trade_benchmarks";
  ApplicationDefinition definition;
  definition.name = app.name;
  definition.study = ListSpec("Of another application.").without_checks();
  Application read;
  read.communicator = app.communicator;
  read_scene_file(read, (folder / file).string(), definition);
  return read;
}

/// Values at the end of the whole path that any run can be compared with, and those at critical points and short of it.
void sort_expected(const std::vector<ExpectedValue>& expected, BenchmarkProblem& problem) {
  const Benchmark& about = problem.about;
  for (const ExpectedValue& value : expected) {
    const bool on_path =
        value.critical_point || value.load_factor.value_or(problem.scene.stages) != problem.scene.stages;
    if (on_path && about.in_gallery) problem.expected_on_path.push_back(value);
    if (!on_path && value.load_case == about.load_case && about.load_share == 1.0) problem.expected.push_back(value);
  }
  if (!about.limit.empty()) problem.expected = about.limit;
}

std::string loaded_point(const Scene& scene) {
  if (scene.point_loads.empty())
    throw InputError("the study judges the displacement of the first loaded point; the scene has no point load");
  return scene.point_loads.front().point;
}

}  // namespace

const std::vector<Benchmark>& all_benchmarks() {
  static const std::vector<Benchmark> list = list_benchmarks();
  return list;
}

const std::vector<Benchmark>& all_scenes() {
  static const std::vector<Benchmark> list = list_scenes();
  return list;
}

Scene BenchmarkProblem::with(int order, int elements, ForceIntegration integration) const {
  Scene changed = with_mesh(scene, order, elements);
  const int own = own_elements();
  for (size_t m = 0; m < changed.members.size(); ++m) {
    changed.members[m].force_integration = integration;
    if (about.in_gallery) changed.members[m].elements = (scene.members[m].elements * elements + own - 1) / own;
  }
  return changed;
}

int BenchmarkProblem::own_elements() const {
  int most = 1;
  for (const Member& member : scene.members) most = std::max(most, member.elements);
  return most;
}

bool BenchmarkProblem::keeps_path() const {
  std::vector<ExpectedValue> values = expected;
  values.insert(values.end(), expected_on_path.begin(), expected_on_path.end());
  return asks_for_path(solver, values, about.load_case, scene);
}

BenchmarkProblem read_benchmark(const Application& app, const Benchmark& benchmark) {
  const Application file = benchmark.file.empty() ? app : read_scene_of(app, benchmark.file);
  BenchmarkProblem problem{benchmark, with_loads(scene_of_case(file.scene, benchmark.load_case), benchmark.load_share),
                           file.solver};
  sort_expected(file.expected, problem);
  if (benchmark.in_gallery) return problem;
  if (benchmark.point.empty()) problem.about.point = loaded_point(problem.scene);
  if (benchmark.branch != Branch::primary) problem.solver.analysis.branch = benchmark.branch;
  problem.solver.analysis.stability = problem.solver.analysis.branch != Branch::primary;
  return problem;
}

}  // namespace mixbeam
