#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/command_line.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/batch_run.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/found_scene.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "apps/mixbeam/scene_run.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace mixbeam {

namespace {

std::string chosen_case(const Scene& scene, const std::optional<std::string>& wanted) {
  const std::vector<std::string> cases = chosen_cases(scene, wanted);
  if (!wanted && !cases.front().empty())
    throw InputError("the scene has load cases; a batch takes one of them: --case " + cases.front());
  return cases.front();
}

void set_up_batch(Application& app, const CommandLine& line) {
  set_up_run(app, line, *line.scene_file, mixbeam_definition());
  refuse_rest_shape(app);
  refuse_search(app);
  warn_of_scene(app);
  if (!app.xml.list->isSublist("Batch"))
    throw app.xml.source.error(
        {"Batch"}, "missing " + app.xml.source.list_word() + "; needed: the cases, by \"Table\" or \"Vary\"");
  if (app.gradient) app.out() << "The list \"Gradient\" belongs to mixbeam run; a batch finds no gradients.\n";
  const std::filesystem::path scene(*line.scene_file);
  app.output = line.output ? std::filesystem::path(*line.output) : std::filesystem::path("results") / scene.stem();
  prepare_output_folder(app.output);
}

/// A batch over the cases of one scene.
class VariedBatch : public BatchRun {
 public:
  VariedBatch(Application& app, const Batch& batch, const std::string& load_case, const Communicator& ranks)
      : BatchRun(app, ranks),
        batch_(batch),
        quantities_(app, batch_.output, load_case),
        case_scenes_(app, batch_, load_case),
        solver_(app, quantities_, results_, [&app] { return interrupt_requested(app.communicator); }) {
    results_.resize(batch_.size());
  }

  void solve() override {
    read_scenes();
    const Stopwatch stopwatch(app_, "batch solve");
    double before = stopwatch.seconds();
    const auto report = [&](std::size_t g) {
      const double now = stopwatch.seconds();
      report_group(groups_[g], g, groups_.size(), now - before);
      before = now;
    };
    gather(solver_.solve_all(groups_, case_scenes_, report, ranks_->getRank(), ranks_->getSize()));
  }

  BatchTable table(const std::vector<CaseResult>&) const override {
    BatchTable table{batch_.before, {}, quantities_.names(), !quantities_.limits().empty(), {{"scene", app_.xml.text}}};
    for (std::size_t c = 0; c < batch_.columns.size(); ++c)
      table.own.push_back(
          column_of_numbers(batch_.columns[c].parameter, [this, c](std::size_t i) { return batch_.value(i, c); }));
    return table;
  }

  std::string name_of_case(std::size_t index) const override { return batch_.name_of_case(index); }
  const CaseQuantities& quantities_of(std::size_t) const override { return quantities_; }
  std::size_t place_of(std::size_t name, std::size_t) const override { return name; }

  /// Compares the cases with expected values in columns of the table.
  void check_expected() override {
    for (const CaseScenes::OwnExpectation& own : case_scenes_.own_expectations()) {
      const auto& names = quantities_.names();
      const auto place = std::find(names.begin(), names.end(), own.name) - names.begin();
      ExpectedValue wanted = quantities_.expected()[place];
      for (std::size_t i = 0; i < batch_.size(); ++i) {
        const CaseResult& result = results()[i];
        wanted.value = case_scenes_.expected(own, i);
        if (std::isnan(wanted.value) || !result.converged) continue;
        app_.summary.check_expected(wanted.name + ", " + batch_.name_of_case(i), result.values.written[place], wanted);
      }
    }
    if (!app_.expected.empty())
      app_.summary.unchecked =
          "the expected values of the scene belong to the scene as it stands; those of cases are columns "
          "\"Expected/<name>/Value\" of the table, with \"Output\" = \"expected\"";
  }

 private:
  void read_scenes() {
    const Stopwatch stopwatch(app_, "batch set-up");
    if (batch_.size() > 0) require_memory_of_cases(app_, case_scenes_.scene_of(0), batch_.size(), ranks_);
    choose_mesh(app_, batch_.size(), [this](std::size_t row) { return case_scenes_.scene_of(row); });
    groups_ = grouped_cases(case_scenes_, batch_.size());
    quantities_.take_limits(case_scenes_.limits());
  }

  void report_group(const std::vector<std::size_t>& group, std::size_t number, std::size_t groups, double seconds) {
    if (app_.quiet) return;
    int most_iterations = 0;
    std::size_t alone = 0, failed = 0, unstable = 0;
    for (const std::size_t i : group) {
      const CaseResult& result = results()[i];
      most_iterations = std::max(most_iterations, result.iterations);
      alone += result.alone ? 1 : 0;
      failed += result.converged ? 0 : 1;
      unstable += result.stable == "false" ? 1 : 0;
    }
    app_.out() << formatted(
                      "mixbeam batch: group %3zu of %zu  cases %6zu  iterations %3d  solved alone %4zu  failed %4zu  "
                      "unstable %4zu  %8.3f s\n",
                      number + 1, groups, group.size(), most_iterations, alone, failed, unstable, seconds)
               << std::flush;
  }

  Batch batch_;
  CaseQuantities quantities_;
  CaseScenes case_scenes_;
  BatchSolver solver_;
  CaseGroups groups_;
};

/// All cases, or the rows chosen on the command line.
Batch chosen_batch(const Application& app, const CommandLine& line) {
  Batch batch = read_batch(app.xml.list->sublist("Batch"), app.xml.source);
  if (!line.rows) return batch;
  require_rows(*line.rows, batch.size());
  const auto [first, last] = *line.rows;
  batch.keep(first - 1, last - (first - 1));
  return batch;
}

}  // namespace

int batch_command(const Arguments& arguments) {
  const CommandLine line = read_command_line(
      arguments.count(), arguments.values.data(),
      {"--output", "--case", "--rows", "--threads", "--summary", "--quiet", "--force", "--help"}, "scene file");
  if (!line.scene_file) throw InputError("a scene file is missing: mixbeam batch SCENE.xml");
  if (std::filesystem::is_directory(*line.scene_file)) return structures_batch(line);
  return with_application("mixbeam", [&](Application& app) {
    const Communicator all = app.communicator;  // later, app has a communicator of one rank
    set_up_batch(app, line);
    const auto read = [&] {
      return std::make_unique<VariedBatch>(app, chosen_batch(app, line), chosen_case(app.scene, line.load_case), all);
    };
    return run_batch(app, line, all, std::filesystem::path(*line.scene_file).stem().string(), read);
  });
}

}  // namespace mixbeam
