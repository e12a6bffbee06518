#include "discretization/results/rank_agreement.hpp"

#include "discretization/results/disk_file.hpp"
#include "discretization/results/hdf5_writer.hpp"
#include "discretization/text/errors.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultSerialComm.hpp>

#include <exception>

namespace mixbeam {

Communicator one_rank() { return Teuchos::rcp(new Teuchos::SerialComm<int>()); }

std::string first_problem(const Teuchos::Comm<int>& communicator, const std::function<void()>& action) {
  const int rank = communicator.getRank(), ranks = communicator.getSize();
  std::string problem;
  bool failed = false;
  try {
    action();
  } catch (const std::exception& error) {
    failed = true;
    problem = reason_of(error);
    if (problem.empty()) problem = "no reason given";
  }
  if (ranks == 1) return problem;
  const int mine = failed ? rank : ranks;
  int first = ranks;
  Teuchos::reduceAll(communicator, Teuchos::REDUCE_MIN, 1, &mine, &first);
  if (first == ranks) return "";
  int size = static_cast<int>(problem.size());
  Teuchos::broadcast(communicator, first, &size);
  problem.resize(static_cast<std::size_t>(size));
  Teuchos::broadcast(communicator, first, size, problem.data());
  return first == 0 ? problem : problem + " (rank " + std::to_string(first) + ")";
}

void FileRanks::together(const std::function<void()>& action) const {
  const std::string problem = first_problem(*communicator_, [&] {
    const hdf5::QuietScope quiet;
    try {
      action();
    } catch (const ResultFileError&) {
      throw;
    } catch (const std::exception& error) {
      throw ResultFileError(prefix_ + reason_of(error));
    }
  });
  if (!problem.empty()) throw ResultFileError(problem);
}

void FileRanks::on_root(const std::function<void()>& action) const {
  together([&] {
    if (is_root()) action();
  });
}

}  // namespace mixbeam
