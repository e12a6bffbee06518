#include "apps/trade/cell.hpp"

#include "apps/common/studies/phase_costs.hpp"
#include "apps/trade/estimate_check.hpp"
#include "apps/trade/run_watch.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/element/layout.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace mixbeam {

namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
struct TimedRun {
  Simulation simulation;
  CellTimes times;
};

TimedRun run_once(const BenchmarkProblem& problem, const Scene& scene, int threads, const TimingPlan& plan,
                  const Communicator& communicator) {
  SolverParameters parameters = problem.solver;
  parameters.threads = threads;
  CellTimes times;
  PathControl control;
  const RunWatch watch;
  Simulation simulation(scene, parameters, communicator);
  times.setup_seconds = watch.seconds();
  control.stop = [&] { return communicator->getSize() == 1 && watch.processor_seconds() > plan.most_seconds; };
  simulation.run({}, control);
  times.seconds = watch.seconds();
  times.processor_seconds = watch.processor_seconds();
  return {std::move(simulation), times};
}

/// Numbers of threads in turn, so that a machine that slows down for a while does so for all of them.
std::map<int, CellTimes> time_cell(const BenchmarkProblem& problem, const Scene& scene, const CellTimes& first,
                                   const TimingPlan& plan, const Communicator& communicator) {
  std::map<int, std::vector<CellTimes>> runs;
  const double round_seconds = first.seconds * plan.threads.size();
  const int affordable = static_cast<int>(std::min<double>(plan.repetitions, plan.budget / round_seconds));
  const auto run = [&](int threads) { return run_once(problem, scene, threads, plan, communicator).times; };
  if (affordable < kLeastRounds) {
    for (int threads : plan.threads) runs[threads] = {threads == plan.threads.front() ? first : run(threads)};
  } else {
    for (int threads : plan.threads)
      if (threads != plan.threads.front()) run(threads);
    for (int round = 0; round < affordable; ++round)
      for (int threads : plan.threads) runs[threads].push_back(run(threads));
  }
  std::map<int, CellTimes> times;
  for (const auto& [threads, of_threads] : runs) times[threads] = medians(of_threads);
  return times;
}

void count_unknowns(const Simulation& simulation, CellResult& result) {
  const InteriorLayout layout{result.cell.order, force_point_count(result.cell.order, result.cell.integration)};
  result.global_unknowns = static_cast<int>(simulation.assembler().map()->getGlobalNumElements());
  result.interior_unknowns = static_cast<int>(simulation.assembler().mesh().elements.size()) * layout.increments();
}

}  // namespace

CellTimes time_once(const BenchmarkProblem& problem, const Cell& cell, int threads, const TimingPlan& plan,
                    const Communicator& communicator) {
  return run_once(problem, problem.with(cell.order, cell.elements, cell.integration), threads, plan, communicator)
      .times;
}

const char* name_of(CellStatus status) {
  switch (status) {
    case CellStatus::converged:
      return "converged";
    case CellStatus::failed:
      return "failed";
    case CellStatus::past_round_off:
      return "past round-off";
    case CellStatus::too_long:
      return "too long";
  }
  return "";
}

const char* name_of(ForceIntegration integration) {
  switch (integration) {
    case ForceIntegration::full:
      return "full";
    case ForceIntegration::axial_reduced:
      return "axial reduced";
    case ForceIntegration::shear_reduced:
      return "shear reduced";
    case ForceIntegration::both_reduced:
      return "both reduced";
  }
  return "";
}

double CellResult::seconds(int threads) const {
  const auto found = times.find(threads);
  return found == times.end() ? kNotANumber : found->second.seconds;
}

double CellResult::processor_seconds(int threads) const {
  const auto found = times.find(threads);
  return found == times.end() ? kNotANumber : found->second.processor_seconds;
}

double iteration_flops(int order, int elements) {
  static std::map<int, double> of_order;
  if (of_order.count(order) == 0) of_order[order] = phase_costs("spatial", order).at(kWholeIteration).flops;
  return of_order[order] * elements;
}

CellResult measure_cell(const BenchmarkProblem& problem, const Reference& reference, const Cell& cell,
                        const TimingPlan& plan, const Communicator& communicator) {
  CellResult result;
  result.cell = cell;
  const Scene scene = problem.with(cell.order, cell.elements, cell.integration);
  try {
    const TimedRun first = run_once(problem, scene, plan.threads.front(), plan, communicator);
    const LoadPathResult& path = first.simulation.result();
    count_unknowns(first.simulation, result);
    result.load_steps = path.steps;
    result.failed_steps = path.failed_steps;
    result.iterations = path.newton_iterations;
    result.flops = path.newton_iterations *
                   iteration_flops(cell.order, static_cast<int>(first.simulation.assembler().mesh().elements.size()));
    result.times[plan.threads.front()] = first.times;
    if (path.interrupted) result.status = CellStatus::too_long;
    if (!path.finished) return result;
    result.status = CellStatus::converged;
    result.errors = reference.errors_of(first.simulation);
    if (!problem.about.in_gallery) {
      const RunWatch watch;
      result.estimated = estimated_errors(first.simulation, problem.about.point);
      result.estimate_seconds = watch.processor_seconds();
    }
    result.times = time_cell(problem, scene, first.times, plan, communicator);
  } catch (const InputError&) {  // a mesh that is too coarse for its curve
    result.status = CellStatus::failed;
  }
  return result;
}

}  // namespace mixbeam
