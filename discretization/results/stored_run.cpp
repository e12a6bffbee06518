#include "discretization/results/stored_run.hpp"

#include "discretization/results/hdf5_writer.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

/// Time series that every result file has; the others are monitored quantities of the scene.
ResultHeader read_header(hid_t file) {
  ResultHeader header;
  header.scene_name = hdf5::read_text_attribute(file, "scene_name");
  header.scene_xml = hdf5::read_text(file, "scene");
  header.version = hdf5::read_text(file, "version");
  const auto properties = hdf5::open_group(file, "properties");
  for (const std::string& name : hdf5::attribute_names(properties))
    header.properties[name] = hdf5::read_text_attribute(properties, name);
  const auto imported = hdf5::open_group(file, "imported");
  for (const std::string& number : hdf5::link_names(imported)) {
    const auto group = hdf5::open_group(imported, number);
    header.imported[hdf5::read_text_attribute(group, "name")] = hdf5::read_text(group, "text");
  }
  return header;
}

int whole(hid_t object, const char* attribute) { return static_cast<int>(hdf5::read_number(object, attribute)); }

bool has_attribute(hid_t object, const std::string& name) {
  const auto names = hdf5::attribute_names(object);
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// What files of versions that followed no path by its length do not tell keeps its default.
void read_point_along_path(hid_t state, PathPoint& point) {
  point.stage = std::max(1, static_cast<int>(std::ceil(point.load_factor * (1.0 - kSameLoadFactor))));
  if (!has_attribute(state, "path_length")) return;
  point.stage = whole(state, "stage");
  point.critical_points = whole(state, "critical_points");
  point.path_length = hdf5::read_number(state, "path_length");
  point.direction = whole(state, "direction");
  point.negative = whole(state, "negative");
  point.branched = whole(state, "branched") != 0;
}

PathPoint read_point(hid_t steps, const std::string& name) {
  const auto step = hdf5::open_group(steps, name);
  const auto state = hdf5::open_group(step, "state");
  PathPoint point;
  point.step = whole(step, "step");
  point.load_factor = hdf5::read_number(step, "load_factor");
  point.step_size = hdf5::read_number(state, "step_size");
  point.iterations = whole(state, "iterations");
  point.attempts_left = whole(state, "attempts_left");
  point.failed_steps = whole(state, "failed_steps");
  point.newton_iterations = whole(state, "newton_iterations");
  read_point_along_path(state, point);
  return point;
}

RecordedStability read_stability(hid_t steps, const std::string& name) {
  const auto step = hdf5::open_group(steps, name);
  RecordedStability stability;
  if (has_attribute(step, "stable")) stability.stable = hdf5::read_text_attribute(step, "stable");
  if (has_attribute(step, "stable_held")) stability.held = hdf5::read_text_attribute(step, "stable_held");
  if (has_attribute(step, "negative_eigenvalues")) stability.negative = whole(step, "negative_eigenvalues");
  stability.has_potential = !has_attribute(step, "has_potential");
  return stability;
}

StateSnapshot read_snapshot(hid_t group) {
  const bool knows_plane = has_attribute(group, "in_plane");
  return {hdf5::read_dataset(group, "vertex_displacement"), hdf5::read_dataset(group, "vertex_rotation"),
          hdf5::read_dataset(group, "element_triad"), hdf5::read_dataset(group, "interior"),
          knows_plane && whole(group, "in_plane") == 1};
}

RecordedCriticalPoint read_critical_point(hid_t group) {
  RecordedCriticalPoint point;
  point.kind = hdf5::read_text_attribute(group, "kind");
  point.load_factor = hdf5::read_number(group, "load_factor");
  if (has_attribute(group, "load_factor_error"))
    point.load_factor_error = hdf5::read_number(group, "load_factor_error");
  point.negative_before = whole(group, "negative_before");
  point.negative_after = whole(group, "negative_after");
  point.modes = whole(group, "modes");
  point.state = whole(read_snapshot(hdf5::open_group(group, "state")));
  return point;
}

std::vector<MonitoredSeries> read_monitor(hid_t file) {
  const auto group = hdf5::open_group(file, "monitor");
  std::vector<MonitoredSeries> all;
  for (const std::string& name : hdf5::link_names(group)) {
    MonitoredSeries series;
    series.name = name;
    series.values = hdf5::read_dataset(group, name, &series.columns);
    all.push_back(series);
  }
  return all;
}

std::vector<MemberSamples> read_members(hid_t file) {
  const auto group = hdf5::open_group(file, "members");
  std::vector<MemberSamples> members(hdf5::count_links(group));
  for (const std::string& name : hdf5::link_names(group)) {
    const auto member = hdf5::open_group(group, name);
    const auto index = static_cast<std::size_t>(hdf5::read_number(member, "index"));
    members.at(index).name = name;
    members[index].share.rows = static_cast<std::size_t>(hdf5::read_number(member, "samples"));
  }
  return members;
}

/// Names are kept in alphabetical order; the order of writing is that of the program's own records.
std::vector<MonitoredQuantity> layout_of(const std::vector<MonitoredSeries>& monitor) {
  std::vector<MonitoredQuantity> quantities;
  for (const MonitoredSeries& series : monitor)
    if (!is_own_time_series(series.name)) quantities.push_back({series.name, std::vector<double>(series.columns, 0.0)});
  return quantities;
}

void require_result_file(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) throw InputError(path.string() + ": no such file");
  if (fs::is_directory(path, ignored))
    throw InputError(path.string() + ": is a directory; allowed: a result file (.h5)");
  if (H5Fis_hdf5(path.c_str()) <= 0)
    throw InputError(path.string() + ": not an HDF5 file; allowed: a result file (.h5)");
}

}  // namespace

StoredRun::StoredRun(const fs::path& path) : path_(path) {
  const hdf5::QuietScope quiet;
  require_result_file(path);
  try {
    const auto file = hdf5::open_file_to_read(path);
    const auto attributes = hdf5::attribute_names(file);
    const bool ours = std::find(attributes.begin(), attributes.end(), "format") != attributes.end() &&
                      hdf5::read_text_attribute(file, "format") == "mixbeam results";
    if (!ours) throw InputError(path.string() + ": HDF5, but no result file of mixbeam");
    constexpr int kFirstFormatWithStates = 2;
    if (hdf5::read_number(file, "format_version") < kFirstFormatWithStates)
      throw InputError(path.string() + ": written by a version of mixbeam that kept no states to resume from");
    header_ = read_header(file);
    const auto steps = hdf5::open_group(file, "steps");
    groups_ = hdf5::link_names(steps);
    std::stable_sort(groups_.begin(), groups_.end(),  // numbers: names of more than six digits come out of order
                     [](const std::string& a, const std::string& b) { return a.size() < b.size(); });
    for (const std::string& name : groups_) {
      steps_.push_back(read_point(steps, name));
      stability_.push_back(read_stability(steps, name));
    }
    monitor_ = read_monitor(file);
    layout_.members = read_members(file);
    layout_.monitored = layout_of(monitor_);
    if (!steps_.empty()) layout_.step = steps_.back().step;
  } catch (const hdf5::Error& error) {
    throw InputError(path.string() + ": " + error.what());
  }
}

StateSnapshot StoredRun::state(std::size_t position) const {
  const hdf5::QuietScope quiet;
  try {
    const auto file = hdf5::open_file_to_read(path_);
    const auto steps = hdf5::open_group(file, "steps");
    const auto step = hdf5::open_group(steps, groups_.at(position));
    return read_snapshot(hdf5::open_group(step, "state"));
  } catch (const hdf5::Error& error) {
    throw InputError(path_.string() + ": " + error.what());
  }
}

std::vector<RecordedCriticalPoint> StoredRun::critical_points(std::size_t position) const {
  const hdf5::QuietScope quiet;
  try {
    const auto file = hdf5::open_file_to_read(path_);
    const auto steps = hdf5::open_group(file, "steps");
    const auto step = hdf5::open_group(steps, groups_.at(position));
    const auto names = hdf5::link_names(step);
    std::vector<RecordedCriticalPoint> points;
    if (std::find(names.begin(), names.end(), "critical_points") == names.end()) return points;
    const auto group = hdf5::open_group(step, "critical_points");
    const std::size_t count = hdf5::count_links(group);
    for (std::size_t i = 0; i < count; ++i)
      points.push_back(read_critical_point(hdf5::open_group(group, std::to_string(i))));
    return points;
  } catch (const hdf5::Error& error) {
    throw InputError(path_.string() + ": " + error.what());
  }
}

}  // namespace mixbeam
