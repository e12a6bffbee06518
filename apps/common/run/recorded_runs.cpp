/// Runs of an application that write a result file.
#include "apps/common/run/application.hpp"
#include "apps/common/run/followed_points.hpp"
#include "apps/common/run/quantity_values.hpp"
#include "apps/common/run/room_check.hpp"
#include "apps/common/session/progress.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "discretization/results/stored_run.hpp"
#include "discretization/state/record_fields.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "discretization/text/text_file.hpp"

#include <array>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace mixbeam {

/// Time series of a run as a CSV file with one row per completed step: step, load factor, iterations, residual,
/// energies, then all monitored quantities by name, vectors as <name>.x, .y, .z, and the stability of the state: true,
/// false, neutral, unknown.
class MonitorTable {
 public:
  /// Columns of the series kQuantitySeries; indices of members are written as names.
  struct Quantities {
    std::vector<std::string> names{};
    std::vector<bool> is_member{};
    std::vector<std::string> members{};
  };

  /// Replaces an existing file with the first row.
  MonitorTable(std::filesystem::path path, Quantities quantities)
      : path_(std::move(path)), quantities_(std::move(quantities)) {}

  /// Adds a row for every step of a result file.
  void add(const StoredRun& run) {
    for (std::size_t step = 0; step < run.steps().size(); ++step) {
      Row row;
      for (const MonitoredSeries& series : run.monitor()) {
        const auto begin = series.values.begin() + static_cast<std::ptrdiff_t>(step * series.columns);
        row[series.name].assign(begin, begin + static_cast<std::ptrdiff_t>(series.columns));
      }
      write(row, run.stability()[step].stable);
    }
  }

  void add(const StepRecord& record) {
    Row row;
    visit_fields<const StepSummary>(
        record, [&](const auto& field, auto value) { row[field.name] = {static_cast<double>(value)}; });
    for (const MonitoredQuantity& quantity : record.monitored) row[quantity.name] = quantity.components;
    write(row, record.stability.stable);
  }

  /// Waits until the file is on disk.
  void close() {
    if (table_) table_->close();
  }

 private:
  /// Quantities by name, in alphabetical order.
  using Row = std::map<std::string, std::vector<double>>;
  static constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

  void write(const Row& row, const std::string& stable) {
    std::vector<std::string> names = kOwnTimeSeries;  // the others follow in alphabetical order
    for (const auto& [name, values] : row)
      if (!is_own_time_series(name) && name != kQuantitySeries) names.push_back(name);
    std::vector<std::string> columns;
    std::vector<CsvCell> cells;
    for (const std::string& name : names) {
      const std::vector<double>& values = row.at(name);
      for (std::size_t i = 0; i < values.size(); ++i) {
        columns.push_back(values.size() == kAxes.size() ? name + "." + kAxes[i] : name);
        cells.emplace_back(values[i]);
      }
    }
    for (std::size_t i = 0; i < quantities_.names.size(); ++i) {
      columns.push_back(quantities_.names[i]);
      cells.push_back(quantity_cell(i, row.at(kQuantitySeries).at(i)));
    }
    columns.emplace_back("stable");
    cells.emplace_back(stable);
    if (!table_) table_.emplace(path_, columns);
    table_->add_row(cells);
  }

  CsvCell quantity_cell(std::size_t column, double value) const {
    const auto members = static_cast<double>(quantities_.members.size());
    const bool is_member = quantities_.is_member[column] && value >= 0.0 && value < members;
    return is_member ? CsvCell(quantities_.members.at(static_cast<std::size_t>(value))) : CsvCell(value);
  }

  std::filesystem::path path_;
  Quantities quantities_;
  std::optional<CsvTable> table_;
};

namespace {

/// Growth rates below this share of the largest frequency count as rounding: equal frequencies differ by its root.
constexpr double kRealFrequency = 1e-6;

MonitorTable::Quantities quantity_columns(const QuantitySet* quantities, const Scene& scene) {
  MonitorTable::Quantities columns;
  if (quantities == nullptr) return columns;
  columns.names = quantities->names();
  for (const QuantitySet::Column& column : quantities->columns()) columns.is_member.push_back(column.is_member);
  for (const Member& member : scene.members) columns.members.push_back(member.name);
  return columns;
}

PathControl control_of(const Recording& recording) {
  PathControl control;
  control.stop = recording.stop;
  if (recording.resume != nullptr && !recording.resume->steps().empty())
    control.resume = recording.resume->steps().back();
  return control;
}

/// Property of a path that was followed again more closely, read on resuming.
const char* const kCloseness = "closeness";

int closeness_of(const Recording& recording) {
  if (recording.resume == nullptr) return 0;
  const std::string text = recording.resume->header().property(kCloseness);
  int closeness = 0;
  if (!text.empty() && (!parse_number(text, closeness).empty() || closeness < 0))
    throw InputError(recording.resume->path().string() + ": damaged: its closeness is \"" + text + "\"");
  return std::min(closeness, kMostCloseness);
}

/// Checks the number of quantities, whose names and values are stored in different places of the file.
void require_series_of(const QuantitySet* quantities, const StoredRun& run) {
  const std::size_t columns = quantities == nullptr ? 0 : quantities->columns().size();
  std::size_t found = 0;
  for (const MonitoredSeries& series : run.monitor())
    if (series.name == kQuantitySeries) found = series.columns;
  if (found != columns && !run.steps().empty())
    throw InputError(run.path().string() + ": damaged: it has " + std::to_string(found) + " quantities, its scene " +
                     std::to_string(columns));
}

/// Says where a failed run has left its last state.
std::string remains_of(const Recording& recording) {
  return recording.file.empty() ? "" : "The last converged state is the last step in " + recording.file.string() + ".";
}

}  // namespace

std::string judged_by_modes(const std::string& stable, const std::vector<RecordedVibrationMode>& modes) {
  if (modes.empty() || stable != "unknown") return stable;
  double largest = 0.0;
  bool grows = false, all_found = true;
  for (const RecordedVibrationMode& mode : modes) largest = std::max(largest, mode.omega);
  for (const RecordedVibrationMode& mode : modes) {
    grows = grows || mode.growth > kRealFrequency * largest;
    all_found = all_found && mode.confirmed;
  }
  if (grows || all_found) return grows ? "false" : "true";
  return stable;
}

/// Writes the files of a run and calls its observers.
class Application::Recorder {
 public:
  Recorder(const Application& app, const Scene& scene, const SolverParameters& parameters, const Recording& recording)
      : communicator_(app.communicator),
        searches_(app.progress_out(recording.file.stem().string()), app.name + " " + recording.file.stem().string(),
                  scene.stages),
        parameters_(parameters),
        recording_(recording),
        points_(followed_points(scene)) {
    if (recording.file.empty()) return;
    ResultHeader header = app.header(scene, recording.properties);
    if (recording.quantities != nullptr) {
      header.quantities = recording.quantities->names();
      header.quantity_units = recording.quantities->units(scene.units);
    }
    require_no_input(failure_file_of(recording.file).string());
    if (!recording.monitor.empty()) require_no_input(recording.monitor.string());
    results_ = recording.resume != nullptr
                   ? std::make_unique<ResultFile>(*recording.resume, app.communicator, recording.writing)
                   : std::make_unique<ResultFile>(recording.file, header, app.communicator, recording.writing);
    if (app.writes_files()) {
      std::error_code ignored;
      std::filesystem::remove(failure_file_of(recording.file), ignored);  // of an earlier run
      if (!recording.monitor.empty())
        monitor_.emplace(recording.monitor, quantity_columns(recording.quantities, scene));
    }
    if (recording.resume != nullptr) for_monitor([&] { monitor_->add(*recording.resume); });
  }

  /// Restores the mode tracks of a resumed run. Recomputes the modes of its last two searches, and of the earlier
  /// searches in which a track was last seen, as many as ModeTracks may remember.
  void follow_tracks(const Simulation& running, const StoredRun& run) {
    int tracks = 0;
    std::map<int, std::size_t> last_seen;
    std::set<std::size_t> searched;  // steps to search again
    std::size_t last = 0, last_but_one = 0;
    for (std::size_t i = 0; i < run.steps().size(); ++i) {
      if (!run.vibration()[i].empty()) last_but_one = std::exchange(last, i);
      for (const RecordedVibrationMode& mode : run.vibration()[i]) {
        tracks = std::max(tracks, mode.track);
        last_seen[mode.track] = i;
      }
    }
    tracks_ = ModeTracks(tracks);
    for (const auto& [track, step] : last_seen) searched.insert(step);
    for (const std::size_t step : {last_but_one, last})
      if (!run.steps().empty() && !run.vibration()[step].empty()) searched.insert(step);
    const std::size_t remembered = static_cast<std::size_t>(parameters_.analysis.modes.number) + 2;
    while (searched.size() > remembered) searched.erase(searched.begin());
    for (const std::size_t i : searched) {
      std::vector<int> known;
      for (const RecordedVibrationMode& mode : run.vibration()[i]) known.push_back(mode.track);
      Simulation there = running;
      there.restore(communicator_->getRank() == 0 ? run.state(i) : StateSnapshot{}, run.steps()[i].load_factor);
      find_modes(there, known);
    }
  }

  bool has_steps() const { return has_steps_; }
  /// Records a step and calls the observers. `estimate`: of the state, if it is known.
  void keep(const Simulation& running, const StepReport& report, const ErrorEstimate* estimate = nullptr) {
    has_steps_ = true;
    const StepRecord step = record(running, report, estimate);
    if (results_) results_->append_step(step);
    for_monitor([&] { monitor_->add(step); });
    if (recording_.record_observer) recording_.record_observer(step);
    if (!recording_.observer) return;
    if (step.stability.stable == running.stability().stable) return recording_.observer(running, report);
    recording_.observer(running.at(running.state(), running.load_factor(), step.stability), report);
  }

  StepRecord record(const Simulation& running, const StepReport& report, const ErrorEstimate* estimate) {
    const bool is_end = running.is_end_of_path(running.load_factor());
    std::optional<ErrorEstimate> own;  // first: samples then reuse the memory of its arrays
    if (estimate == nullptr && is_end && estimates_error(parameters_.analysis, running.model().mesh().elements.size()))
      estimate = &own.emplace(running.estimate_error());
    StepRecord step = running.record(report, recording_.points_per_element, points_);
    follow_reactions(points_, step);
    if (const ModesParameters& modes = parameters_.analysis.modes; asks_for_modes(modes, running.load_factor(), is_end))
      step.vibration = find_modes(running);
    step.stability.stable = judged_by_modes(step.stability.stable, step.vibration);
    if (recording_.quantities != nullptr) follow_quantities(running, report, step);
    if (recording_.gradients) {
      passed_.insert(passed_.end(), report.critical_points.begin(), report.critical_points.end());
      if (is_end) step.gradients = recording_.gradients(running, passed_);
    }
    if ((report.step == 0 || running.is_between_stages()) && parameters_.analysis.buckling_modes > 0)
      step.buckling = running.buckling_modes(parameters_.analysis.buckling_modes, recording_.points_per_element);
    step.buckling.insert(step.buckling.end(), recording_.motions.begin(), recording_.motions.end());
    if (estimate != nullptr) add_errors(running, *estimate, step);
    return step;
  }
  void close() {
    if (results_) results_->close();
    for_monitor([&] { monitor_->close(); });
  }

 private:
  std::vector<RecordedVibrationMode> find_modes(const Simulation& at, const std::vector<int>& known = {}) {
    const ModesParameters& modes = parameters_.analysis.modes;
    return at.vibration_modes(
        modes.number, modes.in_plane, recording_.points_per_element,
        [&](const ModeSearch& search) { searches_.report(search); }, &tracks_, known);
  }
  void add_errors(const Simulation& running, const ErrorEstimate& estimate, StepRecord& step) const {
    step.error_estimate = running.record_error(estimate, points_);
    add_value_errors(recording_.quantities, running, estimate, step);
  }
  void follow_quantities(const Simulation& running, const StepReport& report, StepRecord& step) const {
    step.monitored.push_back({kQuantitySeries, values_of(*recording_.quantities, running, step)});
    for (std::size_t i = 0; i < step.critical_points.size(); ++i) {
      const CriticalPoint& point = report.critical_points[i];
      step.critical_points[i].monitored.push_back(
          {kQuantitySeries, values_of(*recording_.quantities, running.at(point.state, point.load_factor))});
    }
  }

  /// Acts on the monitor of rank 0; throws on all ranks if that fails.
  void for_monitor(const std::function<void()>& action) const {
    const std::string problem = first_problem(*communicator_, [&] {
      if (monitor_) action();
    });
    if (!problem.empty())
      throw ResultFileError(problem + " (the steps so far are in " + recording_.file.string() + ")");
  }

  Communicator communicator_;
  Progress searches_;
  const SolverParameters& parameters_;
  const Recording& recording_;
  std::vector<std::string> points_;
  ModeTracks tracks_{};
  std::vector<CriticalPoint> passed_{};  ///< only for gradients
  std::unique_ptr<ResultFile> results_;  ///< null: without a file
  std::optional<MonitorTable> monitor_;
  bool has_steps_ = false;
};

std::optional<StoredRun> Application::completed_series(const Scene& solved, const SolverParameters& parameters,
                                                       const Recording& recording) const {
  const StoredRun* const run = recording.resume;
  if (run == nullptr || run->has_all_series()) return {};
  SolverParameters chosen = parameters;
  chosen.threads = threads_for(solved, parameters);
  Simulation simulation(solved, chosen, communicator);
  return with_all_series(*run, solved, recording.quantities, simulation);
}

Simulation Application::record(const std::shared_ptr<const Scene>& solved, const SolverParameters& parameters,
                               const Recording& wanted) {
  require_room(*this, *solved, parameters, wanted.file);
  const std::optional<StoredRun> completed = completed_series(*solved, parameters, wanted);
  Recording recording = wanted;
  if (completed) recording.resume = &*completed;
  if (recording.resume != nullptr) require_series_of(recording.quantities, *recording.resume);
  SolverParameters chosen = parameters;
  for (chosen.analysis.closeness = closeness_of(recording);; ++chosen.analysis.closeness) {
    if (chosen.analysis.closeness > 0) recording.properties[kCloseness] = std::to_string(chosen.analysis.closeness);
    Recorder recorder(*this, *solved, chosen, recording);
    const auto prepare = [&](Simulation& simulation) {
      if (recording.resume == nullptr) return;
      replay(simulation, *recording.resume, recording.observer);
      if (chosen.analysis.modes.number > 0) recorder.follow_tracks(simulation, *recording.resume);
    };
    Simulation simulation =
        walk(solved, chosen, recording.file.stem().string(), control_of(recording), prepare,
             [&](const Simulation& running, const StepReport& report) { recorder.keep(running, report); });
    if (simulation.result().returned && chosen.analysis.closeness < kMostCloseness) {
      recording.resume = nullptr;  // the path was lost somewhere
      const std::string label = recording.file.stem().string();
      progress_out(label) << name << " " << label << ": followed again from its start, more closely ("
                          << chosen.analysis.closeness + 1 << " of " << kMostCloseness << ")\n";
      if (recording.restart) recording.restart();
      continue;
    }
    if (!recorder.has_steps() && recording.record_observer) {  // resumed at the end of its path
      StepReport last;
      if (recording.resume != nullptr && !recording.resume->steps().empty())
        last = stored_report(*recording.resume, recording.resume->steps().size() - 1);
      last.jump.reset();  // belongs to the stored steps
      recording.record_observer(recorder.record(simulation, last, nullptr));
    }
    recorder.close();
    if (simulation.result().finished || simulation.result().interrupted) return simulation;
    give_up(simulation, recording.file.stem().string(), remains_of(recording), recording.file);
  }
}

AccurateRun Application::record_accurately(const Scene& solved, const SolverParameters& parameters,
                                           const Recording& recording, bool keeps_path) {
  const std::string label = recording.file.stem().string();
  std::optional<Recorder> recorder;
  std::optional<Progress> progress;
  AccurateRunObserver observer;
  observer.begin = [&](const Simulation& running) {
    recorder.reset();  // removes the hidden copy of the file
    recorder.emplace(*this, running.scene(), parameters, recording);
    progress.emplace(progress_out(label), name + " " + label, solved.stages, 0.0);
    if (recording.restart) recording.restart();
  };
  observer.step = [&](const Simulation& running, const StepReport& report) {
    progress->report(report, running.share_done());
    recorder->keep(running, report);
  };
  observer.end = [&](const Simulation& running, const StepReport& report, const ErrorEstimate& estimate) {
    progress->report(report, running.share_done());
    recorder->keep(running, report, &estimate);
  };
  judge_wanted(solved, quantities, observer);
  observer.stop = recording.stop;
  observer.step_failed = [&](const StepFailure& failure) { progress->report(failure); };
  observer.threads = [&](const Scene& on_mesh) {
    require_room(*this, on_mesh, parameters, recording.file);
    return threads_for(on_mesh, parameters);
  };
  AccurateRun run = run_accurately(solved, parameters, communicator, keeps_path, observer);
  recorder->close();
  for (const MeshRound& round : run.rounds) summary.add_work(round.steps, round.iterations);
  summary.add_work(0, 0, run.simulation.times());
  if (run.simulation.result().finished || run.simulation.result().interrupted) return run;
  give_up(run.simulation, label, remains_of(recording), recording.file);
}

void Application::write(const Simulation& simulation, const std::vector<KeptStep>& steps,
                        const Recording& recording) const {
  Recorder recorder(*this, simulation.scene(), solver, recording);
  for (const KeptStep& step : steps)
    recorder.keep(simulation.at(step.state, step.report.load_factor, step.stability), step.report);
  recorder.close();
}

}  // namespace mixbeam
