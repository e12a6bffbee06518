#include "apps/common/run/scene_file.hpp"

#include "apps/common/run/followed_points.hpp"
#include "apps/common/session/guarded_run.hpp"
#include "apps/common/tables/formatted.hpp"
#include "discretization/checks/scene_warnings.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/variables.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/expression.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "discretization/text/text_file.hpp"
#include "kernels/execution/execution_space.hpp"
#include "mixbeam/version.hpp"
#include "nonlinear/run/imperfect_scene.hpp"
#include "nonlinear/run/rest_shape.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>

namespace mixbeam {

namespace {

ListSpec report_spec() {
  ListSpec spec("Words for the head of the report (mixbeam report); they change nothing else.");
  spec.add(text("Title"), "Of the report; default: the name of the scene.");
  spec.add(text("Project"), "Name or number of the project.");
  spec.add(text("Author"), "Who answers for it.");
  spec.add(text("Checked By"), "Who has checked it.");
  spec.add(text("Date"), "Of the document; default: that of the results.");
  spec.add(text("Remarks"), "What a reader should know first.");
  return spec;
}

/// Requires a path on which critical points are located, if values at them are expected.
void check_critical_points_are_found(const Application& app) {
  std::vector<ParameterPath> places;
  for (const ExpectedValue& value : app.expected)
    if (value.critical_point) places.push_back({"Expected", value.name, "Critical Point"});
  if (app.gradient && asks_for_critical_points(*app.gradient)) places.push_back({"Gradient", "Of"});
  for (const ParameterPath& path : places) {
    if (!app.solver.analysis.stability.value_or(true))
      throw app.xml.source.error(path, R"(given, but critical points are not looked for with "Stability" = false)");
    if (app.solver.load_path.method != LoadPathMethod::automatic)
      throw app.xml.source.error(
          path, R"(given, but critical points are located only with "Method" = "automatic" in "Solver / Load Path")");
  }
}

/// Requires the automatic method for everything but load steps along the primary path.
void check_method(const Application& app) {
  const AnalysisParameters& analysis = app.solver.analysis;
  if (analysis.snap == Snap::jump || app.solver.load_path.method == LoadPathMethod::automatic) return;
  for (const auto& [name, is_given] : {std::pair{"Control", analysis.control.has_value()},
                                       {"Trace", analysis.trace},
                                       {"Branch", analysis.branch != Branch::primary}})
    if (is_given)
      throw app.xml.source.error(
          {"Analysis", name},
          R"(given, but steps are those of the load factor; allowed: with "Method" = "automatic" in "Solver / Load Path", without "LOCA")");
}

/// Upper bound of the unknowns with mass: displacements, and rotations if sections or bodies have rotary inertia.
long long most_modes(const Scene& scene) {
  long long count = 6LL * static_cast<long long>(scene.point_masses.size());
  for (const Member& member : scene.members) count += member.elements * (9LL * member.order - 3) + 3;
  for (const Support& support : scene.supports)
    count -= std::count(support.displacement_fixed.begin(), support.displacement_fixed.end(), true);
  return count;
}

/// Requires a mass in every section, unless there are bodies at points.
void check_modes(const Application& app, const std::string& free_motions) {
  const ParameterSource& source = app.xml.source;
  if (app.solver.analysis.modes.number == 0) return;
  if (!free_motions.empty() && anything_acts(app.scene)) throw InputError(free_motions);
  for (const Section& section : app.scene.sections) {
    const auto uses = [&](const Member& m) { return m.section == section.name || m.end_section == section.name; };
    if (section.mass > 0.0 || section.name == kRigidArm || !app.scene.point_masses.empty() ||
        std::none_of(app.scene.members.begin(), app.scene.members.end(), uses))
      continue;
    throw section.shape ? source.error({"Scene", "Sections", section.name, "Material", "Density"},
                                       "missing; needed: the list \"Modes\" asks for vibrations")
                        : source.error({"Scene", "Sections", section.name, "Mass"},
                                       "missing; needed: the list \"Modes\" asks for vibrations");
  }
  const ParameterPath number = {"Analysis", "Modes", "Number"};
  if (const long long most = most_modes(app.scene); !app.scene.accuracy && app.solver.analysis.modes.number > most)
    throw source.error(number, "value " + std::to_string(app.solver.analysis.modes.number) + ", but no more than " +
                                   std::to_string(most) +
                                   " unknowns carry mass; allowed: fewer modes, or more elements");
}

/// Imports entries of lists from tables, before anything is checked.
void import_tables(XmlParameters& xml) {
  if (!xml.list->isSublist("Scene")) return;
  Teuchos::ParameterList& scene = xml.list->sublist("Scene");
  if (xml.source.files().empty()) xml.source.set_files(read_imported_files(scene, xml.source));
  import_entries(scene, xml.source);
}

/// Parameter that keeps a load from having a potential, empty if it has one. Moments with fixed axes and follower loads
/// have none.
std::string without_potential(const Teuchos::ParameterList& load) {
  if (load.isParameter("Frame") && load.get<std::string>("Frame") == "follower") return "Frame";
  for (const char* moment : {"Moment", "Couple"}) {
    if (!load.isParameter(moment)) continue;
    const auto& value = load.get<Teuchos::Array<double>>(moment);
    if (std::any_of(value.begin(), value.end(), [](double v) { return v != 0.0; })) return moment;
  }
  return load.isParameter("Couple Formula") ? "Couple Formula" : "";
}

/// Requires what jumps need: they descend the total potential between stable states, with load steps.
void check_jumps(const Application& app) {
  const AnalysisParameters& analysis = app.solver.analysis;
  if (analysis.snap != Snap::jump) return;
  const auto refuse = [&app](const ParameterPath& path, const std::string& why) {
    throw app.xml.source.error(path, why + R"( with "Snap" = "jump" in "Analysis")");
  };
  if (!analysis.stability.value_or(true)) refuse({"Analysis", "Stability"}, "value false; allowed: true, or nothing,");
  if (analysis.trace) refuse({"Analysis", "Trace"}, "value true; allowed: false, or nothing,");
  if (analysis.control) refuse({"Analysis", "Control"}, "given; allowed: prescribed displacements in its place");
  if (!app.solver.loca.is_null()) refuse({"Solver", "LOCA"}, "given; allowed: nothing");
  if (app.scene.accuracy) refuse({"Scene", "Accuracy"}, "given; allowed: \"Order\" and \"Elements\" of members");
  const Teuchos::ParameterList& scene = app.xml.list->sublist("Scene");
  for (const char* kind : {"Point Loads", "Distributed Loads"}) {
    if (!scene.isSublist(kind)) continue;
    const Teuchos::ParameterList& loads = scene.sublist(kind);
    for (auto load = loads.begin(); load != loads.end(); ++load) {
      const std::string& name = loads.name(load);
      const std::string parameter = without_potential(loads.sublist(name));
      if (!parameter.empty())
        refuse({"Scene", kind, name, parameter},
               "this load has no potential; allowed: dead forces, prescribed motions");
    }
  }
}

/// Requires "Accuracy Of" to name a quantity, or stresses that exist.
void check_accuracy_of(const Application& app) {
  const std::string& name = app.scene.accuracy_of;
  const auto place = [&app](const std::string& why) { return app.xml.source.error({"Scene", "Accuracy Of"}, why); };
  if (name.empty()) return;
  std::vector<std::string> known = {"stress"};
  for (const QuantitySet::Column& column : app.quantities.columns()) known.push_back(app.quantities.name_of(column));
  known.erase(std::unique(known.begin(), known.end()), known.end());
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw place("value \"" + excerpt(name) + "\"; allowed: " + quoted_list(known));
  const auto is_known = [&app](const Member& member) { return has_stress(app.scene, member, "von Mises stress"); };
  if (name == "stress" && std::none_of(app.scene.members.begin(), app.scene.members.end(), is_known))
    throw place(
        "value \"stress\", but no member has a section of known shape; allowed: sections given by \"Shape\" "
        "and \"Material\", or with \"Stress Points\"");
}

/// Requires a fixed load factor at the end of the path, and one process, for gradients.
void check_gradient(const Application& app) {
  if (app.gradient && app.solver.analysis.control)
    throw app.xml.source.error({"Gradient"},
                               R"(given with "Control" in "Analysis"; allowed: paths by the load factor)");
  if (app.gradient && app.communicator->getSize() > 1)
    throw app.xml.source.error({"Gradient"}, "given, and the run has several processes; allowed: one");
}

/// Refuses formulas with a name of both a variable and a quantity; in formulas the name of a variable means its value.
void check_names_in_formulas(const Application& app, const std::vector<Quantity>& quantities) {
  if (!app.xml.list->sublist("Scene").isSublist("Variables")) return;
  std::vector<std::string> names;
  for (const QuantitySet::Column& column : app.quantities.columns()) names.push_back(name_in_formulas(column.name));
  for (const Quantity& quantity : quantities) {
    if (quantity.formula.empty()) continue;
    const Teuchos::ParameterEntry& entry =
        app.xml.list->sublist("Quantities").sublist(quantity.name).getEntry("Formula");
    const std::string written = std::get<std::string>(written_value(entry).value);
    with_names_replaced(written, [&](const std::string& name) {
      if (std::count(names.begin(), names.end(), name) > 0 &&
          app.xml.list->sublist("Scene").sublist("Variables").isParameter(name))
        throw app.xml.source.error({"Quantities", quantity.name, "Formula"},
                                   "value \"" + excerpt(written) + "\": \"" + name +
                                       "\" names a variable and a quantity; allowed: names that differ");
      return name;
    });
  }
}

void read_quantities_of(Application& app) {
  const ParameterPath path = {"Quantities"};
  const std::vector<Quantity> quantities = read_quantities(app.xml.list->sublist("Quantities"), app.xml.source, path);
  for (const Quantity& quantity : quantities)
    if (quantity.mode > app.solver.analysis.modes.number)
      throw app.xml.source.error(child(child(path, quantity.name), "Mode"),
                                 "value " + std::to_string(quantity.mode) +
                                     "; allowed: up to the \"Number\" of the list \"Modes\" in \"Analysis\", " +
                                     std::to_string(app.solver.analysis.modes.number));
  app.quantities = QuantitySet(quantities, app.scene, {app.xml.source, path});
  check_limits(quantities, app.scene, {app.xml.source, path});
  check_names_in_formulas(app, quantities);
  std::set<std::string> taken(kOwnTimeSeries.begin(), kOwnTimeSeries.end());
  for (const char* kind : {".displacement", ".rotation", ".reaction_force", ".reaction_moment"})
    for (const std::string& point : followed_points(app.scene)) taken.insert(point + kind);
  if (app.solver.analysis.snap == Snap::jump) taken.insert(kJumpSeries.begin(), kJumpSeries.end());
  for (const QuantitySet::Column& column : app.quantities.columns())
    if (!taken.insert(column.name).second)
      throw app.xml.source.error(child(path, quantities[column.quantity].name),
                                 "\"" + excerpt(column.name) + "\" is the name of something else that is followed; " +
                                     "allowed: names that differ");
}

/// Takes the start mesh of a scene that names no mesh. A failure is reported when the scene is solved.
void take_start_mesh(Application& app) {
  app.mesh_is_free = names_no_mesh(app.scene);
  if (!app.mesh_is_free) return;
  try {
    app.scene = on_mesh(app.scene, start_mesh(app.scene, kAccuracyWithoutMesh));
  } catch (const std::exception&) {
  }
}

/// Reads all lists; after a mistake still checks what does not depend on it.
void read_lists(Application& app, const ApplicationDefinition& definition) {
  const ParameterSource& source = app.xml.source;
  Teuchos::ParameterList& root = *app.xml.list;
  std::vector<std::string> notes;
  std::string free_motions;  // left by the supports; allowed for vibrations
  const bool asks_for_modes = root.isSublist("Analysis") && root.sublist("Analysis").isSublist("Modes");
  std::string* const loose = app.loose == nullptr && asks_for_modes ? &free_motions : app.loose;
  app.scene = read_scene(root.sublist("Scene"), source, {"Scene"}, {&notes, loose});
  for (const std::string& note : notes) app.out() << "note: " << note << "\n";
  source.attempt([&] {
    if (app.scene.accuracy && !definition.chooses_meshes)
      throw source.error({"Scene", "Accuracy"},
                         "given, but this program's meshes are those of its study; allowed: in scenes for mixbeam run");
  });
  if (definition.chooses_meshes && !source.has_mistakes()) take_start_mesh(app);
  source.attempt([&] { app.solver = read_solver_parameters(root.sublist("Solver"), source); });
  source.attempt([&] {
    if (!source.has_mistakes() && (app.loose == nullptr || app.loose->empty()))
      app.scene = with_mode_shapes(app.scene, app.solver, app.communicator, {source, {"Scene"}});
  });
  source.attempt([&] { app.solver.analysis = read_analysis_parameters(root.sublist("Analysis"), app.scene, source); });
  if (!source.has_mistakes()) source.attempt([&] { check_modes(app, free_motions); });
  if (!free_motions.empty()) {  // a singular tangent: no stability, no error estimate
    app.solver.analysis.stability = false;
    app.solver.analysis.error_estimate = ErrorEstimation::off;
  }
  if (root.isSublist("Quantities")) source.attempt([&] { read_quantities_of(app); });
  if (root.isSublist("Gradient") && !source.has_mistakes())
    source.attempt([&] { app.gradient = read_gradient(app.xml, app.quantities, app.scene); });
  app.expected = read_expected_values(root.sublist("Expected"), source, definition.own_quantities, {"Expected"},
                                      app.quantities.names());
  check_expected_values(app.expected, app.scene, source);
  source.require_none();
  check_accuracy_of(app);
  check_gradient(app);
  check_critical_points_are_found(app);
  check_method(app);
  check_jumps(app);
  app.search = read_search(app);
}

/// With more threads per processor, starting them dominates.
constexpr int kMostThreadsPerProcessor = 8;

void limit_threads(Application& app) {
  if (app.solver.threads <= kMostThreadsPerProcessor) return;  // asking the system takes a hundredth of a small run
  const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  if (app.solver.threads <= kMostThreadsPerProcessor * processors) return;
  app.warn(std::to_string(app.solver.threads) + " threads on " + std::to_string(processors) + " processor(s); " +
           std::to_string(processors) + " are used, results are the same");
  app.solver.threads = processors;
}

SharedResultLock locked_summary(const std::filesystem::path& file) {
  try {
    return std::make_shared<const ResultLock>(file);
  } catch (const ResultFileError& error) {
    throw InputError(std::string("the summary: ") + error.what());
  }
}

bool is_of(const ExpectedValue& value, const std::vector<std::string>& cases) {
  return std::find(cases.begin(), cases.end(), value.load_case) != cases.end();
}

/// Length of the load steps if none fails; 1: only the ends of stages are known.
double regular_step(const SolverParameters& parameters) {
  const LoadPathParameters& path = parameters.load_path;
  if (path.method == LoadPathMethod::fixed) return 1.0 / path.steps;
  const bool grows = path.initial_step < path.maximum_step;
  return grows || parameters.analysis.trace ? 1.0 : path.maximum_step;
}

/// Whether a path with these parameters has a step to this load factor, unless an earlier step fails.
bool is_end_of_some_step(const SolverParameters& parameters, double load_factor) {
  constexpr double kRounding = 1e-9;  // steps are sums of rounded numbers
  if (parameters.analysis.control) return load_factor == 0.0;
  const auto is_whole = [](double number) {
    return std::abs(number - std::round(number)) <= kRounding * (1.0 + number);
  };
  const std::vector<double>& asked = parameters.analysis.modes.load_factors;
  const auto is_here = [&](double one) { return std::abs(one - load_factor) <= kRounding; };
  if (std::any_of(asked.begin(), asked.end(), is_here)) return true;
  return is_whole(load_factor) || is_whole((load_factor - std::floor(load_factor)) / regular_step(parameters));
}

}  // namespace

ListSpec root_spec(const ApplicationDefinition& definition) {
  ListSpec root("Scene file of " + definition.name +
                ". [Name] is a ParameterList, Name: a Parameter; <name> stands for names of your own.");
  root.add_list("Scene", scene_spec(), Presence::required);
  if (definition.answers_quantities) {
    root.add_list("Quantities", quantities_spec(), Presence::optional);
    root.add_list("Gradient", gradient_spec(), Presence::optional);
  }
  if (definition.finds_rest_shapes) {
    root.add_list("Inverse", rest_shape_spec(), Presence::optional);
    root.add_list("Identification", identification_spec(), Presence::optional);
    root.add_list("Design", design_spec(), Presence::optional);
  }
  root.add_list("Expected", expected_values_spec(definition.own_quantities), Presence::defaulted);
  root.add_list("Analysis", analysis_spec(), Presence::defaulted);
  root.add_list("Solver", solver_spec(), Presence::defaulted);
  if (definition.batch) root.add_list("Batch", *definition.batch, Presence::optional);
  root.add_list("Report", report_spec(), Presence::optional);
  root.add_list("Study", definition.study, Presence::defaulted);
  return root;
}

void read_scene_file(Application& app, XmlParameters xml, const ApplicationDefinition& definition,
                     const ListSpec& root) {
  app.xml = std::move(xml);
  app.xml.source.collect([&] {
    import_tables(app.xml);
    if (app.xml.list->isSublist("Scene"))
      Variables(app.xml.list->sublist("Scene"), app.xml.source).resolve(*app.xml.list, root, {});
    for (const std::string& text : validate(*app.xml.list, root, app.xml.source)) app.warn(text);
    app.xml.source.require_mended();
    read_lists(app, definition);
  });
}

void read_scene_file(Application& app, const std::string& file, const ApplicationDefinition& definition) {
  const ListSpec root = root_spec(definition);
  read_scene_file(app, read_parameters(file, root, Mistakes::kept), definition, root);
}

void warn_of_scene(Application& app) {
  for (const std::string& text : warnings(app.scene))
    if (app.solver.analysis.modes.number == 0 || text != kNothingActs) app.warn(text);
}

InputError placed(const Application& app, const MemberError& error) {
  return app.xml.source.error({"Scene", "Members", error.member()}, error.what());
}

void describe_run(Application& app, const std::string& name, const std::optional<int>& threads) {
  app.name = app.summary.program = name;
  app.summary.version = kVersion;
  app.summary.compiler = kCompiler;
  app.summary.ranks = app.communicator->getSize();
  if (threads) app.solver.threads = *threads;
  limit_threads(app);
  if (app.solver.threads > 0) set_number_of_threads(app.solver.threads);
  app.summary.threads = number_of_threads();
}

void prepare_output_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw InputError("the folder \"" + folder.string() + "\" for results cannot be created: " + error.message());
  if (!std::filesystem::is_directory(folder))
    throw InputError("\"" + folder.string() + "\", meant as a folder for results, is not a folder");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError("the folder \"" + folder.string() + "\" for results cannot be written to");
}

void prepare_summary(Application& app, const std::filesystem::path& file) {
  on_first_rank(app.communicator, [&] {
    if (std::filesystem::is_directory(file))
      throw InputError("the summary \"" + file.string() + "\" is a folder; allowed: the name of a file");
    if (file.has_parent_path()) prepare_output_folder(file.parent_path());
    app.summary_lock = locked_summary(file);
    if (!holds_summary(file)) return;  // possibly an input of this run
    std::error_code error;
    std::filesystem::remove(file, error);
    if (error) throw InputError("the summary \"" + file.string() + "\" cannot be replaced: " + error.message());
  });
}

void set_up_run(Application& app, const CommandLine& line, const std::string& file,
                const ApplicationDefinition& definition) {
  app.quiet = line.quiet;
  app.force = line.force;
  if (line.summary) prepare_summary(app, *line.summary);
  read_scene_file(app, file, definition);
  if (line.summary) require_no_input(*line.summary);
  describe_run(app, definition.name, line.threads);
}

std::string compute_with_summary(Application& app, const CommandLine& line, const std::function<void()>& compute) {
  const auto start = std::chrono::steady_clock::now();
  const auto finish = [&] {
    app.summary.seconds["total"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (line.summary && app.writes_files()) app.summary.write_json(*line.summary);
  };
  try {
    compute();
  } catch (const ConvergenceError& error) {
    app.summary.failure = error.what();
    finish();
    throw;
  }
  finish();
  app.summary.print_checks(app.out(), false);
  return formatted("%.3f s", app.summary.seconds["total"]);
}

void require_reachable(const Application& app, const std::vector<std::string>& cases) {
  for (const ExpectedValue& value : app.expected) {
    if (!value.load_factor || !is_of(value, cases) || is_end_of_some_step(app.solver, *value.load_factor)) continue;
    const std::string allowed = app.solver.analysis.control
                                    ? "none, for with \"Control\" a path ends at a displacement, whatever the load"
                                    : "ends of stages, and in \"Solver / Load Path\" with \"Method\" = \"fixed\" the "
                                      "multiples of 1 / \"Steps\", else those of \"Maximum Step\"; \"Load Factors\" of "
                                      "\"Modes\"";
    throw app.xml.source.error({"Expected", value.name, "Load Factor"},
                               "value " + shortest(*value.load_factor) +
                                   "; a run would find that no load step ended there; allowed: " + allowed);
  }
}

void fail_what_was_missed(Application& app, const std::vector<std::string>& cases) {
  for (const ExpectedValue& value : app.not_compared()) {
    if (!is_of(value, cases)) continue;
    std::string remark = "the run did not compare this value";
    if (value.load_factor) remark = "no load step ended at load factor " + shortest(*value.load_factor);
    if (value.critical_point)
      remark = "critical point " + std::to_string(*value.critical_point) +
               " did not come; critical points on the path: " + std::to_string(app.critical_points(value.load_case));
    app.summary.fail(value.name, value.word.empty() ? shortest(value.value) : value.word, value.source, remark);
  }
}

}  // namespace mixbeam
