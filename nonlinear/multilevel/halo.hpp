/// Ghosts: nodes of other ranks that are linked with nodes of this one.
#pragma once

#include "nonlinear/linear/sparse_matrix.hpp"

#include <mpi.h>

#include <algorithm>
#include <vector>

namespace mixbeam {

/// Local nodes are numbered first, then the ghosts, rank by rank. All functions but renumber() are collective if there
/// are several ranks.
class Halo {
 public:
  /// Halo of one rank, which has all nodes.
  Halo() = default;
  /// `ghosts`: their global numbers, ascending; global numbers follow the order of ranks. Informs owners which of their
  /// nodes are ghosts elsewhere.
  Halo(MPI_Comm communicator, int nodes, const std::vector<int>& ghosts) : communicator_(communicator), nodes_(nodes) {
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

  bool has_several_ranks() const { return communicator_ != MPI_COMM_SELF; }
  MPI_Comm communicator() const { return communicator_; }
  int ghosts() const { return ghost_.empty() ? 0 : ghost_.back(); }
  /// Renumbers local nodes; ghosts keep their numbers. `place`: (node) new number.
  void renumber(const std::vector<int>& place) {
    for (int& node : sender_) node = place[node];
  }

  /// Copies the values of ghosts from their owners. `start`: (nodes, then ghosts, and one more) first value of each.
  template <class Number, class Start>
  void exchange(Number* data, const Start& start) const {
    if (!has_several_ranks()) return;
    const int neighbours = static_cast<int>(rank_.size());
    const MPI_Datatype type = type_of(data);
    std::vector<MPI_Request> requests(2 * rank_.size());
    std::vector<std::vector<Number>> sent(rank_.size());
    for (int n = 0; n < neighbours; ++n) {
      const auto begin = start[nodes_ + ghost_[n]], end = start[nodes_ + ghost_[n + 1]];
      MPI_Irecv(data + begin, static_cast<int>(end - begin), type, rank_[n], 0, communicator_, &requests[2 * n]);
      for (int s = sent_[n]; s < sent_[n + 1]; ++s)
        sent[n].insert(sent[n].end(), data + start[sender_[s]], data + start[sender_[s] + 1]);
      MPI_Isend(sent[n].data(), static_cast<int>(sent[n].size()), type, rank_[n], 0, communicator_,
                &requests[2 * n + 1]);
    }
    MPI_Waitall(2 * neighbours, requests.data(), MPI_STATUSES_IGNORE);
  }

  /// Exclusive sum of `mine` over the ranks before this one: the first global number here.
  int first_of(int mine) const {
    int before = 0;
    if (has_several_ranks()) MPI_Exscan(&mine, &before, 1, MPI_INT, MPI_SUM, communicator_);
    int rank = 0;
    MPI_Comm_rank(communicator_, &rank);
    return rank == 0 ? 0 : before;  // MPI_Exscan leaves it undefined on rank 0
  }

  double sum(double here) const {
    if (has_several_ranks()) MPI_Allreduce(MPI_IN_PLACE, &here, 1, MPI_DOUBLE, MPI_SUM, communicator_);
    return here;
  }

  double largest(double here) const {
    if (has_several_ranks()) MPI_Allreduce(MPI_IN_PLACE, &here, 1, MPI_DOUBLE, MPI_MAX, communicator_);
    return here;
  }

 private:
  static MPI_Datatype type_of(const int*) { return MPI_INT; }
  static MPI_Datatype type_of(const double*) { return MPI_DOUBLE; }

  MPI_Comm communicator_ = MPI_COMM_SELF;
  int nodes_ = 0;
  std::vector<int> rank_;    ///< (neighbour)
  std::vector<int> ghost_;   ///< (neighbour, and one more): first ghost that it owns
  std::vector<int> sent_;    ///< (neighbour, and one more): first entry of sender_ for it
  std::vector<int> sender_;  ///< local nodes whose values are sent
};

}  // namespace mixbeam
