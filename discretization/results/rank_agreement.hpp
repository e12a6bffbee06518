/// Ranks that succeed or fail together.
#pragma once

#include "discretization/mesh/communicator.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <utility>

namespace mixbeam {

/// Communicator for the work of a single process, with or without MPI.
Communicator one_rank();

/// Runs `action` on every rank. Empty if it threw nowhere; otherwise, on every rank, the message of the first rank on
/// which it failed, with the number of that rank unless it is 0. So no rank waits for one that meets a full disk.
/// `action` must not communicate. Collective.
std::string first_problem(const Teuchos::Comm<int>& communicator, const std::function<void()>& action);

/// Number of a rank, and of ranks.
struct RankNumber {
  int rank = 0, ranks = 1;
};

/// The ranks that write one file of results. An error on one of them throws the same ResultFileError, with the name of
/// the file, on all. All functions are collective.
class FileRanks {
 public:
  FileRanks(Communicator communicator, const std::filesystem::path& file)
      : communicator_(std::move(communicator)), prefix_("result file " + file.string() + ": ") {}

  const Teuchos::Comm<int>& communicator() const { return *communicator_; }
  RankNumber number() const { return {communicator_->getRank(), communicator_->getSize()}; }
  bool is_root() const { return number().rank == 0; }
  const std::string& prefix() const { return prefix_; }

  /// Every rank runs `action`, which must not communicate.
  void together(const std::function<void()>& action) const;
  void on_root(const std::function<void()>& action) const;

 private:
  Communicator communicator_;
  std::string prefix_;
};

}  // namespace mixbeam
