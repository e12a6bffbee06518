/// Result files are verified in another process before this one reads them.
#pragma once

#include <filesystem>
#include <optional>

namespace mixbeam {

/// Runs `mixbeam verify` on a result file, up to a step where one is given, so that a file on which the HDF5 library
/// crashes ends that process and not this one. Throws InputError, which says what is damaged. For programs that have
/// not started MPI or threads yet; of several ranks the first does it.
void require_whole(const std::filesystem::path& results, std::optional<int> last_step = {});

/// Whether this is the only process or the first rank, also before MPI starts.
bool is_first_process();

}  // namespace mixbeam
