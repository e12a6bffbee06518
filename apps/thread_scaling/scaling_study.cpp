// Median time of one Newton iteration, phase by phase, against the number of threads.
#include "apps/common/studies/study.hpp"
#include "apps/thread_scaling/chain_unit.hpp"
#include "apps/thread_scaling/measure_case.hpp"
#include "apps/thread_scaling/scaling_report.hpp"
#include "apps/thread_scaling/separate_process.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/execution/pack.hpp"

#include <cstdlib>
#include <ostream>
#include <sstream>

namespace mixbeam {

namespace {

constexpr const char* kPlanar = "planar";
constexpr const char* kSpatial = "spatial";
constexpr double kLargestCount = 1e7;

/// A process of its own for each measurement; MPI ranks stay together.
std::string measured_apart(const Application& app, const std::function<std::string()>& work) {
  return app.communicator->getSize() == 1 ? in_separate_process(work) : work();
}

CeilingsByThreads ceilings_of(const Application& app, const std::vector<int>& threads) {
  CeilingsByThreads ceilings;
  for (int n : threads) {
    const std::string text = measured_apart(app, [n] {
      const MachineCeilings of_threads = measure_ceilings(n);
      std::ostringstream numbers;
      numbers << of_threads.flops_per_second << " " << of_threads.bytes_per_second;
      return numbers.str();
    });
    std::istringstream(text) >> ceilings[n].flops_per_second >> ceilings[n].bytes_per_second;
  }
  return ceilings;
}

/// Work of others on the machine while this was measured.
std::string load_average() {
  double load = 0.0;
  return getloadavg(&load, 1) == 1 ? CsvCell(load).text : "unknown";
}

/// The scene in that size; planar: its loads keep what acts in the plane of x and y.
Scene scene_of_case(const Scene& scene, const ScalingCase& of) {
  Scene changed = scene;
  for (Member& member : changed.members) {
    member.elements = of.elements;
    member.order = of.order;
  }
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
  const auto counts = [](const char* name, const std::vector<int>& by_default, const char* meaning,
                         double largest = kLargestCount) {
    ParameterSpec parameter = array(name, ParameterType::integer_array);
    return parameter.at_least(1).at_most(largest).by_default(Teuchos::Array<int>(by_default)).means(meaning);
  };
  ListSpec spec("Sizes of the thread scaling study.");
  spec.add(subset("Kinds", {kSpatial, kPlanar})
               .by_default(Teuchos::Array<std::string>(std::vector<std::string>{kSpatial, kPlanar}))
               .means("Loads in space, or their part in the plane of x and y."));
  spec.add(counts("Elements", {1000, 10000, 100000}, "Numbers of elements of the chain."));
  spec.add(counts("Orders", {1, 2, 3, 4}, "Element orders, 1 to 8.", kMaximumOrder));
  spec.add(counts("Threads", {1, 2}, "Numbers of threads; the least is the reference of the speed-up."));
  spec.add(integer("Repetitions")
               .at_least(1)
               .at_most(1000)
               .by_default(15)
               .means("Timed iterations for each number of threads, at most; at least three are taken."));
  spec.add(integer("Repetitions of Runs")
               .at_least(0)
               .at_most(1000)
               .by_default(3)
               .means("Timed runs from the straight rod to equilibrium for each number of threads, at most; at least "
                      "one is taken, unless this is zero."));
  spec.add(real("Seconds").at_least(0.0).by_default(3.0).means(
      "Time after which no more repetitions are begun, for iterations and for runs of a case each."));
  spec.add(boolean("Compare with KLU2")
               .by_default(true)
               .means("Each tangent is solved by the sparse solver alone as well, which takes memory of its own."));
  return spec;
}

/// For each kind, size, order and number of threads: median wall time of the phases of an iteration, as a multiple of
/// the unit of time (see ChainUnit), against the machine's ceilings, and memory. Each case has a process of its own.
/// Writes machine.csv, ceilings.csv, thread_scaling.csv and cases.csv, prints the tables.
void run_scaling_study(Application& app) {
  Teuchos::ParameterList& study = app.study();
  MeasuringPlan plan;
  plan.threads = study_list<int>(app, "Threads");
  plan.repetitions = study.get<int>("Repetitions");
  plan.run_repetitions = study.get<int>("Repetitions of Runs");
  plan.seconds = study.get<double>("Seconds");
  plan.compare_sparse_solver = study.get<bool>("Compare with KLU2");
  write_machine(app, {{"lanes", std::to_string(kLanes)},
                      {"BLAS of the unit", blas_library()},
                      {"load average before", load_average()}});
  std::optional<std::filesystem::path> folder;
  if (app.writes_files()) folder = app.output;
  ScalingReport report(app.out(), folder, ceilings_of(app, plan.threads));
  for (const ScalingCase& of : cases_of(app)) {
    SolverParameters solver = app.solver;
    solver.planar = of.kind == kPlanar;
    const Scene scene = scene_of_case(app.scene, of);
    const std::string text =
        measured_apart(app, [&] { return written(measure_case(scene, solver, app.communicator, plan)); });
    report.add(of, read_measurement(text));
  }
  report.print_summary();
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "thread_scaling";
  definition.purpose = "time of one Newton iteration on a chain of elements, split into phases, for 1, 2, .. threads.";
  definition.study = mixbeam::scaling_spec();
  definition.run_study = mixbeam::run_scaling_study;
  return mixbeam::run_application(argc, argv, definition);
}
