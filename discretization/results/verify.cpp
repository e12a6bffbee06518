#include "discretization/results/records.hpp"
#include "discretization/results/stored_run.hpp"
#include "discretization/text/errors.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <set>

#include <unistd.h>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostNames = 6;  // of damaged objects in a message

/// Damaged bytes from `first` to `end`.
struct Damage {
  std::uint64_t first = 0, end = 0;
};

std::vector<Damage> damages(const SealedFile& file) {
  std::vector<Damage> found;
  const Seal& seal = file.seal();
  std::vector<std::byte> buffer(seal.block);
  for (std::uint64_t i = 0; i < seal.blocks(); ++i) {
    read_block(file.disk(), seal, i, buffer.data());
    if (seal.holds(i, buffer.data())) continue;
    const std::uint64_t first = i * seal.block, end = first + seal.bytes_of(i);
    if (!found.empty() && found.back().end == first)
      found.back().end = end;
    else
      found.push_back({first, end});
  }
  return found;
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t place) {
  Number number{};
  std::memcpy(&number, bytes.data() + place, sizeof number);
  return number;
}

/// The header of a dataset as it lies in the file. Knows the versions of HDF5's structures that this program writes:
/// superblock 0, headers 1 in one piece, layouts 3, numbers in little endian.
struct RawHeader {
  std::string bytes{};
  std::size_t place = 0;  ///< in `bytes`, of the address and the size of values that lie in one piece; 0: not known

  bool differs_in_address_alone(const RawHeader& other) const {
    return place == other.place && bytes.size() == other.bytes.size() &&
           bytes.compare(0, place, other.bytes, 0, place) == 0 &&
           bytes.compare(place + 8, std::string::npos, other.bytes, place + 8) == 0;
  }
  std::uint64_t first() const { return number_at<std::uint64_t>(bytes, place); }
  std::uint64_t count() const { return number_at<std::uint64_t>(bytes, place + 8); }
};

/// Bytes at an address; empty if the file ends before, or is damaged there.
std::string bytes_at(GuardedFile& file, std::uint64_t address, std::size_t count) {
  if (address > file.size() || count > file.size() - address) return {};
  std::string bytes(count, '\0');
  try {
    file.read(address, bytes.data(), count);
  } catch (const DamageError&) {
    return {};
  }
  return bytes;
}

RawHeader raw_header(GuardedFile& file, std::uint64_t address) {
  constexpr std::uint32_t kPrefix = 16, kMostBytes = 4096;
  constexpr std::uint16_t kLayout = 8, kContinuation = 16, kContiguousOfVersion3 = 0x0103;
  RawHeader header{bytes_at(file, address, kPrefix)};
  if (header.bytes.empty() || header.bytes[0] != 1) return {};
  const auto size = number_at<std::uint32_t>(header.bytes, 8);
  header.bytes = size > kMostBytes ? "" : bytes_at(file, address, kPrefix + size);
  for (std::size_t message = kPrefix; message + 8 <= header.bytes.size();) {
    const auto kind = number_at<std::uint16_t>(header.bytes, message);
    const std::size_t body = message + 8, next = body + number_at<std::uint16_t>(header.bytes, message + 2);
    if (kind == kContinuation || next > header.bytes.size()) return {};
    if (kind == kLayout && next >= body + 18 && number_at<std::uint16_t>(header.bytes, body) == kContiguousOfVersion3)
      header.place = body + 2;
    message = next;
  }
  return header;
}

/// Whether addresses in a file have eight bytes and count from its beginning.
bool has_plain_addresses(GuardedFile& file) {
  const std::string superblock = bytes_at(file, 0, 32);
  return superblock.size() == 32 && superblock.compare(0, 9, std::string("\x89HDF\r\n\x1a\n\0", 9)) == 0 &&
         number_at<std::uint16_t>(superblock, 13) == 0x0808 && number_at<std::uint64_t>(superblock, 24) == 0;
}

/// Visits every object of a file once.
class Walk {
 public:
  /// Walks through a sealed file: numbers that lie in one piece are known to be those that were written, and are not
  /// read again.
  Walk(const std::vector<Damage>& damages, SealedFile& file)
      : damages_(damages), file_(file), has_plain_addresses_(has_plain_addresses(file.content())) {}

  void visit_all(hid_t group, const std::string& path = "") {
    attempt(path.empty() ? "/" : path, [&] {
      hdf5::read_attributes(group);
      for (const hdf5::ObjectLink& child : hdf5::links_of(group))
        attempt(path + "/" + child.name, [&] { visit(group, child, path + "/" + child.name); });
    });
  }
  /// Notes an error that an object causes.
  template <class Action>
  void attempt(const std::string& path, const Action& action) {
    try {
      action();
    } catch (const hdf5::Error& error) {
      damaged_.push_back(path);
      if (reason_.empty()) reason_ = error.what();
    }
  }

  const std::vector<std::string>& damaged() const { return damaged_; }
  const std::string& first_reason() const { return reason_; }

 private:
  void visit(hid_t parent, const hdf5::ObjectLink& link, const std::string& path) {
    if (!visited_.insert(link.address).second) throw hdf5::Error("it is in another place of the file too");
    constexpr std::ptrdiff_t kMostSlashes = 8;  // more than results have, and no more than a copy follows
    if (std::count(path.begin(), path.end(), '/') > kMostSlashes) throw hdf5::Error("it lies deeper than results do");
    // Opening a dataset takes the library a hundred times as long as comparing it with one that has been opened.
    const RawHeader header = has_plain_addresses_ ? raw_header(file_.content(), link.address) : RawHeader{};
    for (const RawHeader& known : known_)
      if (header.differs_in_address_alone(known)) return require_undamaged(header.first(), header.count());
    hdf5::Handle object = hdf5::open_object(parent, link.name);
    if (hdf5::is_group(object)) return visit_all(object, path);
    const hdf5::StoredValues dataset = hdf5::values_of(std::move(object), link.name, hdf5::Stored::anything);
    const auto [first, bytes] = hdf5::data_place(dataset);
    if (first == 0 || !file_.is_sealed()) return hdf5::read_all(dataset, link.name);
    constexpr std::size_t kMostKnown = 64;  // results have some twenty kinds of datasets
    if (header.place != 0 && known_.size() < kMostKnown) known_.push_back(header);
    require_undamaged(first, bytes);
  }
  void require_undamaged(std::uint64_t first, std::uint64_t bytes) const {
    if (first > file_.content().size() || bytes > file_.content().size() - first)
      throw hdf5::Error("it lies beyond the end of the file");
    for (const Damage& damage : damages_)
      if (damage.first < first + bytes && first < damage.end)
        throw hdf5::Error(text_of_damage(damage.first, damage.end));
  }

  const std::vector<Damage>& damages_;
  SealedFile& file_;
  bool has_plain_addresses_;
  std::vector<RawHeader> known_;  ///< of datasets that are as declared
  std::set<std::uint64_t> visited_;
  std::vector<std::string> damaged_;
  std::string reason_;
};

/// Reads what resuming reads: undamaged bytes may still not make a run.
void read_run(hid_t file, const std::vector<std::string>& groups, Walk& walk) {
  walk.attempt("/", [&] { read_header(file); });
  walk.attempt("/members", [&] {
    if (!groups.empty()) read_members(file);
  });
  walk.attempt("/monitor", [&] { read_monitor(file); });
  const auto steps = hdf5::open_group(file, "steps");
  for (const std::string& name : groups)
    walk.attempt("/steps/" + name, [&] {
      const auto step = hdf5::open_group(steps, name);
      if (!hdf5::has_link(step, "state")) return;  // of a study, which is not resumed
      read_point(step, name);
      read_stability(step);
      read_jump(step);
      read_state(step);
      read_critical_points(step);
    });
}

bool begins_with(const std::string& text, const std::string& begin) { return text.rfind(begin, 0) == 0; }

/// Whether it is a time series, which resuming makes anew from the steps.
bool is_made_anew(const std::string& path) { return path == "/monitor" || begins_with(path, "/monitor/"); }

/// A step is whole if it, all steps before it, and all that does not belong to a step are undamaged.
std::optional<int> last_whole_step(const std::vector<std::string>& groups, const std::vector<std::string>& damaged) {
  for (const std::string& path : damaged)
    if (!begins_with(path, "/steps/") && !is_made_anew(path)) return {};
  std::optional<int> last;
  for (const std::string& group : groups) {
    const std::string path = "/steps/" + group;
    const auto belongs = [&](const std::string& other) { return other == path || begins_with(other, path + "/"); };
    if (std::any_of(damaged.begin(), damaged.end(), belongs)) return last;
    last = std::atoi(group.c_str());
  }
  return last;
}

std::string text_of_all(const std::vector<Damage>& found, const std::vector<std::string>& damaged) {
  std::string text;
  if (!found.empty()) {
    text = text_of_damage(found.front().first, found.front().end);
    if (found.size() > 1) text += " (and " + std::to_string(found.size() - 1) + " more places)";
    text += damaged.empty() ? "; no object lies in them" : "; in them ";
  }
  for (std::size_t i = 0; i < std::min(kMostNames, damaged.size()); ++i) text += (i == 0 ? "" : ", ") + damaged[i];
  if (damaged.size() > kMostNames) text += " and " + std::to_string(damaged.size() - kMostNames) + " more objects";
  return text;
}

/// Copies a file as resuming does, and discards the copy: in files without seal, copying finds damage that reading each
/// object does not.
void rehearse_copy(hid_t source) {
  std::error_code error;
  std::string name = (fs::temp_directory_path(error) / "mixbeam_verify_XXXXXX").string();
  const int placeholder = error ? -1 : ::mkstemp(name.data());
  if (placeholder < 0) return;  // no place for a rehearsal
  ::close(placeholder);
  DiskFile file(name, DiskAccess::create);
  ::unlink(name.c_str());  // it disappears with this process, however that ends
  Seal seal;
  seal.block = kLargeBlock;
  GuardedFile content(file, seal);
  hdf5::File target(content, hdf5::FileUse::create);
  copy_steps(source, target, step_groups(source).size(), read_monitor(source));
  try {
    target.close();
  } catch (const DiskError&) {  // no room for it is no fault of the file
  }
}

/// Examines with the library a file whose bytes have been checked.
void look_inside(SealedFile& file, const fs::path& path, const std::vector<Damage>& found, FileReport& report) {
  Walk walk(found, file);
  std::vector<std::string> groups;
  try {
    const hdf5::File results(file.content(), hdf5::FileUse::read);
    const bool is_table = file.is_sealed() && !holds_run(results);
    if (!is_table) require_known_format(results, path.string(), file.is_sealed());
    walk.visit_all(results);
    if (!is_table) groups = step_groups(results);
    if (!is_table && walk.damaged().empty()) read_run(results, groups, walk);
    if (!file.is_sealed() && walk.damaged().empty()) rehearse_copy(results);
  } catch (const hdf5::Error& error) {
    const std::string structure = "the structure of the file";
    if (!found.empty())
      report.damage = text_of_all(found, {structure});
    else
      report.damage =
          structure + (file.is_sealed() ? ": " : ", whose end with the checksums is missing: ") + error.what();
    return;
  }
  for (const std::string& group : groups) report.steps.push_back(std::atoi(group.c_str()));
  report.last_whole_step = last_whole_step(groups, walk.damaged());
  if (!found.empty())
    report.damage = text_of_all(found, walk.damaged());
  else if (!walk.damaged().empty())
    report.damage = text_of_all({}, walk.damaged()) + ": " + walk.first_reason();
}

}  // namespace

FileReport verify_results(const fs::path& path) {
  require_result_file(path);
  const hdf5::QuietScope quiet;
  FileReport report;
  try {
    SealedFile file(path);
    report.is_sealed = file.is_sealed();
    const std::vector<Damage> found = file.is_sealed() ? damages(file) : std::vector<Damage>{};
    look_inside(file, path, found, report);
  } catch (const DamageError& error) {
    report.damage = error.what();
  } catch (const DiskError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
  return report;
}

}  // namespace mixbeam
