#include "apps/thread_scaling/scaling_study.hpp"

#include "apps/common/csv_table.hpp"
#include "apps/common/machine_facts.hpp"
#include "kernels/execution_space.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <ostream>

namespace mixbeam {

namespace {

using Clock = std::chrono::steady_clock;
using PhaseSamples = std::map<std::string, std::vector<double>>;

/// Phases that are work on elements, in the sense of "kernels under two threads".
const std::vector<std::string> kElementPhases = {"residual", "element tangent", "recover", "update"};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

/// One full Newton step at `state`, timed by phase.
void time_iteration(BeamProblem& problem, const State& state, MixedVector& residual, MixedVector& increment,
                    PhaseSamples& samples) {
  Assembler& assembler = problem.assembler;
  const PhaseTimes before = assembler.times();
  const auto start = Clock::now();
  assembler.residual(state, 1.0, residual);
  assembler.tangent(state, 1.0);
  problem.linear_solver->factorize();
  assembler.condensed_residual().scale(-1.0);
  problem.linear_solver->solve(assembler.condensed_residual(), increment.vertex_dofs());
  assembler.recover(state, increment);
  const State moved = assembler.apply(state, increment, 1e-3);
  samples["whole iteration"].push_back(std::chrono::duration<double>(Clock::now() - start).count());
  double elements = 0.0;
  for (const auto& [phase, total] : assembler.times()) {
    const auto earlier = before.find(phase);
    const double seconds = total - (earlier == before.end() ? 0.0 : earlier->second);
    if (seconds == 0.0) continue;
    samples[phase].push_back(seconds);
    if (std::find(kElementPhases.begin(), kElementPhases.end(), phase) != kElementPhases.end()) elements += seconds;
  }
  samples["element work"].push_back(elements);
}

/// All numbers of threads in turn on the same problem; the first round warms up and is not counted.
std::map<int, PhaseSamples> measure(const Scene& scene, Application& app, const std::vector<int>& threads,
                                    int repetitions) {
  BeamProblem problem(scene, app.communicator, app.solver);
  const State state = problem.assembler.reference_state();
  MixedVector residual = problem.assembler.create_vector(), increment = problem.assembler.create_vector();
  std::map<int, PhaseSamples> samples;
  for (int round = 0; round <= repetitions; ++round)
    for (int n : threads) {
      set_number_of_threads(n);
      PhaseSamples discarded;
      time_iteration(problem, state, residual, increment, round == 0 ? discarded : samples[n]);
    }
  return samples;
}

/// Newton iterations as a user's run has them: NOX and LOCA included, from the straight rod to equilibrium.
void measure_whole_runs(const Scene& scene, Application& app, const std::vector<int>& threads, int repetitions,
                        std::map<int, PhaseSamples>& samples) {
  for (int round = 0; round <= repetitions; ++round)
    for (int n : threads) {
      set_number_of_threads(n);
      SolverParameters parameters = app.solver;
      parameters.threads = n;
      Simulation simulation(scene, parameters, app.communicator);
      const auto start = Clock::now();
      const int iterations = simulation.run().newton_iterations;
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      if (round > 0 && iterations > 0) samples[n]["run, per iteration"].push_back(seconds / iterations);
    }
}

/// What the figures were measured with, beside them.
void write_machine(Application& app) {
  std::unique_ptr<CsvTable> csv;
  if (app.writes_files())
    csv = std::make_unique<CsvTable>(app.output / "machine.csv", std::vector<std::string>{"name", "value"});
  for (const auto& [name, value] : machine_facts()) {
    app.out() << name << ": " << value << "\n";
    if (csv != nullptr) csv->add_row({name, value});
  }
}

void print_samples(std::ostream& out, int elements, int order, const std::map<int, PhaseSamples>& samples) {
  const PhaseSamples& one = samples.begin()->second;
  char text[200];
  std::snprintf(text, sizeof text, "\n%d elements of order %d: median seconds (speed-up against %d thread%s)\n",
                elements, order, samples.begin()->first, samples.begin()->first == 1 ? "" : "s");
  out << text;
  for (const auto& [phase, values] : one) {
    std::snprintf(text, sizeof text, "  %-24s", phase.c_str());
    out << text;
    for (const auto& [threads, of_threads] : samples) {
      const auto entry = of_threads.find(phase);
      if (entry == of_threads.end()) continue;
      std::snprintf(text, sizeof text, "  %d: %9.5f (%4.2f)", threads, median(entry->second),
                    median(values) / median(entry->second));
      out << text;
    }
    out << "\n";
  }
}

}  // namespace

ListSpec scaling_spec() {
  constexpr double kLargestCount = 1e7;
  const auto counts = [](const char* name, const std::vector<int>& by_default, const char* meaning) {
    ParameterSpec parameter = array(name, ParameterType::integer_array);
    return parameter.at_least(1).at_most(kLargestCount).by_default(Teuchos::Array<int>(by_default)).means(meaning);
  };
  ListSpec spec("Sizes of the thread scaling study.");
  spec.add(counts("Elements", {1000, 10000, 100000}, "Numbers of elements of the chain."));
  spec.add(counts("Orders", {1, 2, 4}, "Element orders, 1 to 8."));
  spec.add(counts("Threads", {1, 2}, "Numbers of threads; the first is the reference of the speed-up."));
  spec.add(integer("Repetitions")
               .at_least(1)
               .at_most(1000)
               .by_default(7)
               .means("Timed iterations for each number of threads."));
  spec.add(integer("Repetitions of Runs")
               .at_least(0)
               .at_most(1000)
               .by_default(3)
               .means("Timed runs from the straight rod to equilibrium for each number of threads."));
  return spec;
}

void run_scaling_study(Application& app) {
  Teuchos::ParameterList& study = app.study();
  const auto threads = study.get<Teuchos::Array<int>>("Threads").toVector();
  std::unique_ptr<CsvTable> csv;
  if (app.writes_files())
    csv =
        std::make_unique<CsvTable>(app.output / "thread_scaling.csv",
                                   std::vector<std::string>{"elements", "order", "threads", "phase", "median_seconds"});
  write_machine(app);
  for (int elements : study.get<Teuchos::Array<int>>("Elements"))
    for (int order : study.get<Teuchos::Array<int>>("Orders")) {
      Scene scene = app.scene;
      for (Member& member : scene.members) {
        member.elements = elements;
        member.order = order;
      }
      auto samples = measure(scene, app, threads, study.get<int>("Repetitions"));
      measure_whole_runs(scene, app, threads, study.get<int>("Repetitions of Runs"), samples);
      print_samples(app.out(), elements, order, samples);
      for (const auto& [n, phases] : samples)
        for (const auto& [phase, values] : phases)
          if (csv != nullptr) csv->add_row({elements, order, n, phase, median(values)});
    }
  set_number_of_threads(threads.front());
}

}  // namespace mixbeam
