#include "apps/common/run/room_check.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/guarded_run.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/mixbeam/case_processes.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/found_scene.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/mesh/mpi_at_need.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/text_file.hpp"
#include "kernels/execution/execution_space.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <sstream>

namespace mixbeam {

namespace {

/// Number of cases solved at once.
std::size_t jobs_of(const CommandLine& line, const std::vector<std::string>& cases) {
  return std::min(static_cast<std::size_t>(line.jobs), cases.size());
}

/// Divides the processors among cases solved at once, unless the user has chosen a number of threads.
void share_processors(Application& app, std::size_t jobs) {
  if (app.solver.threads > 0 || std::getenv("OMP_NUM_THREADS") != nullptr) return;
  set_number_of_threads(std::max(1, number_of_threads() / static_cast<int>(jobs)));
  app.summary.threads = number_of_threads();
}

void set_up(Application& app, const CommandLine& line) {
  set_up_run(app, line, *line.scene_file, mixbeam_definition());
  app.quiet = app.quiet || chosen_cases(app.scene, line.load_case).size() > 1;
  if (line.jobs > 1) share_processors(app, jobs_of(line, chosen_cases(app.scene, line.load_case)));
  const std::filesystem::path scene(*line.scene_file);
  app.output = line.output ? std::filesystem::path(*line.output) : std::filesystem::path("results") / scene.stem();
  on_first_rank(app.communicator, [&app] { prepare_output_folder(app.output); });
  take_rest_shape(app, scene.stem().string(), line.jobs);
  if (app.search && line.jobs > 1)
    throw app.xml.source.error(
        {app.search->list}, "given with --jobs " + std::to_string(line.jobs) + "; allowed: one case after the other");
  warn_of_scene(app);
  if (app.xml.source.line({"Study"}) > 0)
    app.out() << "The list \"Study\" belongs to a benchmark program; it is ignored.\n";
  if (app.xml.source.line({"Batch"}) > 0)
    app.out() << "The list \"Batch\" belongs to mixbeam batch; the scene is solved as it stands.\n";
}

std::filesystem::path file_of(const Application& app, const CommandLine& line, const std::string& load_case) {
  return result_file_of(app.output, std::filesystem::path(*line.scene_file).stem().string(), load_case);
}

RunEnd solve_case(Application& app, const CommandLine& line, const std::string& load_case,
                  const SharedResultLock& lock) {
  const RunEnd end = run_case(app, load_case, file_of(app, line, load_case), {lock, line.durable});
  if (end == RunEnd::arrived) fail_what_was_missed(app, {load_case});
  return end;
}

/// Checks the memory of concurrent cases; each case is also checked when it begins.
void require_memory_side_by_side(const Application& app, const std::vector<std::string>& cases, std::size_t jobs) {
  const double memory = needs_of_run(app, scene_of_case(app.scene, cases.front()), app.solver).memory;
  require_memory(app, static_cast<double>(jobs) * memory, std::to_string(jobs) + " cases side by side (--jobs)");
}

/// Processes for concurrent cases; null if cases are solved one by one. Call it before MPI starts.
std::unique_ptr<CaseProcesses> case_processes(const CommandLine& line) {
  if (line.jobs == 1 || line.load_case || is_under_mpirun()) return {};
  CommandLine own = line;
  own.summary.reset();
  CaseWork work;
  work.set_up = [own](Application& app) { set_up(app, own); };
  work.solve = [own](Application& app, std::size_t number) {
    return solve_case(app, own, chosen_cases(app.scene, {})[number], std::make_shared<const ResultLock>());
  };
  return std::make_unique<CaseProcesses>(line.jobs, work);
}

}  // namespace

int run_command(const Arguments& arguments) {
  const CommandLine line = read_command_line(
      arguments.count(), arguments.values.data(),
      {"--output", "--case", "--jobs", "--threads", "--summary", "--durable", "--quiet", "--force", "--help"},
      "scene file");
  if (!line.scene_file) throw InputError("a scene file is missing: mixbeam run SCENE.xml");
  const std::unique_ptr<CaseProcesses> processes = case_processes(line);
  return with_application("mixbeam", [&](Application& app) {
    if (line.jobs > 1 && is_under_mpirun())
      throw InputError("option --jobs: value \"" + std::to_string(line.jobs) +
                       "\" under mpirun, whose ranks share each case; allowed: 1, or a run without mpirun");
    set_up(app, line);
    const auto cases = chosen_cases(app.scene, line.load_case);
    require_reachable(app, cases);
    const std::size_t jobs = jobs_of(line, cases);
    if (jobs > 1) require_memory_side_by_side(app, cases, jobs);
    std::vector<SharedResultLock> locks;  // taken for all cases first, so that the run is refused as a whole
    for (const std::string& load_case : cases) locks.push_back(lock_or_warn(app, file_of(app, line, load_case)));
    const std::filesystem::path of_all = file_of(app, line, "");
    if (cases.size() > 1 && !app.quantities.empty()) locks.push_back(lock_or_warn(app, of_all));
    const std::string envelope = (of_all.parent_path() / of_all.stem()).string() + "-envelope.csv";
    if (cases.size() > 1 && !app.quantities.empty()) require_no_input(envelope);
    watch_for_interrupts();
    return finish_runs(app, line, [&] {
      RunEnd end = RunEnd::arrived;
      for (const std::string& one : cases)  // if the search fails, no older results remain beside its files
        if (app.search) std::filesystem::remove(file_of(app, line, one));
      if (!take_found_numbers(app, app.output / std::filesystem::path(*line.scene_file).stem()))
        return RunEnd::interrupted;
      choose_mesh(app);
      std::ostringstream reports;  // of several cases, printed after the envelope
      if (cases.size() > 1) app.reports = &reports;
      const auto tell = [&] {
        app.out() << reports.str();
        app.reports = nullptr;
      };
      try {
        if (jobs > 1)
          end = processes->solve(app, cases);
        else
          for (std::size_t i = 0; i < cases.size() && end == RunEnd::arrived; ++i)
            end = solve_case(app, line, cases[i], locks[i]);
      } catch (...) {
        tell();
        throw;
      }
      if (end == RunEnd::arrived) line.load_case ? renew_envelope(app, of_all) : write_envelope(app, of_all);
      tell();
      return end;
    });
  });
}

}  // namespace mixbeam
