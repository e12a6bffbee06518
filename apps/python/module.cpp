/// mixbeam._core: the program's own library in the process of Python. The user interface is written in Python, in
/// apps/python/mixbeam; this module only passes data.
#include "apps/common/run/scene_file.hpp"
#include "apps/mixbeam/batch_solver.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/found_scene.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "apps/mixbeam/view_page.hpp"
#include "apps/python/arrays.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/print.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "mixbeam/version.hpp"

#include <filesystem>
#include <limits>
#include <sstream>
#include <string>
#include <tuple>

namespace py = pybind11;

namespace mixbeam {

namespace {

/// {name: [type, value] of a parameter, a dict of a list}.
py::dict entries_of(const Teuchos::ParameterList& list) {
  py::dict entries;
  for (auto entry = list.begin(); entry != list.end(); ++entry) {
    const std::string& name = list.name(entry);
    if (list.isSublist(name)) {
      entries[py::str(name)] = entries_of(list.sublist(name));
      continue;
    }
    const auto& [written, value] = written_value(list.entry(entry));
    const auto to_python = [](const auto& held) -> py::object {
      using Held = std::decay_t<decltype(held)>;
      if constexpr (std::is_same_v<Held, std::monostate>)
        return py::none();
      else if constexpr (std::is_class_v<Held> && !std::is_same_v<Held, std::string>)
        return py::cast(held.toVector());
      else
        return py::cast(held);
    };
    const std::string& type = written.empty() ? xml_name(static_cast<ParameterType>(value.index() - 1)) : written;
    entries[py::str(name)] = py::make_tuple(type, std::visit(to_python, value));
  }
  return entries;
}

/// Text, its name in messages, and whether it was made from an object.
using SceneText = std::tuple<std::string, std::string, bool>;

XmlParameters parsed(const SceneText& scene) {
  return parsed_scene(std::get<0>(scene), std::get<1>(scene), std::get<2>(scene));
}

py::tuple parse(const std::string& text, const std::string& file) {
  return parameters_of(in_turn([&] {
    XmlParameters scene = parsed_scene(text, file);
    scene.source.collect([] {});  // throws collected mistakes
    return scene;
  }));
}
py::tuple read_file(const std::string& file) {
  return parameters_of(in_turn([&] { return read_parameters(file, mixbeam_root_spec()); }));
}

std::string yaml_of(const std::string& text, const std::string& file) {
  return in_turn([&] { return yaml_text(parse_xml(text, file), mixbeam_root_spec(), file); });
}

std::string declarations() {
  std::ostringstream text;
  print_parameters_json(text, mixbeam_root_spec());
  return text.str();
}

py::tuple check(const SceneText& scene, const std::optional<std::string>& load_case) {
  Run run = in_turn([&] {
    Run read(new SolvedRun(parsed(scene), Turn::threads({}), false), DeleteInTurn());
    check_scene(read->app(), load_case);
    return read;
  });
  return py::make_tuple(run->report(), run->app().summary.warnings);
}

void undeformed(const std::string& text, const std::string& file, const std::optional<std::string>& load_case,
                const std::string& folder) {
  in_turn([&] {
    write_undeformed([&] { return parsed_scene(text, file); }, start_as_guest(), folder, "scene", load_case);
  });
}

/// The run, and the reason if it did not converge.
struct Outcome {
  Run run;
  std::optional<std::string> failure{};
};

/// Solves the run that `prepare` returns; calls the listener for its steps.
template <class Prepare, class Solve>
py::tuple watched(py::object callback, const Prepare& prepare, const Solve& solve) {
  Listener listener(std::move(callback));
  Outcome outcome;
  {
    const Turn turn;
    outcome.run = Run(prepare().release(), DeleteInTurn());
    Application& app = outcome.run->app();
    app.asked_to_stop = [&] { return listener.stops(); };
    outcome.run->on_step([&] { listener.call(outcome.run); });
    try {
      solve(*outcome.run);
    } catch (const ConvergenceError& error) {
      outcome.failure = error.what();
    }
    app.asked_to_stop = {};
    outcome.run->on_step({});
  }
  listener.rethrow();
  return py::make_tuple(outcome.run, outcome.failure);
}

py::tuple run(const SceneText& scene, const std::optional<std::string>& load_case, const std::string& output,
              const std::optional<int>& threads, bool durable, bool force, py::object callback) {
  return watched(
      std::move(callback), [&] { return std::make_unique<SolvedRun>(parsed(scene), Turn::threads(threads), force); },
      [&](SolvedRun& solved) {
        const std::filesystem::path results(output);
        if (results.has_parent_path()) prepare_output_folder(results.parent_path());
        solved.solve(meant_case(solved.app().scene, load_case), results, {{}, durable});
      });
}

py::tuple resume(const std::string& file, const std::optional<int>& threads, bool durable, py::object callback) {
  std::optional<StoredRun> stored;
  return watched(
      std::move(callback),
      [&] {
        stored.emplace(file);
        return SolvedRun::from_file(file, Turn::threads(threads));
      },
      [&](SolvedRun& solved) {
        const std::string obstacle = obstacle_to_resuming(solved.app());
        if (!obstacle.empty()) throw InputError(file + ": cannot be resumed: " + obstacle);
        solved.solve(solved.app().load_case, file, {{}, durable}, &*stored);
      });
}

std::string page_of(const std::vector<std::string>& files, const std::string& parts, const std::string& refusal,
                    const std::optional<std::vector<std::string>>& warnings) {
  return in_turn([&] {
    for (const std::string& file : files)
      if (const FileReport report = verify_results(file); !report.damage.empty())
        throw InputError(file + ": damaged: " + report.damage);
    std::optional<SaidOfScene> said;
    if (warnings) said = SaidOfScene{refusal, *warnings};
    return view_page({files.begin(), files.end()}, said, parts);
  });
}

void verify(const std::string& file) {
  const FileReport report = in_turn([&] { return verify_results(file); });
  if (!report.damage.empty()) throw InputError(file + ": damaged: " + report.damage);
}

Run open(const std::string& file) {
  return in_turn([&] { return Run(SolvedRun::from_file(file, Turn::threads({})).release(), DeleteInTurn()); });
}

py::dict batch(const SceneText& scene, const std::optional<std::string>& load_case,
               const std::vector<std::string>& parameters, const py::array_t<double, py::array::c_style>& values,
               std::size_t before, int output, const std::optional<int>& threads, py::object callback) {
  Listener listener(std::move(callback));
  Batch cases;
  for (const std::string& parameter : parameters)
    cases.columns.push_back({parameter, [](const std::string& problem) { return InputError{problem}; }});
  cases.values.assign(values.data(), values.data() + values.size());
  cases.before = before;
  cases.unvaried = static_cast<std::size_t>(values.shape(0));
  cases.output = static_cast<BatchOutput>(output);
  std::vector<std::string> names;
  std::vector<CaseResult> results;
  {
    const Turn turn;
    SolvedRun base(parsed(scene), Turn::threads(threads), false);
    refuse_search(base.app());
    const std::string name = meant_case(base.app().scene, load_case);
    base.app().solver.analysis.error_estimate = ErrorEstimation::off;  // limits are not checked here
    const CaseQuantities quantities(base.app(), cases.output, name);
    CaseScenes scenes(base.app(), cases, name);
    CaseResults solved_cases;
    solved_cases.resize(cases.size());
    BatchSolver solver(base.app(), quantities, solved_cases, [&] { return listener.stops(); });
    if (cases.size() > 0)
      require_memory_of_cases(base.app(), scenes.scene_of(0), cases.size(), base.app().communicator);
    choose_mesh(base.app(), cases.size(), [&](std::size_t row) { return scenes.scene_of(row); });
    const CaseGroups groups = grouped_cases(scenes, cases.size());
    std::size_t done = 0;
    solver.solve_all(groups, scenes, [&](std::size_t g) { listener.call(done += groups[g].size(), cases.size()); });
    names = quantities.names();
    results = solved_cases.all();
  }
  listener.rethrow();
  std::vector<double> rows, residual;
  std::vector<int> iterations, converged, solved;
  std::vector<std::string> stable, cause;
  for (CaseResult& result : results) {
    std::vector<double>& written = result.values.written;
    written.resize(names.size(), std::numeric_limits<double>::quiet_NaN());
    rows.insert(rows.end(), written.begin(), written.end());
    residual.push_back(result.residual);
    iterations.push_back(result.iterations);
    converged.push_back(result.converged ? 1 : 0);
    solved.push_back(result.solved ? 1 : 0);
    stable.push_back(result.stable);
    cause.push_back(result.cause);
  }
  const std::size_t columns = names.size();
  using namespace py::literals;
  return py::dict("names"_a = names, "values"_a = table(std::move(rows), columns), "residual"_a = numbers(residual),
                  "iterations"_a = numbers(iterations), "converged"_a = numbers(converged),
                  "solved"_a = numbers(solved), "stable"_a = stable, "cause"_a = cause);
}

void set_error(const char* name, const std::exception& error) {
  PyErr_SetString(py::module_::import("mixbeam.errors").attr(name).ptr(), error.what());
}

/// Translates exceptions: exit code 2 becomes InputError; unforeseen ones are left to pybind11.
void translate(const std::exception_ptr& thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const py::error_already_set&) {
    throw;
  } catch (const ConvergenceError& error) {
    set_error("ConvergenceError", error);
  } catch (const std::exception& error) {
    const bool is_input = dynamic_cast<const InputError*>(&error) != nullptr ||
                          dynamic_cast<const FileError*>(&error) != nullptr ||
                          dynamic_cast<const ResultFileError*>(&error) != nullptr ||
                          dynamic_cast<const std::invalid_argument*>(&error) != nullptr;
    if (is_input)
      set_error("InputError", error);
    else if (is_out_of_memory(error))
      PyErr_SetString(PyExc_MemoryError, reason_of(error).c_str());
    else
      throw;
  } catch (const char* text) {  // NOX and LOCA throw string literals
    PyErr_SetString(PyExc_RuntimeError, text);
  }
}

}  // namespace

py::tuple parameters_of(const XmlParameters& parameters) {
  return py::make_tuple(parameters.list->name(), entries_of(*parameters.list));
}

}  // namespace mixbeam

PYBIND11_MODULE(_core, module) {
  using namespace mixbeam;
  py::register_exception_translator([](std::exception_ptr thrown) { translate(thrown); });
  module.attr("version") = kVersion;
  module.def("parse", parse);
  module.def("read", read_file);
  module.def("yaml_of", yaml_of);
  module.def("declarations", declarations);
  module.def("did_you_mean", did_you_mean);
  module.def("number_hint", number_hint);
  module.def("check", check);
  module.def("undeformed", undeformed);
  module.def("run", run);
  module.def("resume", resume);
  module.def("open", open);
  module.def("batch", batch);
  module.def("verify", verify);
  module.def("view_page", page_of);
  module.def("write_page",
             [](const std::string& file, const std::string& text) { in_turn([&] { write_page(file, text); }); });
  bind_run(module);
  bind_study(module);
  py::module_::import("atexit").attr("register")(py::cpp_function([] { Guest::instance().end_of_interpreter(); }));
}
