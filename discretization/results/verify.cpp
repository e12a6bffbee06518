#include "discretization/results/records.hpp"
#include "discretization/results/stored_run.hpp"
#include "discretization/text/errors.hpp"

#include <algorithm>
#include <cstdlib>
#include <set>

#include <unistd.h>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostNames = 6;  // of damaged objects in a message

/// Bytes from `first` to `end` are not what was written.
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

/// Looks at every object of a file, once.
class Walk {
 public:
  /// `is_sealed`: numbers that lie in one piece are known to be those that were written, and are not read again.
  Walk(const std::vector<Damage>& damages, bool is_sealed) : damages_(damages), is_sealed_(is_sealed) {}

  void visit_all(hid_t group, const std::string& path = "") {
    attempt(path.empty() ? "/" : path, [&] {
      hdf5::read_attributes(group);
      for (const hdf5::ObjectLink& child : hdf5::links_of(group))
        attempt(path + "/" + child.name, [&] { visit(group, child, path + "/" + child.name); });
    });
  }
  /// Notes what goes wrong with an object.
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
    constexpr std::ptrdiff_t kMostSlashes = 8;  // more than results have, and no more than a copy goes down
    if (std::count(path.begin(), path.end(), '/') > kMostSlashes) throw hdf5::Error("it lies deeper than results do");
    hdf5::Handle object = hdf5::open_object(parent, link.name);
    if (hdf5::is_group(object)) return visit_all(object, path);
    const hdf5::StoredValues dataset = hdf5::values_of(std::move(object), link.name, hdf5::Stored::anything);
    const auto [first, bytes] = hdf5::data_place(dataset);
    if (first == 0 || !is_sealed_) return hdf5::read_all(dataset, link.name);
    for (const Damage& damage : damages_)
      if (damage.first < first + bytes && first < damage.end)
        throw hdf5::Error(text_of_damage(damage.first, damage.end));
  }

  const std::vector<Damage>& damages_;
  bool is_sealed_;
  std::set<std::uint64_t> visited_;
  std::vector<std::string> damaged_;
  std::string reason_;
};

/// Reads what resuming reads: bytes may be those that were written, and yet make no run.
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

/// Time series are made anew from the steps.
bool is_made_anew(const std::string& path) { return path == "/monitor" || begins_with(path, "/monitor/"); }

/// A step is whole if it is and all that do not belong to a step are, and those before it.
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

/// Copies a file as resuming does, to nowhere: for files without seal, of which reading each object tells less than the
/// library meets when it copies them.
void rehearse_copy(hid_t source) {
  std::string name = (fs::temp_directory_path() / "mixbeam_verify_XXXXXX").string();
  const int placeholder = ::mkstemp(name.data());
  if (placeholder < 0) return;  // no place for a rehearsal
  ::close(placeholder);
  DiskFile file(name, DiskAccess::create);
  ::unlink(name.c_str());  // it goes away with this process, however that ends
  Seal seal;
  seal.block = kLargeBlock;
  GuardedFile content(file, seal);
  hdf5::File target(content, hdf5::FileUse::create);
  copy_steps(source, target, step_groups(source).size(), read_monitor(source));
  try {
    target.close();
  } catch (const DiskError&) {  // no room for it: no fault of the file
  }
}

/// What the library can tell of a file whose bytes have been checked.
void look_inside(SealedFile& file, const fs::path& path, const std::vector<Damage>& found, FileReport& report) {
  Walk walk(found, file.is_sealed());
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
