/// Ranks that work on a structure together.
#pragma once

#include <Teuchos_Comm.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_RCP.hpp>

#include <vector>

namespace mixbeam {

using Communicator = Teuchos::RCP<const Teuchos::Comm<int>>;

/// Sums the contributions of all ranks.
inline void sum_over_ranks(const Teuchos::Comm<int>& comm, double* numbers, size_t count) {
  if (comm.getSize() == 1) return;
  const std::vector<double> mine(numbers, numbers + count);
  Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, static_cast<int>(count), mine.data(), numbers);
}
inline double sum_over_ranks(const Teuchos::Comm<int>& comm, double mine) {
  sum_over_ranks(comm, &mine, 1);
  return mine;
}

}  // namespace mixbeam
