// The part of NetworkSolver that reads nodes, links and values from the system that chains leave.
#include "nonlinear/multilevel/block_rows.hpp"
#include "nonlinear/multilevel/network_solver.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

using NetworkRange = Kokkos::RangePolicy<ExecutionSpace>;

/// Entries of a block that the links do not explain, relative to the largest one of the row: rounding of sums.
constexpr double kUnexplained = 1e-11;

}  // namespace

/// Nodes are vertices with at least one free row; links join two of them.
void NetworkSolver::number_nodes() {
  const DofMatrix& matrix = *system_.matrix();
  const std::vector<unsigned char> free = free_rows();
  if (maximum_over_ranks(*matrix.getRowMap()->getComm(), free == free_ ? 0.0 : 1.0) == 0.0) return;
  PhaseTimer timer(times_, "multilevel: aggregates");
  free_ = free;
  const int n = BlockRows(matrix).vertices(), columns = static_cast<int>(free_.size()) / kVertexDofs;
  node_.assign(columns, -1);
  int nodes = 0;
  for (int v = 0; v < n; ++v)
    if (has_free_row(v)) node_[v] = nodes++;
  Halo halo = number_ghosts(nodes);
  LinkEnds ends = find_links();
  const bool is_other = hierarchy_ == nullptr || hierarchy_->finest().nodes() != nodes || ends != ends_;
  if (halo.largest(is_other ? 1.0 : 0.0) > 0.0) {
    has_spaces_ = false;
    std::vector<Vector3> places(nodes);
    const Model& model = system_.model();
    const auto vertices = system_.remaining().vertices();
    for (int v = 0; v < n; ++v)
      if (node_[v] >= 0)
        places[node_[v]] = model.mesh().vertex_position[model.structure().local_vertex_to_global[vertices(v)]];
    hierarchy_ = std::make_unique<Hierarchy>(places, ends, std::move(halo));
    ends_ = std::move(ends);
  }
  const std::vector<int>& order = hierarchy_->order();
  std::vector<int> number(nodes);
  for (int k = 0; k < nodes; ++k) number[order[k]] = k;
  vertex_.resize(nodes);
  for (int v = 0; v < n; ++v)
    if (node_[v] >= 0) {
      node_[v] = number[node_[v]];
      vertex_[node_[v]] = v;
    }
  self_ = KernelView<double*>("mixbeam::multilevel::self", static_cast<size_t>(kVertexDofs * kVertexDofs) * nodes);
  for (LevelVector* vector : {&r_, &x_, &z_, &p_, &q_})
    *vector = LevelVector("mixbeam::multilevel::vector",
                          kVertexDofs * (nodes + static_cast<size_t>(hierarchy_->finest().halo().ghosts())));
}

/// (row, then column of other ranks): 1 where an equation couples the unknown with others.
std::vector<unsigned char> NetworkSolver::free_rows() const {
  const DofMatrix& matrix = *system_.matrix();
  const BlockRows rows(matrix);
  DofVector mine(matrix.getRowMap());
  const KernelView<double*> is_free = MixedVector::view_of(mine);
  Kokkos::parallel_for(
      "mixbeam::multilevel::free_rows", NetworkRange(0, rows.vertices()), KOKKOS_LAMBDA(int v) {
        for (int r = 0; r < kVertexDofs; ++r) {
          const double* row = rows.row(v, r);
          is_free(vertex_row(v, r)) = 0.0;
          for (int b = 0; b < rows.blocks(v); ++b)
            for (int c = 0; c < kVertexDofs; ++c)
              if (row[kVertexDofs * b + c] != 0.0 && (rows.neighbour(v, b) != v || c != r))
                is_free(vertex_row(v, r)) = 1.0;
        }
      });
  const DofVector columns = in_columns(matrix, mine);
  const KernelView<const double*> all = MixedVector::view_of(columns);
  return {all.data(), all.data() + all.extent(0)};
}

bool NetworkSolver::has_free_row(int vertex) const {
  const unsigned char* first = &free_[kVertexDofs * vertex];
  return std::any_of(first, first + kVertexDofs, [](auto f) { return f != 0; });
}

/// Places of other ranks' vertices in node_, in the order of their ranks and numbers there.
Halo NetworkSolver::number_ghosts(int nodes) {
  const DofMatrix& matrix = *system_.matrix();
  if (matrix.getRowMap()->getComm()->getSize() == 1) return {};
  const MPI_Comm comm = communicator_of(matrix);
  const int first = Halo(comm, nodes, {}).first_of(nodes);
  DofVector mine(matrix.getRowMap());
  const KernelView<double*> number = MixedVector::view_of(mine);
  const int n = BlockRows(matrix).vertices();
  for (int v = 0; v < n; ++v) number(vertex_row(v, 0)) = first + node_[v];
  const DofVector columns = in_columns(matrix, mine);
  const KernelView<const double*> all = MixedVector::view_of(columns);
  std::vector<std::pair<int, int>> ghosts;  // number among those of all ranks, vertex
  for (int v = n; v < static_cast<int>(node_.size()); ++v)
    if (has_free_row(v)) ghosts.push_back({static_cast<int>(all(vertex_row(v, 0))), v});
  std::sort(ghosts.begin(), ghosts.end());
  std::vector<int> numbers;
  for (const auto& [ghost, v] : ghosts) {
    node_[v] = nodes + static_cast<int>(numbers.size());
    numbers.push_back(ghost);
  }
  return {comm, nodes, numbers};
}

LinkEnds NetworkSolver::find_links() {
  LinkEnds ends;
  link_.clear();
  masked_.clear();
  link_vertices_.clear();
  for (const RemainingLink& link : system_.links()) {
    const int a = system_.remaining().place(link.vertex[0]), b = system_.remaining().place(link.vertex[1]);
    if (node_[a] < 0 || node_[b] < 0 || a == b) continue;
    ends.push_back({node_[a], node_[b]});
    link_.push_back(link.link);
    link_vertices_.push_back({a, b});
    masked_.push_back(0);
    for (int r = 0; r < kVertexDofs; ++r)
      if (free_[kVertexDofs * a + r] == 0 || free_[kVertexDofs * b + r] == 0) masked_.back() = 1;
  }
  return ends;
}

LinkBlocks NetworkSolver::link_blocks(int link, double* room) const {
  constexpr int kBoth = 2 * kVertexDofs;
  const double* matrix = matrices_.full(link_[link], room);
  if (masked_[link] != 0) {
    if (matrix != room) std::copy_n(matrix, kBoth * kBoth, room);
    for (int end = 0; end < 2; ++end)
      for (int r = 0; r < kVertexDofs; ++r)
        if (free_[kVertexDofs * link_vertices_[link][end] + r] == 0)
          for (int c = 0; c < kBoth; ++c)
            room[kBoth * (kVertexDofs * end + r) + c] = room[kBoth * c + kVertexDofs * end + r] = 0.0;
    matrix = room;
  }
  const int second = kBoth * kVertexDofs;
  return {matrix, matrix + second, matrix + second + kVertexDofs, kBoth, kBoth, 1, kBoth};
}

/// Reads the part of the rows that the links do not explain: S on the diagonal, and nothing beside it; false where
/// there is, or S is unsymmetric.
bool NetworkSolver::read_values() {
  matrices_ = system_.link_matrices();
  find_turned_rows();
  const BlockRows rows(*system_.matrix());
  const int n = rows.vertices();
  std::vector<std::vector<std::pair<int, int>>> touching(n);  // link, its end here
  for (size_t l = 0; l < link_.size(); ++l)
    for (int end = 0; end < 2; ++end)
      if (const int v = link_vertices_[l][end]; v < n) touching[v].push_back({static_cast<int>(l), end});
  std::vector<unsigned char> unfit(n, 0);
  Kokkos::parallel_for("mixbeam::multilevel::self", NetworkRange(0, n), [&](int v) {
    if (node_[v] < 0) return;
    const size_t width = rows.width(v);
    std::vector<double> left(rows.row(v, 0), rows.row(v, 0) + kVertexDofs * width);
    double room[4 * kVertexDofs * kVertexDofs], size[kVertexDofs] = {};
    TurnedRows* turned = turned_of_[v] < 0 ? nullptr : &turned_[turned_of_[v]];
    for (int r = 0; r < kVertexDofs; ++r)
      for (size_t c = 0; c < width; ++c) size[r] = std::max(size[r], std::abs(left[width * r + c]));
    const auto slot = [&](int w) {
      int b = 0;
      while (rows.neighbour(v, b) != w) ++b;
      return b;
    };
    const int own = slot(v);
    double stiffness[kVertexDofs] = {};
    for (const auto& [l, end] : touching[v]) {
      const LinkBlocks link = link_blocks(l, room).seen_from(end);
      const int other = slot(link_vertices_[l][1 - end]);
      for (int r = 0; r < kVertexDofs; ++r) {
        stiffness[r] += link.first[link.first_stride * r + r];
        for (int q = 0; q < kVertexDofs; ++q) {
          const double part = turned != nullptr ? turned->projection[r][q] : (q == r ? 1.0 : 0.0);
          if (part == 0.0) continue;
          for (int c = 0; c < kVertexDofs; ++c) {
            left[width * r + kVertexDofs * own + c] -= part * link.first[link.first_stride * c + q];
            left[width * r + kVertexDofs * other + c] -=
                part * link.coupling[link.coupling_row * q + link.coupling_column * c];
          }
        }
      }
    }
    if (turned != nullptr) set_springs(*turned, &free_[kVertexDofs * v], stiffness, width, own, left.data());
    double* self = self_.data() + static_cast<size_t>(kVertexDofs * kVertexDofs) * node_[v];
    for (int r = 0; r < kVertexDofs; ++r)
      for (size_t c = 0; c < width; ++c) {
        const int w = rows.neighbour(v, static_cast<int>(c) / kVertexDofs), k = static_cast<int>(c) % kVertexDofs;
        const bool counts = free_[kVertexDofs * v + r] != 0 && free_[kVertexDofs * w + k] != 0;
        const double value = left[width * r + c];
        if (w == v)
          self[kVertexDofs * k + r] = counts ? value : (k == r ? 1.0 : 0.0);
        else if (counts && !(std::abs(value) <= kUnexplained * size[r]))
          unfit[v] = 1;
      }
    for (int r = 0; r < kVertexDofs; ++r)
      for (int c = 0; c < r; ++c) {
        double &a = self[kVertexDofs * c + r], &b = self[kVertexDofs * r + c];
        if (!(std::abs(a - b) <= kUnexplained * std::max(size[r], size[c]))) unfit[v] = 1;
        a = b = 0.5 * (a + b);
      }
  });
  const bool is_unfit = !turned_.empty() || std::find(unfit.begin(), unfit.end(), 1) != unfit.end();
  return hierarchy_->finest().halo().largest(is_unfit ? 1.0 : 0.0) == 0.0;
}

}  // namespace mixbeam
