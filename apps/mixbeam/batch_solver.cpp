#include "apps/mixbeam/batch_solver.hpp"

#include "apps/common/run/quantity_values.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/scene/merged_scene.hpp"
#include "nonlinear/run/accurate_run.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace mixbeam {

// Serialization for other ranks.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EstimatedValue, name, value, error, not_estimated)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CaseValues, written, limited)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CaseResult, solved, converged, alone, values, iterations, residual, cause, stable)

namespace {

/// Up to this many cases are solved one by one if they do not converge together.
constexpr std::size_t kFewCases = 4;

/// Factor on the residual tolerance of a group: forces differ by kLikeness, moments by its square, so that a residual
/// below it relative to the scales of the group is small enough for each case.
constexpr double kGroupTolerance = 1.0 / (kLikeness * kLikeness);

/// Thrown to leave the path of a group after a failed step.
struct StepFailed {};

/// Whether the analysis is defined for a single structure only.
bool has_path_of_its_own(const AnalysisParameters& analysis) {
  return analysis.modes.number > 0 || analysis.control || analysis.trace || analysis.branch != Branch::primary ||
         analysis.snap == Snap::jump;
}

double elements_of_longest_member(const Scene& scene) {
  int elements = 0;
  for (const Member& member : scene.members) elements = std::max(elements, member.elements);
  return elements;
}

/// Cases in the current state of a simulation.
SolvedCases solved_cases(const Simulation& simulation, const Scene* scenes, std::size_t count, bool merged) {
  std::vector<int> part_of_member;
  SolvedCases solved{simulation, merged};
  for (std::size_t i = 0, support = 0; i < count; ++i) {
    solved.first_support.push_back(support);
    solved.first_member.push_back(static_cast<int>(part_of_member.size()));
    support += scenes[i].supports.size();
    part_of_member.resize(part_of_member.size() + scenes[i].members.size(), static_cast<int>(i));
  }
  solved.reactions = simulation.reactions();
  solved.energies = strain_energy_of_parts(simulation.model(), simulation.state(),
                                           structure_parts(simulation.model(), part_of_member));
  return solved;
}

/// Likewise in another space; `like`: the same cases.
SolvedCases solved_cases(const Simulation& simulation, const SolvedCases& like, const std::vector<int>& part_of_member,
                         const std::vector<EndLayer>* layers) {
  const StructureParts parts = structure_parts(simulation.model(), part_of_member);
  return {simulation,
          like.merged,
          simulation.reactions(),
          strain_energy_of_parts(simulation.model(), simulation.state(), parts),
          like.first_support,
          like.first_member,
          layers};
}

/// Stability at the end of the path of a single structure; by modes, if requested, where the tangent leaves it unknown.
std::string verdict_of(const Simulation& simulation, const ModesParameters& modes) {
  const std::string& stable = simulation.stability().stable;
  if (stable != "unknown" || modes.number == 0) return stable;
  return judged_by_modes(stable, simulation.vibration_modes(modes.number, modes.in_plane, kPointsByOrder));
}

std::string cause_of(const LoadPathResult& result) {
  std::string text = formatted("stopped at load factor %.6g", result.load_factor);
  if (result.report && !result.report->attempts.empty()) text += ": " + cause_text(result.report->attempts.back());
  return text;
}

using Json = nlohmann::json;

/// Gathers the texts of all ranks on rank 0.
std::vector<std::string> texts_of(const Teuchos::Comm<int>& ranks, const std::string& mine) {
  std::vector<std::string> all(ranks.getSize());
  all[0] = mine;
  for (int rank = 1; rank < ranks.getSize(); ++rank) {
    int size = static_cast<int>(mine.size());
    if (ranks.getRank() == rank) {
      Teuchos::send(ranks, size, 0);
      ranks.send(size, mine.data(), 0);
    } else if (ranks.getRank() == 0) {
      Teuchos::receive(ranks, rank, &size);
      all[rank].resize(size);
      ranks.receive(rank, size, all[rank].data());
    }
  }
  return all;
}

}  // namespace

BatchSolver::BatchSolver(Application& app, const CaseQuantities& quantities, CaseResults& results,
                         std::function<bool()> stop)
    : app_(app),
      quantities_(quantities),
      stop_(std::move(stop)),
      results_(results),
      may_merge_(!has_path_of_its_own(app.solver.analysis) && !app.scene.accuracy &&
                 app.scene.rotating_frames.empty()) {}

void BatchSolver::solve(const std::vector<std::size_t>& cases, const std::vector<Scene>& scenes) {
  cases_ = &cases;
  scenes_ = &scenes;
  solve_range({0, cases.size()});
}

bool BatchSolver::solve_all(const CaseGroups& groups, CaseScenes& scenes,
                            const std::function<void(std::size_t group)>& solved, int rank, int ranks) {
  const auto is_left = [this](std::size_t i) { return !results_.all()[i].solved; };
  for (std::size_t g = static_cast<std::size_t>(rank); g < groups.size(); g += static_cast<std::size_t>(ranks)) {
    std::vector<Scene> of_group;
    for (const std::size_t i : groups[g]) of_group.push_back(scenes.scene_of(i));
    solve(groups[g], of_group);
    solved(g);
    const bool is_last = g + static_cast<std::size_t>(ranks) >= groups.size();
    if (stop_() && (!is_last || std::any_of(groups[g].begin(), groups[g].end(), is_left))) return false;
  }
  return true;
}

bool CaseResults::gather(const Teuchos::Comm<int>& ranks, Summary& summary, bool all_solved) {
  constexpr std::size_t kCasesOfMessage = 10'000;  // bounds memory: JSON needs several times that of a result
  for (std::size_t first = 0; first < all_.size(); first += kCasesOfMessage) {
    const std::size_t end = std::min(first + kCasesOfMessage, all_.size());
    Json mine = {{"all", all_solved}, {"results", Json::array()}};
    if (end == all_.size()) mine["summary"] = summary.packed();
    for (std::size_t i = first; i < end && ranks.getRank() > 0; ++i)
      if (all_[i].solved) mine["results"].push_back({i, all_[i]});
    std::string bytes;
    Json::to_cbor(mine, bytes);
    const std::vector<std::string> all = texts_of(ranks, bytes);
    for (int rank = 1; ranks.getRank() == 0 && rank < ranks.getSize(); ++rank) {
      const Json other = Json::from_cbor(all[rank]);
      all_solved = all_solved && other["all"].get<bool>();
      if (other.contains("summary")) summary.append(other["summary"]);
      for (const Json& result : other["results"]) result[1].get_to(all_[result[0]]);
    }
  }
  return all_solved;
}

void BatchSolver::solve_range(const Range& range) {
  if (stop_()) return;
  const std::size_t count = range.second - range.first;
  const bool together = may_merge_ && count > 1;
  if (together && solve_together(range)) {
    for (std::size_t i = range.first; i < range.second; ++i)
      if (!results_.all()[(*cases_)[i]].converged) keep(i, solved_alone((*scenes_)[i]));
    return;
  }
  if (stop_()) return;
  if (!together || count <= kFewCases) {
    for (std::size_t i = range.first; i < range.second; ++i) keep(i, solved_alone((*scenes_)[i]));
    return;
  }
  const std::size_t middle = range.first + count / 2;
  solve_range({range.first, middle});
  solve_range({middle, range.second});
}

/// Solves cases as one structure. False if they do not converge together.
bool BatchSolver::solve_together(const Range& range) {
  std::vector<const Scene*> scenes;
  for (std::size_t i = range.first; i < range.second; ++i) scenes.push_back(&(*scenes_)[i]);
  const MergedScene merged = merge_scenes(scenes);
  SolverParameters parameters = app_.solver;
  parameters.threads = app_.threads_for(merged.scene, app_.solver);
  parameters.newton.residual_tolerance *= kGroupTolerance;
  Simulation simulation(merged.scene, parameters, app_.communicator);
  References references;
  const RunObserver take = taking(references, &(*scenes_)[range.first], scenes.size(), true);
  PathControl control;
  control.step_failed = [](const StepFailure&) { throw StepFailed(); };
  control.stop = stop_;
  try {
    simulation.run([&](const StepReport& report, const State&) { take(simulation, report); }, control);
  } catch (const StepFailed&) {
    app_.summary.newton_iterations += simulation.work().newton_iterations;
    return false;
  }
  app_.summary.add_work(simulation.result().steps, simulation.result().newton_iterations, simulation.times());
  if (!simulation.result().finished) return false;
  const std::string& stable = simulation.stability().stable;
  if (stable == "false" || stable == "neutral") return false;  // of some case; the halves will show which one
  std::vector<CaseResult> results =
      checked(simulation, &(*scenes_)[range.first], scenes.size(), merged.part_of_member, true, references);
  if (results.empty()) return false;
  for (std::size_t i = 0; i < results.size(); ++i)
    if (results[i].converged) keep(range.first + i, std::move(results[i]));
  return true;
}

/// Solves a case on a mesh of its own, see accurate_run.hpp.
CaseResult BatchSolver::solved_accurately(const Scene& scene) {
  AccurateRunObserver observer;
  observer.stop = stop_;
  judge_wanted(scene, app_.quantities, observer);
  observer.threads = [this](const Scene& on_mesh) { return app_.threads_for(on_mesh, app_.solver); };
  References references;
  observer.step = taking(references, &scene, 1, false);
  const AccurateRun run = run_accurately(scene, app_.solver, app_.communicator, quantities_.needs_path(), observer);
  for (const MeshRound& round : run.rounds) app_.summary.add_work(round.steps, round.iterations);
  app_.summary.add_work(0, 0, run.simulation.times());
  CaseResult result;
  if (run.end == AccuracyEnd::interrupted) return result;
  result.solved = result.alone = true;
  if (!run.simulation.result().finished) {
    result.cause = cause_of(run.simulation.result());
    return result;
  }
  result = checked_alone(run.simulation, scene, references);
  if (run.end == AccuracyEnd::reached || run.rounds.back().error <= *scene.accuracy) return result;
  result.converged = false;
  result.cause = formatted("accuracy of %.1e: ", *scene.accuracy) + text_of(run.end);
  return result;
}

/// Solves a single case; result.solved stays false if interrupted.
CaseResult BatchSolver::solved_alone(const Scene& scene) {
  CaseResult result;
  if (stop_()) return result;
  if (scene.accuracy) return solved_accurately(scene);
  PathControl control;
  control.stop = stop_;
  References references;
  const Simulation simulation = app_.try_to_solve(
      scene, app_.solver, quantities_.needs_path() ? taking(references, &scene, 1, false) : RunObserver{}, control);
  if (simulation.result().interrupted) return result;
  if (simulation.result().finished) return checked_alone(simulation, scene, references);
  result.solved = result.alone = true;
  result.iterations = simulation.result().newton_iterations;
  result.cause = cause_of(simulation.result());
  return result;
}

CaseResult BatchSolver::checked_alone(const Simulation& simulation, const Scene& scene, const References& references) {
  const bool merged = false;
  CaseResult result =
      checked(simulation, &scene, 1, std::vector<int>(scene.members.size(), 0), merged, references).front();
  result.alone = true;
  return result;
}

/// Returns an observer that stores the reference values of limits.
RunObserver BatchSolver::taking(References& references, const Scene* scenes, std::size_t count, bool merged) const {
  return [=, &references](const Simulation& simulation, const StepReport& report) {
    if (!quantities_.is_reference(report.load_factor)) return;
    const SolvedCases solved = solved_cases(simulation, scenes, count, merged);
    std::vector<std::vector<double>>& values = references[static_cast<Stage>(std::lround(report.load_factor))];
    values.clear();
    for (std::size_t i = 0; i < count; ++i) values.push_back(quantities_.asked_of(solved, static_cast<int>(i)));
  };
}

/// Checks each case of a simulation at the end of its path. Empty if errors are needed and cannot be estimated for
/// cases side by side.
std::vector<CaseResult> BatchSolver::checked(const Simulation& simulation, const Scene* scenes, std::size_t count,
                                             const std::vector<int>& part_of_member, bool merged,
                                             const References& references) {
  const StructureParts parts = structure_parts(simulation.model(), part_of_member);
  const std::vector<PartCheck> checks = simulation.check_parts(parts);
  const SolvedCases solved = solved_cases(simulation, scenes, count, merged);
  std::optional<RicherStates> there;
  RicherCases richer;
  if (!quantities_.limits().empty() &&
      estimates_error(app_.solver.analysis, static_cast<std::size_t>(elements_of(scenes[0])))) {
    there.emplace(simulation, simulation.estimate_error());
    richer.not_estimated = there->not_estimated;
    if (merged && there->states.empty()) return {};
    for (std::size_t i = 0; i < there->states.size(); ++i)
      richer.states.push_back(solved_cases(there->states[i], solved, part_of_member, &there->layers[i]));
  }
  const std::string stable = verdict_of(simulation, app_.solver.analysis.modes);
  std::vector<CaseResult> results(count);
  for (int part = 0; part < parts.count; ++part) {
    const PartCheck& check = checks[part];
    CaseResult& result = results[part];
    result.solved = true;
    result.iterations = simulation.result().newton_iterations;
    result.residual = check.residual;
    result.stable = stable;
    // a single structure has passed the solver's own tests; cases side by side are tested here
    const double allowed =
        balance_tolerance(static_cast<double>(elements_of(scenes[part])), elements_of_longest_member(scenes[part]),
                          check.residual, rounding_of_levers(scenes[part]));
    const bool balances = check.force_error <= allowed && check.moment_error <= allowed;
    const bool settled = !merged || check.residual <= app_.solver.newton.residual_tolerance;
    result.converged = balances && settled;
    if (result.converged)
      result.values = quantities_.of(solved, richer, part, references);
    else
      result.cause = formatted("loads and reactions do not balance: forces %.1e, moments %.1e of the largest at work",
                               check.force_error, check.moment_error);
  }
  return results;
}

}  // namespace mixbeam
