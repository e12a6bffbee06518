#include "discretization/results/sampled_file.hpp"

#include "discretization/results/records.hpp"
#include "discretization/results/result_tables.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

/// Columns of acting tables that hold lines of a text; the others hold numbers.
constexpr std::array<const char*, 4> kTextColumns = {"name", "shape", "kind", "point"};
/// Columns that hold numbers of members or, where `sections` of the members says so, of sections.
constexpr std::array<const char*, 3> kNumberColumns = {"place", "member", "section"};

/// Numbers that a field has at each sample: vectors, but for triads and stresses.
std::size_t columns_of(const std::string& field) {
  if (field == "triad") return 4;
  return std::find(kStressNames.begin(), kStressNames.end(), field) == kStressNames.end() ? 3 : 1;
}

/// Calls use(group) with the group of a path below another one; the empty path means that one itself.
template <class Use>
auto in_group(hid_t parent, const std::string& path, const Use& use) {
  if (path.empty()) return use(parent);
  const std::size_t end = std::min(path.find('/'), path.size());
  const hdf5::Handle group = hdf5::open_group(parent, path.substr(0, end));
  return in_group(group, end == path.size() ? "" : path.substr(end + 1), use);
}

const std::string kSuspected = "damaged, or no result file of mixbeam: ";

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) +
         (text.empty() || text.back() == '\n' ? 0 : 1);
}

ActingTable read_table(hid_t acting, const std::string& name) {
  ActingTable table;
  table.name = name;
  const hdf5::Handle group = hdf5::open_group(acting, name);
  for (const std::string& column : hdf5::link_names(group)) {
    std::size_t rows = 0;
    if (std::find(kTextColumns.begin(), kTextColumns.end(), column) != kTextColumns.end()) {
      std::string& text = table.lines[column] = hdf5::read_text(group, column);
      rows = lines_in(text);
    } else {
      std::size_t columns = 1;
      std::vector<double>& numbers = table.numbers[column] = hdf5::read_series(group, column, columns);
      rows = numbers.size() / columns;
    }
    if (table.rows != 0 && rows != table.rows) throw hdf5::Error("read " + name + ": columns of different lengths");
    table.rows = rows;
  }
  return table;
}

/// Throws if a table names members or sections that do not exist.
void require_numbers(const Acting& acting, std::size_t members) {
  std::size_t sections = 0;
  for (const ActingTable& table : acting.tables)
    if (table.name == "sections") sections = table.rows;
  for (const ActingTable& table : acting.tables)
    for (const char* column : kNumberColumns) {
      const auto found = table.numbers.find(column);
      if (found == table.numbers.end()) continue;
      const std::size_t width = table.rows > 0 ? found->second.size() / table.rows : 1;
      const double most = static_cast<double>(column == std::string("section") ? sections : members);
      for (std::size_t i = 0; i < found->second.size(); i += width)
        if (!(found->second[i] >= 0.0 && found->second[i] < most))
          throw hdf5::Error("read " + table.name + "/" + column + ": a number of what is not there");
    }
}

}  // namespace

struct SampledFile::Held {
  explicit Held(const std::filesystem::path& path) : file(path), results(file.content(), hdf5::FileUse::read) {}
  hdf5::QuietScope quiet;
  SealedFile file;
  hdf5::File results;
};

template <class Read>
auto SampledFile::reading(const std::string& group, const Read& read) const {
  return naming_file(
      path_, [&] { return in_group(held_->results, group, read); }, kSuspected);
}

SampledFile::SampledFile(const std::filesystem::path& path) : path_(path) {
  require_result_file(path);
  naming_file(
      path, [&] { held_ = std::make_unique<Held>(path); }, kSuspected);
  reading("", [&](hid_t file) {
    require_known_format(file, path.string(), held_->file.is_sealed());
    header_ = read_header(file);
    members_ = read_members(file);
    for (SampledMember& member : members_) {
      if (member.share.rows < 2) throw hdf5::Error("read the members: fewer than two samples");
      member.first_sample = samples_;
      samples_ += member.share.rows;
    }
    if (members_.empty()) throw hdf5::Error("read the members: there are none");
    if (hdf5::has_link(file, "acting")) {
      const hdf5::Handle acting = hdf5::open_group(file, "acting");
      if (hdf5::has_attribute(acting, "units")) acting_.units = hdf5::read_text_attribute(acting, "units");
      for (const std::string& name : hdf5::link_names(acting)) acting_.tables.push_back(read_table(acting, name));
      require_numbers(acting_, members_.size());
    }
    for (const std::string& name : step_groups(file)) {
      SampledStep& step = steps_.emplace_back();
      step.group = "steps/" + name;
      in_group(file, step.group, [&](hid_t group) {
        hdf5::read_attribute(group, "step", step.number);
        hdf5::read_attribute(group, "load_factor", step.load_factor);
        step.stable = read_stability(group).stable;
      });
    }
    monitor_ = read_monitor(file);
  });
  if (steps_.empty()) throw InputError(path.string() + ": holds no steps");
  for (MonitoredSeries& series : monitor_)
    if (series.values.size() < steps_.size() * series.columns)
      throw InputError(path.string() + ": the time series " + series.name + " is too short");
}

SampledFile::~SampledFile() = default;

std::vector<double> SampledFile::arc_lengths() const {
  const bool has_tables = reading("members", [&](hid_t group) {
    return hdf5::has_link(group, "arc_length") && !hdf5::is_group(hdf5::open_object(group, "arc_length"));
  });
  std::vector<double> all;
  if (has_tables) {
    all = numbers("members", "arc_length");
  } else {
    for (const SampledMember& member : members_) {
      const std::vector<double> own = numbers("members/" + member.name, "arc_length");
      all.insert(all.end(), own.begin(), own.end());
    }
  }
  if (all.size() != samples_)
    throw InputError(path_.string() + ": damaged: as many arc lengths as samples are missing");
  return all;
}

bool SampledFile::has(const std::string& group, const std::string& name) const {
  return reading(group, [&](hid_t id) { return hdf5::has_link(id, name); });
}

std::size_t SampledFile::count(const std::string& group, const std::string& name) const {
  return reading(group, [&](hid_t id) {
    return hdf5::has_link(id, name) ? hdf5::count_links(hdf5::open_group(id, name)) : std::size_t{0};
  });
}

std::vector<double> SampledFile::field(const std::string& group, const std::string& name) const {
  return reading(group, [&](hid_t id) {
    std::size_t columns = 1;
    std::vector<double> values = hdf5::read_series(id, name, columns);
    if (columns != columns_of(name) || values.size() != samples_ * columns)
      throw hdf5::Error("read " + group + "/" + name + ": not a row of its numbers for each sample");
    return values;
  });
}

std::vector<double> SampledFile::numbers(const std::string& group, const std::string& name, std::size_t columns) const {
  return reading(group, [&](hid_t id) { return hdf5::read_dataset(id, name, columns); });
}

double SampledFile::number(const std::string& group, const std::string& attribute) const {
  return reading(group, [&](hid_t id) { return hdf5::read_number(id, attribute); });
}

std::string SampledFile::word(const std::string& group, const std::string& attribute) const {
  return reading(group, [&](hid_t id) { return hdf5::read_text_attribute(id, attribute); });
}

std::vector<std::filesystem::path> runs_of_envelope(const std::filesystem::path& path) {
  require_result_file(path);
  const hdf5::QuietScope quiet;
  const auto read = [&] {
    SealedFile file(path);
    const hdf5::File results(file.content(), hdf5::FileUse::read);
    std::vector<std::filesystem::path> files;
    if (holds_run(results) || !hdf5::has_link(results, kEnvelope)) return files;
    for (const std::string& run : lines_of(hdf5::read_text(results, kEnvelopeRuns)))
      files.push_back(std::filesystem::path(path).replace_filename(run + ".h5"));
    return files;
  };
  return naming_file(path, read, kSuspected);
}

}  // namespace mixbeam
