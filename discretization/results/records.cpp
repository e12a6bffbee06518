#include "discretization/results/records.hpp"

#include "discretization/results/result_tables.hpp"
#include "discretization/state/record_fields.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

namespace mixbeam {

namespace {

const std::string kFormat = "mixbeam results";

/// Names the files of an envelope: "2 runs; allowed: out/frame-snow.h5, out/frame-wind.h5".
std::string files_of_runs(hid_t file, const std::string& name) {
  std::vector<std::string> files;
  for (const std::string& run : lines_of(hdf5::read_text(file, kEnvelopeRuns)))
    files.push_back(std::filesystem::path(name).replace_filename(run + ".h5").string());
  return std::to_string(files.size()) + " runs; allowed: one of theirs, " + quoted_list(files);
}

std::vector<std::string> read_lines(hid_t file, const std::string& name) {
  return hdf5::has_link(file, name) ? lines_of(hdf5::read_text(file, name)) : std::vector<std::string>{};
}

/// Reads files that have a group for each member.
std::vector<SampledMember> read_member_groups(hid_t group) {
  const std::vector<std::string> names = hdf5::link_names(group);
  std::vector<SampledMember> members(names.size());
  for (const std::string& name : names) {
    const auto member = hdf5::open_group(group, name);
    int index = 0, samples = 0;
    hdf5::read_attribute(member, "index", index);
    hdf5::read_attribute(member, "samples", samples);
    if (index < 0 || static_cast<std::size_t>(index) >= members.size() || samples < 0)
      throw hdf5::Error("cannot read member " + name + ": its numbers are inconsistent");
    members[static_cast<std::size_t>(index)].name = name;
    members[static_cast<std::size_t>(index)].number = index;
    members[static_cast<std::size_t>(index)].share.rows = static_cast<std::size_t>(samples);
  }
  return members;
}

/// Rows of numbers as a dataset.
template <class Row>
void write_rows(hid_t group, const std::string& name, const std::vector<Row>& rows) {
  static_assert(sizeof(Row) % sizeof(double) == 0, "rows are written as they are in memory");
  constexpr std::size_t kColumns = sizeof(Row) / sizeof(double);
  const double* const begin = reinterpret_cast<const double*>(rows.data());
  hdf5::write_dataset(group, name, {begin, begin + kColumns * rows.size()}, kColumns);
}

/// Attributes of a record: fields at samples are tables (result_tables.cpp).
struct Writing {
  hid_t object;
  template <class Field, class Value>
  void operator()(const Field& field, const Value& value) const {
    if constexpr (!kIsAtSamples<Value>)
      if (field.kept == Kept::always || is_known_value(value)) hdf5::write_attribute(object, field.name, value);
  }
};
struct Reading {
  hid_t object;
  template <class Field, class Value>
  void operator()(const Field& field, Value& value) const {
    if constexpr (!kIsAtSamples<Value>)
      if (field.kept == Kept::always || hdf5::has_attribute(object, field.name))
        hdf5::read_attribute(object, field.name, value);
  }
};

/// Writes a group of records, each in a group of its own; rest(group, record) writes what is not a field.
template <class Record, class Rest>
void write_records(hid_t parent, const char* name, const std::vector<Record>& records, const Rest& rest) {
  if (records.empty()) return;
  const auto all = hdf5::create_group(parent, name);
  int number = 0;
  for (const Record& record : records) {
    const auto group = hdf5::create_group(all, std::to_string(number++));
    visit_fields(record, Writing{group});
    rest(group, record);
  }
}
template <class Record, class Rest>
std::vector<Record> read_records(hid_t parent, const char* name, const Rest& rest) {
  std::vector<Record> records;
  if (!hdf5::has_link(parent, name)) return records;
  const auto all = hdf5::open_group(parent, name);
  records.resize(hdf5::count_links(all));
  int number = 0;
  for (Record& record : records) {
    const auto group = hdf5::open_group(all, std::to_string(number++));
    visit_fields(record, Reading{group});
    rest(group, record);
  }
  return records;
}
constexpr auto kNoRest = [](hid_t, const auto&) {};

void write_components(hid_t parent, const char* name, const std::vector<MonitoredQuantity>& quantities) {
  const auto group = hdf5::create_group(parent, name);
  for (const auto& quantity : quantities) write_rows(group, quantity.name, quantity.components);
}

/// Group of the jump with which a step was made, and attribute of a state: jumps of the path so far.
constexpr const char *kJump = "jump", *kJumps = "jumps";

using ForceAndMoment = std::array<Vector3, 2>;

void write_reactions(hid_t group, const StepRecord& record) {
  std::vector<ForceAndMoment> rows;
  for (const auto& reaction : record.reactions) rows.push_back({reaction.force, reaction.moment});
  write_rows(group, "reactions", rows);
  const RecordedBalance& sums = record.balance;
  write_rows<ForceAndMoment>(group, "balance",
                             {{sums.applied_force, sums.applied_moment}, {sums.reaction_force, sums.reaction_moment}});
  hdf5::write_attribute(group, "force_balance_error", sums.force_error);
  hdf5::write_attribute(group, "moment_balance_error", sums.moment_error);
}

void write_history(hid_t group, const std::vector<NewtonIteration>& history) {
  std::vector<Vector3> rows;
  for (const auto& entry : history)
    rows.push_back({static_cast<double>(entry.attempt), static_cast<double>(entry.iteration), entry.residual});
  write_rows(group, "residual_history", rows);
}

hdf5::Handle write_state(hid_t parent, const StateShare& state) {
  auto group = hdf5::create_group(parent, "state");
  hdf5::write_attribute(group, "in_plane", state.held.in_plane);
  return group;
}

void write_stability(hid_t step, const StepRecord& record) {
  const RecordedStability& stability = record.stability;
  visit_fields(stability, Writing{step});
  if (stability.negative >= 0 && !stability.has_potential) hdf5::write_attribute(step, "has_potential", 0);
  write_records(step, "critical_points", record.critical_points, [](hid_t group, const RecordedCriticalPoint& point) {
    write_components(group, "monitor", point.monitored);
    if (!point.state.empty()) write_state(group, point.state);
  });
}

/// Writes estimated values, if there are any. A value that is not estimated has a reason, and NaN as its error.
void write_values(hid_t parent, const std::string& name, const std::vector<EstimatedValue>& values) {
  if (values.empty()) return;
  const auto group = hdf5::create_group(parent, name);
  std::vector<std::string> names, reasons;
  std::vector<double> sizes, errors;
  for (const EstimatedValue& one : values) {
    names.push_back(one.name);
    reasons.push_back(one.is_estimated() ? "" : one.not_estimated);
    sizes.push_back(one.value);
    errors.push_back(one.error);
  }
  write_lines(group, "names", names);
  write_rows(group, "value", sizes);
  write_rows(group, "error", errors);
  write_lines(group, "not_estimated", reasons);
}

void write_error_estimate(hid_t step, const RecordedErrorEstimate& estimate) {
  const auto group = hdf5::create_group(step, "error_estimate");
  if (!estimate.not_estimated.empty()) return hdf5::write_attribute(group, "not_estimated", estimate.not_estimated);
  for (const auto& [name, member] : kErrorsOfEstimate) {
    hdf5::write_attribute(group, name + std::string("_error"), (estimate.*member).error);
    hdf5::write_attribute(group, name + std::string("_size"), (estimate.*member).size);
  }
  write_components(group, "points", estimate.points);
  write_values(group, "quantities", estimate.quantities);
  write_values(group, "sections", estimate.sections);
}

void write_gradients(hid_t step, const RecordedGradients& gradients) {
  const auto group = hdf5::create_group(step, "gradients");
  if (!gradients.not_found.empty()) return hdf5::write_attribute(group, "not_found", gradients.not_found);
  write_lines(group, "numbers", gradients.numbers);
  int number = 0;
  for (const RecordedGradient& one : gradients.quantities) {
    const auto own = hdf5::create_group(group, std::to_string(number++));
    hdf5::write_attribute(own, "quantity", one.quantity);
    hdf5::write_attribute(own, "value", one.value);
    if (!one.note.empty()) hdf5::write_attribute(own, "no_derivative", one.note);
    write_rows(own, "derivative", one.derivative);
    if (one.stiffness.empty()) continue;
    write_rows(own, "stiffness", one.stiffness);
    write_rows(own, "compliance", one.compliance);
    write_rows(own, "natural", one.natural);
  }
}

/// The time series of every run are the fields of a step's summary.
void write_monitor(hid_t file, const StepRecord& record) {
  const auto monitor = hdf5::open_group(file, "monitor");
  visit_fields<const StepSummary>(record, [&](const auto& field, auto value) {
    hdf5::append_rows(monitor, field.name, {static_cast<double>(value)}, 1);
  });
  for (const auto& quantity : record.monitored)
    hdf5::append_rows(monitor, quantity.name, quantity.components, quantity.components.size());
}

/// Row of the table of frequencies: motions by their tracks.
std::vector<double> row_of_tracks(const std::vector<RecordedVibrationMode>& modes,
                                  double RecordedVibrationMode::*number) {
  std::vector<double> row;
  for (const RecordedVibrationMode& mode : modes) {
    if (mode.track < 1) continue;
    row.resize(std::max<std::size_t>(row.size(), mode.track), NAN);
    row[mode.track - 1] = mode.*number;
  }
  return row;
}

}  // namespace

void write_lines(hid_t group, const std::string& name, const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  if (!lines.empty()) hdf5::write_text(group, name, text);
}

void write_header(hid_t file, const ResultHeader& header) {
  hdf5::write_attribute(file, "format", kFormat);
  hdf5::write_attribute(file, "format_version", kFormatVersion);
  hdf5::write_attribute(file, "scene_name", header.scene_name);
  hdf5::write_text(file, "scene", header.scene_xml);
  hdf5::write_text(file, "version", header.version);
  const auto properties = hdf5::create_group(file, "properties");
  for (const auto& [name, value] : header.properties) hdf5::write_attribute(properties, name, value);
  const auto imported = hdf5::create_group(file, "imported");
  for (const auto& [name, text] : header.imported) {
    const auto group = hdf5::create_group(imported, std::to_string(hdf5::count_links(imported)));
    hdf5::write_attribute(group, "name", name);
    hdf5::write_text(group, "text", text);
  }
  write_lines(file, kQuantitySeries, header.quantities);
  write_lines(file, kQuantityUnits, header.quantity_units);
  hdf5::create_group(file, "members");
  hdf5::create_group(file, "steps");
  hdf5::create_group(file, "monitor");
}

void require_result_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(path.string() + ": no such file");
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(path.string() + ": is a directory; allowed: a result file (.h5)");
  if (!std::filesystem::is_regular_file(path, ignored))
    throw InputError(path.string() + ": is a pipe or a device, not a file; allowed: a result file (.h5)");
  try {
    const DiskFile file(path, DiskAccess::read);
    if (read_seal(file)) return;
    std::array<unsigned char, 8> begin{};
    if (file.size() >= begin.size()) file.read(0, begin.data(), begin.size());
    if (begin != std::array<unsigned char, 8>{0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'})
      throw InputError(path.string() + ": not an HDF5 file; allowed: a result file (.h5)");
  } catch (const DiskError& error) {
    throw InputError(path.string() + ": " + error.what());
  } catch (const DamageError&) {  // reported when it is read
  }
}

bool holds_run(hid_t file) {
  return hdf5::has_attribute(file, "format") && hdf5::read_text_attribute(file, "format") == kFormat;
}

void require_known_format(hid_t file, const std::string& name, bool is_sealed) {
  if (!holds_run(file))
    throw InputError(name + ": HDF5, but no result file of " +
                     (hdf5::has_link(file, kEnvelope) ? "a run: the envelope of " + files_of_runs(file, name)
                                                      : std::string("mixbeam")));
  int version = 0;
  hdf5::read_attribute(file, "format_version", version);
  if (version < kFirstFormatWithStates)
    throw InputError(name + ": written by a version of mixbeam that kept no states to resume from");
  if (version > kFormatVersion)
    throw InputError(name + ": its format_version is " + std::to_string(version) +
                     ", of a newer mixbeam; this one knows those up to " + std::to_string(kFormatVersion));
  if (version >= kFirstSealedFormat && !is_sealed)
    throw InputError(name +
                     ": damaged: the checksums after its content are missing: the file was truncated, or another " +
                     "program has written to it");
}

ResultHeader read_header(hid_t file) {
  ResultHeader header;
  hdf5::read_attribute(file, "scene_name", header.scene_name);
  header.scene_xml = hdf5::read_text(file, "scene");
  header.version = hdf5::read_text(file, "version");
  const auto properties = hdf5::open_group(file, "properties");
  for (const std::string& name : hdf5::attribute_names(properties))
    hdf5::read_attribute(properties, name, header.properties[name]);
  const auto imported = hdf5::open_group(file, "imported");
  for (const std::string& number : hdf5::link_names(imported)) {
    const auto group = hdf5::open_group(imported, number);
    header.imported[hdf5::read_text_attribute(group, "name")] = hdf5::read_text(group, "text");
  }
  header.quantities = read_lines(file, kQuantitySeries);
  header.quantity_units = read_lines(file, kQuantityUnits);
  return header;
}

void write_members(hid_t file, const SampledMembers& members) {
  const auto group = hdf5::open_group(file, "members");
  std::vector<std::string> names;
  members.for_each_known([&](const SampledMember& member) { names.push_back(member.name); });
  hdf5::write_texts(group, "names", names);
  const auto write = [&](const char* name, const auto& number) {
    std::vector<int> numbers;
    members.for_each_known(
        [&](const SampledMember& m) { numbers.push_back(static_cast<int>(std::invoke(number, m))); });
    hdf5::write_dataset(group, name, numbers);
  };
  write("first_sample", &SampledMember::first_sample);
  write("samples", [](const SampledMember& member) { return member.share.rows; });
  write("points_per_element", &SampledMember::points_per_element);
  write("order", &SampledMember::order);
  write("elements", &SampledMember::elements);
  hdf5::create_group(file, "polyline");
}

std::vector<SampledMember> read_members(hid_t file) {
  const auto group = hdf5::open_group(file, "members");
  const std::vector<std::string> links = hdf5::link_names(group);
  const bool has_tables = std::find(links.begin(), links.end(), "names") != links.end() &&
                          !hdf5::is_group(hdf5::open_object(group, "names"));
  if (!has_tables) return read_member_groups(group);
  const std::vector<std::string> names = hdf5::read_texts(group, "names");
  const auto counts = [&](const char* name) { return hdf5::read_dataset(group, name, 1, hdf5::Stored::integers); };
  const std::vector<double> samples = counts("samples"), orders = counts("order"), elements = counts("elements");
  const auto refuse = [] { throw hdf5::Error("cannot read the members: their numbers are inconsistent"); };
  if (samples.size() != names.size() || orders.size() != names.size() || elements.size() != names.size()) refuse();
  const std::vector<hsize_t> in_file = hdf5::open_dataset(group, "arc_length", hdf5::Stored::reals).shape;
  if (in_file.size() != 1 || std::accumulate(samples.begin(), samples.end(), 0.0) != static_cast<double>(in_file[0]))
    refuse();
  std::vector<SampledMember> members(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (samples[i] < 0.0 || elements[i] < 0.0 || elements[i] > samples[i])
      refuse();  // no more than the file has room for
    members[i].name = names[i];
    members[i].number = static_cast<int>(i);
    members[i].order = static_cast<int>(orders[i]);
    members[i].elements = static_cast<int>(elements[i]);
    members[i].share.rows = static_cast<std::size_t>(samples[i]);
  }
  return members;
}

void write_supports(hid_t file, const std::vector<RecordedReaction>& reactions) {
  const auto supports = hdf5::create_group(file, "supports");
  for (std::size_t i = 0; i < reactions.size(); ++i)
    hdf5::write_attribute(hdf5::create_group(supports, std::to_string(i)), "point", reactions[i].point);
}

void write_acting(hid_t file, const Acting& acting) {
  const auto group = hdf5::create_group(file, "acting");
  if (!acting.units.empty()) hdf5::write_attribute(group, "units", acting.units);
  for (const ActingTable& table : acting.tables) {
    const auto columns = hdf5::create_group(group, table.name);
    for (const auto& [column, text] : table.lines) hdf5::write_text(columns, column, text);
    for (const auto& [column, values] : table.numbers)
      hdf5::write_dataset(columns, column, values, values.size() / table.rows);
  }
}

std::vector<MonitoredSeries> read_monitor(hid_t file) {
  const auto group = hdf5::open_group(file, "monitor");
  std::vector<MonitoredSeries> all;
  for (const std::string& name : hdf5::link_names(group)) {
    MonitoredSeries series;
    series.name = name;
    series.values = hdf5::read_series(group, name, series.columns);
    all.push_back(series);
  }
  return all;
}

std::vector<MonitoredSeries> own_time_series(hid_t file, const std::vector<std::string>& groups) {
  std::vector<MonitoredSeries> all;
  for (const std::string& name : kOwnTimeSeries) all.push_back({name});
  const auto steps = hdf5::open_group(file, "steps");
  for (const std::string& group : groups) {
    const auto step = hdf5::open_group(steps, group);
    for (MonitoredSeries& series : all) series.values.push_back(hdf5::read_number(step, series.name));
  }
  return all;
}

void copy_steps(hid_t source, hid_t target, std::size_t steps, const std::vector<MonitoredSeries>& monitor) {
  write_header(target, read_header(source));
  for (const std::string& name : hdf5::link_names(source)) {
    const bool has_own_way = name == "scene" || name == "version" || name == "properties" || name == "imported" ||
                             name == "steps" || name == "monitor" || name == kQuantitySeries ||
                             name == kQuantityUnits || name == kFrequencies;
    if (has_own_way) continue;
    if (name == "members") hdf5::remove_link(target, name);  // the empty one
    hdf5::copy_link(source, name, target);
  }
  const auto from = hdf5::open_group(source, "steps"), to = hdf5::open_group(target, "steps");
  const auto groups = step_groups(source);
  for (std::size_t i = 0; i < std::min(steps, groups.size()); ++i) {
    hdf5::copy_link(from, groups[i], to);
    const auto step = hdf5::open_group(from, groups[i]);
    append_frequencies(target, static_cast<int>(hdf5::read_number(step, "step")),
                       hdf5::read_number(step, "load_factor"), read_vibration(step));
  }
  const auto series_group = hdf5::open_group(target, "monitor");
  for (MonitoredSeries series : monitor) {
    if (series.values.size() < steps * series.columns)
      throw hdf5::Error("cannot read time series " + series.name + ": it is too short");
    series.values.resize(steps * series.columns);
    hdf5::append_rows(series_group, series.name, series.values, series.columns);
  }
}

void append_frequencies(hid_t file, int step, double load_factor, const std::vector<RecordedVibrationMode>& modes) {
  const std::vector<double> omega = row_of_tracks(modes, &RecordedVibrationMode::omega);
  if (omega.empty()) return;
  const auto group = hdf5::has_link(file, kFrequencies) ? hdf5::open_group(file, kFrequencies)
                                                        : hdf5::create_group(file, kFrequencies);
  hdf5::append_rows(group, "step", {static_cast<double>(step)}, 1);
  hdf5::append_rows(group, "load_factor", {load_factor}, 1);
  hdf5::append_row(group, "omega", omega);
  hdf5::append_row(group, "frequency", row_of_tracks(modes, &RecordedVibrationMode::frequency));
}

void write_step(hid_t file, const StepRecord& record) {
  const auto steps = hdf5::open_group(file, "steps");
  const auto group = hdf5::create_group(steps, step_group_name(record.step));
  write_records(record.step == 0 ? file : static_cast<hid_t>(group), "buckling", record.buckling, kNoRest);
  write_records(group, "vibration", record.vibration, kNoRest);
  append_frequencies(file, record.step, record.load_factor, record.vibration);
  visit_fields<const StepSummary>(record, Writing{group});
  write_reactions(group, record);
  write_history(group, record.history);
  write_stability(group, record);
  if (record.jump) visit_fields(*record.jump, Writing{hdf5::create_group(group, kJump)});
  if (record.error_estimate) write_error_estimate(group, *record.error_estimate);
  if (record.gradients) write_gradients(group, *record.gradients);
  if (!record.state.empty()) {
    const auto state = write_state(group, record.state);
    visit_fields(record.point, Writing{state});
    visit_fields(record.point, kFieldsAlongPath, Writing{state});
    if (record.point.piece >= 0.0) visit_fields(record.point, kFieldsOfPiece, Writing{state});
    if (record.point.jumps > 0) hdf5::write_attribute(state, kJumps, record.point.jumps);
  }
  write_monitor(file, record);
}

std::vector<std::string> step_groups(hid_t file) {
  std::vector<std::string> groups = hdf5::link_names(hdf5::open_group(file, "steps"));
  std::stable_sort(groups.begin(), groups.end(),  // numbers: names of more than six digits come out of order
                   [](const std::string& a, const std::string& b) { return a.size() < b.size(); });
  return groups;
}

PathPoint read_point(hid_t step, const std::string& name) {
  const auto state = hdf5::open_group(step, "state");
  PathPoint point;
  hdf5::read_attribute(step, "step", point.step);
  if (step_group_name(point.step) != name) throw hdf5::Error("cannot read step " + name + ": it has another number");
  hdf5::read_attribute(step, "load_factor", point.load_factor);
  visit_fields(point, Reading{state});
  // Fields that files of versions which followed no path by its length lack keep their defaults.
  point.stage = static_cast<int>(std::clamp(std::ceil(point.load_factor * (1.0 - kSameLoadFactor)), 1.0, 1e9));
  if (hdf5::has_attribute(state, "path_length")) visit_fields(point, kFieldsAlongPath, Reading{state});
  if (hdf5::has_attribute(state, "piece")) visit_fields(point, kFieldsOfPiece, Reading{state});
  if (hdf5::has_attribute(state, kJumps)) hdf5::read_attribute(state, kJumps, point.jumps);
  return point;
}

std::optional<RecordedJump> read_jump(hid_t step) {
  if (!hdf5::has_link(step, kJump)) return std::nullopt;
  RecordedJump jump;
  visit_fields(jump, Reading{hdf5::open_group(step, kJump)});
  return jump;
}

std::vector<RecordedVibrationMode> read_vibration(hid_t step) {
  return read_records<RecordedVibrationMode>(step, "vibration", kNoRest);
}

RecordedStability read_stability(hid_t step) {
  RecordedStability stability;
  visit_fields(stability, Reading{step});
  stability.has_potential = !hdf5::has_attribute(step, "has_potential");
  return stability;
}

StateSnapshot read_state(hid_t group) {
  const auto state = hdf5::open_group(group, "state");
  const auto numbers = [&](const char* name, std::size_t columns) {
    std::vector<double> values = hdf5::read_dataset(state, name, columns);
    if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }))
      throw hdf5::Error("cannot read state/" + std::string(name) + ": it has numbers that are not finite");
    return values;
  };
  StateSnapshot snapshot{numbers("vertex_displacement", 3), numbers("vertex_rotation", 4), numbers("element_triad", 4),
                         numbers("interior", 1), false};
  if (hdf5::has_attribute(state, "in_plane")) hdf5::read_attribute(state, "in_plane", snapshot.in_plane);
  return snapshot;
}

std::vector<RecordedCriticalPoint> read_critical_points(hid_t step) {
  return read_records<RecordedCriticalPoint>(step, "critical_points", [](hid_t group, RecordedCriticalPoint& point) {
    point.state = whole(read_state(group));
  });
}

}  // namespace mixbeam
