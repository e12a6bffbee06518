#include "apps/mixbeam/mesh_report.hpp"

#include "apps/common/tables/formatted.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <utility>

namespace mixbeam {

namespace {

/// Names in one line; the result file has the mesh of every member.
constexpr int kMostNames = 4;
/// Lines of groups.
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

/// What the last two meshes tell about critical load factors, if there are any.
void check_critical_points(Application& app, const std::string& run, const AccurateRun& accurate) {
  const MeshRound& last = accurate.rounds.back();
  if (last.critical_points == 0 && !(last.critical_error > 0.0)) return;
  const std::vector<Member>& members = accurate.simulation.scene().members;
  const bool has_kept = std::any_of(members.begin(), members.end(),
                                    [](const Member& member) { return member.keeps_order && member.keeps_elements; });
  if (has_kept)
    app.out() << "  error of critical load factors not estimated: members keep order and elements\n";
  else if (!std::isnan(last.critical_error))
    app.out() << formatted("  critical load factors differ by %.1e from those of the mesh before\n",
                           last.critical_error);
  if (!has_kept && accurate.end != AccuracyEnd::interrupted)
    app.summary.check_upper_bound(run + ": estimated error of critical load factors", last.critical_error,
                                  *accurate.simulation.scene().accuracy, "accuracy that the scene asks for");
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
  for (const MeshRound& round : accurate.rounds)
    report.rounds.push_back(
        {round.elements, round.followed, round.steps, round.iterations, round.seconds, round.error, round.remark});
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

}  // namespace mixbeam
