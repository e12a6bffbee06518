/// Free memory and disk of the machine. Linux; elsewhere everything counts as unlimited.
#pragma once

#include <filesystem>
#include <string>

namespace mixbeam {

struct Room {
  double bytes = 0.0;
  std::string limit{};  ///< whose it is: "memory of the machine", "address space (ulimit -v)", ...
};

/// The least of MemAvailable, of what is left to every cgroup that this process is in, and of the limits on its address
/// space and data.
Room memory_left();

/// Bytes of this process behind a word of /proc/self/status, as "VmRSS:"; not a number where the system does not tell.
double memory_of_process(const std::string& word);

/// Bytes that may be written to a file in this folder.
double disk_left(const std::filesystem::path& folder);

/// Keeps freed blocks in the heap. Vectors and states of large models come and go in every iteration; by default glibc
/// returns such blocks to the system, and the page faults of getting them back cost as much as the arithmetic.
void keep_freed_memory();

/// Extends the heap by `bytes` of untouched address space with large pages, for what a run is about to allocate, and
/// keeps freed blocks: with small pages a long rod spends a third of its time in page faults on virtual machines.
/// Nothing happens for small runs and where there is less room.
void take_large_pages(double bytes);

/// Work of a library in another program: its end returns to the system what take_large_pages() has kept, and restores
/// the thresholds that glibc arrives at by itself.
struct GuestHeap {
  GuestHeap() = default;
  ~GuestHeap();
  GuestHeap(const GuestHeap&) = delete;
  GuestHeap& operator=(const GuestHeap&) = delete;
};

/// "1.53 GB", "12.4 MB".
std::string bytes_text(double bytes);

}  // namespace mixbeam
