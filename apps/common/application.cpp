#include "apps/common/application.hpp"

#include "apps/common/mpi_session.hpp"
#include "apps/common/progress.hpp"
#include "discretization/mechanism_check.hpp"
#include "discretization/nearest_name.hpp"
#include "discretization/print_parameters.hpp"
#include "discretization/scene_parameters.hpp"
#include "discretization/scene_reader.hpp"
#include "discretization/validate.hpp"
#include "kernels/execution_space.hpp"
#include "mixbeam/version.hpp"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>

namespace mixbeam {

namespace {

struct CommandLine {
  std::optional<std::string> scene_file, output, summary;
  std::optional<int> threads;
  bool help = false, print_parameters = false, single = false, quiet = false;
};

const std::vector<std::string> kOptions = {"--help", "--print-parameters", "--single", "--quiet",
                                           "--output", "--summary", "--threads"};

int positive_number(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || value < 1 || value > 4096)
    throw InputError("option " + option + ": value \"" + text + "\"; allowed: a whole number from 1 to 4096");
  return static_cast<int>(value);
}

CommandLine read_command_line(int argc, char** argv) {
  CommandLine line;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    const auto value = [&]() -> std::string {
      if (i + 1 >= argc) throw InputError("option " + option + " needs a value");
      return argv[++i];
    };
    if (option == "--help" || option == "-h") line.help = true;
    else if (option == "--print-parameters") line.print_parameters = true;
    else if (option == "--single") line.single = true;
    else if (option == "--quiet") line.quiet = true;
    else if (option == "--output") line.output = value();
    else if (option == "--summary") line.summary = value();
    else if (option == "--threads") line.threads = positive_number(option, value());
    else if (option.rfind("-", 0) == 0)
      throw InputError("unknown option \"" + option + "\"; did you mean \"" + nearest_name(option, kOptions) + "\"? (--help lists them)");
    else if (line.scene_file)
      throw InputError("two scene files given: \"" + *line.scene_file + "\" and \"" + option + "\"; allowed: one");
    else line.scene_file = option;
  }
  return line;
}

void print_help(std::ostream& out, const ApplicationDefinition& definition) {
  out << definition.name << ": " << definition.purpose << "\n\n"
      << "usage: " << definition.name << " [SCENE.xml] [options]\n\n"
      << "  SCENE.xml            scene, solver, study and expected answers; default: " << definition.name << ".xml beside the program\n"
      << "  --single             only the scene as it stands, without the study\n"
      << "  --output DIR         folder for results (HDF5 + XDMF, CSV); default: results/" << definition.name << "\n"
      << "  --summary FILE.json  every checked quantity, steps, iterations and times, for scripts\n"
      << "  --threads N          OpenMP threads; default: \"Threads\" in the scene, else OMP_NUM_THREADS\n"
      << "  --quiet              no progress lines\n"
      << "  --print-parameters   all parameters of the scene file with type, default, range and meaning\n"
      << "  --help               this text\n\n"
      << "exit code: 0 all checks passed, 1 a check failed, 2 bad input, 3 no convergence\n"
      << "on several ranks: mpirun --bind-to none -np 2 " << definition.name << " ...   (without --bind-to none the threads of a rank share one core)\n";
}

ListSpec root_spec(const ApplicationDefinition& definition) {
  ListSpec root("Scene file of " + definition.name + ".");
  root.add_list("Scene", scene_spec(), Presence::required);
  root.add_list("Solver", solver_spec(), Presence::defaulted);
  root.add_list("Study", definition.study, Presence::defaulted);
  root.add_list("Expected", expected_values_spec(definition.own_quantities), Presence::defaulted);
  return root;
}

std::string default_scene_file(const std::string& name) {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / (name + ".xml")).string();
}

/// A stream that swallows everything.
std::ostream& nowhere() {
  static std::ostream stream(nullptr);
  return stream;
}

void set_up(Application& app, const CommandLine& line, const ApplicationDefinition& definition) {
  app.name = definition.name;
  app.quiet = line.quiet;
  app.xml = read_xml(line.scene_file ? *line.scene_file : default_scene_file(definition.name));
  validate(*app.xml.list, root_spec(definition), app.xml.source);
  app.scene = read_scene(app.xml.list->sublist("Scene"), app.xml.source);
  check_supports(app.scene, app.xml.source);
  app.solver = read_solver_parameters(app.xml.list->sublist("Solver"), app.xml.source);
  app.expected = read_expected_values(app.xml.list->sublist("Expected"), app.xml.source, definition.own_quantities);
  if (line.threads) app.solver.threads = *line.threads;
  if (app.solver.threads > 0) set_number_of_threads(app.solver.threads);
  app.output = line.output ? *line.output : "results/" + definition.name;
  std::error_code error;
  if (app.writes_files()) std::filesystem::create_directories(app.output, error);
  if (error) throw InputError("the output folder \"" + app.output.string() + "\" cannot be made: " + error.message());
  app.summary.program = definition.name;
  app.summary.version = kVersion;
  app.summary.compiler = kCompiler;
  app.summary.threads = number_of_threads();
  app.summary.ranks = app.communicator->getSize();
}

void run_single(Application& app) {
  const Simulation simulation = app.solve_and_record(app.scene, app.solver, "single");
  app.check_expected(simulation);
}

int run(Application& app, const CommandLine& line, const ApplicationDefinition& definition) {
  const auto start = std::chrono::steady_clock::now();
  set_up(app, line, definition);
  if (line.single || !definition.run_study) {
    if (definition.single) definition.single(app);
    else run_single(app);
  } else {
    definition.run_study(app);
  }
  app.summary.seconds["total"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  app.summary.print_checks(app.out(), false);
  app.out() << app.name << ": " << app.summary.load_steps << " load steps, " << app.summary.newton_iterations
            << " Newton iterations, " << app.summary.seconds["total"] << " s, results in " << app.output.string() << "\n";
  if (line.summary && app.writes_files()) app.summary.write_json(*line.summary);
  return app.summary.all_passed() ? 0 : 1;
}

/// Component of a vector by the names of the list "Expected".
double component(const Vector3& v, const std::string& name) {
  if (name == "norm") return std::hypot(v[0], v[1], v[2]);
  return v[name == "x" ? 0 : name == "y" ? 1 : 2];
}

}  // namespace

std::ostream& Application::out() const { return writes_files() ? std::cout : nowhere(); }

Simulation Application::solve(const Scene& solved, const SolverParameters& parameters, const std::string& label,
                              const RunObserver& observer) {
  Simulation simulation(solved, parameters, communicator);
  Progress progress(quiet || label.empty() ? nowhere() : out(), name + " " + label, solved.stages);
  StepReport last;
  simulation.run([&](const StepReport& report, const State&) {
    last = report;
    progress.report(report);
    if (observer) observer(simulation, report);
  });
  summary.load_steps += simulation.result().steps;
  summary.newton_iterations += simulation.result().newton_iterations;
  for (const auto& [phase, seconds] : simulation.times()) summary.seconds[phase] += seconds;
  if (simulation.result().finished) return simulation;
  const std::filesystem::path file = output / ((label.empty() ? name : label) + "_last_converged.h5");
  const StepRecord record = simulation.record(last, 9, {});
  if (writes_files()) ResultFile(file, {solved.name, xml.text, kVersion, {}}).append_step(record);
  throw ConvergenceError(name + (label.empty() ? "" : " " + label) + ": " + simulation.result().failure +
                         " The last converged state is in " + file.string() + ".");
}

Simulation Application::solve_and_record(const Scene& solved, const SolverParameters& parameters, const std::string& file,
                                         int points_per_element, const RunObserver& observer) {
  std::unique_ptr<ResultFile> results;
  if (writes_files())
    results = std::make_unique<ResultFile>(
        output / (file + ".h5"),
        ResultHeader{solved.name, xml.text, kVersion,
                     {{"program", name}, {"compiler", kCompiler}, {"threads", std::to_string(number_of_threads())},
                      {"ranks", std::to_string(communicator->getSize())}}});
  std::vector<std::string> points;
  for (const Support& support : solved.supports) points.push_back(support.point);
  for (const PointLoad& load : solved.point_loads) points.push_back(load.point);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  Simulation simulation = solve(solved, parameters, file, [&](const Simulation& running, const StepReport& report) {
    const StepRecord record = running.record(report, points_per_element, points);
    if (results != nullptr) results->append_step(record);
    if (observer) observer(running, report);
  });
  if (results != nullptr) results->close();
  return simulation;
}

void Application::check_expected(const Simulation& simulation,
                                 const std::function<double(const ExpectedValue&)>& own_quantity) {
  for (const ExpectedValue& value : expected) {
    if (value.load_factor && std::abs(*value.load_factor - simulation.result().load_factor) > 1e-12) continue;
    double actual = 0.0;
    if (value.quantity == "displacement") actual = component(simulation.displacement(value.point), value.component);
    else if (value.quantity == "position") actual = component(simulation.position(value.point), value.component);
    else if (value.quantity == "rotation") actual = component(simulation.rotation(value.point), value.component);
    else if (own_quantity) actual = own_quantity(value);
    else continue;
    if (value.kind == ToleranceKind::absolute)
      summary.check_absolute(value.name, actual, value.value, value.tolerance, value.source);
    else
      summary.check_relative(value.name, actual, value.value, value.tolerance, value.source);
  }
}

int run_application(int argc, char** argv, const ApplicationDefinition& definition) {
  int code = 1;
  try {
    const CommandLine line = read_command_line(argc, argv);
    if (line.help || line.print_parameters) {
      if (line.help) print_help(std::cout, definition);
      else print_parameters(std::cout, root_spec(definition), definition.name);
      return 0;
    }
    const MpiSession session(argc, argv);
    Application app;
    app.communicator = session.communicator();
    const auto complain = [&](const std::string& kind, const char* what) {
      if (app.writes_files()) std::cerr << definition.name << ": " << kind << ": " << what << "\n";
    };
    try {
      code = run(app, line, definition);
    } catch (const InputError& error) {
      complain("bad input", error.what());
      code = kInputErrorExitCode;
    } catch (const ResultFileError& error) {
      complain("results cannot be written", error.what());
      code = kInputErrorExitCode;
    } catch (const ConvergenceError& error) {
      complain("no convergence", error.what());
      code = kConvergenceErrorExitCode;
    } catch (const std::invalid_argument& error) {
      complain("bad input", error.what());
      code = kInputErrorExitCode;
    } catch (const std::exception& error) {
      complain("unforeseen error", error.what());
      if (app.communicator->getSize() > 1) MPI_Abort(MPI_COMM_WORLD, code);  // the other ranks may wait for this one
    }
  } catch (const InputError& error) {
    std::cerr << definition.name << ": bad input: " << error.what() << "\n";
    code = kInputErrorExitCode;
  }
  return code;
}

}  // namespace mixbeam
