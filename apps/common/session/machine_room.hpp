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

/// Large pages for what a run is about to allocate: with small ones a long rod spends a third of its time in page
/// faults on virtual machines. The heap grows by so much address space at once, untouched. For programs, whose heap
/// keeps what is freed; nothing happens where there is less room.
void take_large_pages(double bytes);

/// "1.53 GB", "12.4 MB".
std::string bytes_text(double bytes);

}  // namespace mixbeam
