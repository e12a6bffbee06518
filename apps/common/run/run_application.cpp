#include "apps/common/run/application.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/command_line.hpp"
#include "apps/common/session/guarded_run.hpp"
#include "apps/common/session/mpi_session.hpp"
#include "apps/common/session/standard_output.hpp"
#include "discretization/parameters/print.hpp"
#include "discretization/text/message_text.hpp"

#include <iostream>

namespace mixbeam {

namespace {

std::string default_scene_file(const ApplicationDefinition& of) {
  const bool beside_program = of.folder.empty();
  const auto folder = beside_program ? std::filesystem::read_symlink("/proc/self/exe").parent_path() : of.folder;
  return (folder / (of.name + ".xml")).string();
}

void set_up(Application& app, const CommandLine& line, const ApplicationDefinition& definition) {
  set_up_run(app, line, line.scene_file ? *line.scene_file : default_scene_file(definition), definition);
  app.output = line.output ? *line.output : "results/" + definition.name;
  on_first_rank(app.communicator, [&app] { prepare_output_folder(app.output); });
}

void run_single(Application& app) {
  app.solve_and_record(
      app.scene, app.solver, "single", kPointsByOrder,
      [&app](const Simulation& simulation, const StepReport& report) { app.check_expected(simulation, report); });
}

void say_what_was_not_compared(const Application& app) {
  const std::vector<ExpectedValue> left_out = app.not_compared();
  if (left_out.empty()) return;
  std::vector<std::string> names;
  names.reserve(left_out.size());
  for (const ExpectedValue& value : left_out) names.push_back(value.name);
  app.out() << "The study does not compare these expected values, --single does: " << quoted_list(names) << "\n";
}

/// Runs the single computation or the study.
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
  fail_what_was_missed(app);
}

int run(Application& app, const CommandLine& line, const ApplicationDefinition& definition) {
  const std::string seconds = compute_with_summary(app, line, [&] {
    set_up(app, line, definition);
    require_reachable(app, app.scene.load_cases.empty() ? std::vector<std::string>{""} : app.scene.load_cases);
    compute(app, line, definition);
  });
  app.out() << app.name << ": " << app.summary.load_steps << " load steps, " << app.summary.newton_iterations
            << " Newton iterations, " << seconds << ", results in " << app.output.string() << "\n";
  return app.summary.all_passed() ? 0 : 1;
}

int run_with(int argc, char** argv, const ApplicationDefinition& definition) {
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
  return with_application(definition.name, [&](Application& app) { return run(app, line, definition); });
}

}  // namespace

int with_application(const std::string& program, const std::function<int(Application&)>& action) {
  const MpiSession session;
  return guarded_run(session.communicator(), program, [&] {
    Application app;
    app.communicator = session.communicator();
    return action(app);
  });
}

int run_application(int argc, char** argv, const ApplicationDefinition& definition) {
  StandardOutput output;
  return output.exit_code(run_with(argc, argv, definition), definition.name);
}

}  // namespace mixbeam
