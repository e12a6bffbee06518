/// One writer: two runs that would write the same file exclude each other.
#pragma once

#include "discretization/mesh/communicator.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace mixbeam {

/// The right to write one file of results and the files beside it under its name. Held by a lock of the kernel on a
/// hidden file, so that it ends with the process that holds it, however that ends.
class ResultLock {
 public:
  /// Throws ResultFileError, which names the file and the other process, when another run holds it, be it in this
  /// process. The folder must exist.
  explicit ResultLock(const std::filesystem::path& file);
  /// For a process that writes on behalf of the one that holds the lock.
  ResultLock() = default;
  /// Removes the hidden file.
  ~ResultLock();
  ResultLock(const ResultLock&) = delete;
  ResultLock& operator=(const ResultLock&) = delete;

  /// Why the file is not protected, for file systems without locks; else empty.
  const std::string& warning() const { return warning_; }

 private:
  std::filesystem::path path_;  ///< of the hidden file
  int descriptor_ = -1;
  std::string warning_{};
};

using SharedResultLock = std::shared_ptr<const ResultLock>;

/// Takes the lock on rank 0 only; throws the same on every rank. Collective.
SharedResultLock lock_result(const std::filesystem::path& file, const Teuchos::Comm<int>& communicator);

}  // namespace mixbeam
