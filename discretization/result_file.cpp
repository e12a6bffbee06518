#include "discretization/result_file.hpp"

#include "discretization/hdf5_writer.hpp"
#include "discretization/result_names.hpp"
#include "discretization/xdmf_text.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace mixbeam {
namespace {

namespace fs = std::filesystem;

constexpr int kFormatVersion = 2;
constexpr std::size_t kOverheadPerStep = 65536;  // bytes; HDF5's own data for a step were seen to take 12 kB
constexpr int kXdmfPolyline = 2;                 // XDMF's number for a polyline in a mixed topology
const std::set<std::string> kOwnTimeSeries = {"step",          "load_factor",  "newton_iterations", "residual",
                                              "strain_energy", "force_energy", "moment_energy"};
constexpr std::size_t kXdmfRewriteShare = 100;  // the XDMF file may lag by 1 % of the steps, so a long run stays linear

std::string step_group_name(int step) {
  std::string digits = std::to_string(step);
  return std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits;
}

template <class Field>
void append_values(const MemberSamples& member, Field field, std::vector<double>& values) {
  for (const auto& sample : member.*field) values.insert(values.end(), sample.begin(), sample.end());
}

template <class Field>
std::vector<double> concatenated(const std::vector<MemberSamples>& members, Field field) {
  std::vector<double> values;
  for (const auto& member : members) append_values(member, field, values);
  return values;
}

// Columns g1, g2, g3 of the rotation matrix of a unit quaternion, spatial components.
std::array<Vector3, 3> triad_vectors(const TriadQuaternion& triad) {
  const auto [w, x, y, z] = triad;
  return {Vector3{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
          Vector3{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
          Vector3{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
}

// Spatial components of a material vector field: v = sum_i V_i g_i at every sample.
std::vector<double> spatial(const std::vector<MemberSamples>& members, std::vector<Vector3> MemberSamples::*material) {
  std::vector<double> values;
  for (const auto& member : members) {
    for (std::size_t sample = 0; sample < member.size(); ++sample) {
      const auto g = triad_vectors(member.triad[sample]);
      const Vector3& v = (member.*material)[sample];
      for (std::size_t i = 0; i < 3; ++i) values.push_back(v[0] * g[0][i] + v[1] * g[1][i] + v[2] * g[2][i]);
    }
  }
  return values;
}

std::vector<double> triad_column(const std::vector<MemberSamples>& members, std::size_t column) {
  std::vector<double> values;
  for (const auto& member : members) {
    for (const auto& triad : member.triad) {
      const Vector3 g = triad_vectors(triad)[column];
      values.insert(values.end(), g.begin(), g.end());
    }
  }
  return values;
}

std::vector<int> polyline_connectivity(const std::vector<MemberSamples>& members) {
  std::vector<int> connectivity;
  int sample = 0;
  for (const auto& member : members) {
    connectivity.push_back(kXdmfPolyline);
    connectivity.push_back(static_cast<int>(member.size()));
    for (std::size_t i = 0; i < member.size(); ++i) connectivity.push_back(sample++);
  }
  return connectivity;
}

std::size_t count_samples(const std::vector<MemberSamples>& members) {
  std::size_t samples = 0;
  for (const auto& member : members) samples += member.size();
  return samples;
}

void write_header(hid_t file, const ResultHeader& header) {
  hdf5::write_attribute(file, "format", std::string("mixbeam results"));
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
  hdf5::create_group(file, "members");
  hdf5::create_group(file, "steps");
  hdf5::create_group(file, "monitor");
}

int points_per_element(const MemberSamples& member) {
  return static_cast<int>(std::count(member.element.begin(), member.element.end(), 0));
}

void write_members(hid_t file, const std::vector<MemberSamples>& members) {
  const auto parent = hdf5::open_group(file, "members");
  int index = 0;
  int first_sample = 0;
  for (const auto& member : members) {
    const auto group = hdf5::create_group(parent, member.name);
    hdf5::write_attribute(group, "index", index++);
    hdf5::write_attribute(group, "first_sample", first_sample);
    hdf5::write_attribute(group, "samples", static_cast<int>(member.size()));
    hdf5::write_attribute(group, "points_per_element", points_per_element(member));
    hdf5::write_attribute(group, "order", member.order);
    hdf5::write_attribute(group, "elements", member.elements);
    hdf5::write_dataset(group, "arc_length", member.arc_length, 1);
    hdf5::write_dataset(group, "element", member.element);
    std::vector<double> reference_position;
    append_values(member, &MemberSamples::reference_position, reference_position);
    hdf5::write_dataset(group, "reference_position", reference_position, 3);
    first_sample += static_cast<int>(member.size());
  }
  const auto polyline = hdf5::create_group(file, "polyline");
  hdf5::write_dataset(polyline, "connectivity", polyline_connectivity(members));
}

void write_fields(hid_t group, const std::vector<MemberSamples>& members) {
  hdf5::write_dataset(group, "position", concatenated(members, &MemberSamples::position), 3);
  hdf5::write_dataset(group, "displacement", concatenated(members, &MemberSamples::displacement), 3);
  hdf5::write_dataset(group, "triad", concatenated(members, &MemberSamples::triad), 4);
  hdf5::write_dataset(group, "force_strain", concatenated(members, &MemberSamples::force_strain), 3);
  hdf5::write_dataset(group, "moment_strain", concatenated(members, &MemberSamples::moment_strain), 3);
  hdf5::write_dataset(group, "material_force", concatenated(members, &MemberSamples::material_force), 3);
  hdf5::write_dataset(group, "material_moment", concatenated(members, &MemberSamples::material_moment), 3);
  hdf5::write_dataset(group, "spatial_force", spatial(members, &MemberSamples::material_force), 3);
  hdf5::write_dataset(group, "spatial_moment", spatial(members, &MemberSamples::material_moment), 3);
  for (std::size_t i = 0; i < 3; ++i) {
    hdf5::write_dataset(group, "triad_" + std::to_string(i + 1), triad_column(members, i), 3);
  }
}

void write_supports(hid_t file, const std::vector<RecordedReaction>& reactions) {
  const auto supports = hdf5::create_group(file, "supports");
  for (std::size_t i = 0; i < reactions.size(); ++i)
    hdf5::write_attribute(hdf5::create_group(supports, std::to_string(i)), "point", reactions[i].point);
}

void append(std::vector<double>& numbers, const Vector3& v) { numbers.insert(numbers.end(), v.begin(), v.end()); }

std::vector<double> numbers_of(const std::vector<Vector3>& vectors) {
  std::vector<double> numbers;
  for (const Vector3& v : vectors) append(numbers, v);
  return numbers;
}

void write_reactions(hid_t group, const StepRecord& record) {
  std::vector<double> numbers;
  for (const auto& reaction : record.reactions) {
    append(numbers, reaction.force);
    append(numbers, reaction.moment);
  }
  hdf5::write_dataset(group, "reactions", numbers, 6);
  numbers.clear();
  for (const Vector3* v : {&record.balance.applied_force, &record.balance.applied_moment,
                           &record.balance.reaction_force, &record.balance.reaction_moment})
    append(numbers, *v);
  hdf5::write_dataset(group, "balance", numbers, 6);
  hdf5::write_attribute(group, "force_balance_error", record.balance.force_error);
  hdf5::write_attribute(group, "moment_balance_error", record.balance.moment_error);
}

void write_history(hid_t group, const std::vector<NewtonIteration>& history) {
  std::vector<double> rows;
  for (const auto& entry : history) {
    rows.push_back(entry.attempt);
    rows.push_back(entry.iteration);
    rows.push_back(entry.residual);
  }
  hdf5::write_dataset(group, "residual_history", rows, 3);
}

void write_snapshot(hid_t group, const StateSnapshot& state) {
  hdf5::write_dataset(group, "vertex_displacement", state.vertex_displacement, 3);
  hdf5::write_dataset(group, "vertex_rotation", state.vertex_rotation, 4);
  hdf5::write_dataset(group, "element_triad", state.element_triad, 4);
  hdf5::write_dataset(group, "interior", state.interior, 1);
  hdf5::write_attribute(group, "in_plane", state.in_plane ? 1 : 0);
}

void write_state(hid_t step, const StateSnapshot& state, const PathPoint& point) {
  const auto group = hdf5::create_group(step, "state");
  write_snapshot(group, state);
  hdf5::write_attribute(group, "stage", point.stage);
  hdf5::write_attribute(group, "step_size", point.step_size);
  hdf5::write_attribute(group, "iterations", point.iterations);
  hdf5::write_attribute(group, "attempts_left", point.attempts_left);
  hdf5::write_attribute(group, "failed_steps", point.failed_steps);
  hdf5::write_attribute(group, "newton_iterations", point.newton_iterations);
  hdf5::write_attribute(group, "critical_points", point.critical_points);
  hdf5::write_attribute(group, "path_length", point.path_length);
  hdf5::write_attribute(group, "direction", point.direction);
  hdf5::write_attribute(group, "negative", point.negative);
  hdf5::write_attribute(group, "branched", point.branched ? 1 : 0);
}

void write_critical_point(hid_t group, const RecordedCriticalPoint& point) {
  hdf5::write_attribute(group, "kind", point.kind);
  hdf5::write_attribute(group, "load_factor", point.load_factor);
  hdf5::write_attribute(group, "negative_before", point.negative_before);
  hdf5::write_attribute(group, "negative_after", point.negative_after);
  hdf5::write_attribute(group, "modes", point.modes);
  hdf5::write_dataset(group, "position", numbers_of(point.position), 3);
  hdf5::write_dataset(group, "displacement", numbers_of(point.displacement), 3);
  hdf5::write_dataset(group, "mode", numbers_of(point.mode), 3);
  const auto monitor = hdf5::create_group(group, "monitor");
  for (const auto& quantity : point.monitored) hdf5::write_dataset(monitor, quantity.name, quantity.components, 1);
  if (!point.state.empty()) write_snapshot(hdf5::create_group(group, "state"), point.state);
}

void write_stability(hid_t step, const StepRecord& record) {
  if (record.negative_eigenvalues >= 0)
    hdf5::write_attribute(step, "negative_eigenvalues", record.negative_eigenvalues);
  if (record.critical_points.empty()) return;
  const auto points = hdf5::create_group(step, "critical_points");
  int number = 0;
  for (const auto& point : record.critical_points)
    write_critical_point(hdf5::create_group(points, std::to_string(number++)), point);
}

void write_error(hid_t group, const std::string& name, const RecordedError& error) {
  hdf5::write_attribute(group, name + "_error", error.error);
  hdf5::write_attribute(group, name + "_size", error.size);
}

void write_error_estimate(hid_t step, const RecordedErrorEstimate& estimate) {
  const auto group = hdf5::create_group(step, "error_estimate");
  if (!estimate.not_estimated.empty()) {
    hdf5::write_attribute(group, "not_estimated", estimate.not_estimated);
    return;
  }
  write_error(group, "largest_displacement", estimate.largest_displacement);
  write_error(group, "displacement", estimate.displacement);
  write_error(group, "moment", estimate.moment);
  write_error(group, "energy", estimate.energy);
  hdf5::write_dataset(group, "vertex_displacement", numbers_of(estimate.vertex_displacement), 3);
  hdf5::write_dataset(group, "element_displacement", estimate.element_displacement, 1);
  hdf5::write_dataset(group, "element_moment", estimate.element_moment, 1);
  const auto points = hdf5::create_group(group, "points");
  for (const auto& point : estimate.points) hdf5::write_dataset(points, point.name, point.components, 1);
}

void write_buckling(hid_t file, const std::vector<RecordedBucklingMode>& modes) {
  if (modes.empty()) return;
  const auto buckling = hdf5::create_group(file, "buckling");
  int number = 0;
  for (const auto& mode : modes) {
    const auto group = hdf5::create_group(buckling, std::to_string(number++));
    hdf5::write_attribute(group, "load_factor", mode.load_factor);
    hdf5::write_dataset(group, "mode", numbers_of(mode.mode), 3);
  }
}

void write_step(hid_t file, const StepRecord& record) {
  write_buckling(file, record.buckling);
  const auto steps = hdf5::open_group(file, "steps");
  const auto group = hdf5::create_group(steps, step_group_name(record.step));
  hdf5::write_attribute(group, "step", record.step);
  hdf5::write_attribute(group, "load_factor", record.load_factor);
  hdf5::write_attribute(group, "newton_iterations", record.newton_iterations);
  hdf5::write_attribute(group, "residual", record.residual);
  hdf5::write_attribute(group, "strain_energy", record.strain_energy);
  hdf5::write_attribute(group, "force_energy", record.force_energy);
  hdf5::write_attribute(group, "moment_energy", record.moment_energy);
  write_fields(group, record.members);
  write_reactions(group, record);
  write_history(group, record.history);
  write_stability(group, record);
  if (record.error_estimate) write_error_estimate(group, *record.error_estimate);
  if (!record.state.empty()) write_state(group, record.state, record.point);

  const auto monitor = hdf5::open_group(file, "monitor");
  hdf5::append_row(monitor, "step", {static_cast<double>(record.step)});
  hdf5::append_row(monitor, "load_factor", {record.load_factor});
  hdf5::append_row(monitor, "newton_iterations", {static_cast<double>(record.newton_iterations)});
  hdf5::append_row(monitor, "residual", {record.residual});
  hdf5::append_row(monitor, "strain_energy", {record.strain_energy});
  hdf5::append_row(monitor, "force_energy", {record.force_energy});
  hdf5::append_row(monitor, "moment_energy", {record.moment_energy});
  for (const auto& quantity : record.monitored) hdf5::append_row(monitor, quantity.name, quantity.components);
}

std::size_t bytes_of(const StateSnapshot& state) {
  return sizeof(double) * (state.vertex_displacement.size() + state.vertex_rotation.size() +
                           state.element_triad.size() + state.interior.size());
}

// Upper bound of what a record adds to a file, in bytes.
std::size_t bytes_of(const StepRecord& record) {
  constexpr std::size_t kDoublesPerSample = 48;  // 37 for a step, 5 for the sampling, the rest in hand
  std::size_t bytes = kOverheadPerStep;
  for (const auto& member : record.members)
    bytes += kOverheadPerStep + member.size() * kDoublesPerSample * sizeof(double);
  bytes += bytes_of(record.state);
  for (const auto& point : record.critical_points)
    bytes += kOverheadPerStep + bytes_of(point.state) + point.mode.size() * 3 * sizeof(Vector3) +
             point.monitored.size() * 4096;
  if (record.error_estimate)
    bytes += kOverheadPerStep + record.error_estimate->vertex_displacement.size() * sizeof(Vector3) +
             record.error_estimate->element_displacement.size() * 2 * sizeof(double) +
             record.error_estimate->points.size() * 4096;
  for (const auto& mode : record.buckling) bytes += 4096 + mode.mode.size() * sizeof(Vector3);
  bytes += record.reactions.size() * (6 * sizeof(double) + 2048);
  bytes += record.history.size() * sizeof(NewtonIteration) * 2;
  for (const auto& quantity : record.monitored) bytes += 128 * sizeof(double) * quantity.components.size() + 4096;
  return bytes;
}

// Makes the system set disk space aside behind the end of a file, so that a full disk is noticed here: a write that
// fails inside the HDF5 library leaves it in a state in which it crashes when the program ends. Closing an HDF5 file
// cuts it to its true length again.
void reserve_space(const fs::path& path, std::size_t bytes) {
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT, 0666);
  if (file < 0) throw hdf5::Error("cannot create the file: " + std::string(std::strerror(errno)));
  const off_t end = ::lseek(file, 0, SEEK_END);
  const int error = ::posix_fallocate(file, end, static_cast<off_t>(bytes));
  ::close(file);
  if (error != 0) throw hdf5::Error("cannot get disk space: " + std::string(std::strerror(error)));
}

/// Room for a copy of a file, see reserve_space().
void reserve_copy(const fs::path& from, const fs::path& to) {
  try {
    reserve_space(to, fs::file_size(from));
  } catch (const std::exception& error) {
    throw ResultFileError("result file " + from.string() + ": " + error.what());
  }
}

fs::path hidden(const fs::path& path, const std::string& ending) {
  return path.parent_path() / ("." + path.filename().string() + "." + ending);
}

void check_place(const fs::path& path) {
  std::error_code ignored;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const std::string prefix = "result file " + path.string() + ": ";
  if (path.filename().empty()) throw ResultFileError(prefix + "a file name is missing");
  if (fs::is_directory(path, ignored)) throw ResultFileError(prefix + "exists and is a directory");
  if (!fs::exists(folder, ignored)) {
    throw ResultFileError(prefix + "the folder " + folder.string() + " does not exist");
  }
  if (!fs::is_directory(folder, ignored)) throw ResultFileError(prefix + folder.string() + " is not a folder");
}

bool is_link_name(const std::string& name) { return result_name_problem(name).empty(); }

std::map<std::string, std::size_t> sizes_of(const std::vector<MonitoredQuantity>& monitored) {
  std::map<std::string, std::size_t> sizes;
  for (const auto& quantity : monitored) sizes[quantity.name] = quantity.components.size();
  return sizes;
}

bool same_sampling(const MemberSamples& a, const MemberSamples& b) { return a.name == b.name && a.size() == b.size(); }

void replace_file(const fs::path& path, const fs::path& new_name, const std::string& text) {
  std::ofstream stream(new_name, std::ios::binary | std::ios::trunc);
  stream << text;
  stream.close();
  if (!stream) throw ResultFileError("file " + path.string() + ": cannot be written: " + std::strerror(errno));
  std::error_code error;
  fs::rename(new_name, path, error);
  if (error) throw ResultFileError("file " + path.string() + ": cannot be replaced: " + error.message());
}

}  // namespace

ResultFile::ResultFile(const fs::path& path, ResultHeader header)
    : path_(path), xdmf_path_(fs::path(path).replace_extension(".xdmf")), header_(std::move(header)) {
  check_place(path_);
  if (xdmf_path_ == path_) throw ResultFileError("result file " + path.string() + ": its name must not end in .xdmf");
  new_name_ = hidden(path_, "new");
  copies_[0].path = hidden(path_, "a");
  copies_[1].path = hidden(path_, "b");
  remove_hidden_files();
  std::error_code ignored;
  fs::remove(xdmf_path_, ignored);
  write_copy(copies_[0], nullptr);
  publish(copies_[0]);
  next_copy_ = 1;
}

ResultFile::ResultFile(const StoredRun& run)
    : path_(run.path()), xdmf_path_(fs::path(path_).replace_extension(".xdmf")), header_(run.header()) {
  check_place(path_);
  new_name_ = hidden(path_, "new");
  copies_[0].path = hidden(path_, "a");
  copies_[1].path = hidden(path_, "b");
  remove_hidden_files();
  previous_ = std::make_shared<const StepRecord>(run.layout());
  for (const auto& step : run.steps()) labels_.push_back({step.step, step.load_factor});
  for (auto& copy : copies_) {
    std::error_code error;
    reserve_copy(path_, copy.path);
    fs::copy_file(path_, copy.path, fs::copy_options::overwrite_existing, error);
    if (error) throw ResultFileError("result file " + path_.string() + ": cannot be copied: " + error.message());
    copy.created = true;
    copy.has_members = !labels_.empty();
    copy.last_step = labels_.empty() ? -1 : labels_.back().step;
  }
}

ResultFile::~ResultFile() {
  try {
    close();
  } catch (const std::exception&) {
    remove_hidden_files();
  }
}

void ResultFile::append_step(std::shared_ptr<const StepRecord> record) {
  if (failed_ || closed_) throw ResultFileError("result file " + path_.string() + ": takes no more steps");
  check_consistent(*record);
  Copy& copy = copies_[next_copy_];
  write_copy(copy, record.get());
  publish(copy);
  next_copy_ = 1 - next_copy_;
  labels_.push_back({record->step, record->load_factor});
  previous_ = std::move(record);
  if ((labels_.size() - steps_in_xdmf_) * kXdmfRewriteShare >= labels_.size()) write_xdmf();
}

void ResultFile::close() {
  if (closed_) return;
  closed_ = true;
  remove_hidden_files();
  if (steps_in_xdmf_ < labels_.size()) write_xdmf();
}

void ResultFile::check_consistent(const StepRecord& record) const {
  const std::string prefix = "result file " + path_.string() + ", step " + std::to_string(record.step) + ": ";
  if (record.members.empty()) throw ResultFileError(prefix + "no members");
  for (const auto& member : record.members) {
    if (!member.is_complete())
      throw ResultFileError(prefix + "member " + member.name + " has fields of unequal length");
    if (!is_link_name(member.name)) throw ResultFileError(prefix + "'" + member.name + "' cannot name a member");
  }
  for (const auto& quantity : record.monitored) {
    if (!is_link_name(quantity.name) || kOwnTimeSeries.count(quantity.name) > 0) {
      throw ResultFileError(prefix + "'" + quantity.name + "' cannot name a monitored quantity");
    }
    if (quantity.components.empty()) throw ResultFileError(prefix + quantity.name + " has no components");
  }
  if (labels_.empty()) return;
  if (record.step <= previous_->step) throw ResultFileError(prefix + "steps must grow");
  bool same =
      record.members.size() == previous_->members.size() && record.monitored.size() == previous_->monitored.size();
  for (std::size_t i = 0; same && i < record.members.size(); ++i) {
    same = same_sampling(record.members[i], previous_->members[i]);
  }
  same = same && sizes_of(record.monitored) == sizes_of(previous_->monitored);
  if (!same) throw ResultFileError(prefix + "members, samples or monitored quantities differ from the step before");
}

// Brings a copy up to date: header, the step that only the other copy has, and `record` (none: the header only).
void ResultFile::write_copy(Copy& copy, const StepRecord* record) {
  const hdf5::QuietScope quiet;
  try {
    std::size_t bytes = kOverheadPerStep + header_.scene_xml.size();
    for (const auto& [name, text] : header_.imported) bytes += 4096 + name.size() + text.size();
    if (record != nullptr) bytes += bytes_of(*record) + bytes_of(*previous_);
    reserve_space(copy.path, bytes);
    auto file = copy.created ? hdf5::open_file(copy.path) : hdf5::create_file(copy.path);
    if (!copy.created) write_header(file, header_);
    copy.created = true;
    if (record != nullptr) {
      if (!copy.has_members) {
        write_members(file, record->members);
        write_supports(file, record->reactions);
      }
      copy.has_members = true;
      if (!labels_.empty() && copy.last_step != previous_->step) write_step(file, *previous_);
      write_step(file, *record);
      copy.last_step = record->step;
    }
    file.close("complete the file");
  } catch (const hdf5::Error& error) {
    failed_ = true;
    remove_hidden_files();
    throw ResultFileError("result file " + path_.string() + ": " + error.what());
  }
}

// Moves the file's own name to `copy` in one indivisible operation. Where the file system has no hard links, the copy
// is duplicated instead.
void ResultFile::publish(const Copy& copy) {
  std::error_code error;
  fs::remove(new_name_, error);
  fs::create_hard_link(copy.path, new_name_, error);
  if (error) fs::copy_file(copy.path, new_name_, fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(new_name_, path_, error);
  if (!error) return;
  failed_ = true;
  remove_hidden_files();
  throw ResultFileError("result file " + path_.string() + ": cannot take its name: " + error.message());
}

void ResultFile::write_xdmf() {
  std::vector<XdmfStep> steps;
  for (const auto& label : labels_)
    steps.push_back({"/steps/" + step_group_name(label.step), label.step, label.load_factor});
  const std::size_t members = previous_->members.size();
  const std::size_t samples = count_samples(previous_->members);
  replace_file(xdmf_path_, new_name_,
               xdmf_text(path_.filename().string(), steps, members, samples, samples + 2 * members));
  steps_in_xdmf_ = labels_.size();
}

void ResultFile::remove_hidden_files() noexcept {
  std::error_code ignored;
  for (const auto& path : {copies_[0].path, copies_[1].path, new_name_}) fs::remove(path, ignored);
}

}  // namespace mixbeam
