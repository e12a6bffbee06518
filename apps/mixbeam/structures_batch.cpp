#include "apps/common/run/room_check.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/guarded_run.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/batch_run.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/found_scene.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/scene/load_cases.hpp"

#include <algorithm>
#include <ostream>
#include <set>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

/// "towers" for "designs/towers/".
std::string name_of_folder(const std::string& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

/// Scene files of a folder, sorted by name.
std::vector<fs::path> scenes_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".xml" || ending == ".yaml" || ending == ".yml") files.push_back(entry.path());
  }
  if (files.empty()) throw InputError("folder " + folder.string() + " holds no scene (*.xml, *.yaml, *.yml)");
  std::sort(files.begin(), files.end());
  return files;
}

/// One structure under one of its load cases.
struct StructureCase {
  fs::path file;
  std::string load_case;
  BatchOutput output;
  CaseQuantities quantities;
  std::string name() const { return file.filename().string() + (load_case.empty() ? "" : ": case " + load_case); }
};

class StructuresRun : public BatchRun {
 public:
  StructuresRun(Application& app, const CommandLine& line, const Communicator& ranks)
      : BatchRun(app, ranks), line_(line) {}

  /// Reads all scenes. Throws InputError for a refused one.
  void read() {
    const Stopwatch stopwatch(app_, "batch set-up");
    bool asks = false;
    for (const fs::path& file : scenes_in(*line_.scene_file)) {
      const std::unique_ptr<Application> one = read(file);
      const BatchOutput output = one->quantities.empty() ? BatchOutput::followed : BatchOutput::quantities;
      asks = asks || output == BatchOutput::quantities;
      try {
        for (const std::string& load_case : chosen_cases(one->scene, line_.load_case))
          cases_.push_back({file, load_case, output, CaseQuantities(*one, output, load_case)});
      } catch (const InputError& error) {
        const std::string text = error.what();
        throw InputError(text.find(file.string()) == std::string::npos ? file.string() + ": " + text : text);
      }
    }
    std::set<std::string> seen;
    for (const StructureCase& one : cases_)
      if (one.output == BatchOutput::quantities || !asks)  // if a scene has quantities, no points of the others
        for (const std::string& name : one.quantities.names())
          if (seen.insert(name).second) names_.push_back(name);
    if (line_.rows) {
      require_rows(*line_.rows, cases_.size());
      const auto [first, last] = *line_.rows;
      before_ = static_cast<std::size_t>(first) - 1;
      cases_.erase(cases_.begin() + last, cases_.end());
      cases_.erase(cases_.begin(), cases_.begin() + static_cast<std::ptrdiff_t>(before_));
    }
    results_.resize(cases_.size());
  }

  void solve() override {
    const Stopwatch stopwatch(app_, "batch solve");
    const auto ranks = static_cast<std::size_t>(ranks_->getSize());
    const std::size_t mine = (cases_.size() + ranks - 1) / ranks;
    std::unique_ptr<Application> one;
    fs::path file;
    bool all = true;
    for (std::size_t i = static_cast<std::size_t>(ranks_->getRank()), done = 1; i < cases_.size() && all; i += ranks) {
      if (!one || file != cases_[i].file) {
        if (one) app_.summary.append(one->summary.packed());
        file = cases_[i].file;
        one = read(file);
        warn_of_scene(*one);
        choose_mesh(*one);
        if (i > 0 && cases_[i - 1].file == file) {  // told by the rank of its first case
          one->summary.warnings.clear();
          one->summary.chosen_meshes.clear();
        }
      }
      CaseResult result = solved_case(*one, cases_[i]);
      all = result.solved;
      results_.keep(i, std::move(result));
      report(done++, mine);
    }
    if (one) app_.summary.append(one->summary.packed());
    gather(all);
  }

  BatchTable table(const std::vector<CaseResult>& results) const override {
    BatchTable table;
    table.before = before_;
    table.own = {{"structure", [this](std::size_t i) { return CsvCell(cases_[i].file.filename().string()); }},
                 {"load case", [this](std::size_t i) { return CsvCell(cases_[i].load_case); }}};
    table.names = names_;
    std::string& structures = table.texts["structures"];
    for (std::size_t i = 0; i < results.size(); ++i)
      if (results[i].solved) structures += cases_[i].name() + "\n";
    return table;
  }

  std::string name_of_case(std::size_t index) const override { return cases_[index].name(); }
  const CaseQuantities& quantities_of(std::size_t index) const override { return cases_[index].quantities; }

  std::size_t place_of(std::size_t name, std::size_t index) const override {
    const std::vector<std::string>& own = cases_[index].quantities.names();
    return static_cast<std::size_t>(std::find(own.begin(), own.end(), names_[name]) - own.begin());
  }

  void check_expected() override { app_.summary.unchecked = "expected values are compared by mixbeam run"; }

 private:
  std::unique_ptr<Application> read(const fs::path& file) const {
    static std::ostream silence(nullptr);
    auto one = std::make_unique<Application>();
    one->communicator = app_.communicator;
    one->terminal = &silence;
    one->quiet = true;
    one->force = app_.force;
    read_scene_file(*one, file.string(), mixbeam_definition());
    refuse_rest_shape(*one);
    refuse_search(*one);
    describe_run(*one, mixbeam_definition().name, line_.threads);
    return one;
  }

  CaseResult solved_case(Application& one, const StructureCase& which) const {
    const Scene scene = scene_of_case(one.scene, which.load_case);
    require_room(one, scene, one.solver);
    CaseResults result;
    result.resize(1);
    BatchSolver solver(one, which.quantities, result, [this] { return interrupt_requested(app_.communicator); });
    try {
      solver.solve({0}, {scene});
    } catch (const MemberError& error) {
      throw placed(one, error);
    }
    return result.all().front();
  }

  void report(std::size_t done, std::size_t mine) {
    constexpr std::chrono::seconds kBetweenLines{1};
    const auto now = std::chrono::steady_clock::now();
    if (app_.quiet || (done < mine && now - last_report_ < kBetweenLines)) return;
    last_report_ = now;
    const auto failed = std::count_if(results().begin(), results().end(),
                                      [](const CaseResult& result) { return result.solved && !result.converged; });
    app_.out() << formatted("mixbeam batch: %zu of %zu cases", done, mine)
               << (ranks_->getSize() > 1 ? " of rank 0" : "") << formatted(", %td failed\n", failed) << std::flush;
  }

  const CommandLine& line_;
  std::size_t before_ = 0;  ///< number of cases before the first chosen row
  std::vector<StructureCase> cases_;
  std::vector<std::string> names_;  ///< columns of all structures, in order of appearance
  std::chrono::steady_clock::time_point last_report_ = std::chrono::steady_clock::now();
};

}  // namespace

int structures_batch(const CommandLine& line) {
  return with_application("mixbeam", [&](Application& app) {
    const Communicator all = app.communicator;  // later, app has a communicator of one rank
    app.quiet = line.quiet;
    app.force = line.force;
    if (line.summary) prepare_summary(app, *line.summary);
    describe_run(app, mixbeam_definition().name, line.threads);
    const std::string folder = name_of_folder(*line.scene_file);
    app.output = line.output ? fs::path(*line.output) : fs::path("results") / folder;
    on_first_rank(app.communicator, [&app] { prepare_output_folder(app.output); });
    const auto read = [&] {
      auto run = std::make_unique<StructuresRun>(app, line, all);
      run->read();
      return run;
    };
    return run_batch(app, line, all, folder, read);
  });
}

}  // namespace mixbeam
