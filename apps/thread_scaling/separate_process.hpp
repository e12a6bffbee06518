/// Work in a process of its own: what it takes of memory and leaves in caches and heap is its own.
#pragma once

#include <functional>
#include <string>

namespace mixbeam {

/// The text that `work` returns in a copy of this process; what it throws is thrown here as std::runtime_error with its
/// message. The copy has no threads: call it only while this process has started none. Not among several MPI ranks.
std::string in_separate_process(const std::function<std::string()>& work);

// Memory of this process, in bytes; not a number where the system does not tell.
double resident_memory();
double peak_resident_memory();

}  // namespace mixbeam
