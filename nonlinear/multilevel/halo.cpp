#include "nonlinear/multilevel/halo.hpp"

#include "nonlinear/linear/sparse_matrix.hpp"

#include <algorithm>

namespace mixbeam {

/// Owners are told which of their nodes are ghosts elsewhere.
Halo::Halo(MPI_Comm communicator, int nodes, const std::vector<int>& ghosts)
    : communicator_(communicator), nodes_(nodes) {
  const GatherPlan owners(communicator, nodes);
  const int ranks = static_cast<int>(owners.counts.size());
  std::vector<int> wanted(ranks, 0), asked(ranks), from(ranks + 1, 0), to(ranks + 1, 0);
  for (const int ghost : ghosts) {
    const auto behind = std::upper_bound(owners.offsets.begin(), owners.offsets.end(), ghost);
    ++wanted[behind - owners.offsets.begin() - 1];
  }
  MPI_Alltoall(wanted.data(), 1, MPI_INT, asked.data(), 1, MPI_INT, communicator);
  for (int r = 0; r < ranks; ++r) {
    from[r + 1] = from[r] + wanted[r];
    to[r + 1] = to[r] + asked[r];
  }
  std::vector<int> names(to.back());
  MPI_Alltoallv(ghosts.data(), wanted.data(), from.data(), MPI_INT, names.data(), asked.data(), to.data(), MPI_INT,
                communicator);
  int rank = 0;
  MPI_Comm_rank(communicator, &rank);
  for (int& name : names) name -= owners.offsets[rank];
  sender_ = std::move(names);
  ghost_ = sent_ = {0};
  for (int r = 0; r < ranks; ++r) {
    if (wanted[r] == 0 && asked[r] == 0) continue;
    rank_.push_back(r);
    ghost_.push_back(from[r + 1]);
    sent_.push_back(to[r + 1]);
  }
}

void Halo::renumber(const std::vector<int>& place) {
  for (int& node : sender_) node = place[node];
}

int Halo::first_of(int mine) const {
  int before = 0;
  if (has_several_ranks()) MPI_Exscan(&mine, &before, 1, MPI_INT, MPI_SUM, communicator_);
  int rank = 0;
  MPI_Comm_rank(communicator_, &rank);
  return rank == 0 ? 0 : before;  // MPI leaves that of the first rank as it is
}

double Halo::sum(double here) const {
  if (has_several_ranks()) MPI_Allreduce(MPI_IN_PLACE, &here, 1, MPI_DOUBLE, MPI_SUM, communicator_);
  return here;
}

double Halo::largest(double here) const {
  if (has_several_ranks()) MPI_Allreduce(MPI_IN_PLACE, &here, 1, MPI_DOUBLE, MPI_MAX, communicator_);
  return here;
}

}  // namespace mixbeam
