#include "discretization/results/result_file.hpp"

#include "discretization/results/records.hpp"
#include "discretization/text/result_names.hpp"
#include "discretization/text/text_file.hpp"

#include <algorithm>
#include <map>
#include <system_error>

namespace mixbeam {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kXdmfRewriteShare = 100;  // the XDMF file may lag by 1 % of the steps, so a long run stays linear

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

/// Whether a member is among those of the steps before, in the order of their numbers.
bool is_known(const SampledMember& member, const std::vector<SampledMember>& members) {
  const auto found = std::lower_bound(members.begin(), members.end(), member.number,
                                      [](const SampledMember& other, int number) { return other.number < number; });
  return found != members.end() && found->number == member.number && found->name == member.name &&
         found->share.rows == member.share.rows;
}

bool is_complete(const StateShare& state) {
  const StateSnapshot& held = state.held;
  return held.vertex_displacement.size() == 3 * state.vertices.held() &&
         held.vertex_rotation.size() == 4 * state.vertices.held() &&
         held.element_triad.size() == 4 * state.elements.held() && held.interior.size() == state.interior.held();
}

/// Whether all rows besides the samples of members are complete.
bool has_complete_rows(const StepRecord& record) {
  std::size_t samples = 0;
  for (const auto& member : record.members) samples += member.size();
  bool complete = is_complete(record.state);
  for (const auto& point : record.critical_points)
    complete = complete && is_complete(point.state) && point.position.size() == samples &&
               point.displacement.size() == samples && point.mode.size() == samples;
  for (const auto& mode : record.buckling) complete = complete && mode.mode.size() == samples;
  for (const auto& mode : record.vibration) complete = complete && mode.mode.size() == samples;
  return complete;
}

std::uint64_t bytes_of(const std::vector<ResultTable>& tables) {
  std::uint64_t bytes = 0;
  for (const ResultTable& table : tables) bytes += table.shape.bytes();
  return bytes;
}

/// Names the stresses of a step in a file that is continued.
std::vector<std::string> stored_stresses(hid_t file, int step) {
  const hdf5::Handle group = hdf5::open_group(hdf5::open_group(file, "steps"), step_group_name(step));
  std::vector<std::string> names(kStressNames.begin(), kStressNames.end());
  const auto is_missing = [&](const std::string& name) { return !hdf5::has_link(group, name); };
  names.erase(std::remove_if(names.begin(), names.end(), is_missing), names.end());
  return names;
}

}  // namespace

ResultFile::ResultFile(const fs::path& path, ResultHeader header, const Communicator& communicator,
                       WritingOptions options)
    : path_(path),
      xdmf_path_(fs::path(path).replace_extension(".xdmf")),
      ranks_(communicator, path),
      lock_(std::move(options.lock)),
      file_(path, ranks_, options.durable) {
  take_place();
  or_give_up([&] {
    ranks_.on_root([&] {
      std::error_code ignored;
      fs::remove(xdmf_path_, ignored);
      file_.begin(kSmallBlock, [&](GuardedFile& content) {
        hdf5::File results(content, hdf5::FileUse::create);
        write_header(results, header);
        results.close();
      });
    });
    file_.publish();
  });
}

ResultFile::ResultFile(const StoredRun& run, const Communicator& communicator, WritingOptions options)
    : path_(run.path()),
      xdmf_path_(fs::path(path_).replace_extension(".xdmf")),
      ranks_(communicator, path_),
      lock_(std::move(options.lock)),
      file_(path_, ranks_, options.durable),
      members_(run.members()),
      previous_(run.layout()) {
  take_place();
  member_count_ = members_.size();
  for (const SampledMember& member : members_) sample_count_ += member.share.rows;
  for (const auto& step : run.steps()) labels_.push_back({step.step, step.load_factor, {}});
  or_give_up([&] {
    ranks_.on_root([&] {
      SealedFile stored(path_);
      const hdf5::File source(stored.content(), hdf5::FileUse::read);
      for (XdmfStep& label : labels_) label.stresses = stored_stresses(source, label.step);
      file_.begin(stored.is_sealed() ? stored.seal().block : kLargeBlock, [&](GuardedFile& content) {
        hdf5::File target(content, hdf5::FileUse::create);
        copy_steps(source, target, labels_.size(), run.monitor());
        target.close();
      });
    });
    if (run.drops_the_rest()) file_.publish();  // there may be no step to come
  });
}

ResultFile::~ResultFile() {
  if (closed_ || !ranks_.is_root()) return;
  try {
    finish();
  } catch (const std::exception&) {  // close() reports it
  }
}

// Nothing is touched before the lock is held.
void ResultFile::take_place() {
  ranks_.on_root([&] {
    check_place(path_);
    if (xdmf_path_ == path_) throw ResultFileError(ranks_.prefix() + "its name must not end in .xdmf");
    if (!lock_) lock_ = std::make_shared<const ResultLock>(path_);
    for (const auto& name : {path_, xdmf_path_, hidden(path_, "a"), hidden(path_, "b"), hidden(path_, "new")})
      require_no_input(name.string());
    file_.remove_copies();
  });
}

// After a failure of `step`, which is collective, the file takes no more steps.
void ResultFile::or_give_up(const std::function<void()>& step) {
  try {
    step();
  } catch (const ResultFileError&) {
    failed_ = true;
    if (ranks_.is_root()) file_.remove_copies();
    throw;
  }
}

void ResultFile::append_step(const StepRecord& record) {
  ranks_.together([&] {
    if (failed_ || closed_) throw ResultFileError(ranks_.prefix() + "takes no more steps");
    check_consistent(record);
  });
  or_give_up([&] { write_step_of(record); });
  labels_.push_back({record.step, record.load_factor, stresses_of_step(record)});
  if (member_count_ == 0) {
    members_.assign(record.members.begin(), record.members.end());
    member_count_ = record.members.members();
    sample_count_ = record.members.samples();
  }
  previous_ = record;
  ranks_.on_root([&] {
    if ((labels_.size() - steps_in_xdmf_) * kXdmfRewriteShare >= labels_.size()) write_xdmf();
  });
}

// Rank 0 makes everything but the numbers of the tables; then every rank writes those that it holds to the places made
// for them.
void ResultFile::write_step_of(const StepRecord& record) {
  const bool is_first = labels_.empty();
  std::vector<ResultTable> tables;
  ranks_.together([&] {
    if (is_first) tables = tables_of_members(record.members);
    for (ResultTable& table : tables_of_step(record, ranks_.number())) tables.push_back(std::move(table));
  });
  file_.catch_up();
  std::vector<std::uint64_t> places;
  ranks_.on_root([&] {
    if (is_first && bytes_of(tables) >= kLargeStep) file_.use_large_blocks();
    file_.change([&](GuardedFile& content) {
      hdf5::File results(content, hdf5::FileUse::change);
      if (is_first) {
        write_members(results, record.members);
        write_supports(results, record.reactions);
        if (record.acting) write_acting(results, *record.acting);
      }
      write_step(results, record);
      for (const ResultTable& table : tables) {
        const bool integers = table.shape.numbers == TableNumbers::integers;
        places.push_back(
            hdf5::place_dataset(results, table.shape.name, integers, table.shape.rows, table.shape.columns));
      }
      results.close();
    });
  });
  file_.write_tables(tables, std::move(places));
  file_.publish();
}

void ResultFile::close() {
  if (closed_) return;
  closed_ = true;
  ranks_.on_root([&] { finish(); });
}

void ResultFile::finish() {
  file_.remove_copies();
  const SharedResultLock until_the_end = std::move(lock_);
  if (failed_) return;
  if (steps_in_xdmf_ < labels_.size()) write_xdmf();
  file_.sync();
}

void ResultFile::check_consistent(const StepRecord& record) const {
  const std::string prefix = "result file " + path_.string() + ", step " + std::to_string(record.step) + ": ";
  if (record.members.members() == 0) throw ResultFileError(prefix + "no members");
  for (const auto& member : record.members) {
    if (!member.is_complete())
      throw ResultFileError(prefix + "member " + member.name + " has fields of unequal length");
  }
  record.members.for_each_known([&](const SampledMember& member) {
    if (!is_link_name(member.name)) throw ResultFileError(prefix + "'" + member.name + "' cannot name a member");
  });
  if (!has_complete_rows(record)) throw ResultFileError(prefix + "modes, critical points or states of unequal length");
  for (const auto& quantity : record.monitored) {
    if (!is_link_name(quantity.name) || is_own_time_series(quantity.name)) {
      throw ResultFileError(prefix + "'" + quantity.name + "' cannot name a monitored quantity");
    }
    if (quantity.components.empty()) throw ResultFileError(prefix + quantity.name + " has no components");
  }
  if (labels_.empty()) return;
  if (record.step <= previous_.step) throw ResultFileError(prefix + "steps must grow");
  bool same = record.members.members() == member_count_ && record.members.samples() == sample_count_ &&
              record.monitored.size() == previous_.monitored.size();
  for (const SampledMember& member : record.members) same = same && is_known(member, members_);
  same = same && sizes_of(record.monitored) == sizes_of(previous_.monitored);
  if (!same) throw ResultFileError(prefix + "members, samples or monitored quantities differ from the step before");
}

void ResultFile::write_xdmf() {
  const std::size_t members = member_count_, samples = sample_count_;
  const bool durable = false;  // it can be made again from the result file
  const auto write = [&](const TextSink& sink) {
    write_xdmf_text(sink, path_.filename().string(), labels_, members, samples, samples + 2 * members);
  };
  replace_file(xdmf_path_, write, durable);
  steps_in_xdmf_ = labels_.size();
}

void begin_results_library() { const hdf5::QuietScope first_use; }

}  // namespace mixbeam
