#include "apps/trade/cell.hpp"

#include "apps/common/studies/phase_costs.hpp"
#include "apps/common/studies/study.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/element/layout.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

/// A mesh is as exact as rounding allows when all errors are this small or those of the reference ...
constexpr double kRoundOff = 1e-12;
/// ... and two meshes in a row tell it, so that one lucky error does not end a row.
constexpr int kRoundedMeshes = 2;
/// Time for twice as many elements, at least: how long a finer mesh takes is guessed from the last one.
constexpr double kGrowth = 2.0;
/// From a mesh that is worse than this nothing is guessed: it has followed a path of its own.
constexpr double kNoSolution = 0.01;
/// Times scatter: a cell that costs more than this many times a better one is no candidate.
constexpr double kClearlyDearer = 1.3;
/// Elements of a member of the file are halved at most so often.
constexpr int kMostHalvings = 4;

/// A median of fewer is none.
constexpr int kLeastRounds = 3;
/// Seconds for the runs of one accuracy with one number of threads, where more than the least number of them are made.
constexpr double kPriceBudget = 0.3;
/// Cells that are timed again for it: the cheapest of a matrix is one of them, whatever the scatter of its times.
constexpr std::size_t kCandidates = 3;
/// The difference of the references is an error of both; what is judged stands well above.
constexpr double kAboveReference = 10.0;

RunTimes medians(const std::vector<RunTimes>& runs) {
  const auto of = [&runs](double RunTimes::*what) {
    std::vector<double> values;
    for (const RunTimes& run : runs) values.push_back(run.*what);
    return median(values);
  };
  return {of(&RunTimes::seconds), of(&RunTimes::setup_seconds), of(&RunTimes::processor_seconds)};
}

/// With one thread the processor time is the wall time on an idle machine, and what others do does not lengthen it.
double cost_of(const RunTimes& times, int threads) { return threads == 1 ? times.processor_seconds : times.seconds; }

double cost_of(const CellResult& cell, int threads) {
  const auto found = cell.times.find(threads);
  const auto& [known, times] = found == cell.times.end() ? *cell.times.begin() : *found;
  return cost_of(times, known);
}

struct TimedRun {
  Simulation simulation;
  RunTimes times;
};

TimedRun run_once(const BenchmarkProblem& problem, const Cell& cell, int threads, const TimingPlan& plan) {
  const Scene scene = problem.with(cell.order, cell.elements, cell.integration);
  SolverParameters parameters = problem.solver;
  parameters.threads = threads;
  RunTimes times;
  PathControl control;
  const RunWatch watch;
  Simulation simulation(scene, parameters, plan.communicator);
  times.setup_seconds = watch.seconds();
  control.stop = [&] { return plan.communicator->getSize() == 1 && watch.processor_seconds() > plan.most_seconds; };
  simulation.run({}, control);
  times.stop(watch);
  return {std::move(simulation), times};
}

/// Numbers of threads in turn, so that a machine that slows down for a while does so for all of them.
TimesByThreads time_cell(const BenchmarkProblem& problem, const Cell& cell, const RunTimes& first,
                         const TimingPlan& plan) {
  std::map<int, std::vector<RunTimes>> runs;
  const double round_seconds = first.seconds * plan.threads.size();
  const int affordable = static_cast<int>(std::min<double>(plan.repetitions, plan.budget / round_seconds));
  const bool only_once = affordable < kLeastRounds;
  for (int round = 0; round <= (only_once ? 0 : affordable); ++round)
    for (const int threads : plan.threads) {
      const bool is_first = round == 0 && threads == plan.threads.front();
      const RunTimes times = is_first ? first : run_once(problem, cell, threads, plan).times;
      if (round > 0 || only_once) runs[threads].push_back(times);
    }
  TimesByThreads times;
  for (const auto& [threads, of_threads] : runs) times[threads] = medians(of_threads);
  return times;
}

/// Counted by running the kernels of a plain section on counting numbers: element work, condensation of chains, solve,
/// check.
double element_flops(int order) {
  static std::map<int, double> of_order;
  if (of_order.count(order) == 0) of_order[order] = phase_costs("spatial", order).at(kWholeIteration).flops;
  return of_order[order];
}

void count_costs(const Simulation& simulation, CellResult& result) {
  const InteriorLayout layout{result.cell.order, force_point_count(result.cell.order, result.cell.integration)};
  const int elements = static_cast<int>(simulation.model().mesh().elements.size());
  const LoadPathResult& path = simulation.result();
  result.global_unknowns = static_cast<int>(simulation.model().map()->getGlobalNumElements());
  result.interior_unknowns = elements * layout.increments();
  result.load_steps = path.steps;
  result.failed_steps = path.failed_steps;
  result.iterations = path.newton_iterations;
  result.flops = path.newton_iterations * (element_flops(result.cell.order) * elements);
}

Scene scene_with_accuracy(const BenchmarkProblem& problem, double wanted) {
  Scene scene = problem.scene;
  scene.accuracy = wanted;
  for (Member& member : scene.members) {
    member.keeps_order = member.keeps_elements = false;
    member.stations.clear();
    member.force_integration = ForceIntegration::both_reduced;
  }
  return scene;
}

AccurateRun run_for_accuracy(const BenchmarkProblem& problem, double wanted, int threads, const TimingPlan& plan,
                             RunTimes& times, PathTrace* trace = nullptr) {
  const Scene scene = scene_with_accuracy(problem, wanted);
  SolverParameters parameters = problem.solver;
  parameters.threads = threads;
  AccurateRunObserver observer;
  if (trace != nullptr) {
    observer.begin = [&problem, trace](const Simulation&) { *trace = PathTrace(problem); };
    observer.step = [trace](const Simulation& simulation, const StepReport& report) { trace->add(simulation, report); };
    observer.end = [trace](const Simulation& simulation, const StepReport& report, const ErrorEstimate&) {
      trace->add(simulation, report);
    };
  }
  const RunWatch watch;
  AccurateRun run = run_accurately(scene, parameters, plan.communicator, problem.keeps_path(), observer);
  times.stop(watch);
  return run;
}

/// The program's way and the cheapest cells in turn, so that a machine that slows down for a while does so for all.
AccuracyPrice price_of(const BenchmarkResult& result, double wanted, int threads, const TimingPlan& plan) {
  std::vector<const CellResult*> cells = result.cheapest(wanted, threads);
  cells.resize(std::min(cells.size(), kCandidates));
  std::vector<std::vector<RunTimes>> runs(1 + cells.size());
  const RunWatch watch;
  const int least = std::min(plan.repetitions, kLeastRounds);
  for (int round = 0; round < least || (round < plan.repetitions && watch.seconds() < kPriceBudget); ++round) {
    run_for_accuracy(result.problem, wanted, threads, plan, runs[0].emplace_back());
    for (std::size_t i = 0; i < cells.size(); ++i)
      runs[1 + i].push_back(run_once(result.problem, cells[i]->cell, threads, plan).times);
  }
  AccuracyPrice price;
  price.seconds = cost_of(medians(runs[0]), threads);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double seconds = cost_of(medians(runs[1 + i]), threads);
    if (price.best && seconds >= price.best_seconds) continue;
    price.best = cells[i]->cell;
    price.best_seconds = seconds;
  }
  return price;
}

/// Cells that are not computed are among them, with the reason.
void measure_row(BenchmarkResult& result, const Reference& reference, const MatrixPlan& plan,
                 ForceIntegration integration, int order) {
  const double rounded = std::max(kRoundOff, largest_error(reference.difference()));
  int rounded_meshes = 0;
  double last_seconds = 0.0;
  for (const int elements : plan.elements) {
    CellResult cell{{integration, order, elements}};
    if (rounded_meshes >= kRoundedMeshes) {
      cell.status = CellStatus::past_round_off;
    } else if (kGrowth * last_seconds > plan.timing.most_seconds) {
      cell.status = CellStatus::too_long;
    } else {
      cell = measure_cell(result.problem, reference, cell.cell, plan.timing);
      const double error = largest_error(cell.errors);
      last_seconds = error < kNoSolution ? cell.times.at(plan.timing.threads.front()).processor_seconds : 0.0;
      rounded_meshes = error <= rounded ? rounded_meshes + 1 : 0;
    }
    result.cells.push_back(std::move(cell));
  }
}

/// Elements of the finest member: those of the file, halved and doubled.
std::vector<int> meshes_of(const BenchmarkProblem& problem) {
  std::vector<int> meshes;
  const int own = problem.own_elements();
  for (int part = 1 << kMostHalvings; part >= 1; part /= 2)
    if (own >= part) meshes.push_back((own + part - 1) / part);
  for (int factor = 2; factor <= problem.about.refinement; factor *= 2) meshes.push_back(own * factor);
  return meshes;
}

}  // namespace

CellResult measure_cell(const BenchmarkProblem& problem, const Reference& reference, const Cell& cell,
                        const TimingPlan& plan) {
  CellResult result;
  result.cell = cell;
  try {
    const TimedRun first = run_once(problem, cell, plan.threads.front(), plan);
    count_costs(first.simulation, result);
    result.times[plan.threads.front()] = first.times;
    if (first.simulation.result().interrupted) result.status = CellStatus::too_long;
    if (!first.simulation.result().finished) return result;
    result.status = CellStatus::converged;
    result.errors = reference.errors_of(first.simulation);
    if (!problem.about.in_gallery) {
      const RunWatch watch;
      result.estimated = estimated_errors(first.simulation, problem.about.point);
      result.estimate_seconds = watch.processor_seconds();
    }
    result.times = time_cell(problem, cell, first.times, plan);
  } catch (const InputError&) {  // a mesh that is too coarse for its curve
    result.status = CellStatus::failed;
  }
  return result;
}

double BenchmarkResult::floor() const {
  return kAboveReference * (problem.about.in_gallery ? motion_error(difference) : largest_error(difference));
}

std::vector<const CellResult*> BenchmarkResult::cheapest(double accuracy, int threads) const {
  std::vector<const CellResult*> good;
  if (accuracy < floor()) return good;
  for (const CellResult& cell : cells)
    if (cell.converged() && cell.cell.integration == ForceIntegration::both_reduced &&
        motion_error(cell.errors) <= accuracy)
      good.push_back(&cell);
  std::stable_sort(good.begin(), good.end(), [threads](const CellResult* a, const CellResult* b) {
    return cost_of(*a, threads) < cost_of(*b, threads);
  });
  return good;
}

AccurateCell measure_accurate_cell(const BenchmarkResult& result, const Reference& reference, double wanted,
                                   const TimingPlan& plan) {
  PathTrace trace(result.problem);
  RunTimes times;
  const AccurateRun run = run_for_accuracy(result.problem, wanted, plan.threads.front(), plan, times, &trace);
  AccurateCell cell;
  cell.wanted = wanted;
  cell.end = run.end;
  cell.rounds = run.rounds;
  if (run.simulation.result().finished) cell.errors = reference.errors_of(run.simulation);
  if (!reference.trace().is_empty()) cell.path_error = trace.error_against(reference.trace(), reference.displacement());
  for (const int threads : plan.threads) cell.prices[threads] = price_of(result, wanted, threads, plan);
  return cell;
}

void measure_matrix(BenchmarkResult& result, const Reference& reference, const MatrixPlan& plan) {
  for (const ForceIntegration integration : {ForceIntegration::both_reduced, ForceIntegration::full})
    for (const int order : plan.orders)
      if (integration == ForceIntegration::both_reduced || result.problem.about.integrations)
        measure_row(result, reference, plan, integration, order);
}

void measure_front(BenchmarkResult& result, const Reference& reference, const MatrixPlan& plan) {
  const double smallest = *std::min_element(plan.accuracies.begin(), plan.accuracies.end());
  TimingPlan timing = plan.timing;
  timing.threads.resize(1);  // more of them are left to the accuracies
  const int threads = timing.threads.front();
  for (auto order = plan.orders.rbegin(); order != plan.orders.rend(); ++order)
    for (const int elements : meshes_of(result.problem)) {
      const Cell cell{ForceIntegration::both_reduced, *order, elements};
      result.cells.push_back(measure_cell(result.problem, reference, cell, timing));
      const CellResult& last = result.cells.back();
      const double error = motion_error(last.errors);
      if (last.status == CellStatus::too_long || error <= smallest) break;
      const auto best = result.cheapest(smallest, threads);
      if (error < kNoSolution && !best.empty() &&
          last.times.at(threads).processor_seconds > kClearlyDearer * best.front()->times.at(threads).processor_seconds)
        break;
    }
}

}  // namespace mixbeam
