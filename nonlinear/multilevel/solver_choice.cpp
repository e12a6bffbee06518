// Chooses between direct and iterative: the size of a network's factors decides.
#include "nonlinear/multilevel/block_rows.hpp"
#include "nonlinear/multilevel/network_solver.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

/// Factors of a network that a separator of s vertices cuts in two hold about 10 (6 s)^2 entries by nested dissection.
constexpr double kEntriesPerSquare = 10.0;
/// Entries of factors for each junction from which on iteration is quicker: cubes from 13 junctions a side on, no
/// sheets.
constexpr double kLeastEntriesOfJunction = 2800.0;

/// Vertices that lie as far from one end of a network as the middle one, in steps: a separator.
int separator(const std::vector<int>& start, const std::vector<int>& next) {
  const int n = static_cast<int>(start.size()) - 1;
  std::vector<int> queue, distance;
  const auto search = [&](int first) {
    distance.assign(n, -1);
    queue = {first};
    distance[first] = 0;
    for (size_t k = 0; k < queue.size(); ++k)
      for (int i = start[queue[k]]; i < start[queue[k] + 1]; ++i)
        if (const int w = next[i]; distance[w] < 0) {
          distance[w] = distance[queue[k]] + 1;
          queue.push_back(w);
        }
  };
  if (n == 0) return 0;
  search(0);
  search(queue.back());
  const int middle = distance[queue[queue.size() / 2]];
  return static_cast<int>(std::count_if(queue.begin(), queue.end(), [&](int v) { return distance[v] == middle; }));
}

}  // namespace

double factor_entries(const std::vector<int>& start, const std::vector<int>& next) {
  const double side = static_cast<double>(kVertexDofs) * separator(start, next);
  return kEntriesPerSquare * side * side;
}

double factor_entries(const CondensedSystem& system) {
  const DofMatrix& matrix = *system.matrix();
  const BlockRows rows(matrix);
  SparseMatrix graph{{0}, {}, {}};  // of vertices
  for (int v = 0; v < rows.vertices(); ++v) {
    for (int b = 0; b < rows.blocks(v); ++b) graph.column.push_back(rows.neighbour(v, b));
    graph.row_start.push_back(static_cast<int>(graph.column.size()));
  }
  if (matrix.getRowMap()->getComm()->getSize() == 1) return factor_entries(graph.row_start, graph.column);
  SharedRows share;
  share.communicator = communicator_of(matrix);
  share.rows = GatherPlan(share.communicator, rows.vertices());
  const auto columns = matrix.getColMap();
  for (size_t c = 0; c < columns->getNodeNumElements(); c += kVertexDofs)
    share.column_number.push_back(static_cast<int>(columns->getGlobalElement(static_cast<int>(c)) / kVertexDofs));
  const SparseMatrix all = gathered_structure(graph, share);
  double entries = factor_entries(all.row_start, all.column);  // the first rank has them
  MPI_Bcast(&entries, 1, MPI_DOUBLE, 0, share.communicator);
  return entries;
}

bool is_quicker_by_iteration(const CondensedSystem& system, double factor_entries) {
  const double junctions = static_cast<double>(system.matrix()->getGlobalNumRows()) / kVertexDofs;
  return factor_entries >= kLeastEntriesOfJunction * junctions;
}

std::unique_ptr<TangentSolver> make_tangent_solver(const Model& model, const std::string& method,
                                                   double residual_tolerance) {
  if (method != kAutomatic && method != kIterative)
    return make_direct_tangent_solver(model, method, residual_tolerance);
  return std::make_unique<ChainSolver>(
      model, kSparseSolver, residual_tolerance, [&](const CondensedSystem& system) -> std::unique_ptr<LinearSolver> {
        const double entries = method == kIterative ? 2.0 * kMostFactorEntries : factor_entries(system);
        if (entries > kMostFactorEntries || is_quicker_by_iteration(system, entries)) {
          auto solver = std::make_unique<NetworkSolver>(system, residual_tolerance, model.times());
          if (entries <= kMostFactorEntries) solver->keep_factors_at_hand();
          return solver;
        }
        return make_direct_solver(system.matrix(), kSparseSolver, residual_tolerance, model.times());
      });
}

}  // namespace mixbeam
