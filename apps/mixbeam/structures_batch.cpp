#include "apps/mixbeam/structures_batch.hpp"

#include "apps/common/run/room_check.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/guarded_run.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/common/session/last_resort.hpp"
#include "apps/common/session/mpi_session.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/batch_solver.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/found_scene.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "apps/mixbeam/rest_shape_files.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/results/table_file.hpp"
#include "discretization/scene/load_cases.hpp"
#include "mixbeam/version.hpp"

#include <algorithm>
#include <limits>
#include <ostream>
#include <set>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

/// "towers" of "designs/towers/".
std::string name_of_folder(const std::string& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

/// In the order of their names.
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

class StructuresRun {
 public:
  StructuresRun(Application& app, const CommandLine& line, const Communicator& ranks)
      : app_(app), line_(line), ranks_(ranks) {}

  /// Throws InputError for a scene that is refused.
  void read();
  void solve();
  void check_limits();
  void write(const fs::path& stem) const;
  SolvedBatch solved() const {
    return {results_, [this](std::size_t i) { return cases_[i].name(); }, interrupted_};
  }

 private:
  std::unique_ptr<Application> read(const fs::path& file) const;
  CaseResult solved_case(Application& one, const StructureCase& which) const;
  void report(std::size_t done, std::size_t mine);
  std::vector<CaseResult> results_so_far() const {
    const std::lock_guard<std::mutex> lock(results_mutex_);
    return results_;
  }

  Application& app_;
  const CommandLine& line_;
  Communicator ranks_;
  std::size_t before_ = 0;  ///< cases before the first row that was chosen
  std::vector<StructureCase> cases_;
  std::vector<std::string> names_;  ///< of what is written of all structures, in the order in which they appear
  std::vector<CaseResult> results_;
  mutable std::mutex results_mutex_;  // a program that is interrupted writes from another thread
  std::chrono::steady_clock::time_point last_report_ = std::chrono::steady_clock::now();
  bool interrupted_ = false;
};

std::unique_ptr<Application> StructuresRun::read(const fs::path& file) const {
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

void StructuresRun::read() {
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
    if (one.output == BatchOutput::quantities || !asks)  // where some scene asks, points of the others are not wanted
      for (const std::string& name : one.quantities.names())
        if (seen.insert(name).second) names_.push_back(name);
  if (line_.rows) {
    const auto [first, last] = *line_.rows;
    require_row(first, cases_.size());
    before_ = static_cast<std::size_t>(first) - 1;
    const auto begin = cases_.begin();
    cases_.erase(begin + std::min<std::ptrdiff_t>(last, std::distance(begin, cases_.end())), cases_.end());
    cases_.erase(begin, begin + static_cast<std::ptrdiff_t>(before_));
  }
  results_.resize(cases_.size());
}

CaseResult StructuresRun::solved_case(Application& one, const StructureCase& which) const {
  const Scene scene = scene_of_case(one.scene, which.load_case);
  require_room(one, scene, one.solver);
  BatchSolver solver(one, which.quantities, 1, [this] { return interrupt_requested(app_.communicator); });
  try {
    solver.solve({0}, {scene});
  } catch (const MemberError& error) {
    throw placed(one, error);
  }
  return solver.results().front();
}

void StructuresRun::solve() {
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
    }
    CaseResult result = solved_case(*one, cases_[i]);
    all = result.solved;
    {
      const std::lock_guard<std::mutex> lock(results_mutex_);
      results_[i] = std::move(result);
    }
    report(done++, mine);
  }
  if (one) app_.summary.append(one->summary.packed());
  interrupted_ = !gather_results(*ranks_, app_.summary, results_, all);
}

void StructuresRun::report(std::size_t done, std::size_t mine) {
  constexpr std::chrono::seconds kBetweenLines{1};
  const auto now = std::chrono::steady_clock::now();
  if (app_.quiet || (done < mine && now - last_report_ < kBetweenLines)) return;
  last_report_ = now;
  const auto failed = std::count_if(results_.begin(), results_.end(),
                                    [](const CaseResult& result) { return result.solved && !result.converged; });
  app_.out() << formatted("mixbeam batch: %zu of %zu cases", done, mine) << (ranks_->getSize() > 1 ? " of rank 0" : "")
             << formatted(", %td failed\n", failed) << std::flush;
}

void StructuresRun::check_limits() {
  for (std::size_t i = 0; i < cases_.size(); ++i) {
    const CaseQuantities& quantities = cases_[i].quantities;
    const std::vector<EstimatedValue>& values = results_[i].values.limited;
    for (std::size_t j = 0; j < values.size(); ++j)
      app_.summary.check_limit(cases_[i].name() + ": size of " + values[j].name, "", std::abs(values[j].value),
                               values[j].error, values[j].not_estimated, quantities.limits()[j].largest_size);
  }
}

void StructuresRun::write(const fs::path& stem) const {
  const std::vector<CaseResult> results = results_so_far();
  std::vector<std::string> head = {"case", "structure", "load case"};
  head.insert(head.end(), names_.begin(), names_.end());
  for (const char* name : {"iterations", "residual", "converged", "stable", "cause", "beyond limits"})
    head.emplace_back(name);
  CsvTable table(stem.string() + ".csv", head, Appears::when_closed);
  std::vector<TableColumn> columns(1, {"case", {}});
  for (const std::string& name : names_) columns.push_back({name, {}});
  for (const char* name : {"iterations", "residual", "converged", "stable", "within limits"})
    columns.push_back({name, {}});
  std::string structures, causes;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const CaseResult& result = results[i];
    if (!result.solved) continue;
    const std::string beyond = beyond_limits(result, cases_[i].quantities, 0);
    std::vector<CsvCell> cells = {before_ + i + 1, cases_[i].file.filename().string(), cases_[i].load_case};
    std::vector<double> numbers = {static_cast<double>(before_ + i + 1)};
    for (const std::string& name : names_) {
      const std::vector<std::string>& own = cases_[i].quantities.names();
      const std::size_t place = std::find(own.begin(), own.end(), name) - own.begin();
      const bool is_there = place < own.size() && !result.values.written.empty();
      numbers.push_back(is_there ? result.values.written[place] : std::numeric_limits<double>::quiet_NaN());
      const std::string member = is_there ? cases_[i].quantities.member_of(place, numbers.back()) : "";
      cells.push_back(member.empty() ? CsvCell(numbers.back()) : CsvCell(member));
    }
    for (const CsvCell& cell :
         {CsvCell(result.iterations), CsvCell(result.residual), CsvCell(result.converged ? "yes" : "no"),
          CsvCell(result.stable), CsvCell(result.cause), CsvCell(beyond)})
      cells.push_back(cell);
    table.add_row(cells);
    numbers.insert(numbers.end(),
                   {static_cast<double>(result.iterations), result.residual, result.converged ? 1.0 : 0.0,
                    number_of_stable(result.stable), beyond.empty() ? 1.0 : 0.0});
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].values.push_back(numbers[c]);
    structures += cases_[i].name() + "\n";
    if (!result.cause.empty()) causes += cases_[i].name() + ": " + result.cause + "\n";
  }
  table.close();
  write_table_file(stem.string() + ".h5", columns,
                   {{"structures", structures}, {"version", kVersion}, {"causes", causes}});
}

}  // namespace

int structures_batch(const CommandLine& line) {
  const MpiSession session;
  return guarded_run(session.communicator(), "mixbeam", [&] {
    Application app;
    app.communicator = session.communicator();
    app.quiet = line.quiet;
    app.force = line.force;
    if (line.summary) prepare_summary(app, *line.summary);
    describe_run(app, mixbeam_definition().name, line.threads);
    const std::string folder = name_of_folder(*line.scene_file);
    app.output = line.output ? fs::path(*line.output) : fs::path("results") / folder;
    on_first_rank(app.communicator, [&app] { prepare_output_folder(app.output); });
    const fs::path stem = app.output / (folder + "-batch" + rows_text(line));
    const SharedResultLock lock = lock_or_warn(app, stem.string() + ".h5");
    watch_for_interrupts();
    part_ranks(app);
    StructuresRun run(app, line, session.communicator());
    run.read();
    for (const char* ending : {".h5", ".csv"}) require_no_input(stem.string() + ending);
    {
      const LastResort rows([&] {
        if (session.communicator()->getRank() == 0) run.write(stem);
      });
      run.solve();
    }
    if (session.communicator()->getRank() > 0) return 0;
    finish_in_order();  // the table is written as a whole
    {
      const Stopwatch stopwatch(app, "batch output");
      run.write(stem);
    }
    run.check_limits();
    app.summary.unchecked = "expected values are compared by mixbeam run";
    return conclude_batch(app, line, run.solved());
  });
}

}  // namespace mixbeam
