#include "apps/common/scene_file.hpp"

#include "discretization/number_text.hpp"
#include "discretization/scene_import.hpp"
#include "discretization/scene_parameters.hpp"
#include "discretization/validate.hpp"
#include "kernels/execution_space.hpp"
#include "mixbeam/version.hpp"

#include <unistd.h>

namespace mixbeam {

ListSpec root_spec(const ApplicationDefinition& definition) {
  ListSpec root("Scene file of " + definition.name +
                ". [Name] is a ParameterList, Name: a Parameter; <name> stands for names of your own.");
  root.add_list("Scene", scene_spec(), Presence::required);
  root.add_list("Expected", expected_values_spec(definition.own_quantities), Presence::defaulted);
  root.add_list("Analysis", analysis_spec(), Presence::defaulted);
  root.add_list("Solver", solver_spec(), Presence::defaulted);
  if (definition.batch) root.add_list("Batch", *definition.batch, Presence::optional);
  root.add_list("Study", definition.study, Presence::defaulted);
  return root;
}

namespace {

/// Values at critical points need a path on which these are looked for.
void check_critical_points_are_found(const Application& app) {
  for (const ExpectedValue& value : app.expected) {
    if (!value.critical_point) continue;
    const ParameterPath path = {"Expected", value.name, "Critical Point"};
    if (!app.solver.analysis.stability.value_or(true))
      throw app.xml.source.error(path, R"(given, but critical points are not looked for with "Stability" = false)");
    if (app.solver.load_path.method != LoadPathMethod::automatic)
      throw app.xml.source.error(
          path, R"(given, but critical points are located only with "Method" = "automatic" in "Solver / Load Path")");
  }
}

}  // namespace

void read_scene_file(Application& app, XmlParameters xml, const ApplicationDefinition& definition) {
  app.xml = std::move(xml);
  for (const std::string& text : validate(*app.xml.list, root_spec(definition), app.xml.source)) {
    app.summary.warnings.push_back(text);
    app.out() << "warning: " << text << "\n";
  }
  if (app.xml.source.files().empty())
    app.xml.source.set_files(read_imported_files(app.xml.list->sublist("Scene"), app.xml.source));
  app.scene = read_scene(app.xml.list->sublist("Scene"), app.xml.source);
  if (app.scene.accuracy && !definition.chooses_meshes)
    throw app.xml.source.error({"Scene", "Accuracy"},
                               "given, but this program's meshes are those of its study; allowed: "
                               "in scenes for mixbeam run");
  app.solver = read_solver_parameters(app.xml.list->sublist("Solver"), app.xml.source);
  app.solver.analysis = read_analysis_parameters(app.xml.list->sublist("Analysis"), app.scene, app.xml.source);
  app.expected = read_expected_values(app.xml.list->sublist("Expected"), app.xml.source, definition.own_quantities);
  check_expected_values(app.expected, app.scene, app.xml.source);
  check_critical_points_are_found(app);
}

void describe_run(Application& app, const std::string& name, const std::optional<int>& threads) {
  app.name = app.summary.program = name;
  app.summary.version = kVersion;
  app.summary.compiler = kCompiler;
  app.summary.ranks = app.communicator->getSize();
  if (threads) app.solver.threads = *threads;
  if (app.solver.threads > 0) set_number_of_threads(app.solver.threads);
  app.summary.threads = number_of_threads();
}

void prepare_output_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError("the folder \"" + folder.string() + "\" for results cannot be made: " + error.message());
  if (!std::filesystem::is_directory(folder))
    throw InputError("\"" + folder.string() + "\", meant as a folder for results, is not a folder");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError("the folder \"" + folder.string() + "\" for results cannot be written to");
}

void prepare_summary(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file))
    throw InputError("the summary \"" + file.string() + "\" is a folder; allowed: the name of a file");
  if (file.has_parent_path()) prepare_output_folder(file.parent_path());
  std::error_code error;
  std::filesystem::remove(file, error);
  if (error) throw InputError("the summary \"" + file.string() + "\" cannot be replaced: " + error.message());
}

void require_all_compared(const Application& app, const std::vector<std::string>& cases) {
  for (const ExpectedValue& value : app.not_compared()) {
    if (std::find(cases.begin(), cases.end(), value.load_case) == cases.end()) continue;
    if (value.critical_point)
      throw app.xml.source.error({"Expected", value.name, "Critical Point"},
                                 "value " + std::to_string(*value.critical_point) + "; critical points on the path: " +
                                     std::to_string(app.critical_points(value.load_case)));
    const ParameterPath path = {"Expected", value.name, "Load Factor"};
    if (!value.load_factor) throw app.xml.source.error(path, "the run did not compare this value");
    throw app.xml.source.error(path, "value " + shortest(*value.load_factor) +
                                         "; no load step ended there; allowed: ends of stages, and with \"Method\" = "
                                         "\"fixed\" in \"Solver / Load Path\" the multiples of 1 / \"Steps\"");
  }
}

}  // namespace mixbeam
