#include "apps/common/run/quantity_values.hpp"
#include "apps/common/run/room_check.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/command_line.hpp"
#include "apps/common/session/machine_room.hpp"
#include "apps/common/studies/phase_costs.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/checks/mechanism.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "kernels/math/vector_algebra.hpp"
#include "nonlinear/linear/blas_setup.hpp"

#include <Teuchos_BLAS.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <ostream>
#include <set>
#include <sstream>
#include <vector>

namespace mixbeam {

namespace {

/// Extent and loads of larger scenes are computed on a mesh of this many elements; their sums differ by rounding.
constexpr long long kElementsForCheck = 20'000;

/// "0.35 s", "12 h".
std::string duration_text(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0;
  if (seconds >= 2 * kHour) return formatted("%.2g h", seconds / kHour);
  if (seconds >= 2 * kMinute) return formatted("%.2g min", seconds / kMinute);
  return formatted("%.2g s", seconds);
}

void print_needs(std::ostream& out, const Needs& needs, int ranks) {
  out << formatted("  members %lld, elements %lld, vertices %lld\n", needs.members, needs.elements, needs.vertices);
  out << formatted("  unknowns %lld, of which %lld inside the elements; equations to solve %lld\n", needs.unknowns(),
                   needs.interior, needs.unknowns() - needs.interior);
  out << "  memory of a run about " << bytes_text(needs.memory) << ", of which factors " << bytes_text(needs.factors)
      << "\n";
  if (ranks > 1)
    out << "  memory of each of " << ranks << " ranks about " << bytes_text(needs.memory_of_rank(ranks)) << "\n";
  out << "  result file about " << bytes_text(needs.file) << " and " << bytes_text(needs.file_per_step)
      << " for each step\n";
}

/// Operations and bytes moved per second on one thread of this machine.
struct Rates {
  double operations = 0.0, bytes = 0.0;
};

/// Shortest of several times [s], least disturbed by other processes.
template <class Action>
double seconds_of(const Action& action) {
  constexpr int kTimes = 4;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTimes; ++i) {
    const auto start = std::chrono::steady_clock::now();
    action();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

/// Measures a matrix product and a copy; takes some hundredths of a second.
Rates measured_rates() {
  constexpr int kSide = 128;
  constexpr std::size_t kNumbers = 1 << 22;  // beyond caches
  set_up_blas();                             // one thread
  const std::vector<double> a(kSide * kSide, 1.0), from(kNumbers, 1.0);
  std::vector<double> product(a.size()), to(kNumbers);
  const double of_product = seconds_of([&] {
    Teuchos::BLAS<int, double>().GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, kSide, kSide, kSide, 1.0, a.data(), kSide,
                                      a.data(), kSide, 0.0, product.data(), kSide);
  });
  const double of_copy = seconds_of([&] { std::copy(from.begin(), from.end(), to.begin()); });
  return {2.0 * kSide * kSide * kSide / of_product, 2.0 * sizeof(double) * kNumbers / of_copy};
}

/// Approximate share of both rates that element loops and fronts of networks reach.
constexpr double kShareOfRates = 0.5;

/// Estimated time of a Newton iteration [s], with elements as in a chain.
double iteration_seconds(const Scene& scene, const Needs& needs, bool planar) {
  std::vector<double> elements(kMaximumOrder + 1, 0.0);
  for (const Member& member : scene.members) elements[member.order] += member.elements;
  PhaseCost sum = {needs.network_operations, needs.network_bytes};
  for (int order = 1; order <= kMaximumOrder; ++order) {
    if (elements[order] == 0.0) continue;
    const PhaseCost cost = phase_costs(planar ? "planar" : "spatial", order).at(kWholeIteration);
    sum.flops += elements[order] * cost.flops;
    sum.bytes += elements[order] * cost.bytes;
  }
  const Rates rates = measured_rates();
  return (sum.flops / rates.operations + sum.bytes / rates.bytes) / kShareOfRates;
}

/// Prints the members whose elements or chains take longer than plain ones, and why.
void print_slow_members(std::ostream& out, const Scene& scene) {
  std::set<std::string> unsymmetric, kept;
  for (const DistributedLoad& load : scene.distributed_loads) {
    const bool has_couple =
        vector_algebra::norm(load.couple) > 0.0 || load.couple_formula != DistributedLoad().couple_formula;
    if (has_couple || load.frame == LoadFrame::follower) unsymmetric.insert(load.member);
  }
  for (const PointLoad& load : scene.point_loads)
    if (vector_algebra::norm(load.moment) > 0.0 || load.frame == LoadFrame::follower) kept.insert(load.point);
  const auto print = [&](const char* reason, const auto& holds) {
    std::vector<std::string> names;
    for (const Member& member : scene.members)
      if (holds(member)) names.push_back(member.name);
    if (!names.empty()) out << "  off the fast path by " << reason << ": " << quoted_list(names) << "\n";
  };
  print("a taper", [](const Member& m) { return !m.end_section.empty(); });
  print("a 6 x 6 matrix", [&](const Member& m) { return m.end_section.empty() && has_general_section(scene, m); });
  print("line loads without potential", [&](const Member& m) { return unsymmetric.count(m.name) > 0; });
  print("moments or followers at inner points", [&](const Member& m) {
    return std::any_of(m.inner_points.begin(), m.inner_points.end(),
                       [&](const InnerPoint& inner) { return kept.count(inner.point) > 0; });
  });
}

/// Relative rounding of sums that should vanish.
constexpr double kRoundingOfSums = 1e-12;

Vector3 without_rounding(Vector3 v, double size) {
  for (double& component : v)
    if (std::abs(component) < kRoundingOfSums * size) component = 0.0;
  return v;
}

/// Prints the bounding box of the undeformed members; returns its diagonal.
double print_extent(std::ostream& out, const Simulation& simulation) {
  const double length = simulation.model().mesh().total_length();
  vector_algebra::Box box;
  for (const MemberSamples& member : simulation.samples(kPointsByOrder))
    for (const Vector3& position : member.reference_position) box.enclose(position);
  const double size = box.diagonal();
  const Vector3 low = without_rounding(box.low, size), high = without_rounding(box.high, size);
  out << formatted("  total length %.10g, box (%.10g, %.10g, %.10g) to (%.10g, %.10g, %.10g)\n", length, low[0], low[1],
                   low[2], high[0], high[1], high[2]);
  return size;
}

/// Prints the resultants of the loads at the end of each stage, on the undeformed shape. `size`: of the structure.
void print_loads(std::ostream& out, Simulation& simulation, double size) {
  const StateSnapshot undeformed = snapshot_of(simulation.model(), simulation.state());
  for (int stage = 1; stage <= simulation.scene().stages; ++stage) {
    simulation.restore(undeformed, stage);
    const Balance sums = simulation.balance();
    const double force = vector_algebra::norm(sums.applied_force);
    const Vector3 f = without_rounding(sums.applied_force, force), c = without_rounding(sums.center, size);
    const Vector3 m = without_rounding(sums.applied_moment, vector_algebra::norm(sums.applied_moment) + force * size);
    out << formatted("  loads at the end of stage %d: force (%.6g, %.6g, %.6g), moment (%.6g, %.6g, %.6g)", stage, f[0],
                     f[1], f[2], m[0], m[1], m[2])
        << formatted(" about (%.6g, %.6g, %.6g)\n", c[0], c[1], c[2]);
  }
}

/// Prints load factors at which formulas reverse or jump; steps end there.
void print_turns(std::ostream& out, const Simulation& simulation) {
  constexpr int kMostShown = 20;
  int shown = 0;
  for (const LoadTurn& turn : simulation.model().clock().turns()) {
    if (turn.before <= 0.0 && turn.after <= 0.0) continue;
    if (turn.before >= simulation.scene().stages) break;
    if (++shown > kMostShown) continue;
    out << (shown == 1 ? "  amplitudes turn back or jump at load factor " : ", ")
        << formatted(turn.is_jump() ? "%.10g (a jump)" : "%.10g", turn.after);
  }
  if (shown > kMostShown) out << formatted(" and %d more", shown - kMostShown);
  if (shown > 0) out << "\n";
}

/// Solves for the initial motion; a run would report the same only at the end of its path.
void warn_of_unmoved_control(Application& app, const Simulation& simulation) {
  if (simulation.load_moves_control()) return;
  const MonitoredComponent& control = *app.solver.analysis.control;
  app.out()
      << "warning: \"Analysis / Control\": the load does not move point \"" << control.point << "\" along "
      << "xyz"[control.component] << " at first; the load is followed until it does, and the run fails (exit code "
      << "3) if it never does. If the structure buckles that way: \"Branch\" = \"positive\" in \"Analysis\", or a "
      << "small load along "
      << "xyz"[control.component] << " (a thousandth of the present one)\n";
}

/// Prints everything that needs a mesh; cost and extent only for the first load case.
void print_simulation(Application& app, const Scene& scene, const Needs& needs, bool first) {
  const Scene coarse = coarse_scene(scene, kElementsForCheck);
  Simulation simulation(coarse, app.solver, app.communicator);
  std::ostringstream unprinted;
  if (first) {
    app.out() << "  Newton iteration about "
              << duration_text(iteration_seconds(scene, needs, simulation.model().plane().has_value()))
              << " on one thread\n";
    print_slow_members(app.out(), scene);
  }
  const double size = print_extent(first ? app.out() : unprinted, simulation);
  print_loads(app.out(), simulation, size);
  print_turns(app.out(), simulation);
  warn_of_unmoved_control(app, simulation);
}

/// ", combination ULS"; empty for a scene without cases.
std::string case_words(const Scene& scene, const std::string& name) {
  if (name.empty()) return "";
  const bool is_case = std::find(scene.load_cases.begin(), scene.load_cases.end(), name) != scene.load_cases.end();
  return (is_case ? ", load case " : ", combination ") + name;
}

/// Prints the variables with their formulas.
void print_variables(Application& app) {
  const Teuchos::ParameterList& list = app.xml.list->sublist("Scene");
  if (!list.isSublist("Variables")) return;
  const Teuchos::ParameterList& variables = list.sublist("Variables");
  for (const std::string& name : names_of(variables)) {
    const ParameterValue written = written_value(variables.getEntry(name)).value;
    app.out() << "  variable " << name << formatted(" = %.10g", variables.get<double>(name))
              << (has_type(written, ParameterType::text) ? "  (" + excerpt(to_text(written)) + ")" : "") << "\n";
  }
}

void print_check(Application& app, const std::string& load_case, bool first) {
  Scene scene = scene_of_case(app.scene, load_case);
  MeshChoice start;
  if (scene.accuracy) {
    start = start_mesh(scene, *scene.accuracy, wants_vertices(scene, app.quantities));
    scene = on_mesh(scene, start);
  }
  std::ostream& out = app.out();
  out << (scene.name.empty() ? "scene" : scene.name) << case_words(app.scene, load_case) << "\n";
  if (first && scene.accuracy) {
    out << formatted("  start mesh for an accuracy of %.1e\n", *scene.accuracy);
    print_members(out, members_by_mesh(scene, start));
  }
  if (first && app.mesh_is_free) {
    out << formatted("  no mesh is given: a run chooses one for an accuracy of %.1e, from this one on\n",
                     kAccuracyWithoutMesh);
    print_members(out, members_by_mesh(scene, mesh_of(scene)));
  }
  const Needs needs = needs_of_run(app, scene, app.solver);
  if (first) {
    print_variables(app);
    if (!scene.units.empty()) out << "  units of length, force: " << excerpt(scene.units) << "\n";
    print_needs(out, needs, app.communicator->getSize());
  }
  if (first && scene.sections.size() == 1)
    out << "  section of all members: " << excerpt(scene.sections[0].name) << "\n";
  out << formatted("  sections %zu, supports %zu, joints %zu, point loads %zu, line loads %zu, eigenstrains %zu\n",
                   scene.sections.size(), scene.supports.size(), scene.joints.size(), scene.point_loads.size(),
                   scene.distributed_loads.size(), scene.eigenstrains.size());
  if (first && !app.quantities.empty())
    out << "  numbers asked for by quantities " << app.quantities.columns().size() << "\n";
  require_memory(app, scene, needs);
  print_simulation(app, scene, needs, first);
}

}  // namespace

void check_scene(Application& app, const std::optional<std::string>& load_case) {
  const std::vector<std::string> cases = load_case ? std::vector{*load_case} : chosen_cases(app.scene, {});
  require_reachable(app, cases);
  try {
    for (const std::string& one : cases) print_check(app, one, &one == &cases.front());
  } catch (const MemberError& error) {
    throw placed(app, error);
  }
  warn_of_scene(app);
  if (app.solver.analysis.modes.number > 0) return;  // supports may be missing
  const std::string skipped = check_supports(app.scene, app.xml.source);
  if (!skipped.empty()) app.out() << "warning: " << skipped << "\n";
}

int check_command(const Arguments& arguments) {
  const CommandLine line =
      read_command_line(arguments.count(), arguments.values.data(), {"--output", "--case", "--help"});
  if (!line.scene_file) throw InputError("a scene file is missing: mixbeam check SCENE.xml");
  return with_application("mixbeam", [&](Application& app) {
    if (line.output)
      write_undeformed([&] { return read_parameters(*line.scene_file, mixbeam_root_spec()); }, app.communicator,
                       *line.output, std::filesystem::path(*line.scene_file).stem().string(), line.load_case);
    read_scene_file(app, *line.scene_file, mixbeam_definition());
    describe_run(app, "mixbeam", {});
    check_scene(app, line.load_case);
    app.out() << *line.scene_file << ": in order\n";
    return 0;
  });
}

}  // namespace mixbeam
