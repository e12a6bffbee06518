#include "apps/thread_scaling/measure_case.hpp"

#include "apps/common/studies/study.hpp"
#include "apps/thread_scaling/chain_unit.hpp"
#include "apps/thread_scaling/separate_process.hpp"
#include "apps/thread_scaling/time_iteration.hpp"
#include "kernels/execution/execution_space.hpp"

#include <algorithm>
#include <limits>

namespace mixbeam {

namespace {

/// A median of fewer rounds is none.
constexpr int kLeastRounds = 3;

/// One sample for each number of threads; `phases` runs what is measured.
template <class Phases>
Round take_round(const std::vector<int>& threads, ChainUnit& unit, const Phases& phases) {
  Round round;
  for (int n : threads) {
    set_number_of_threads(n);
    Sample& sample = round[n];
    sample.phases = phases(n);
    const ChainUnit::Seconds seconds = unit.time();
    sample.unit_factorize = seconds.factorize;
    sample.unit_solve = seconds.solve;
    sample.unit_processor_seconds = seconds.processor;
  }
  return round;
}

template <class Phases>
void take_rounds(const MeasuringPlan& plan, int least, int most, ChainUnit& unit, const Phases& phases,
                 std::vector<Round>& rounds) {
  const RunWatch watch;
  for (int taken = 0; taken < most && (taken < least || watch.seconds() < plan.seconds); ++taken)
    rounds.push_back(take_round(plan.threads, unit, phases));
}

/// Newton iterations as a user's run has them: NOX and LOCA included, from the straight rod to equilibrium.
PhaseSeconds time_run(const Scene& scene, SolverParameters parameters, const Communicator& communicator, int threads) {
  parameters.threads = threads;
  Simulation simulation(scene, parameters, communicator);
  const RunWatch watch;
  const LoadPathResult& result = simulation.run();
  const double seconds = watch.seconds();
  if (result.newton_iterations == 0) return {};
  return {{kWholeRun, seconds / result.newton_iterations}};
}

int vertices_of(const Scene& scene) {
  int vertices = 1;
  for (const Member& member : scene.members) vertices += member.elements;
  return vertices;
}

/// Builds the problem, takes all rounds of iterations and gives its memory back.
void measure_iterations(const Scene& scene, const SolverParameters& parameters, const Communicator& communicator,
                        const MeasuringPlan& plan, Measurement& measurement) {
  const double at_start = resident_memory();
  IterationTimer timer(scene, parameters, communicator);
  for (int n : plan.threads) {
    set_number_of_threads(n);
    timer.time();
  }
  measurement.memory =
      communicator->getSize() == 1 ? peak_resident_memory() - at_start : std::numeric_limits<double>::quiet_NaN();
  ChainUnit unit(vertices_of(scene));
  if (plan.compare_sparse_solver) timer.time_sparse_solver();
  take_rounds(
      plan, kLeastRounds, std::max(kLeastRounds, plan.repetitions), unit,
      [&](int) {
        PhaseSeconds phases = timer.time();
        if (plan.compare_sparse_solver) phases[kLinearSolverSparse] = timer.time_sparse_solver();
        return phases;
      },
      measurement.rounds);
}

}  // namespace

Measurement measure_case(const Scene& scene, const SolverParameters& parameters, const Communicator& communicator,
                         const MeasuringPlan& plan) {
  Measurement measurement;
  measure_iterations(scene, parameters, communicator, plan, measurement);
  ChainUnit unit(vertices_of(scene));
  take_rounds(
      plan, 1, plan.run_repetitions, unit, [&](int n) { return time_run(scene, parameters, communicator, n); },
      measurement.rounds);
  return measurement;
}

}  // namespace mixbeam
