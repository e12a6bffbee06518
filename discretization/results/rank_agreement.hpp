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

/// Runs `action` on every rank. Empty when it threw nothing anywhere; otherwise, on every rank, what the first rank on
/// which it failed has to say, with the number of that rank where it is not 0. So a rank that meets a full disk leaves
/// none waiting. `action` must not communicate. Collective.
std::string first_problem(const Teuchos::Comm<int>& communicator, const std::function<void()>& action);

/// Which of how many ranks.
struct RankNumber {
  int rank = 0, ranks = 1;
};

/// The ranks that work on one file of results. An error on one of them throws the same ResultFileError, with the name
/// of the file, on all. Collective, all of it.
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
