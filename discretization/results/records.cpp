#include "discretization/results/records.hpp"

#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>
#include <array>
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
  } catch (const DamageError&) {  // whoever reads it says so
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

}  // namespace mixbeam
