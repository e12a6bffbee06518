#include "apps/mixbeam/scene_run.hpp"

#include "apps/common/run/quantity_values.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/guarded_run.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "apps/mixbeam/run_report.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// "1 step", "2 steps".
std::string counted(int number, const std::string& noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

void warn_of_uncertain_forces(Application& app, const std::string& run, Simulation& simulation) {
  const std::optional<UncertainForce> force = simulation.uncertain_force();
  if (!force) return;
  app.summary.warnings.push_back(run + ": " + text_of(*force));
  app.out() << "warning: " << text_of(*force) << "\n";
}

void say_how_to_resume(Application& app, const Simulation& simulation, const std::filesystem::path& file) {
  const LoadPathResult& path = simulation.result();
  app.out() << "Stopped after step " << path.steps << ", load factor "
            << formatted("%.6g of %d. ", path.load_factor, simulation.scene().stages);
  const std::string obstacle = obstacle_to_resuming(app);
  if (obstacle.empty() && file.empty())
    app.out() << "This run cannot be resumed: it has no file.\n";
  else if (obstacle.empty())
    app.out() << "To continue:\n  mixbeam resume " << file.string() << "\n";
  else
    app.out() << "This run cannot be resumed: " << obstacle << ".\n";
}

/// "1.35 dead + 1.5 wind"; empty where that is no combination.
std::string combination_text(const Scene& scene, const std::string& name) {
  for (const Combination& one : scene.combinations) {
    if (one.name != name) continue;
    std::string text;
    for (const auto& [load_case, factor] : one.cases)
      text += formatted(text.empty()   ? "%.6g "
                        : factor < 0.0 ? " - %.6g "
                                       : " + %.6g ",
                        text.empty() ? factor : std::abs(factor)) +
              load_case;
    return text;
  }
  return "";
}

/// A table beside the result file; without rows none, also where an earlier run left one.
void write_beside(const std::filesystem::path& file, const std::string& name, const std::vector<std::string>& columns,
                  const std::vector<std::vector<CsvCell>>& rows) {
  const std::filesystem::path csv = file.parent_path() / (file.stem().string() + "-" + name + ".csv");
  std::error_code ignored;
  if (rows.empty()) return static_cast<void>(std::filesystem::remove(csv, ignored));
  CsvTable table(csv, columns, Appears::when_closed);
  for (const std::vector<CsvCell>& row : rows) table.add_row(row);
  table.close();
}

/// Checks of limits since `first`, and where extremes are at the end.
void write_limits_and_places(const Application& app, const RunReport& report, std::size_t first,
                             const std::filesystem::path& file) {
  if (file.empty() || !app.writes_files()) return;
  std::vector<std::vector<CsvCell>> limits, places;
  for (std::size_t i = first; i < app.summary.checks().size(); ++i)
    if (const CheckedQuantity& check = app.summary.checks()[i]; check.source == kLimitOfScene)
      limits.push_back({check.name, check.value, check.reference, check.pass ? "yes" : "NO"});
  for (const auto& [quantity, place] : report.places()) places.push_back({quantity, place});
  write_beside(file, "limits", {"limit", "value", "allowed", "passed"}, limits);
  write_beside(file, "gradients", {"quantity", "value", "number", "derivative"}, report.gradients());
  write_beside(file, "frequencies", report.frequency_columns(), report.frequencies());
  write_beside(file, "places", {"quantity", "place at the end"}, places);
}

}  // namespace

std::string obstacle_to_resuming(const Application& app) {
  if (app.scene.accuracy) return "its scene asks for an accuracy, and the mesh is chosen by the whole run";
  return obstacle_to_resuming(app.solver);
}

std::map<std::string, std::string> properties_of_case(const std::string& load_case) {
  return {{"load_case", load_case}};
}

std::vector<std::string> chosen_cases(const Scene& scene, const std::optional<std::string>& wanted) {
  const std::vector<std::string> known = alternatives(scene);
  if (!wanted) return known.empty() ? std::vector<std::string>{""} : known;
  if (std::find(known.begin(), known.end(), *wanted) != known.end()) return {*wanted};
  throw InputError("option --case: \"" + excerpt(*wanted) +
                   "\" is not a load case or combination of the scene; allowed: " +
                   (known.empty() ? "nothing, the scene has none" : quoted_list(known)) + did_you_mean(*wanted, known));
}

std::filesystem::path result_file_of(const std::filesystem::path& folder, const std::string& name,
                                     const std::string& load_case) {
  return folder / (name + (load_case.empty() ? "" : "-" + load_case) + ".h5");
}

void warn_without_lock(Application& app, const SharedResultLock& lock) {
  if (lock && !lock->warning().empty()) app.warn(lock->warning());
}

SharedResultLock lock_or_warn(Application& app, const std::filesystem::path& file) {
  SharedResultLock lock = lock_result(file, *app.communicator);
  warn_without_lock(app, lock);
  return lock;
}

RunEnd run_case(Application& app, const std::string& load_case, const std::filesystem::path& file,
                const WritingOptions& writing, const StoredRun* resume) {
  // a large scene is not held twice: nothing changes that of the application, which outlives its runs
  const std::shared_ptr<const Scene> kept =
      load_case.empty() && alternatives(app.scene).empty()
          ? std::shared_ptr<const Scene>(std::shared_ptr<const Scene>(), &app.scene)
          : std::make_shared<const Scene>(scene_of_case(app.scene, load_case));
  const Scene& scene = *kept;
  app.load_case = load_case;
  RunReport report(&app.quantities, scene);
  if (resume != nullptr) report.add(*resume);
  const std::string name = file.empty() ? scene.name : file.stem().string();
  Recording recording;
  recording.file = file;
  if (!file.empty()) recording.monitor = file.parent_path() / (file.stem().string() + "-monitor.csv");
  recording.properties = properties_of_case(load_case);
  const std::string combination = combination_text(app.scene, load_case);
  if (!combination.empty()) recording.properties["combination"] = combination;
  if (!app.mesh_note.empty()) recording.properties[kMeshProperty] = app.mesh_note;
  if (!app.quantities.empty()) recording.quantities = &app.quantities;
  if (app.gradient)
    recording.gradients = [&app, load_case, resume](const Simulation& at, const std::vector<CriticalPoint>& passed) {
      std::vector<CriticalPoint> points;
      Simulation before = at.at(at.state(), at.load_factor());
      for (std::size_t i = 0; resume != nullptr && i < resume->steps().size(); ++i)
        for (CriticalPoint& point : stored_critical_points(before, *resume, i)) points.push_back(std::move(point));
      points.insert(points.end(), passed.begin(), passed.end());
      return gradients_or_reason(at, *app.gradient, {app.quantities, points}, app.xml, load_case);
    };
  recording.resume = resume;
  recording.writing = writing;
  recording.stop = [&app] { return app.is_asked_to_stop(); };
  recording.record_observer = [&report](const StepRecord& record) { report.add(record); };
  recording.observer = [&app](const Simulation& simulation, const StepReport& step) {
    app.check_expected(simulation, step);
    if (app.watch) app.watch(simulation, step);
  };
  const std::size_t checks = app.summary.checks().size();
  recording.restart = [&app, &report, &scene, checks] {
    report = RunReport(&app.quantities, scene);
    app.summary.keep_checks(checks);
  };
  std::optional<AccurateRun> accurate;
  if (scene.accuracy)
    accurate =
        app.record_accurately(scene, app.solver, recording, asks_for_path(app.solver, app.expected, load_case, scene));
  Simulation simulation = accurate ? accurate->simulation : app.record(kept, app.solver, recording);
  app.out() << name << ": " << counted(simulation.result().steps, "step") << " to load factor "
            << simulation.result().load_factor << (file.empty() ? "" : ", " + file.string()) << "\n";
  if (accurate) report_mesh(app, name, *accurate);
  report.add_places(places_of(app.quantities, simulation));
  app.reports == nullptr ? report.print(app.out()) : report.print_short(*app.reports, name);
  warn_of_uncertain_forces(app, name, simulation);
  report.add_stresses(app, name);
  report.add_errors(app, name);
  report.add_quantities(app, name);
  report.add_gradients(app, name);
  write_limits_and_places(app, report, checks, file);
  report.check_balance(app, name);
  const bool between_meshes = accurate && accurate->end == AccuracyEnd::interrupted;
  if (!simulation.result().interrupted && !between_meshes) {
    report.add_end(app, name);
    return RunEnd::arrived;
  }
  say_how_to_resume(app, simulation, file);
  return RunEnd::interrupted;
}

int finish_runs(Application& app, const CommandLine& line, const std::function<RunEnd()>& cases) {
  RunEnd end = RunEnd::arrived;
  const std::string seconds = compute_with_summary(app, line, [&] {
    try {
      end = cases();
    } catch (const MemberError& error) {
      throw placed(app, error);
    }
  });
  app.out() << "mixbeam: " << counted(app.summary.load_steps, "load step") << ", "
            << counted(app.summary.newton_iterations, "Newton iteration") << ", " << seconds
            << (app.output.empty() ? "" : ", results in " + app.output.string()) << "\n";
  print_ends(app.out(), app.summary, app.solver.analysis.control.has_value());
  if (end == RunEnd::interrupted) return kInterruptedExitCode;
  return app.summary.all_passed() ? 0 : kFailedExitCode;
}

}  // namespace mixbeam
