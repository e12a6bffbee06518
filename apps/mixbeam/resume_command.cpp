#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/guarded_run.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/results/result_lock.hpp"
#include "discretization/text/errors.hpp"
#include "mixbeam/version.hpp"

#include <memory>

namespace mixbeam {

namespace {

void set_up(Application& app, const CommandLine& line, const StoredRun& run) {
  app.quiet = line.quiet;
  app.force = line.force;
  if (line.summary) prepare_summary(app, *line.summary);
  XmlParameters xml = parse_parameters(run.header().scene_xml, run.path().string() + " (scene)", mixbeam_root_spec());
  xml.source.set_root_name(run.header().scene_name);  // possibly the name of the scene file
  xml.source.set_files(run.header().imported);        // the tables at that time, even if missing or changed now
  read_scene_file(app, std::move(xml), mixbeam_definition(), mixbeam_root_spec());
  if (line.summary && file_number(*line.summary) == file_number(run.path()))
    throw InputError("the summary " + *line.summary + " is the result file " + run.path().string() +
                     "; allowed: another name");
  describe_run(app, "mixbeam", line.threads);
  app.output = run.path().has_parent_path() ? run.path().parent_path() : std::filesystem::path(".");
  on_first_rank(app.communicator, [&app] { prepare_output_folder(app.output); });
  const std::string obstacle = obstacle_to_resuming(app);
  if (!obstacle.empty()) throw InputError(run.path().string() + ": cannot be resumed: " + obstacle);
  if (run.header().property("program") != "mixbeam")
    throw InputError(run.path().string() + ": written by \"" + run.header().property("program") +
                     "\", whose runs belong to its study; allowed: results of mixbeam run");
}

void say_where(const Application& app, const StoredRun& run) {
  if (run.header().version != kVersion)
    app.out() << "Written by version " << run.header().version << ", resumed by " << kVersion
              << ": the last digits may differ from those of an uninterrupted run.\n";
  const std::string written_with = run.header().property("instructions");
  if (!written_with.empty() && written_with != instructions())
    app.out() << "Written with the instruction set " << written_with << ", resumed with " << instructions()
              << ": the last digits may differ from those of an uninterrupted run.\n";
  if (run.steps().empty())
    app.out() << "The file contains no steps: the run starts.\n";
  else
    app.out() << "Resuming after step " << run.steps().back().step << ", load factor " << run.steps().back().load_factor
              << ".\n";
}

/// Renews the envelope unless the result file was renamed.
void renew_envelope_beside(Application& app, const StoredRun& run) {
  const std::string ending = "-" + run.header().property("load_case"), stem = run.path().stem().string();
  if (stem.size() <= ending.size() || stem.substr(stem.size() - ending.size()) != ending) return;
  renew_envelope(app, result_file_of(run.path().parent_path(), stem.substr(0, stem.size() - ending.size()), ""));
}

/// Locks the result file on the first rank, then verifies it; before MPI starts. A running simulation rewrites the
/// copies of its file in turn: resuming it must report that run, not damage.
SharedResultLock lock_whole_file(const std::filesystem::path& results, std::optional<int> last_step) {
  SharedResultLock lock;
  try {
    if (std::filesystem::is_regular_file(results) && is_first_process())
      lock = std::make_shared<const ResultLock>(results);
  } catch (const ResultFileError& error) {
    throw InputError(error.what());
  }
  require_whole(results, last_step);
  return lock;
}

}  // namespace

int resume_command(const Arguments& arguments) {
  const CommandLine line = read_command_line(
      arguments.count(), arguments.values.data(),
      {"--from", "--threads", "--summary", "--durable", "--quiet", "--force", "--help"}, "result file");
  if (!line.scene_file) throw InputError("a result file is missing: mixbeam resume RESULTS.h5");
  const SharedResultLock lock = lock_whole_file(*line.scene_file, line.last_step);
  return with_application("mixbeam", [&](Application& app) {
    warn_without_lock(app, lock);
    const StoredRun run(*line.scene_file, line.last_step);
    set_up(app, line, run);
    take_stored_mesh(app, run);
    require_reachable(app, {run.header().property("load_case")});
    say_where(app, run);
    watch_for_interrupts();
    return finish_runs(app, line, [&] {
      choose_mesh(app);  // for a file without steps
      const RunEnd end = run_case(app, run.header().property("load_case"), run.path(), {lock, line.durable}, &run);
      if (end == RunEnd::arrived) fail_what_was_missed(app, {run.header().property("load_case")});
      if (end == RunEnd::arrived) renew_envelope_beside(app, run);
      return end;
    });
  });
}

}  // namespace mixbeam
