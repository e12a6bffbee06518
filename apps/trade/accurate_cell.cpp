#include "apps/trade/accurate_cell.hpp"

#include "apps/trade/run_watch.hpp"
#include "apps/trade/trade_tables.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

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

TimedAccurateRun run_once(const BenchmarkProblem& problem, const Scene& scene, const TimingPlan& plan,
                          const Communicator& communicator) {
  SolverParameters parameters = problem.solver;
  parameters.threads = plan.threads.front();
  const bool keeps_path = scene.stages > 1 || parameters.analysis.branch != Branch::primary;
  const RunWatch watch;
  AccurateRun run = run_accurately(scene, parameters, communicator, keeps_path);
  return {std::move(run), {watch.seconds(), 0.0, watch.processor_seconds()}};
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

AccurateCell measure_accurate_cell(const BenchmarkProblem& problem, const Reference& reference, double wanted,
                                   const TimingPlan& plan, const Communicator& communicator) {
  const Scene scene = scene_with_accuracy(problem, wanted);
  const TimedAccurateRun first = run_once(problem, scene, plan, communicator);
  AccurateCell cell;
  cell.wanted = wanted;
  cell.end = first.run.end;
  cell.rounds = first.run.rounds;
  cell.estimated = first.run.rounds.back().error;
  if (first.run.simulation.result().finished) cell.errors = reference.errors_of(first.run.simulation);
  std::vector<CellTimes> runs;
  const int affordable = static_cast<int>(std::min<double>(plan.repetitions, plan.budget / first.times.seconds));
  for (int i = 0; i < affordable; ++i) runs.push_back(run_once(problem, scene, plan, communicator).times);
  cell.times = runs.size() < kLeastRounds ? first.times : medians(runs);
  return cell;
}

}  // namespace mixbeam
