#include "discretization/results/stored_run.hpp"

#include "discretization/results/records.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

/// Names are kept in alphabetical order; the order of writing is that of the program's own records.
std::vector<MonitoredQuantity> layout_of(const std::vector<MonitoredSeries>& monitor) {
  std::vector<MonitoredQuantity> quantities;
  for (const MonitoredSeries& series : monitor)
    if (!is_own_time_series(series.name)) quantities.push_back({series.name, std::vector<double>(series.columns, 0.0)});
  return quantities;
}

/// Reads in a result file with read(file).
template <class Read>
auto reading(const fs::path& path, const Read& read) {
  const hdf5::QuietScope quiet;
  return naming_file(path, [&] {
    SealedFile file(path);
    const hdf5::File results(file.content(), hdf5::FileUse::read);
    require_known_format(results, path.string(), file.is_sealed());
    return read(static_cast<hid_t>(results));
  });
}

/// Reads a step of the file with read(its group).
template <class Read>
auto reading_step(const fs::path& path, const std::string& name, const Read& read) {
  return reading(path, [&](hid_t file) { return read(hdf5::open_group(hdf5::open_group(file, "steps"), name)); });
}

/// Requires the time series that every run with steps has.
void require_own_series(const fs::path& path, const std::vector<MonitoredSeries>& monitor) {
  for (const std::string& name : kOwnTimeSeries)
    if (std::none_of(monitor.begin(), monitor.end(),
                     [&](const MonitoredSeries& series) { return series.name == name && series.columns == 1; }))
      throw InputError(path.string() + ": the time series " + name + " is missing");
}

/// A motion has a number as soon as it has a mode: no number exceeds that of all modes so far.
void require_tracks(const std::string& step, const std::vector<RecordedVibrationMode>& modes, std::size_t& before) {
  before += modes.size();
  for (const RecordedVibrationMode& mode : modes)
    if (mode.track > 0 && static_cast<std::size_t>(mode.track) > before)
      throw hdf5::Error("cannot read step " + step + ": its modes have tracks that no run gives");
}

}  // namespace

StoredRun::StoredRun(const fs::path& path, std::optional<int> last_step)
    : path_(path), drops_the_rest_(last_step.has_value()) {
  require_result_file(path);
  reading(path, [&](hid_t file) {
    header_ = read_header(file);
    const auto steps = hdf5::open_group(file, "steps");
    std::size_t modes = 0;
    for (const std::string& name : step_groups(file)) {
      if (last_step && std::atoi(name.c_str()) > *last_step) break;
      const auto step = hdf5::open_group(steps, name);
      groups_.push_back(name);
      steps_.push_back(read_point(step, name));
      stability_.push_back(read_stability(step));
      vibration_.push_back(read_vibration(step));
      require_tracks(name, vibration_.back(), modes);
    }
    try {
      monitor_ = read_monitor(file);
    } catch (const hdf5::Error&) {
      if (!last_step) throw;
      has_all_series_ = false;
      monitor_ = own_time_series(file, groups_);
    }
    members_ = read_members(file);
  });
  if (last_step && (steps_.empty() || steps_.back().step != *last_step))
    throw InputError(path.string() + ": holds no step " + std::to_string(*last_step) + "; allowed: " +
                     (steps_.empty() ? "none below it is there"
                                     : std::to_string(steps_.front().step) + ", ..., " +
                                           std::to_string(steps_.back().step) + " and later ones"));
  if (!steps_.empty()) require_own_series(path, monitor_);
  for (MonitoredSeries& series : monitor_) {
    if (series.values.size() < steps_.size() * series.columns)
      throw InputError(path.string() + ": the time series " + series.name + " is too short");
    series.values.resize(steps_.size() * series.columns);
  }
  layout_.monitored = layout_of(monitor_);
  if (!steps_.empty()) layout_.step = steps_.back().step;
}

void StoredRun::complete(const std::vector<MonitoredSeries>& series) {
  monitor_.insert(monitor_.end(), series.begin(), series.end());
  layout_.monitored = layout_of(monitor_);
  has_all_series_ = true;
}

StateSnapshot StoredRun::state(std::size_t position) const {
  return reading_step(path_, groups_.at(position), read_state);
}

std::vector<RecordedCriticalPoint> StoredRun::critical_points(std::size_t position) const {
  return reading_step(path_, groups_.at(position), read_critical_points);
}

std::optional<RecordedJump> StoredRun::jump(std::size_t position) const {
  return reading_step(path_, groups_.at(position), read_jump);
}

}  // namespace mixbeam
