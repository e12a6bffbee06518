#include "apps/common/session/machine_room.hpp"

#include "apps/common/tables/formatted.hpp"
#include "nonlinear/linear/blas_setup.hpp"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// The number after a word that begins a line of a file; none if file or word is missing.
std::optional<double> number_behind(const fs::path& file, const std::string& word) {
  std::ifstream stream(file);
  std::string first;
  double number = 0.0;
  for (std::string line; std::getline(stream, line);)
    if (std::istringstream text(line); text >> first && first == word && text >> number) return number;
  return std::nullopt;
}

/// The only number of a file; none if it says "max".
std::optional<double> number_in(const fs::path& file) {
  std::ifstream stream(file);
  double number = 0.0;
  if (stream >> number) return number;
  return std::nullopt;
}

void lower(Room& room, double bytes, const std::string& limit) {
  if (bytes < room.bytes) room = {bytes, limit};
}

/// File names of the two versions of cgroups.
struct CgroupFiles {
  const char *root, *most, *used, *inactive;
};
constexpr CgroupFiles kVersion1{"/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes",
                                "total_inactive_file"};
constexpr CgroupFiles kVersion2{"/sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"};

/// Applies the limits of a cgroup and its ancestors. Inactive file pages count as free: the system reclaims them.
void lower_by_cgroups(Room& room, const CgroupFiles& files, fs::path group) {
  for (;; group = group.parent_path()) {
    const fs::path folder = files.root + (group == "/" ? "" : group.string());
    const std::optional<double> most = number_in(folder / files.most), used = number_in(folder / files.used);
    if (most && used)
      lower(room, *most - *used + number_behind(folder / "memory.stat", files.inactive).value_or(0.0),
            "left to the cgroup " + group.string());
    if (group == group.parent_path()) return;
  }
}

void lower_by_cgroups(Room& room) {
  std::ifstream stream("/proc/self/cgroup");  // lines "4:memory:/path" of version 1, "0::/path" of version 2
  for (std::string line; std::getline(stream, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), group = line.substr(second + 1);
    if (group.empty() || group[0] != '/') continue;
    if (controllers.empty()) lower_by_cgroups(room, kVersion2, group);
    if ((',' + controllers + ',').find(",memory,") != std::string::npos) lower_by_cgroups(room, kVersion1, group);
  }
}

/// Index of a number in /proc/self/statm, in pages.
enum Statm { kAddressSpace = 0, kData = 5 };

void lower_by_limit(Room& room, decltype(RLIMIT_AS) resource, Statm place, const std::string& name) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  std::ifstream statm("/proc/self/statm");
  double pages = 0.0;
  for (int i = 0; i <= place; ++i) statm >> pages;
  const double buffer = blas_room_to_come();  // address space counts in full, memory when touched
  lower(room, static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(sysconf(_SC_PAGESIZE)) - buffer,
        name + (buffer > 0.0 ? ", less " + bytes_text(buffer) + " for the buffer of OpenBLAS" : ""));
}

}  // namespace

Room memory_left() {
  Room room{kUnlimited, "no limit"};
  if (const auto kilobytes = number_behind("/proc/meminfo", "MemAvailable:"))
    lower(room, 1024.0 * *kilobytes, "memory of the machine");
  lower_by_cgroups(room);
  lower_by_limit(room, RLIMIT_AS, kAddressSpace, "limit of the address space, ulimit -v");
  lower_by_limit(room, RLIMIT_DATA, kData, "limit of the data, ulimit -d");
  if (room.bytes < 0.0) room.bytes = 0.0;
  return room;
}

double memory_of_process(const std::string& word) {
  return 1024.0 * number_behind("/proc/self/status", word).value_or(std::numeric_limits<double>::quiet_NaN());
}

double disk_left(const fs::path& folder) {
  struct statvfs disk {};
  if (statvfs(folder.empty() ? "." : folder.c_str(), &disk) != 0) return kUnlimited;
  return static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
}

std::string bytes_text(double bytes) {
  constexpr std::array<const char*, 5> kUnits = {"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  for (; unit + 1 < kUnits.size() && bytes >= 999.5; bytes /= 1000.0) ++unit;
  return formatted("%.3g %s", bytes, kUnits[unit]);
}

#ifdef __GLIBC__
namespace {
bool has_large_pages = false;
}  // namespace
#endif

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kNever = 2'000'000'000;
  mallopt(M_MMAP_THRESHOLD, kNever);
  mallopt(M_TRIM_THRESHOLD, kNever);
#endif
}

GuestHeap::~GuestHeap() {
#ifdef __GLIBC__
  constexpr int kLargestOfGlibc = 32 << 20;  // DEFAULT_MMAP_THRESHOLD_MAX, and twice as much is trimmed
  if (!std::exchange(has_large_pages, false)) return;
  mallopt(M_MMAP_THRESHOLD, kLargestOfGlibc);
  mallopt(M_TRIM_THRESHOLD, 2 * kLargestOfGlibc);
  malloc_trim(0);
#endif
}

void take_large_pages(double bytes) {
#ifdef __GLIBC__
  constexpr double kWorthwhile = 3e7;
  constexpr std::uintptr_t kPage = std::uintptr_t{1} << 21;
  if (!(bytes >= kWorthwhile && bytes <= memory_left().bytes)) return;
  keep_freed_memory();
  has_large_pages = true;
  void* const block = std::malloc(static_cast<std::size_t>(bytes));
  const auto address = reinterpret_cast<std::uintptr_t>(block);
  const std::uintptr_t begin = (address + kPage - 1) / kPage * kPage;
  if (block != nullptr)
    madvise(reinterpret_cast<void*>(begin), address + static_cast<std::size_t>(bytes) - begin, MADV_HUGEPAGE);
  std::free(block);
#endif
}

}  // namespace mixbeam
