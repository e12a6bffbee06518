#include "apps/trade/benchmark.hpp"

#include "apps/common/run/scene_file.hpp"
#include "apps/common/studies/variants.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <tuple>

namespace mixbeam {

namespace {

/// In place of the values in the file of the helical rod, which are those of a coarse mesh: the finest row of the
/// paper's table, to half a unit of the last digit.
std::vector<ExpectedValue> limit_of_the_helical_rod() {
  const std::vector<std::tuple<const char*, double, double>> row = {
      {"x", 4.803e-3, 5.1e-7}, {"y", 7.250e-5, 5.1e-9}, {"z", -7.644e-2, 5.1e-6}};
  std::vector<ExpectedValue> limit;
  for (const auto& [component, value, tolerance] : row) {
    ExpectedValue& one = limit.emplace_back();
    one.name = std::string("tip, ") + component;
    one.point = "tip";
    one.quantity = "position";
    one.component = component;
    one.value = value;
    one.kind = ToleranceKind::absolute;
    one.tolerance = tolerance;
    one.source = "Humer, Steinbrecher, Pechstein, table of the rod bent to helical shape, k = 4";
  }
  return limit;
}

/// Elements of order 8 for each one of the file: what bends everywhere needs few, thin layers of bending many.
constexpr int kSmooth = 4, kLayers = 64;

std::vector<Benchmark> list_all() {
  std::vector<Benchmark> list;
  const auto add = [&list](const char* name, const std::string& file, const char* kind,
                           const char* point) -> Benchmark& {
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
  add("helical_rod", "helical_rod.xml", "space, ten turns, many load steps", "tip");
  add("composite_cantilever", "gallery/composite_cantilever.xml", "space, smooth, coupled section", "tip");
  add("slope_discontinuity", "slope_discontinuity.xml", "space, kinked", "tip");
  add("fork", "fork.xml", "space, branched, two stages", "P1");
  add("lateral_buckling", "lateral_buckling_positive.xml", "space, kinked strip, behind a bifurcation", "tip").branch =
      Branch::positive;
  add("narrow_cantilever", "narrow_cantilever.xml", "space, strip, behind a bifurcation", "tip").branch =
      Branch::positive;
  const auto add_scene = [&add](const std::string& name, const char* kind, int refinement = kSmooth) {
    Benchmark& scene = add(name.c_str(), "gallery/" + name + ".xml", kind, "");
    scene.in_gallery = true;
    scene.refinement = refinement;
  };
  add_scene("elastica", "plane, smooth, rigid in force strains");
  add_scene("follower_cantilever", "plane, a force that turns with the section");
  add_scene("composite_cantilever", "space, coupled section");
  add_scene("deployable_ring", "space, closed loop, turned by its support");
  add_scene("coil_spring", "space, helix of six turns, guided");
  add_scene("shallow_arch", "plane, two arcs, hinged");
  add_scene("bistable_strip", "plane, two arcs, through a snap");
  add_scene("lees_frame", "plane, kinked, close to its limit load");
  add_scene("snap_back", "plane, kinked, two limit points");
  add_scene("lateral_buckling", "space, kinked strip, behind a bifurcation");
  add_scene("catenary", "plane, cable, layers at the hooks", kLayers);
  add_scene("gripper", "space, branched, eigencurvature");
  add_scene("parallel_linkage", "plane, hinges, free of stress");
  add_scene("star_dome", "space frame of 24 members");
  add_scene("cable_net", "space, 60 ropes, prestressed, two stages", kLayers);
  add_scene("tree", "space, branched, two stages");
  add_scene("twisted_blade", "space, pre-twist, coupled section, two stages");
  add_scene("honeycomb", "plane, lattice");
  return list;
}

/// The scenes belong to applications with studies of their own, which do not matter here.
Application read_scene_of(const Application& app, const std::string& file) {
  ApplicationDefinition definition;
  definition.name = app.name;
  definition.study = ListSpec("Of another application.").without_checks();
  Application read;
  read.communicator = app.communicator;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "trade_benchmarks";
  read_scene_file(read, (folder / file).string(), definition);
  return read;
}

}  // namespace

std::vector<Benchmark> benchmarks_of(bool gallery) {
  static const std::vector<Benchmark> list = list_all();
  std::vector<Benchmark> chosen;
  std::copy_if(list.begin(), list.end(), std::back_inserter(chosen),
               [gallery](const Benchmark& one) { return one.in_gallery == gallery; });
  return chosen;
}

Scene BenchmarkProblem::with(const Discretization& mesh) const {
  Scene changed = scene;
  const int own = own_elements();
  for (Member& member : changed.members) {
    member.order = mesh.order;
    member.elements = about.in_gallery ? (member.elements * mesh.elements + own - 1) / own : mesh.elements;
    member.force_integration = mesh.integration;
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
  for (const ExpectedValue& value : file.expected) {
    const int stages = problem.scene.stages;
    const bool on_path = value.critical_point || value.load_factor.value_or(stages) != stages;
    if (on_path && benchmark.in_gallery) problem.expected_on_path.push_back(value);
    if (!on_path && value.load_case == benchmark.load_case && benchmark.load_share == 1.0)
      problem.expected.push_back(value);
  }
  if (benchmark.name == "helical_rod") problem.expected = limit_of_the_helical_rod();
  if (benchmark.in_gallery) return problem;
  if (benchmark.point.empty() && problem.scene.point_loads.empty())
    throw InputError("the study judges the displacement of the first loaded point; the scene has no point load");
  if (benchmark.point.empty()) problem.about.point = problem.scene.point_loads.front().point;
  if (benchmark.branch != Branch::primary) problem.solver.analysis.branch = benchmark.branch;
  problem.solver.analysis.stability = problem.solver.analysis.branch != Branch::primary;
  return problem;
}

namespace {

using vector_algebra::distance;
using vector_algebra::norm;

/// More than the k + 1 that are exact for what an element can represent: the reference is no such polynomial.
constexpr int kMoreGaussPoints = 4;
/// Steps end at load factors that are asked for, but for rounding.
constexpr double kSameLoad = 1e-12;

double energy_of(const Simulation& simulation) {
  const StrainEnergy energy = simulation.strain_energy();
  return energy.force + energy.moment;
}

int gauss_points(const Simulation& simulation) { return simulation.scene().members.front().order + kMoreGaussPoints; }

Simulation solved(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& mesh,
                  PathTrace& trace) {
  Simulation simulation(problem.with(mesh), problem.solver, communicator);
  simulation.run([&](const StepReport& report, const State&) { trace.add(simulation, report); });
  if (!simulation.result().finished)
    throw ConvergenceError("no reference for " + problem.about.name + ", order " + std::to_string(mesh.order) + ", " +
                           std::to_string(mesh.elements) + " elements for each member: " + simulation.result().failure);
  return simulation;
}

std::vector<std::string> judged_points(const BenchmarkProblem& problem, const Simulation& simulation) {
  if (!problem.about.in_gallery) return {problem.about.point};
  std::vector<std::string> points;
  for (const auto& [name, vertex] : simulation.model().mesh().vertex_of_point) points.push_back(name);
  return points;
}

}  // namespace

double largest_error(const Errors& errors) {
  for (const double error : errors)
    if (std::isnan(error)) return error;
  return *std::max_element(errors.begin(), errors.end());
}

double motion_error(const Errors& errors) {
  return std::isnan(errors[kDisplacement]) ? std::nan("") : std::max(errors[kDisplacement], errors[kCenterline]);
}

Errors estimated_errors(const Simulation& simulation, const std::string& point) {
  const ErrorEstimate estimate = simulation.estimate_error();
  if (!estimate.exists()) return kNoErrors;
  const Vector3 error = estimate.vertex_displacement.at(vertex_of(simulation.model().mesh(), point));
  return {norm(error) / norm(simulation.displacement(point)), estimate.displacement.relative(),
          estimate.moment.relative(), std::abs(estimate.energy.relative())};
}

PathTrace::PathTrace(const BenchmarkProblem& problem) {
  for (const ExpectedValue& value : problem.expected_on_path)
    if (!value.critical_point && !value.point.empty()) wanted_.push_back(value);
}

void PathTrace::add(const Simulation& simulation, const StepReport& report) {
  for (const CriticalPoint& point : report.critical_points) critical_loads_.push_back(point.load_factor);
  for (const ExpectedValue& value : wanted_)
    if (std::abs(report.load_factor - *value.load_factor) <= kSameLoad)
      displacements_.push_back(simulation.displacement(value.point));
}

double PathTrace::error_against(const PathTrace& exact, double displacement) const {
  if (critical_loads_.size() != exact.critical_loads_.size() || displacements_.size() != exact.displacements_.size() ||
      (critical_loads_.empty() && displacements_.empty()))
    return std::nan("");
  double size = 0.0, error = 0.0;
  for (const double load : exact.critical_loads_) size = std::max(size, std::abs(load));
  for (size_t i = 0; i < critical_loads_.size(); ++i)
    error = std::max(error, std::abs(critical_loads_[i] - exact.critical_loads_[i]) / size);
  for (size_t i = 0; i < displacements_.size(); ++i)
    error = std::max(error, distance(displacements_[i], exact.displacements_[i]) / displacement);
  return error;
}

Reference::Reference(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& reference,
                     const Discretization& confirmation)
    : trace(problem),
      simulation(solved(problem, communicator, reference, trace)),
      points(judged_points(problem, simulation)) {
  const int gauss = gauss_points(simulation);
  scale = {problem.about.in_gallery ? largest_displacement(simulation.model(), simulation.state())
                                    : norm(simulation.displacement(problem.about.point)),
           simulation.l2_norm(gauss, [](const PointSample& sample, int) { return sample.displacement; }),
           simulation.l2_norm(gauss, [](const PointSample& sample, int) { return sample.moment; }),
           energy_of(simulation)};
  PathTrace ignored(problem);
  difference = errors_of(solved(problem, communicator, confirmation, ignored));
}

Errors Reference::errors_of(const Simulation& other) const {
  const int gauss = gauss_points(other);
  const auto exact = [&](const PointSample& sample, int member) {
    const double length = simulation.model().mesh().member_length[member];
    return sample_member(simulation.model(), simulation.state(), member, sample.arc_length / length);
  };
  Errors errors{};
  for (const std::string& point : points)
    errors[kDisplacement] =
        std::max(errors[kDisplacement], distance(other.displacement(point), simulation.displacement(point)));
  errors[kCenterline] = other.l2_norm(gauss, [&](const PointSample& sample, int member) {
    return sample.displacement - exact(sample, member).displacement;
  });
  errors[kMoment] = other.l2_norm(
      gauss, [&](const PointSample& sample, int member) { return sample.moment - exact(sample, member).moment; });
  errors[kEnergy] = std::abs(energy_of(other) - scale[kEnergy]);
  for (int i = 0; i < kErrors; ++i) errors[i] /= scale[i];
  return errors;
}

}  // namespace mixbeam
