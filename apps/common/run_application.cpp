#include "apps/common/application.hpp"
#include "apps/common/command_line.hpp"
#include "apps/common/mpi_session.hpp"
#include "discretization/mechanism_check.hpp"
#include "discretization/message_text.hpp"
#include "discretization/nearest_name.hpp"
#include "discretization/number_text.hpp"
#include "discretization/print_parameters.hpp"
#include "discretization/scene_parameters.hpp"
#include "discretization/scene_reader.hpp"
#include "discretization/validate.hpp"
#include "kernels/execution_space.hpp"
#include "mixbeam/version.hpp"

#include <mpi.h>
#include <unistd.h>

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <iostream>

namespace mixbeam {

namespace {

constexpr int kUnforeseenErrorExitCode = 1;
constexpr int kSamplesPerElement = 9;

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

/// An InputError of rank 0 is thrown on every rank; otherwise the others would wait for it for ever.
void on_first_rank(const Communicator& communicator, const std::function<void()>& action) {
  std::string problem;
  try {
    if (communicator->getRank() == 0) action();
  } catch (const InputError& error) {
    problem = error.what();
  }
  int size = static_cast<int>(problem.size());
  Teuchos::broadcast(*communicator, 0, &size);
  if (size == 0) return;
  problem.resize(size);
  Teuchos::broadcast(*communicator, 0, size, problem.data());
  throw InputError(problem);
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

/// Finds out before the run, not after it, whether the summary can be written; removes the one of an earlier run, which
/// a script might otherwise take for that of a run that failed.
void prepare_summary(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file))
    throw InputError("the summary \"" + file.string() + "\" is a folder; allowed: the name of a file");
  if (file.has_parent_path()) prepare_output_folder(file.parent_path());
  std::error_code error;
  std::filesystem::remove(file, error);
  if (error) throw InputError("the summary \"" + file.string() + "\" cannot be replaced: " + error.message());
}

/// A point that the scene does not have, or a load factor that its path does not reach, would never be compared.
void check_expected_values(const Application& app) {
  std::vector<std::string> points;
  for (const Point& point : app.scene.points) points.push_back(point.name);
  for (const ExpectedValue& value : app.expected) {
    const ParameterPath path = {"Expected", value.name};
    if (!value.point.empty() && std::find(points.begin(), points.end(), value.point) == points.end()) {
      throw app.xml.source.error(child(path, "Point"), "\"" + excerpt(value.point) + "\" is not a point; allowed: " +
                                                           quoted_list(points) + did_you_mean(value.point, points));
    }
    if (value.load_factor.value_or(0.0) > app.scene.stages) {
      throw app.xml.source.error(child(path, "Load Factor"),
                                 "value " + shortest(*value.load_factor) + "; allowed: at most " +
                                     std::to_string(app.scene.stages) + ", where the load path of the scene ends");
    }
  }
}

void read_scene_file(Application& app, const std::string& file, const ApplicationDefinition& definition) {
  app.xml = read_xml(file);
  validate(*app.xml.list, root_spec(definition), app.xml.source);
  app.scene = read_scene(app.xml.list->sublist("Scene"), app.xml.source);
  check_supports(app.scene, app.xml.source);
  app.solver = read_solver_parameters(app.xml.list->sublist("Solver"), app.xml.source);
  app.expected = read_expected_values(app.xml.list->sublist("Expected"), app.xml.source, definition.own_quantities);
  check_expected_values(app);
}

void set_up(Application& app, const CommandLine& line, const ApplicationDefinition& definition) {
  app.name = app.summary.program = definition.name;
  app.summary.version = kVersion;
  app.summary.compiler = kCompiler;
  app.summary.ranks = app.communicator->getSize();
  app.quiet = line.quiet;
  if (line.summary) on_first_rank(app.communicator, [&line] { prepare_summary(*line.summary); });
  read_scene_file(app, line.scene_file ? *line.scene_file : default_scene_file(definition.name), definition);
  if (line.threads) app.solver.threads = *line.threads;
  if (app.solver.threads > 0) set_number_of_threads(app.solver.threads);
  app.summary.threads = number_of_threads();
  app.output = line.output ? *line.output : "results/" + definition.name;
  on_first_rank(app.communicator, [&app] { prepare_output_folder(app.output); });
}

void run_single(Application& app) {
  app.solve_and_record(app.scene, app.solver, "single", kSamplesPerElement,
                       [&app](const Simulation& simulation, const StepReport& report) {
                         app.check_expected(simulation, report.load_factor);
                       });
}

void require_all_compared(const Application& app) {
  for (const ExpectedValue& value : app.not_compared()) {
    const ParameterPath path = {"Expected", value.name, "Load Factor"};
    if (!value.load_factor) throw app.xml.source.error(path, "the run did not compare this value");
    throw app.xml.source.error(path, "value " + shortest(*value.load_factor) +
                                         "; no load step ended there; allowed: ends of stages, and with \"Method\" = "
                                         "\"fixed\" in \"Solver / Load Path\" the multiples of 1 / \"Steps\"");
  }
}

void say_what_was_not_compared(const Application& app) {
  const std::vector<ExpectedValue> left_out = app.not_compared();
  if (left_out.empty()) return;
  std::vector<std::string> names;
  names.reserve(left_out.size());
  for (const ExpectedValue& value : left_out) names.push_back(value.name);
  app.out() << "The study does not compare these expected values, --single does: " << quoted_list(names) << "\n";
}

/// Single computation or study; throws whatever goes wrong.
void compute(Application& app, const CommandLine& line, const ApplicationDefinition& definition) {
  if (!line.single && definition.run_study) {
    definition.run_study(app);
    say_what_was_not_compared(app);
    return;
  }
  if (definition.single)
    definition.single(app);
  else
    run_single(app);
  require_all_compared(app);
}

int run(Application& app, const CommandLine& line, const ApplicationDefinition& definition) {
  const auto start = std::chrono::steady_clock::now();
  const auto finish = [&] {
    app.summary.seconds["total"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (line.summary && app.writes_files()) app.summary.write_json(*line.summary);
  };
  set_up(app, line, definition);
  try {
    compute(app, line, definition);
  } catch (const ConvergenceError& error) {
    app.summary.failure = error.what();
    finish();
    throw;
  }
  finish();
  app.summary.print_checks(app.out(), false);
  std::array<char, 32> seconds{};
  std::snprintf(seconds.data(), seconds.size(), "%.3f s", app.summary.seconds["total"]);
  app.out() << app.name << ": " << app.summary.load_steps << " load steps, " << app.summary.newton_iterations
            << " Newton iterations, " << seconds.data() << ", results in " << app.output.string() << "\n";
  return app.summary.all_passed() ? 0 : 1;
}

/// Runs the program once MPI has started; says what went wrong and returns the exit code.
int run_and_complain(const Communicator& communicator, const CommandLine& line,
                     const ApplicationDefinition& definition) {
  Application app;
  app.communicator = communicator;
  const auto complain = [&](const char* kind, const char* what, int code) {
    if (app.writes_files()) std::cerr << definition.name << ": " << kind << ": " << what << "\n" << std::flush;
    return code;
  };
  // What may have happened on one rank only: the others would wait for it for ever.
  const auto complain_alone = [&](const char* kind, const char* what, int code) {
    if (communicator->getSize() == 1) return complain(kind, what, code);
    std::cerr << definition.name << ", rank " << communicator->getRank() << ": " << kind << ": " << what << "\n"
              << std::flush;
    MPI_Abort(MPI_COMM_WORLD, code);
    return code;
  };
  try {
    return run(app, line, definition);
  } catch (const InputError& error) {
    return complain("bad input", error.what(), kInputErrorExitCode);
  } catch (const ConvergenceError& error) {
    return complain("no convergence", error.what(), kConvergenceErrorExitCode);
  } catch (const ResultFileError& error) {
    return complain_alone("results cannot be written", error.what(), kInputErrorExitCode);
  } catch (const std::invalid_argument& error) {
    return complain_alone("bad input", error.what(), kInputErrorExitCode);
  } catch (const std::exception& error) {
    return complain_alone("unforeseen error", error.what(), kUnforeseenErrorExitCode);
  } catch (const char* error) {  // NOX and LOCA throw texts
    return complain_alone("unforeseen error", error, kUnforeseenErrorExitCode);
  }
}

}  // namespace

int run_application(int argc, char** argv, const ApplicationDefinition& definition) {
  CommandLine line;
  try {
    line = read_command_line(argc, argv);
  } catch (const InputError& error) {
    std::cerr << definition.name << ": bad input: " << error.what() << "\n";
    return kInputErrorExitCode;
  }
  if (line.help) print_help(std::cout, definition.name, definition.purpose);
  if (line.print_parameters) print_parameters(std::cout, root_spec(definition), definition.name);
  if (line.help || line.print_parameters) return 0;
  const MpiSession session(argc, argv);
  return run_and_complain(session.communicator(), line, definition);
}

}  // namespace mixbeam
