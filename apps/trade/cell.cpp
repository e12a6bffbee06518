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
  RunTimes result;
  for (int what = 0; what < kTimes; ++what) {
    std::vector<double> values;
    for (const RunTimes& run : runs) values.push_back(run[what]);
    result[what] = median(values);
  }
  return result;
}

/// With one thread the processor time is the wall time on an idle machine, and what others do does not lengthen it.
double cost_of(const RunTimes& times, int threads) { return times[threads == 1 ? kProcessor : kWall]; }

double cost_of(const CellResult& cell, int threads) {
  const auto found = cell.times.find(threads);
  const auto& [known, times] = found == cell.times.end() ? *cell.times.begin() : *found;
  return cost_of(times, known);
}

std::pair<Simulation, RunTimes> run_once(const BenchmarkProblem& problem, const Discretization& mesh, int threads,
                                         const TradePlan& plan) {
  const Scene scene = problem.with(mesh);
  SolverParameters parameters = problem.solver;
  parameters.threads = threads;
  PathControl control;
  const RunWatch watch;
  Simulation simulation(scene, parameters, plan.communicator);
  const double setup = watch.seconds();
  control.stop = [&] { return plan.communicator->getSize() == 1 && watch.processor_seconds() > plan.most_seconds; };
  simulation.run({}, control);
  return {std::move(simulation), RunTimes{watch.seconds(), setup, watch.processor_seconds()}};
}

/// Numbers of threads in turn, so that a machine that slows down for a while does so for all of them. The first run
/// with each warms up; it counts only where it is the only one that the budget allows.
std::map<int, RunTimes> time_cell(const BenchmarkProblem& problem, const Discretization& mesh, const RunTimes& first,
                                  const TradePlan& plan) {
  std::map<int, std::vector<RunTimes>> runs;
  const double round_seconds = first[kWall] * plan.threads.size();
  const int affordable = static_cast<int>(std::min<double>(plan.repetitions, plan.budget / round_seconds));
  const bool only_once = affordable < kLeastRounds;
  for (int round = 0; round <= (only_once ? 0 : affordable); ++round)
    for (const int threads : plan.threads) {
      const bool is_first = round == 0 && threads == plan.threads.front();
      if (round == 1) runs[threads].clear();
      runs[threads].push_back(is_first ? first : run_once(problem, mesh, threads, plan).second);
    }
  std::map<int, RunTimes> times;
  for (const auto& [threads, of_threads] : runs) times[threads] = medians(of_threads);
  return times;
}

void count_costs(const Simulation& simulation, CellResult& result) {
  const InteriorLayout layout{result.mesh.order, force_point_count(result.mesh.order, result.mesh.integration)};
  const int elements = static_cast<int>(simulation.model().mesh().elements.size());
  const LoadPathResult& path = simulation.result();
  result.global_unknowns = static_cast<int>(simulation.model().map()->getGlobalNumElements());
  result.interior_unknowns = elements * layout.increments();
  result.load_steps = path.steps;
  result.failed_steps = path.failed_steps;
  result.iterations = path.newton_iterations;
  // counted by running the kernels of a plain section on counting numbers
  static std::map<int, double> flops_of_element;
  const auto [flops, is_new] = flops_of_element.try_emplace(result.mesh.order);
  if (is_new) flops->second = phase_costs("spatial", result.mesh.order).at(kWholeIteration).flops;
  result.flops = path.newton_iterations * (flops->second * elements);
}

/// The program's way to an accuracy; `trace` is what its last path met.
std::pair<AccurateRun, RunTimes> run_for_accuracy(const BenchmarkProblem& problem, double wanted, int threads,
                                                  const TradePlan& plan, PathTrace& trace) {
  Scene scene = problem.scene;
  scene.accuracy = wanted;
  for (Member& member : scene.members) {
    member.keeps_order = member.keeps_elements = false;
    member.stations.clear();
    member.force_integration = ForceIntegration::both_reduced;
  }
  SolverParameters parameters = problem.solver;
  parameters.threads = threads;
  AccurateRunObserver observer;
  observer.begin = [&](const Simulation&) { trace = PathTrace(problem); };
  observer.step = [&](const Simulation& simulation, const StepReport& report) { trace.add(simulation, report); };
  observer.end = [&](const Simulation& simulation, const StepReport& report, const ErrorEstimate&) {
    trace.add(simulation, report);
  };
  const RunWatch watch;
  AccurateRun run = run_accurately(scene, parameters, plan.communicator, problem.keeps_path(), observer);
  return {std::move(run), RunTimes{watch.seconds(), std::nan(""), watch.processor_seconds()}};
}

/// The program's way and the cheapest cells in turn, so that a machine that slows down for a while does so for all.
AccuracyPrice price_of(const BenchmarkResult& result, double wanted, int threads, const TradePlan& plan) {
  std::vector<const CellResult*> cells = result.cheapest(wanted, threads);
  cells.resize(std::min(cells.size(), kCandidates));
  std::vector<std::vector<RunTimes>> runs(1 + cells.size());
  PathTrace trace(result.problem);
  const RunWatch watch;
  const int least = std::min(plan.repetitions, kLeastRounds);
  for (int round = 0; round < least || (round < plan.repetitions && watch.seconds() < kPriceBudget); ++round) {
    runs[0].push_back(run_for_accuracy(result.problem, wanted, threads, plan, trace).second);
    for (std::size_t i = 0; i < cells.size(); ++i)
      runs[1 + i].push_back(run_once(result.problem, cells[i]->mesh, threads, plan).second);
  }
  AccuracyPrice price;
  price.seconds = cost_of(medians(runs[0]), threads);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double seconds = cost_of(medians(runs[1 + i]), threads);
    if (price.best && seconds >= price.best_seconds) continue;
    price.best = cells[i]->mesh;
    price.best_seconds = seconds;
  }
  return price;
}

CellResult measure_cell(const BenchmarkProblem& problem, const Reference& reference, const Discretization& mesh,
                        const TradePlan& plan) {
  CellResult result{mesh};
  try {
    const auto [simulation, times] = run_once(problem, mesh, plan.threads.front(), plan);
    count_costs(simulation, result);
    result.times[plan.threads.front()] = times;
    if (simulation.result().interrupted) result.status = CellStatus::too_long;
    if (!simulation.result().finished) return result;
    result.status = CellStatus::converged;
    result.errors = reference.errors_of(simulation);
    if (!problem.about.in_gallery) {
      const RunWatch watch;
      result.estimated = estimated_errors(simulation, problem.about.point);
      result.estimate_seconds = watch.processor_seconds();
    }
    result.times = time_cell(problem, mesh, times, plan);
  } catch (const InputError&) {  // a mesh that is too coarse for its curve
    result.status = CellStatus::failed;
  }
  return result;
}

/// Cells that are not computed are among them, with the reason.
void measure_row(BenchmarkResult& result, const Reference& reference, const TradePlan& plan,
                 ForceIntegration integration, int order) {
  const double rounded = std::max(kRoundOff, largest_error(reference.difference));
  int rounded_meshes = 0;
  double last_seconds = 0.0;
  for (const int elements : plan.elements) {
    CellResult cell{{order, elements, integration}};
    if (rounded_meshes >= kRoundedMeshes) {
      cell.status = CellStatus::past_round_off;
    } else if (kGrowth * last_seconds > plan.most_seconds) {
      cell.status = CellStatus::too_long;
    } else {
      cell = measure_cell(result.problem, reference, cell.mesh, plan);
      const double error = largest_error(cell.errors);
      last_seconds = error < kNoSolution ? cell.times.at(plan.threads.front())[kProcessor] : 0.0;
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

void measure_front(BenchmarkResult& result, const Reference& reference, TradePlan plan) {
  plan.threads.resize(1);  // more of them are left to the accuracies
  const double smallest = *std::min_element(plan.accuracies.begin(), plan.accuracies.end());
  const auto seconds = [&plan](const CellResult& cell) { return cell.times.at(plan.threads.front())[kProcessor]; };
  for (auto order = plan.orders.rbegin(); order != plan.orders.rend(); ++order)
    for (const int elements : meshes_of(result.problem)) {
      result.cells.push_back(measure_cell(result.problem, reference, {*order, elements}, plan));
      const CellResult& last = result.cells.back();
      const double error = motion_error(last.errors);
      if (last.status == CellStatus::too_long || error <= smallest) break;
      const auto best = result.cheapest(smallest, plan.threads.front());
      if (error < kNoSolution && !best.empty() && seconds(last) > kClearlyDearer * seconds(*best.front())) break;
    }
}

}  // namespace

double BenchmarkResult::floor() const { return kAboveReference * problem.judged(difference); }

std::vector<const CellResult*> BenchmarkResult::cheapest(double accuracy, int threads) const {
  std::vector<const CellResult*> good;
  if (accuracy < floor()) return good;
  for (const CellResult& cell : cells)
    if (cell.converged() && cell.mesh.integration == ForceIntegration::both_reduced &&
        motion_error(cell.errors) <= accuracy)
      good.push_back(&cell);
  std::stable_sort(good.begin(), good.end(), [threads](const CellResult* a, const CellResult* b) {
    return cost_of(*a, threads) < cost_of(*b, threads);
  });
  return good;
}

AccurateCell measure_accurate_cell(const BenchmarkResult& result, const Reference& reference, double wanted,
                                   const TradePlan& plan) {
  PathTrace trace(result.problem);
  const AccurateRun run = run_for_accuracy(result.problem, wanted, plan.threads.front(), plan, trace).first;
  AccurateCell cell{wanted, run.end, run.rounds};
  if (run.simulation.result().finished) cell.errors = reference.errors_of(run.simulation);
  cell.path_error = trace.error_against(reference.trace, reference.scale[kDisplacement]);
  for (const int threads : plan.threads) cell.prices[threads] = price_of(result, wanted, threads, plan);
  return cell;
}

void measure_cells(BenchmarkResult& result, const Reference& reference, const TradePlan& plan) {
  if (result.problem.about.in_gallery) return measure_front(result, reference, plan);
  for (const ForceIntegration integration : {ForceIntegration::both_reduced, ForceIntegration::full})
    for (const int order : plan.orders)
      if (integration == ForceIntegration::both_reduced || result.problem.about.integrations)
        measure_row(result, reference, plan, integration, order);
}

}  // namespace mixbeam
