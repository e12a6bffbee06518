#include "discretization/results/result_file.hpp"

#include "discretization/results/hdf5_writer.hpp"
#include "discretization/results/xdmf_text.hpp"
#include "discretization/text/result_names.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace mixbeam {
namespace {

namespace fs = std::filesystem;

constexpr int kFormatVersion = 2;
constexpr std::size_t kOverheadPerStep = 65536;   // bytes; HDF5's own data for a step were seen to take 12 kB
constexpr std::size_t kOverheadPerMember = 8192;  // bytes; they were seen to take 2.4 kB
constexpr std::size_t kXdmfRewriteShare = 100;  // the XDMF file may lag by 1 % of the steps, so a long run stays linear

std::size_t count_samples(const std::vector<MemberSamples>& members) {
  std::size_t samples = 0;
  for (const auto& member : members) samples += member.share.rows;
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

void write_members(hid_t file, const std::vector<MemberSamples>& members) {
  const auto parent = hdf5::open_group(file, "members");
  int index = 0;
  int first_sample = 0;
  for (const auto& member : members) {
    const auto group = hdf5::create_group(parent, member.name);
    const int samples = static_cast<int>(member.share.rows);
    hdf5::write_attribute(group, "index", index++);
    hdf5::write_attribute(group, "first_sample", first_sample);
    hdf5::write_attribute(group, "samples", samples);
    hdf5::write_attribute(group, "points_per_element", member.points_per_element);
    hdf5::write_attribute(group, "order", member.order);
    hdf5::write_attribute(group, "elements", member.elements);
    first_sample += samples;
  }
  hdf5::create_group(file, "polyline");
}

void write_supports(hid_t file, const std::vector<RecordedReaction>& reactions) {
  const auto supports = hdf5::create_group(file, "supports");
  for (std::size_t i = 0; i < reactions.size(); ++i)
    hdf5::write_attribute(hdf5::create_group(supports, std::to_string(i)), "point", reactions[i].point);
}

void append(std::vector<double>& numbers, const Vector3& v) { numbers.insert(numbers.end(), v.begin(), v.end()); }

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

hdf5::Handle write_state(hid_t parent, const StateShare& state) {
  auto group = hdf5::create_group(parent, "state");
  hdf5::write_attribute(group, "in_plane", state.held.in_plane ? 1 : 0);
  return group;
}

void write_state(hid_t step, const StateShare& state, const PathPoint& point) {
  const auto group = write_state(step, state);
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
  hdf5::write_attribute(group, "load_factor_error", point.load_factor_error);
  hdf5::write_attribute(group, "negative_before", point.negative_before);
  hdf5::write_attribute(group, "negative_after", point.negative_after);
  hdf5::write_attribute(group, "modes", point.modes);
  const auto monitor = hdf5::create_group(group, "monitor");
  for (const auto& quantity : point.monitored) hdf5::write_dataset(monitor, quantity.name, quantity.components, 1);
  if (!point.state.empty()) write_state(group, point.state);
}

void write_stability(hid_t step, const StepRecord& record) {
  const RecordedStability& stability = record.stability;
  hdf5::write_attribute(step, "stable", stability.stable);
  if (!stability.held.empty()) hdf5::write_attribute(step, "stable_held", stability.held);
  if (stability.negative >= 0) hdf5::write_attribute(step, "negative_eigenvalues", stability.negative);
  if (stability.negative >= 0 && !stability.has_potential) hdf5::write_attribute(step, "has_potential", 0);
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
    hdf5::write_attribute(group, "residual", mode.residual);
    hdf5::write_attribute(group, "confirmed", mode.confirmed ? 1 : 0);
  }
}

/// All of a step but its tables.
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

// Upper bound of what a record adds to a file besides its tables, in bytes.
std::size_t bytes_of(const StepRecord& record) {
  std::size_t bytes = kOverheadPerStep;
  for (const auto& point : record.critical_points) bytes += kOverheadPerStep + point.monitored.size() * 4096;
  if (record.error_estimate) bytes += kOverheadPerStep + record.error_estimate->points.size() * 4096;
  bytes += record.buckling.size() * 4096;
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

bool same_sampling(const MemberSamples& a, const MemberSamples& b) {
  return a.name == b.name && a.share.rows == b.share.rows;
}

bool is_complete(const StateShare& state) {
  const StateSnapshot& held = state.held;
  return held.vertex_displacement.size() == 3 * state.vertices.held() &&
         held.vertex_rotation.size() == 4 * state.vertices.held() &&
         held.element_triad.size() == 4 * state.elements.held() && held.interior.size() == state.interior.held();
}

/// Besides the samples of members.
bool has_complete_rows(const StepRecord& record) {
  std::size_t samples = 0;
  for (const auto& member : record.members) samples += member.size();
  bool complete = is_complete(record.state);
  for (const auto& point : record.critical_points)
    complete = complete && is_complete(point.state) && point.position.size() == samples &&
               point.displacement.size() == samples && point.mode.size() == samples;
  for (const auto& mode : record.buckling) complete = complete && mode.mode.size() == samples;
  return complete;
}

}  // namespace

ResultFile::ResultFile(const fs::path& path, ResultHeader header, const Communicator& communicator,
                       SharedResultLock lock)
    : communicator_(communicator),
      lock_(std::move(lock)),
      path_(path),
      xdmf_path_(fs::path(path).replace_extension(".xdmf")),
      header_(std::move(header)) {
  take_place();
  on_root([&] {
    std::error_code ignored;
    fs::remove(xdmf_path_, ignored);
  });
  or_give_up([&] {
    on_root([&] {
      start(copies_[0]);
      publish(copies_[0]);
    });
  });
  copies_[0].created = true;
  next_copy_ = 1;
}

ResultFile::ResultFile(const StoredRun& run, const Communicator& communicator, SharedResultLock lock)
    : communicator_(communicator),
      lock_(std::move(lock)),
      path_(run.path()),
      xdmf_path_(fs::path(path_).replace_extension(".xdmf")),
      header_(run.header()),
      previous_(run.layout()) {
  take_place();
  or_give_up([&] {
    on_root([&] {
      for (const Copy& copy : copies_) {
        reserve_space(copy.path, fs::file_size(path_));
        std::error_code error;
        fs::copy_file(path_, copy.path, fs::copy_options::overwrite_existing, error);
        if (error) throw ResultFileError(prefix() + "cannot be copied: " + error.message());
      }
    });
  });
  for (const auto& step : run.steps()) labels_.push_back({step.step, step.load_factor});
  for (Copy& copy : copies_) {
    copy.created = true;
    copy.has_members = !labels_.empty();
    copy.last_step = labels_.empty() ? -1 : labels_.back().step;
  }
}

ResultFile::~ResultFile() {
  if (closed_ || !is_root()) return;
  try {
    finish();
  } catch (const std::exception&) {
    remove_hidden_files();
  }
}

// Nothing is touched before the lock is held.
void ResultFile::take_place() {
  new_name_ = hidden(path_, "new");
  copies_[0].path = hidden(path_, "a");
  copies_[1].path = hidden(path_, "b");
  on_root([&] {
    check_place(path_);
    if (xdmf_path_ == path_) throw ResultFileError(prefix() + "its name must not end in .xdmf");
    if (!lock_) lock_ = std::make_shared<const ResultLock>(path_);
    remove_hidden_files();
  });
}

RankNumber ResultFile::rank() const { return {communicator_->getRank(), communicator_->getSize()}; }

std::string ResultFile::prefix() const { return "result file " + path_.string() + ": "; }

// Every rank runs `action`, which must not communicate; where it fails on one of them, all of them throw.
void ResultFile::together(const std::function<void()>& action) const {
  const std::string problem = first_problem(*communicator_, [&] {
    const hdf5::QuietScope quiet;
    try {
      action();
    } catch (const ResultFileError&) {
      throw;
    } catch (const std::exception& error) {
      throw ResultFileError(prefix() + error.what());
    }
  });
  if (!problem.empty()) throw ResultFileError(problem);
}

void ResultFile::on_root(const std::function<void()>& action) const {
  together([&] {
    if (is_root()) action();
  });
}

// After a failure of `step`, which is collective, the file takes no more steps.
void ResultFile::or_give_up(const std::function<void()>& step) {
  try {
    step();
  } catch (const ResultFileError&) {
    failed_ = true;
    if (is_root()) remove_hidden_files();
    throw;
  }
}

void ResultFile::append_step(const StepRecord& record) {
  together([&] {
    if (failed_ || closed_) throw ResultFileError(prefix() + "takes no more steps");
    check_consistent(record);
  });
  Copy& copy = copies_[next_copy_];
  or_give_up([&] {
    write_copy(copy, record);
    on_root([&] { publish(copy); });
  });
  next_copy_ = 1 - next_copy_;
  labels_.push_back({record.step, record.load_factor});
  previous_ = without_rows(record);
  on_root([&] {
    if ((labels_.size() - steps_in_xdmf_) * kXdmfRewriteShare >= labels_.size()) write_xdmf();
  });
}

void ResultFile::close() {
  if (closed_) return;
  closed_ = true;
  on_root([&] { finish(); });
}

void ResultFile::finish() {
  remove_hidden_files();
  if (!failed_ && steps_in_xdmf_ < labels_.size()) write_xdmf();
  lock_ = nullptr;
}

void ResultFile::check_consistent(const StepRecord& record) const {
  const std::string prefix = "result file " + path_.string() + ", step " + std::to_string(record.step) + ": ";
  if (record.members.empty()) throw ResultFileError(prefix + "no members");
  for (const auto& member : record.members) {
    if (!member.is_complete())
      throw ResultFileError(prefix + "member " + member.name + " has fields of unequal length");
    if (!is_link_name(member.name)) throw ResultFileError(prefix + "'" + member.name + "' cannot name a member");
  }
  if (!has_complete_rows(record)) throw ResultFileError(prefix + "modes, critical points or states of unequal length");
  for (const auto& quantity : record.monitored) {
    if (!is_link_name(quantity.name) || is_own_time_series(quantity.name)) {
      throw ResultFileError(prefix + "'" + quantity.name + "' cannot name a monitored quantity");
    }
    if (quantity.components.empty()) throw ResultFileError(prefix + quantity.name + " has no components");
  }
  if (labels_.empty()) return;
  if (record.step <= previous_.step) throw ResultFileError(prefix + "steps must grow");
  bool same =
      record.members.size() == previous_.members.size() && record.monitored.size() == previous_.monitored.size();
  for (std::size_t i = 0; same && i < record.members.size(); ++i) {
    same = same_sampling(record.members[i], previous_.members[i]);
  }
  same = same && sizes_of(record.monitored) == sizes_of(previous_.monitored);
  if (!same) throw ResultFileError(prefix + "members, samples or monitored quantities differ from the step before");
}

// Begins a copy with the header.
void ResultFile::start(const Copy& copy) const {
  std::size_t bytes = kOverheadPerStep + header_.scene_xml.size();
  for (const auto& [name, text] : header_.imported) bytes += 4096 + name.size() + text.size();
  reserve_space(copy.path, bytes);
  auto file = hdf5::create_file(copy.path);
  write_header(file, header_);
  file.close("complete the file");
}

bool ResultFile::lacks_previous(const Copy& copy) const { return !labels_.empty() && copy.last_step != previous_.step; }

// Brings a copy up to date: members, the step that only the other copy has, and `record`. Rank 0 makes everything but
// the numbers of the tables and closes the file; then every rank writes those that it holds to the places made for
// them.
void ResultFile::write_copy(Copy& copy, const StepRecord& record) {
  std::vector<ResultTable> tables, of_step;
  std::vector<std::uint64_t> places;
  together([&] {
    tables = missing_tables(copy, record);
    of_step = tables_of_step(record, rank());
    tables.insert(tables.end(), of_step.begin(), of_step.end());
    places.resize(tables.size());
  });
  on_root([&] { write_frame(copy, record, tables, places); });
  Teuchos::broadcast(*communicator_, 0, static_cast<int>(places.size() * sizeof(places[0])),
                     reinterpret_cast<char*>(places.data()));
  together([&] {
    SlabFile file(copy.path, SlabAccess::write, rank().ranks > 1);
    for (std::size_t i = 0; i < tables.size(); ++i)
      if (tables[i].shape.rows > 0) tables[i].write(file, places[i]);
    file.close();
  });
  copy.created = copy.has_members = true;
  copy.last_step = record.step;
  previous_tables_.clear();
  for (std::size_t i = 0; i < of_step.size(); ++i)
    previous_tables_.push_back({of_step[i].shape, places[tables.size() - of_step.size() + i]});
}

// What a copy needs before the tables of the next step.
std::vector<ResultTable> ResultFile::missing_tables(const Copy& copy, const StepRecord& record) const {
  std::vector<ResultTable> tables;
  if (!copy.has_members) tables = tables_of_members(record.members, rank());
  if (!lacks_previous(copy)) return tables;
  const auto source = std::make_shared<SlabFile>(copies_[1 - next_copy_].path, SlabAccess::read, false);
  for (const PlacedTable& table : previous_tables_)
    tables.push_back(copied_table(table.shape, source, table.place, rank()));
  return tables;
}

// All but the numbers of the tables, and where these go.
void ResultFile::write_frame(const Copy& copy, const StepRecord& record, const std::vector<ResultTable>& tables,
                             std::vector<std::uint64_t>& places) const {
  if (!copy.created) start(copy);
  std::size_t bytes = bytes_of(record) + bytes_of(previous_);
  if (!copy.has_members) bytes += kOverheadPerMember * record.members.size();
  for (const ResultTable& table : tables) bytes += table.shape.bytes();
  reserve_space(copy.path, bytes);
  auto file = hdf5::open_file(copy.path);
  if (!copy.has_members) {
    write_members(file, record.members);
    write_supports(file, record.reactions);
  }
  if (lacks_previous(copy)) write_step(file, previous_);
  write_step(file, record);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const TableShape& shape = tables[i].shape;
    places[i] =
        hdf5::place_dataset(file, shape.name, shape.numbers == TableNumbers::integers, shape.rows, shape.columns);
  }
  file.close("complete the file");
}

// Moves the file's own name to `copy` in one indivisible operation. Where the file system has no hard links, the copy
// is duplicated instead.
void ResultFile::publish(const Copy& copy) const {
  std::error_code error;
  fs::remove(new_name_, error);
  fs::create_hard_link(copy.path, new_name_, error);
  if (error) fs::copy_file(copy.path, new_name_, fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(new_name_, path_, error);
  if (error) throw ResultFileError(prefix() + "cannot take its name: " + error.message());
}

void ResultFile::write_xdmf() {
  std::vector<XdmfStep> steps;
  for (const auto& label : labels_)
    steps.push_back({"/steps/" + step_group_name(label.step), label.step, label.load_factor});
  const std::size_t members = previous_.members.size();
  const std::size_t samples = count_samples(previous_.members);
  const bool durable = false;  // it can be made again from the result file
  replace_file(xdmf_path_, xdmf_text(path_.filename().string(), steps, members, samples, samples + 2 * members),
               durable);
  steps_in_xdmf_ = labels_.size();
}

void ResultFile::remove_hidden_files() const noexcept {
  std::error_code ignored;
  for (const auto& path : {copies_[0].path, copies_[1].path, new_name_}) fs::remove(path, ignored);
}

}  // namespace mixbeam
