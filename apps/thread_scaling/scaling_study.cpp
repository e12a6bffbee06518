// Median time of one Newton iteration, phase by phase, against the number of threads.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/thread_scaling/chain_unit.hpp"
#include "apps/thread_scaling/measurement.hpp"
#include "apps/thread_scaling/separate_process.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/execution/pack.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace mixbeam {

namespace {

constexpr const char* kPlanar = "planar";
constexpr const char* kSpatial = "spatial";
constexpr double kLargestCount = 1e7;
/// Least share of the processor at which times in seconds are reliable.
constexpr double kIdleMachine = 0.95;

/// Measures in a separate process, unless there are several MPI ranks.
std::string measured_apart(const Application& app, const std::function<std::string()>& work) {
  return app.communicator->getSize() == 1 ? in_separate_process(work) : work();
}

/// Number of threads -> ceilings.
using CeilingsByThreads = std::map<int, MachineCeilings>;

CeilingsByThreads ceilings_of(const Application& app, const std::vector<int>& threads) {
  CeilingsByThreads ceilings;
  StudyTable table(app, "ceilings.csv", {"threads", "flops_per_second", "bytes_per_second"}, 3);
  for (int n : threads) {
    const std::string text = measured_apart(app, [n] {
      const MachineCeilings of_threads = measure_ceilings(n);
      return formatted("%.17g %.17g", of_threads.flops_per_second, of_threads.bytes_per_second);
    });
    std::istringstream(text) >> ceilings[n].flops_per_second >> ceilings[n].bytes_per_second;
    table.add_row({n, ceilings[n].flops_per_second, ceilings[n].bytes_per_second});
  }
  return ceilings;
}

/// Load average: work of other processes on the machine.
std::string load_average() {
  double load = 0.0;
  return getloadavg(&load, 1) == 1 ? CsvCell(load).text : "unknown";
}

constexpr int kElementsOfStrut = 2;
constexpr double kSlenderness = 20.0;  ///< length over radius of gyration
/// Force over EI / l^2: strains stay below a percent in cubes of a hundred cells.
constexpr double kForce = 1e-4;

/// Junctions are all places of a grid, or those with an even sum of coordinates; struts run from each along these
/// steps.
struct LatticeKind {
  std::vector<std::array<int, 3>> steps;
  bool even = false, flat = false;
  double struts_per_place = 0.0;  ///< in the interior
};

const std::map<std::string, LatticeKind>& kinds() {
  static const std::map<std::string, LatticeKind> all = {
      {"cubic", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, false, false, 3.0}},
      {"octet", {{{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}}, true, false, 3.0}},
      {"sheet", {{{1, 0, 0}, {0, 1, 0}}, false, true, 2.0}}};
  return all;
}

class Grid {
 public:
  Grid(const LatticeKind& kind, int side) : kind_(kind), side_(side), height_(kind.flat ? 1 : side) {}

  bool has(const std::array<int, 3>& at) const {
    const bool inside = at[0] >= 0 && at[0] < side_ && at[1] >= 0 && at[1] < side_ && at[2] >= 0 && at[2] < height_;
    return inside && (!kind_.even || (at[0] + at[1] + at[2]) % 2 == 0);
  }

  template <class Visit>
  void for_each(const Visit& visit) const {
    for (int i = 0; i < side_; ++i)
      for (int j = 0; j < side_; ++j)
        for (int k = 0; k < height_; ++k)
          if (has({i, j, k})) visit(std::array<int, 3>{i, j, k});
  }

  bool is_first(const std::array<int, 3>& at) const { return at[0] == 0; }
  bool is_last(const std::array<int, 3>& at) const { return at[0] == side_ - 1; }

 private:
  const LatticeKind& kind_;
  int side_, height_;
};

std::string name_of(const std::array<int, 3>& at) {
  return std::to_string(at[0]) + " " + std::to_string(at[1]) + " " + std::to_string(at[2]);
}

/// "cubic", "octet" (of face-centred cubes), "sheet" (squares in the plane of x and y).
const std::vector<std::string>& lattice_kinds() {
  static const std::vector<std::string> names = {"cubic", "octet", "sheet"};
  return names;
}

/// Makes a lattice of equal struts, whose junctions remain after the chains are eliminated, with about `elements`
/// elements, two per strut. Struts have the first section of `scene` and a slenderness of 20. Junctions on one side are
/// clamped; each on the opposite side carries a small transverse force.
Scene lattice_scene(const Scene& scene, const std::string& name, int elements, int order) {
  const LatticeKind& kind = kinds().at(name);
  const double places = elements / (kElementsOfStrut * kind.struts_per_place);
  const Grid grid(kind, std::max(2, static_cast<int>(std::lround(kind.flat ? std::sqrt(places) : std::cbrt(places)))));
  const Section& section = scene.sections.front();
  const double bending = section.bending_stiffness[0];
  const double length = kSlenderness * std::sqrt(bending / section.axial_stiffness);
  const std::array<int, 3>& step = kind.steps.front();
  const double spacing = length / std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);

  Scene lattice;
  lattice.name = name;
  lattice.sections = {section};
  grid.for_each([&](const std::array<int, 3>& at) {
    lattice.points.push_back({name_of(at), {spacing * at[0], spacing * at[1], spacing * at[2]}});
    if (grid.is_first(at)) lattice.supports.push_back(support_of(name_of(at), {true, true, true}, {true, true, true}));
    if (grid.is_last(at)) {
      PointLoad load;
      load.point = name_of(at);
      load.force = {0, 0, kForce * bending / (length * length)};
      lattice.point_loads.push_back(load);
    }
    for (const std::array<int, 3>& way : kind.steps) {
      const std::array<int, 3> end = {at[0] + way[0], at[1] + way[1], at[2] + way[2]};
      if (!grid.has(end) || (grid.is_first(at) && grid.is_first(end))) continue;
      lattice.members.push_back(straight_member(name_of(at), name_of(end), section.name, order, kElementsOfStrut));
    }
  });
  return lattice;
}

bool is_lattice(const std::string& kind) {
  const std::vector<std::string>& kinds = lattice_kinds();
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

/// Writes the tables of the study, case by case; unknown values are NaN.
class ScalingTables {
 public:
  ScalingTables(const Application& app, CeilingsByThreads ceilings)
      : app_(app),
        ceilings_(std::move(ceilings)),
        phases_(app, "thread_scaling.csv",
                {"kind", "elements", "order", "threads", "phase", "median_seconds", "ratio_to_unit", "speed_up",
                 "efficiency", "flops_per_element", "bytes_per_element", "flops_per_second", "bytes_per_second",
                 "share_of_flop_peak", "share_of_bandwidth"},
                15),
        cases_(app, "cases.csv",
               {"kind", "elements", "order", "rounds", "unit_seconds", "unit_factorize_seconds", "unit_solve_seconds",
                "memory_bytes_per_element", "share_of_processor"}) {}

  void add(const ScalingCase& of, const Measurement& measurement) {
    const double unit = measurement.unit(), factorize = measurement.unit_factorize();
    const double memory = measurement.memory / of.elements, share = measurement.share_of_processor();
    cases_.add_row(
        {of.kind, of.elements, of.order, measurement.rounds.size(), unit, factorize, unit - factorize, memory, share});
    app_.out() << formatted(
        "%s, %d elements of order %d: B = %.3f ms (dgbtrf %.3f), %.0f bytes of memory per element\n", of.kind.c_str(),
        of.elements, of.order, 1e3 * unit, 1e3 * factorize, memory);
    if (share < kIdleMachine)
      app_.out() << formatted("The machine was busy: B had the processor %.0f %% of its time. Judge by t / B alone.\n",
                              100.0 * share);
    for (const std::string& phase : measurement.phases())
      for (const auto& [threads, ceilings] : ceilings_) add_phase(of, measurement, phase, threads, ceilings);
    done_.emplace_back(of, measurement);
  }

  /// Prints one line per case and number of threads.
  void print_summary() const {
    StudyTable table(app_, "",
                     {"", "elements", "k", "threads", "iteration [s]", "t / B", "speed-up", "chains [s]", "t / B",
                      "KLU2 [s]", "t / B", "run [s]", "t / B"},
                     13);
    for (const auto& [of, measurement] : done_)
      for (const auto& [threads, ceilings] : ceilings_) {
        std::vector<CsvCell> row = {of.kind, of.elements, of.order, threads};
        for (const char* phase : {kWholeIteration, kLinearSolver, kLinearSolverSparse, kWholeRun}) {
          row.emplace_back(measurement.seconds(threads, phase));
          row.emplace_back(measurement.ratio_to_unit(threads, phase));
          if (phase == kWholeIteration)
            row.emplace_back(measurement.speed_up(ceilings_.begin()->first, threads, phase));
        }
        table.add_row(row);
      }
  }

 private:
  void add_phase(const ScalingCase& of, const Measurement& measurement, const std::string& phase, int threads,
                 const MachineCeilings& ceilings) {
    const double seconds = measurement.seconds(threads, phase);
    if (std::isnan(seconds)) return;
    const auto costs = is_lattice(of.kind) ? std::map<std::string, PhaseCost>{} : phase_costs(of.kind, of.order);
    const auto found = costs.find(phase);
    const PhaseCost cost = found == costs.end() ? PhaseCost{std::nan(""), std::nan("")} : found->second;
    const int reference = ceilings_.begin()->first;
    const double speed_up = measurement.speed_up(reference, threads, phase);
    const double flops = cost.flops * of.elements / seconds, bytes = cost.bytes * of.elements / seconds;
    phases_.add_row({of.kind, of.elements, of.order, threads, phase, seconds, measurement.ratio_to_unit(threads, phase),
                     speed_up, speed_up * reference / threads, cost.flops, cost.bytes, flops, bytes,
                     flops / ceilings.flops_per_second, bytes / ceilings.bytes_per_second});
  }

  const Application& app_;
  CeilingsByThreads ceilings_;
  StudyTable phases_, cases_;
  std::vector<std::pair<ScalingCase, Measurement>> done_;
};

/// The scene in the size of a case, or a lattice of its section; planar: keeps only loads in the plane of x and y.
Scene scene_of_case(const Scene& scene, const ScalingCase& of) {
  if (is_lattice(of.kind)) return lattice_scene(scene, of.kind, of.elements, of.order);
  Scene changed = with_mesh(scene, of.order, of.elements);
  if (of.kind == kPlanar)
    for (PointLoad& load : changed.point_loads) load.force[2] = load.moment[0] = load.moment[1] = 0.0;
  return changed;
}

std::vector<ScalingCase> cases_of(Application& app) {
  std::vector<ScalingCase> cases;
  for (const std::string& kind : study_list<std::string>(app, "Kinds"))
    for (int elements : study_list<int>(app, "Elements"))
      for (int order : study_list<int>(app, "Orders")) cases.push_back({kind, elements, order});
  return cases;
}

ListSpec scaling_spec() {
  ListSpec spec("Sizes of the thread scaling study.");
  std::vector<std::string> kinds = {kSpatial, kPlanar};
  kinds.insert(kinds.end(), lattice_kinds().begin(), lattice_kinds().end());
  spec.add(subset("Kinds", kinds)
               .by_default(Teuchos::Array<std::string>(std::vector<std::string>{kSpatial, kPlanar}))
               .means("The chain under loads in space, or their part in the plane of x and y; lattices of struts of "
                      "two elements and slenderness 20."));
  spec.add(counts("Elements", {1000, 10000, 100000}, kLargestCount,
                  "Numbers of elements of the chain; of lattices about as many."));
  spec.add(counts("Orders", {1, 2, 3, 4}, kMaximumOrder, "Element orders, 1 to 8."));
  spec.add(counts("Threads", {1, 2}, kLargestCount, "Numbers of threads; the least is the reference of the speed-up."));
  spec.add(count("Repetitions", 15, 1000,
                 "Timed iterations for each number of threads, at most; at least three are taken."));
  spec.add(count("Repetitions of Runs", 3, 1000,
                 "Timed runs from the straight rod to equilibrium for each number of threads, at most; at least one is "
                 "taken, unless this is zero.",
                 0));
  spec.add(real("Seconds").at_least(0.0).by_default(3.0),
           "Time after which no more repetitions are begun, for iterations and for runs of a case each.");
  spec.add(boolean("Compare with KLU2").by_default(true),
           "Each tangent of a chain is solved by the sparse solver alone as well, which takes memory of its own.");
  return spec;
}

/// Measures, for each kind, size, order and number of threads, the median wall time of the phases of an iteration, in
/// units of time (see ChainUnit) and relative to the machine's ceilings, and memory. Each case runs in its own process.
/// Writes machine.csv, ceilings.csv, thread_scaling.csv and cases.csv, and prints the tables.
void run_scaling_study(Application& app) {
  Teuchos::ParameterList& study = app.study();
  MeasuringPlan plan;
  plan.threads = study_list<int>(app, "Threads");
  plan.repetitions = study.get<int>("Repetitions");
  plan.run_repetitions = study.get<int>("Repetitions of Runs");
  plan.seconds = study.get<double>("Seconds");
  write_machine(app, {{"lanes", std::to_string(kLanes)},
                      {"BLAS of the unit", blas_library()},
                      {"load average before", load_average()}});
  ScalingTables tables(app, ceilings_of(app, plan.threads));
  for (ScalingCase of : cases_of(app)) {
    SolverParameters solver = app.solver;
    if (!is_lattice(of.kind)) solver.planar = of.kind == kPlanar;
    plan.compare_sparse_solver = study.get<bool>("Compare with KLU2") && !is_lattice(of.kind);
    const Scene scene = scene_of_case(app.scene, of);
    of.elements = static_cast<int>(elements_of(scene));
    tables.add(of, read_measurement(measured_apart(
                       app, [&] { return written(measure_case(scene, solver, app.communicator, plan)); })));
  }
  tables.print_summary();
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "thread_scaling",
      "time of one Newton iteration on a chain of elements, split into phases, for 1, 2, .. threads.",
      mixbeam::scaling_spec(), mixbeam::run_scaling_study);
}
