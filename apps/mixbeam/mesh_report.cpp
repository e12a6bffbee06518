#include "apps/mixbeam/mesh_report.hpp"

#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/element/layout.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <utility>

namespace mixbeam {

namespace {

/// Names per line; the result file has the mesh of every member.
constexpr int kMostNames = 4;
/// Lines with groups of members.
constexpr std::size_t kMostGroups = 12;

void print_rounds(std::ostream& out, const std::vector<ChosenMesh::Round>& rounds) {
  out << formatted("  %-4s %9s %-12s %6s %10s %9s %10s\n", "mesh", "elements", "solved by", "steps", "iterations",
                   "seconds", "estimated");
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    const ChosenMesh::Round& round = rounds[i];
    const std::string error = std::isnan(round.error) ? "-" : formatted("%.1e", round.error);
    out << formatted("  %-4zu %9d %-12s %6d %10d %9.3f %10s%s%s\n", i + 1, round.elements,
                     round.followed ? "load path" : "correction", round.steps, round.iterations, round.seconds,
                     error.c_str(), round.remark.empty() ? "" : "  ", round.remark.c_str());
  }
}

void add_rounds(const AccurateRun& run, ChosenMesh& report) {
  for (const MeshRound& round : run.rounds)
    report.rounds.push_back(
        {round.elements, round.followed, round.steps, round.iterations, round.seconds, round.error, round.remark});
}

/// Checks the change of critical load factors between the last two meshes.
void check_critical_points(Application& app, const std::string& run, const AccurateRun& accurate) {
  const MeshRound& last = accurate.rounds.back();
  if (last.critical_points == 0 && !(last.critical_error > 0.0)) return;
  const bool has_kept = keeps_some_mesh(accurate.simulation.scene());
  if (has_kept)
    app.out() << "  error of critical load factors not estimated: members keep order and elements\n";
  else if (!std::isnan(last.critical_error))
    app.out() << formatted("  critical load factors differ by %.1e from those of the mesh before\n",
                           last.critical_error);
  if (!has_kept && accurate.end != AccuracyEnd::interrupted)
    app.summary.check_upper_bound(run + ": estimated error of critical load factors", last.critical_error,
                                  *accurate.simulation.scene().accuracy, "accuracy that the scene asks for");
}

/// Larger structures keep their start mesh, since solving them twice would be expensive.
constexpr long long kMostElementsToSearch = 20'000;

/// Reason for not searching a mesh; empty if there is none.
std::string obstacle_to_search(const Application& app) {
  const long long elements = elements_of(app.scene);
  if (elements > kMostElementsToSearch) return std::to_string(elements) + " elements are too many to solve them twice";
  if (app.solver.analysis.snap == Snap::jump) return "a path that jumps has no error estimate";
  return "";
}

/// Searches the mesh of one case, from its start mesh or that of earlier cases, for the application's scene.
void search_mesh_of(Application& app, Scene scene, ChosenMesh& report) {
  const bool is_first = report.rounds.empty();
  const MeshChoice start = is_first ? start_mesh(scene, report.wanted) : mesh_of(app.scene);
  // a row of a batch may have another number of members, or name its mesh
  if (!names_no_mesh(scene) || start.size() != app.scene.members.size()) return;
  scene.accuracy = report.wanted;
  AccurateRunObserver observer;
  observer.stop = [&app] { return app.is_asked_to_stop(); };
  observer.threads = [&app](const Scene& on_mesh) { return app.threads_for(on_mesh, app.solver); };
  const AccurateRun run = search_mesh(scene, app.solver, app.communicator, start, observer);
  add_rounds(run, report);
  for (const MeshRound& round : run.rounds) app.summary.newton_iterations += round.iterations;
  MeshChoice mesh = run.rounds.back().mesh;
  if (run.end == AccuracyEnd::no_equilibrium) mesh = doubled(scene, mesh);
  app.scene = on_mesh(app.scene, is_first ? mesh : joined(std::move(mesh), mesh_of(app.scene)));
  if (is_first || run.end != AccuracyEnd::reached) report.outcome = text_of(run.end);
  if (!(run.rounds.back().error <= report.estimated)) report.estimated = run.rounds.back().error;  // keeps NaN
}

std::string note_of(const ChosenMesh& report) {
  const std::string wanted = formatted("for an accuracy of %.1e of displacements", report.wanted);
  if (report.rounds.empty() || std::isnan(report.estimated))
    return wanted + " by the sizes of the loads alone: " + report.outcome;
  return wanted + formatted(", estimated error %.1e: ", report.estimated) + report.outcome;
}

}  // namespace

std::vector<ChosenMesh::Members> members_by_mesh(const Scene& scene, const MeshChoice& choice) {
  std::map<std::pair<int, int>, ChosenMesh::Members> groups;
  for (std::size_t m = 0; m < choice.size(); ++m) {
    ChosenMesh::Members& group = groups[{choice[m].order, choice[m].elements}];
    group.order = choice[m].order;
    group.elements = choice[m].elements;
    if (group.count++ < kMostNames) group.names += (group.names.empty() ? "" : ", ") + scene.members[m].name;
  }
  std::vector<ChosenMesh::Members> members;
  for (auto& [mesh, group] : groups) {
    if (group.count > kMostNames) group.names += " and " + std::to_string(group.count - kMostNames) + " more";
    members.push_back(group);
  }
  std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) { return a.count > b.count; });
  return members;
}

void print_members(std::ostream& out, const std::vector<ChosenMesh::Members>& members) {
  for (std::size_t i = 0; i < std::min(members.size(), kMostGroups); ++i)
    out << formatted("  order %d, elements %d: ", members[i].order, members[i].elements) << members[i].names << "\n";
  if (members.size() > kMostGroups) out << "  ... and " << members.size() - kMostGroups << " other meshes\n";
}

void report_mesh(Application& app, const std::string& run, const AccurateRun& accurate) {
  ChosenMesh report;
  report.run = run;
  report.wanted = *accurate.simulation.scene().accuracy;
  report.estimated = accurate.rounds.back().error;
  report.outcome = text_of(accurate.end);
  MeshChoice choice;
  for (std::size_t m = 0; m < accurate.simulation.scene().members.size(); ++m)
    choice.push_back({accurate.simulation.scene().members[m].order,
                      accurate.simulation.model().mesh().elements_of(static_cast<int>(m))});
  report.members = members_by_mesh(accurate.simulation.scene(), choice);
  add_rounds(accurate, report);
  const std::string& of = accurate.simulation.scene().accuracy_of;
  const std::string name = of.empty() ? "displacements" : "\"" + of + "\"";
  app.out() << "  wanted accuracy of " << name
            << formatted(" %.1e, estimated error %.1e: ", report.wanted, report.estimated) << report.outcome << "\n";
  print_members(app.out(), report.members);
  print_rounds(app.out(), report.rounds);
  check_critical_points(app, run, accurate);
  if (accurate.end != AccuracyEnd::interrupted)
    app.summary.check_upper_bound(run + ": estimated error of " + name, report.estimated, report.wanted,
                                  "accuracy that the scene asks for");
  if (accurate.end != AccuracyEnd::interrupted && accurate.rounds.back().buckling_error != 0.0)
    app.summary.check_upper_bound(run + ": estimated error of linear buckling factors",
                                  accurate.rounds.back().buckling_error, report.wanted,
                                  "accuracy that the scene asks for");
  app.summary.chosen_meshes.push_back(std::move(report));
}

void take_mesh(Application& app, const MeshChoice& mesh, const std::string& note) {
  app.scene = on_mesh(app.scene, mesh);
  app.mesh_is_free = false;
  app.mesh_note = note;
}

void choose_mesh(Application& app, std::size_t count, const std::function<Scene(std::size_t)>& case_of) {
  if (!app.mesh_is_free || count == 0) return;
  ChosenMesh report;
  report.run = app.scene.name;
  report.wanted = kAccuracyWithoutMesh;
  report.outcome = obstacle_to_search(app);
  try {
    if (report.outcome.empty()) {
      search_mesh_of(app, case_of(0), report);
      if (count > 1) search_mesh_of(app, case_of(count - 1), report);
    }
    if (report.outcome.empty()) report.outcome = "the rows have members or meshes of their own";
  } catch (...) {  // the run will meet and report the same problem
    report.outcome = "the search for a better one failed";
    report.estimated = std::nan("");
  }
  app.mesh_is_free = false;
  app.mesh_note = note_of(report);
  report.members = members_by_mesh(app.scene, mesh_of(app.scene));
  app.out() << "no mesh is given: chosen " << app.mesh_note << "\n";
  print_members(app.out(), report.members);
  app.summary.chosen_meshes.push_back(std::move(report));
}

void choose_mesh(Application& app) {
  const std::vector<std::string> cases = chosen_cases(app.scene, {});
  choose_mesh(app, cases.size(), [&](std::size_t i) { return scene_of_case(app.scene, cases[i]); });
}

Scene on_mesh_of(const StoredRun& run, const Scene& scene) {
  MeshChoice mesh;
  bool is_mesh = run.members().size() == scene.members.size();
  for (const SampledMember& member : run.members()) {
    mesh.push_back({member.order, member.elements});
    is_mesh = is_mesh && member.order >= 1 && member.order <= kMaximumOrder && member.elements >= 1;
  }
  if (!is_mesh)
    throw InputError(run.path().string() + ": its members are not those of its scene; allowed: results of mixbeam run");
  Scene result = on_mesh(scene, mesh);
  for (std::size_t m = 0; m < mesh.size(); ++m) {  // files of older versions lack vertices that formulas need
    Member& member = result.members[m];
    if (member.elements == mesh[m].elements) continue;
    member.elements = mesh[m].elements;
    member.stations = scene.members[m].stations;
  }
  return result;
}

void take_stored_mesh(Application& app, const StoredRun& run) {
  if (!app.mesh_is_free || run.members().empty()) return;
  app.scene = on_mesh_of(run, app.scene);
  app.mesh_is_free = false;
  app.mesh_note = run.header().property(kMeshProperty);
}

}  // namespace mixbeam
