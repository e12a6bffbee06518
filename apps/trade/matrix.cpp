#include "apps/trade/matrix.hpp"

#include <algorithm>
#include <cmath>

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

CellResult left_out(const Cell& cell, CellStatus status) {
  CellResult result;
  result.cell = cell;
  result.status = status;
  result.errors = kNoErrors;
  return result;
}

/// All meshes of one order.
void measure_row(const BenchmarkProblem& problem, const Reference& reference, const MatrixPlan& plan,
                 ForceIntegration integration, int order, const Communicator& communicator,
                 std::vector<CellResult>& cells) {
  const double rounded = std::max(kRoundOff, reference.difference().largest());
  int rounded_meshes = 0;
  double last_seconds = 0.0;
  for (const int elements : plan.elements) {
    const Cell cell{integration, order, elements};
    if (rounded_meshes >= kRoundedMeshes) {
      cells.push_back(left_out(cell, CellStatus::past_round_off));
    } else if (kGrowth * last_seconds > plan.timing.most_seconds) {
      cells.push_back(left_out(cell, CellStatus::too_long));
    } else {
      cells.push_back(measure_cell(problem, reference, cell, plan.timing, communicator));
      const bool is_solution = cells.back().errors.largest() < kNoSolution;
      last_seconds = is_solution ? cells.back().processor_seconds(plan.timing.threads.front()) : 0.0;
      rounded_meshes = cells.back().errors.largest() <= rounded ? rounded_meshes + 1 : 0;
    }
  }
}

/// Times scatter: a cell that costs more than this many times a better one is no candidate.
constexpr double kClearlyDearer = 1.3;
/// Elements of a member of the file are halved at most so often.
constexpr int kMostHalvings = 4;

std::vector<int> meshes_of(const BenchmarkProblem& problem) {
  std::vector<int> meshes;
  const int own = problem.own_elements();
  for (int part = 1 << kMostHalvings; part >= 1; part /= 2)
    if (own >= part) meshes.push_back((own + part - 1) / part);
  for (int factor = 2; factor <= problem.about.refinement; factor *= 2) meshes.push_back(own * factor);
  return meshes;
}

}  // namespace

BenchmarkResult measure_front(const BenchmarkProblem& problem, const Reference& reference, const MatrixPlan& plan,
                              const Communicator& communicator) {
  BenchmarkResult result{problem, reference.difference(), {}, {}};
  const double smallest = *std::min_element(plan.accuracies.begin(), plan.accuracies.end());
  const Criterion by{motion_error, processor_time(plan.timing.threads.front())};
  const std::vector<int> meshes = meshes_of(problem);
  TimingPlan timing = plan.timing;
  timing.threads.resize(1);  // more of them are left to the accuracies
  for (auto order = plan.orders.rbegin(); order != plan.orders.rend(); ++order)
    for (const int elements : meshes) {
      const Cell cell{ForceIntegration::both_reduced, *order, elements};
      result.cells.push_back(measure_cell(problem, reference, cell, timing, communicator));
      const CellResult& last = result.cells.back();
      if (last.status == CellStatus::too_long || motion_error(last.errors) <= smallest) break;
      const CellResult* best = cheapest(result, by, smallest);
      const bool is_solution = motion_error(last.errors) < kNoSolution;
      if (is_solution && best != nullptr && by.cost(last) > kClearlyDearer * by.cost(*best)) break;
    }
  return result;
}

BenchmarkResult measure_matrix(const BenchmarkProblem& problem, const Reference& reference, const MatrixPlan& plan,
                               const Communicator& communicator) {
  BenchmarkResult result{problem, reference.difference(), {}, {}};
  for (const int order : plan.orders)
    measure_row(problem, reference, plan, ForceIntegration::both_reduced, order, communicator, result.cells);
  if (problem.about.integrations)
    for (const int order : plan.orders)
      measure_row(problem, reference, plan, ForceIntegration::full, order, communicator, result.cells);
  return result;
}

}  // namespace mixbeam
