#include "apps/trade/accurate_cell.hpp"

#include "apps/trade/choice.hpp"
#include "apps/trade/run_watch.hpp"
#include "apps/trade/trade_tables.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Seconds for the runs of one accuracy with one number of threads, where more than the least number of them are made.
constexpr double kPriceBudget = 0.3;
/// Cells that are timed again for it: the cheapest of a matrix is one of them, whatever the scatter of its times.
constexpr std::size_t kCandidates = 3;

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

struct TimedAccurateRun {
  AccurateRun run;
  CellTimes times;
};

TimedAccurateRun run_once(const BenchmarkProblem& problem, const Scene& scene, int threads,
                          const Communicator& communicator, PathTrace* trace = nullptr) {
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
  AccurateRun run = run_accurately(scene, parameters, communicator, problem.keeps_path(), observer);
  return {std::move(run), {watch.seconds(), 0.0, watch.processor_seconds()}};
}

double cost_of(const CellTimes& times, int threads) { return threads == 1 ? times.processor_seconds : times.seconds; }

/// The cells that reach an accuracy at the least cost, as far as the matrix tells: with so many threads, or with those
/// that it was timed with.
std::vector<Cell> candidates(const BenchmarkResult& result, double wanted, int threads) {
  const CostMeasure cost = [threads](const CellResult& cell) {
    const auto found = cell.times.find(threads);
    const auto& [known, times] = found == cell.times.end() ? *cell.times.begin() : *found;
    return cost_of(times, known);
  };
  BenchmarkResult left = result;
  std::vector<Cell> cells;
  while (cells.size() < kCandidates) {
    const CellResult* best = cheapest(left, {motion_error, cost}, wanted);
    if (best == nullptr) break;
    cells.push_back(best->cell);
    left.cells.erase(left.cells.begin() + (best - left.cells.data()));
  }
  return cells;
}

/// The program's way and the cheapest cells in turn, so that a machine that slows down for a while does so for all.
AccuracyPrice price_of(const BenchmarkResult& result, const Scene& scene, double wanted, int threads,
                       const TimingPlan& plan, const Communicator& communicator) {
  const std::vector<Cell> cells = candidates(result, wanted, threads);
  std::vector<std::vector<CellTimes>> runs(1 + cells.size());
  const RunWatch watch;
  const int least = std::min(plan.repetitions, kLeastRounds);
  for (int round = 0; round < least || (round < plan.repetitions && watch.seconds() < kPriceBudget); ++round) {
    runs[0].push_back(run_once(result.problem, scene, threads, communicator).times);
    for (std::size_t i = 0; i < cells.size(); ++i)
      runs[1 + i].push_back(time_once(result.problem, cells[i], threads, plan, communicator));
  }
  AccuracyPrice price;
  price.seconds = cost_of(medians(runs[0]), threads);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double seconds = cost_of(medians(runs[1 + i]), threads);
    if (price.best && seconds >= price.best_seconds) continue;
    price.best = cells[i];
    price.best_seconds = seconds;
  }
  return price;
}

}  // namespace

std::string meshes_text(const AccurateCell& cell) {
  std::string text;
  for (const MeshRound& round : cell.rounds) {
    const auto work = [](const MemberMesh& mesh) { return (mesh.order + 1) * mesh.elements; };
    const MemberMesh finest = *std::max_element(round.mesh.begin(), round.mesh.end(),
                                                [&](const auto& a, const auto& b) { return work(a) < work(b); });
    text += (text.empty() ? "" : ", ") + mesh_text({ForceIntegration::both_reduced, finest.order, finest.elements}) +
            (round.followed || &round == &cell.rounds.front() ? "" : "*");
  }
  return text;
}

AccurateCell measure_accurate_cell(const BenchmarkResult& result, const Reference& reference, double wanted,
                                   const TimingPlan& plan, const Communicator& communicator) {
  const Scene scene = scene_with_accuracy(result.problem, wanted);
  PathTrace trace(result.problem);
  const AccurateRun run = run_once(result.problem, scene, plan.threads.front(), communicator, &trace).run;
  AccurateCell cell;
  cell.wanted = wanted;
  cell.end = run.end;
  cell.rounds = run.rounds;
  cell.estimated = run.rounds.back().error;
  if (run.simulation.result().finished) cell.errors = reference.errors_of(run.simulation);
  if (!reference.trace().is_empty()) cell.path_error = trace.error_against(reference.trace(), reference.displacement());
  for (const int threads : plan.threads)
    cell.prices[threads] = price_of(result, scene, wanted, threads, plan, communicator);
  return cell;
}

}  // namespace mixbeam
