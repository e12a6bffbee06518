/// Free memory and disk of the machine. Linux; elsewhere everything counts as unlimited.
#pragma once

#include <filesystem>
#include <string>

namespace mixbeam {

struct Room {
  double bytes = 0.0;
  std::string limit{};  ///< the binding limit: "memory of the machine", "limit of the data, ulimit -d", ...
};

/// Free memory: the minimum of MemAvailable and of what the cgroups of this process and its limits on address space and
/// data leave.
Room memory_left();

/// Bytes after a word of /proc/self/status, such as "VmRSS:"; NaN if unavailable.
double memory_of_process(const std::string& word);

/// Free bytes of the file system of this folder.
double disk_left(const std::filesystem::path& folder);

/// Keeps freed blocks in the heap. Large vectors and states are allocated in every iteration; by default glibc returns
/// them to the system, and the page faults cost as much as the arithmetic.
void keep_freed_memory();

/// Requests large pages for the coming allocations of a run: with small pages, a long rod spends a third of its time in
/// page faults on virtual machines. Extends the heap by `bytes` of untouched address space, and keeps freed blocks from
/// then on. Does nothing for small runs or if less memory is free.
void take_large_pages(double bytes);

/// Scope of a run of a library in another program. Its end returns the memory that take_large_pages() has kept, and
/// restores the thresholds that glibc reaches by itself.
struct GuestHeap {
  GuestHeap() = default;
  ~GuestHeap();
  GuestHeap(const GuestHeap&) = delete;
  GuestHeap& operator=(const GuestHeap&) = delete;
};

/// "1.53 GB", "12.4 MB".
std::string bytes_text(double bytes);

}  // namespace mixbeam
