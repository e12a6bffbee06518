/// Work in a separate process, with its own memory, heap and caches.
#pragma once

#include <functional>
#include <string>

namespace mixbeam {

/// Returns the text of `work`, called in a copy of this process; exceptions are rethrown as std::runtime_error with
/// their message. The copy has no threads: call it before this process starts any, and not with several MPI ranks.
std::string in_separate_process(const std::function<std::string()>& work);

// Memory of this process [bytes]; NaN if unavailable.
double resident_memory();
double peak_resident_memory();

}  // namespace mixbeam
