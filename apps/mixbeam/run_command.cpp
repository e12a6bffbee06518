#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/guarded_run.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/common/session/mpi_session.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <ostream>

namespace mixbeam {

namespace {

std::vector<std::string> chosen_cases(const Scene& scene, const std::optional<std::string>& wanted) {
  const std::vector<std::string> known = alternatives(scene);
  if (!wanted) return known.empty() ? std::vector<std::string>{""} : known;
  if (std::find(known.begin(), known.end(), *wanted) != known.end()) return {*wanted};
  throw InputError("option --case: \"" + excerpt(*wanted) +
                   "\" is not a load case or combination of the scene; allowed: " +
                   (known.empty() ? "nothing, the scene has none" : quoted_list(known)) + did_you_mean(*wanted, known));
}

void set_up(Application& app, const CommandLine& line) {
  app.quiet = line.quiet;
  app.force = line.force;
  if (line.summary) prepare_summary(app, *line.summary);
  read_scene_file(app, *line.scene_file, mixbeam_definition());
  describe_run(app, "mixbeam", line.threads);
  warn_of_scene(app);
  const std::filesystem::path scene(*line.scene_file);
  app.output = line.output ? std::filesystem::path(*line.output) : std::filesystem::path("results") / scene.stem();
  on_first_rank(app.communicator, [&app] { prepare_output_folder(app.output); });
  if (app.xml.source.line({"Study"}) > 0)
    app.out() << "The list \"Study\" belongs to a benchmark program; it is ignored.\n";
  if (app.xml.source.line({"Batch"}) > 0)
    app.out() << "The list \"Batch\" belongs to mixbeam batch; the scene is solved as it stands.\n";
}

}  // namespace

int run_command(const Arguments& arguments) {
  const CommandLine line = read_command_line(
      arguments.count(), arguments.values.data(),
      {"--output", "--case", "--threads", "--summary", "--durable", "--quiet", "--force", "--help"}, "scene file");
  if (!line.scene_file) throw InputError("a scene file is missing: mixbeam run SCENE.xml");
  const MpiSession session;
  return guarded_run(session.communicator(), "mixbeam", [&] {
    Application app;
    app.communicator = session.communicator();
    set_up(app, line);
    const auto cases = chosen_cases(app.scene, line.load_case);
    require_reachable(app, cases);
    const std::string stem = std::filesystem::path(*line.scene_file).stem().string();
    std::vector<SharedResultLock> locks;  // of all cases before the first: the run is refused as a whole
    for (const std::string& load_case : cases)
      locks.push_back(lock_or_warn(app, result_file_of(app.output, stem, load_case)));
    const std::filesystem::path of_all = result_file_of(app.output, stem, "");
    if (cases.size() > 1 && !app.quantities.empty()) locks.push_back(lock_or_warn(app, of_all));
    watch_for_interrupts();
    return finish_runs(app, line, [&] {
      RunEnd end = RunEnd::arrived;
      for (std::size_t i = 0; i < cases.size() && end == RunEnd::arrived; ++i)
        end = run_case(app, cases[i], result_file_of(app.output, stem, cases[i]), {locks[i], line.durable});
      if (end == RunEnd::arrived) fail_what_was_missed(app, cases);
      if (end == RunEnd::arrived) line.load_case ? renew_envelope(app, of_all) : write_envelope(app, of_all);
      return end;
    });
  });
}

}  // namespace mixbeam
