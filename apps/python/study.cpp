/// Programs with a study written in Python: everything else (command line, scene file, tables, checks, summary, exit
/// code) is shared with the other programs. Takes no Turn: the process belongs to the program.
#include "apps/common/studies/study.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/python/arrays.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/number_text.hpp"

#include <sstream>

namespace py = pybind11;

namespace mixbeam {

namespace {

CsvCell cell_of(const py::handle& value) {
  if (py::isinstance<py::str>(value)) return {value.cast<std::string>()};
  if (py::isinstance<py::int_>(value)) return {value.cast<long>()};
  return {value.cast<double>()};
}

void add_row(StudyTable& table, const py::iterable& row) {
  std::vector<CsvCell> cells;
  for (const py::handle& value : row) cells.push_back(cell_of(value));
  table.add_row(cells);
}

/// A solved scene, or the reason of the failure.
struct Trial {
  std::optional<Simulation> simulation;
  LoadPathResult result;
  double seconds = 0.0, processor_seconds = 0.0;               ///< from the scene (already read) to the result
  double residual = std::numeric_limits<double>::quiet_NaN();  ///< of the last step
  std::vector<int> negative;                                   ///< negative eigenvalues in each step; -1: not counted
  bool symmetric = true;               ///< tangent of the last step; otherwise `negative` is meaningless
  std::vector<double> critical_loads;  ///< load factors

  void observe(const StepReport& report) {
    residual = report.residual;
    negative.push_back(report.stability ? report.stability->negative : -1);
    symmetric = !report.stability || report.stability->symmetric;
    for (const CriticalPoint& point : report.critical_points) critical_loads.push_back(point.load_factor);
  }
};

enum class Follow {
  counted,   ///< its costs are added to the study
  recorded,  ///< likewise, with a result file, which is not used
  path,      ///< costs are not added
  at_once    ///< likewise, by Newton's method for the whole load, without checks
};

/// Solves a scene. `estimates`: estimates the discretization error too.
Trial solve(Application& app, const std::string& text, Follow way, bool estimates) {
  std::ostringstream unread;
  Application read;
  read.communicator = app.communicator;
  read.terminal = &unread;
  read_scene_file(read, parsed_scene(text, "scene of the study"), mixbeam_definition(), mixbeam_root_spec());
  read.solver.threads = app.solver.threads;
  Trial trial;
  const auto observe = [&trial](const Simulation&, const StepReport& report) { trial.observe(report); };
  const auto observe_path = [&trial](const StepReport& report, const State&) { trial.observe(report); };
  Recording recording;
  recording.file = app.output / "recorded.h5";
  recording.observer = observe;
  if (!read.quantities.empty()) recording.quantities = &read.quantities;
  if (read.gradient)
    recording.gradients = [&read](const Simulation& simulation, const std::vector<CriticalPoint>& points) {
      return gradients_or_reason(simulation, *read.gradient, {read.quantities, points}, read.xml, read.load_case);
    };
  const RunWatch watch;
  try {
    if (way == Follow::counted) {
      trial.simulation = app.try_to_solve(read.scene, read.solver, observe);
    } else if (way == Follow::recorded) {
      trial.simulation = app.record(read.scene, read.solver, recording);
    } else {
      read.solver.threads = app.threads_for(read.scene, read.solver);
      trial.simulation.emplace(read.scene, read.solver, app.communicator);
      if (way == Follow::path)
        trial.simulation->run(observe_path);
      else
        trial.simulation->settle(State(trial.simulation->state()), observe_path);
    }
    trial.result = trial.simulation->result();
    if (estimates) trial.simulation->estimate_error();
  } catch (const InputError& problem) {
    if (way != Follow::counted) throw;
    trial.result.failure = problem.what();
  }
  trial.seconds = watch.seconds();
  trial.processor_seconds = watch.processor_seconds();
  return trial;
}

using Ints = Teuchos::Array<int>;
using Reals = Teuchos::Array<double>;

template <class Kind>
bool is_list_of(const py::handle& value) {
  return py::isinstance<py::list>(value) && py::isinstance<Kind>(value.cast<py::list>()[0]);
}

/// Declares (name, default, least, most, meaning); default words are the set to choose from. A real number must exceed
/// `least` unless that is an integer; those of a list must also be below `most`. A tuple has a fixed length.
void add_parameter(ListSpec& spec, const py::tuple& declared) {
  const auto name = declared[0].cast<std::string>(), meaning = declared[4].cast<std::string>();
  const py::handle value = declared[1], least = declared[2], most = declared[3];
  if (py::isinstance<py::bool_>(value)) {
    spec.add(boolean(name).by_default(value.cast<bool>()), meaning);
  } else if (py::isinstance<py::int_>(value)) {
    spec.add(count(name, value.cast<int>(), most.cast<double>(), meaning, least.cast<int>()));
  } else if (py::isinstance<py::tuple>(value)) {
    const auto by_default = value.cast<std::vector<int>>();
    const ParameterSpec integers = array(name, ParameterType::integer_array, static_cast<int>(by_default.size()));
    spec.add(integers.at_least(least.cast<double>()).at_most(most.cast<double>()).by_default(Ints(by_default)),
             meaning);
  } else if (is_list_of<py::int_>(value)) {
    spec.add(counts(name, value.cast<std::vector<int>>(), most.cast<double>(), meaning, least.cast<int>()));
  } else if (is_list_of<py::float_>(value)) {
    const ParameterSpec reals = array(name, ParameterType::real_array).above(least.cast<double>());
    spec.add(reals.below(most.cast<double>()).by_default(Reals(value.cast<std::vector<double>>())), meaning);
  } else if (py::isinstance<py::float_>(value)) {
    const double bound = least.cast<double>();
    const ParameterSpec number = py::isinstance<py::int_>(least) ? real(name).at_least(bound) : real(name).above(bound);
    spec.add(number.at_most(most.cast<double>()).by_default(value.cast<double>()), meaning);
  } else {
    const auto words = value.cast<std::vector<std::string>>();
    spec.add(subset(name, words).by_default(Teuchos::Array<std::string>(words)), meaning);
  }
}

/// Rethrows mixbeam's Python exceptions as their C++ originals; others are unforeseen.
template <class Action>
void with_errors_of_the_program(const Action& action) {
  try {
    action();
  } catch (py::error_already_set& error) {
    const py::module_ errors = py::module_::import("mixbeam.errors");
    const auto text = py::str(error.value()).cast<std::string>();
    if (error.matches(errors.attr("ConvergenceError"))) throw ConvergenceError(text);
    if (error.matches(errors.attr("InputError"))) throw InputError(text);
    throw;
  }
}

int run_python_study(const std::vector<std::string>& arguments, const std::string& name, const std::string& purpose,
                     const std::string& meaning, const py::list& parameters, const py::function& run) {
  ApplicationDefinition definition;
  definition.name = name;
  definition.purpose = purpose;
  definition.study = ListSpec(meaning);
  definition.folder = std::filesystem::path(arguments.at(0)).parent_path();
  for (const py::handle& parameter : parameters)
    add_parameter(definition.study, py::reinterpret_borrow<py::tuple>(parameter));
  definition.run_study = [&run](Application& app) {
    with_errors_of_the_program([&] { run(py::cast(app, py::return_value_policy::reference)); });
  };
  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  return run_application(static_cast<int>(argv.size()), argv.data(), definition);
}

/// Makes a check of the summary a method of the application.
template <class... Arguments>
auto check_by(bool (Summary::*check)(Arguments...)) {
  return [check](Application& app, Arguments... arguments) { (app.summary.*check)(arguments...); };
}

}  // namespace

void bind_study(py::module_& module) {
  using namespace py::literals;
  py::class_<StudyTable>(module, "StudyTable").def("add_row", add_row);
  py::enum_<Follow>(module, "Follow")
      .value("counted", Follow::counted)
      .value("recorded", Follow::recorded)
      .value("path", Follow::path)
      .value("at_once", Follow::at_once);
  py::class_<Trial>(module, "Trial")
      .def_property_readonly("finished", [](const Trial& t) { return t.result.finished; })
      .def_property_readonly("failure", [](const Trial& t) { return t.result.failure; })
      .def_property_readonly("steps", [](const Trial& t) { return t.result.steps; })
      .def_property_readonly("failed_steps", [](const Trial& t) { return t.result.failed_steps; })
      .def_property_readonly("iterations", [](const Trial& t) { return t.result.newton_iterations; })
      .def_readonly("seconds", &Trial::seconds)
      .def_readonly("processor_seconds", &Trial::processor_seconds)
      .def_readonly("residual", &Trial::residual)
      .def_readonly("negative", &Trial::negative)
      .def_readonly("symmetric", &Trial::symmetric)
      .def_readonly("critical_loads", &Trial::critical_loads)
      .def("condition", [](Trial& t) { return t.simulation ? t.simulation->condition_estimate() : std::nan(""); })
      .def("displacement", [](const Trial& t, const std::string& point) { return t.simulation->displacement(point); })
      .def("rotation", [](const Trial& t, const std::string& point) { return t.simulation->rotation(point); });
  py::class_<Application>(module, "Application")
      .def("scene", [](const Application& app) { return parameters_of(parsed_scene(app.xml.text, app.name)); })
      .def_property_readonly("output", [](const Application& app) { return app.output.string(); })
      .def_property_readonly("writes_files", &Application::writes_files)
      .def_property(
          "threads", [](const Application& app) { return app.solver.threads; },
          [](Application& app, int threads) { app.solver.threads = threads; })
      .def_readwrite("quiet", &Application::quiet)
      .def("number", [](Application& app, const std::string& name) { return app.study().get<int>(name); })
      .def("real", [](Application& app, const std::string& name) { return app.study().get<double>(name); })
      .def("numbers", [](Application& app, const std::string& name) { return study_list<int>(app, name); })
      .def("reals", [](Application& app, const std::string& name) { return study_list<double>(app, name); })
      .def("switch", [](Application& app, const std::string& name) { return app.study().get<bool>(name); })
      .def("words", [](Application& app, const std::string& name) { return study_list<std::string>(app, name); })
      .def("error", [](const Application& app, const ParameterPath& path,
                       const std::string& problem) { throw app.xml.source.error(path, problem); })
      .def("check_upper_bound", check_by(&Summary::check_upper_bound))
      .def("check_absolute", check_by(&Summary::check_absolute))
      .def("check_relative", check_by(&Summary::check_relative))
      .def("count_work", [](Application& app, int steps, int iterations) { app.summary.add_work(steps, iterations); })
      .def("table", [](const Application& app, const std::string& file, const std::string& columns,
                       std::size_t shown) { return StudyTable(app, file, words(columns), shown); })
      .def("write_machine", [](const Application& app) { write_machine(app); })
      .def("solve", solve, "scene"_a, "way"_a = Follow::counted, "estimates"_a = false);
  bind_judged_problem(module);
  module.def("run_study", run_python_study);
  module.def("shortest", shortest);
}

}  // namespace mixbeam
