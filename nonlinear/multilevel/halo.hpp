/// Nodes of other ranks that the nodes of one are linked with.
#pragma once

#include <mpi.h>

#include <vector>

namespace mixbeam {

/// Nodes here are numbered first, then those of others, ghosts, rank by rank. All functions but renumber() are
/// collective where there are several ranks.
class Halo {
 public:
  /// Halo of one rank, which has all nodes.
  Halo() = default;
  /// `ghosts`: their numbers among the nodes of all ranks, ascending. Those of a rank are numbered behind those of the
  /// rank before it.
  Halo(MPI_Comm communicator, int nodes, const std::vector<int>& ghosts);

  bool has_several_ranks() const { return communicator_ != MPI_COMM_SELF; }
  MPI_Comm communicator() const { return communicator_; }
  int ghosts() const { return ghost_.empty() ? 0 : ghost_.back(); }
  /// (node): its new number; ghosts keep theirs here.
  void renumber(const std::vector<int>& place);

  /// Copies the numbers of ghosts from their owners. `start`: (node, ghosts behind them, and one more): where those of
  /// a node begin.
  template <class Number, class Start>
  void exchange(Number* data, const Start& start) const;
  /// First number among those of all ranks, where those of the rank before have `mine` as well.
  int first_of(int mine) const;
  double sum(double here) const;
  double largest(double here) const;

 private:
  MPI_Comm communicator_ = MPI_COMM_SELF;
  int nodes_ = 0;
  std::vector<int> rank_;    ///< (neighbour)
  std::vector<int> ghost_;   ///< (neighbour, and one more): first ghost that it owns
  std::vector<int> sent_;    ///< (neighbour, and one more): first of the nodes that it gets
  std::vector<int> sender_;  ///< the nodes
};

namespace halo {
inline MPI_Datatype type_of(const int*) { return MPI_INT; }
inline MPI_Datatype type_of(const double*) { return MPI_DOUBLE; }
}  // namespace halo

template <class Number, class Start>
void Halo::exchange(Number* data, const Start& start) const {
  if (!has_several_ranks()) return;
  const int neighbours = static_cast<int>(rank_.size());
  const MPI_Datatype type = halo::type_of(data);
  std::vector<MPI_Request> requests(2 * rank_.size());
  std::vector<std::vector<Number>> sent(rank_.size());
  for (int n = 0; n < neighbours; ++n) {
    const auto begin = start[nodes_ + ghost_[n]], end = start[nodes_ + ghost_[n + 1]];
    MPI_Irecv(data + begin, static_cast<int>(end - begin), type, rank_[n], 0, communicator_, &requests[2 * n]);
    for (int s = sent_[n]; s < sent_[n + 1]; ++s)
      sent[n].insert(sent[n].end(), data + start[sender_[s]], data + start[sender_[s] + 1]);
    MPI_Isend(sent[n].data(), static_cast<int>(sent[n].size()), type, rank_[n], 0, communicator_, &requests[2 * n + 1]);
  }
  MPI_Waitall(2 * neighbours, requests.data(), MPI_STATUSES_IGNORE);
}

}  // namespace mixbeam
