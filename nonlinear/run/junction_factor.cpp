#include "nonlinear/run/junction_factor.hpp"

#include "discretization/linear_system/chain_structure.hpp"
#include "discretization/scene/joined_ends.hpp"
#include "nonlinear/multilevel/network_solver.hpp"

#include <metis.h>

#include <algorithm>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mixbeam {

namespace {

constexpr int kDofs = 6;
/// Pairs of junctions in a factor: of 36 numbers each they fill 100 GB.
constexpr double kMostPairs = 3.5e8;

/// Points and joined ends, and members between them, each as one link.
struct PointGraph {
  std::vector<std::array<int, 2>> links;
  std::vector<std::array<int, 2>> joints;  ///< master and slave
  std::vector<unsigned char> kept;         ///< (vertex): not inside a chain
  std::vector<int> free;                   ///< (vertex): unknowns that no support prescribes

  explicit PointGraph(const Scene& scene) {
    const JointTable ends = joined_ends(scene);
    for (std::size_t m = 0; m < scene.members.size(); ++m) {
      const Member& member = scene.members[m];
      int here = end_of(member.start_point, static_cast<int>(m), ends);
      for (const InnerPoint& inner : member.inner_points) {
        const int next = vertex(inner.point);
        links.push_back({here, next});
        here = next;
      }
      links.push_back({here, end_of(member.end_point, static_cast<int>(m), ends)});
    }
    for (const PointLoad& load : scene.point_loads) kept[vertex(load.point)] = 1;
    for (const Support& support : scene.supports) hold(support);
  }

 private:
  int add() {
    kept.push_back(0);
    free.push_back(kDofs);
    return static_cast<int>(kept.size()) - 1;
  }
  int vertex(const std::string& point) {
    const auto [entry, is_new] = vertex_of_.try_emplace(point, static_cast<int>(kept.size()));
    if (is_new) add();
    return entry->second;
  }
  int end_of(const std::string& point, int member, const JointTable& ends) {
    const int master = vertex(point);
    const auto joined = ends.find(point);
    if (joined == ends.end()) return master;
    for (const JoinedEnd& end : joined->second) {
      if (end.member != member) continue;
      const int slave = add();
      kept[master] = kept[slave] = 1;
      joints.push_back({master, slave});
      return slave;
    }
    return master;
  }
  void hold(const Support& support) {
    const int held = vertex(support.point);
    kept[held] = 1;
    for (int i = 0; i < 3; ++i) free[held] -= support.displacement_fixed[i] + support.rotation_fixed[i];
    free[held] = std::max(free[held], 0);
  }

  std::unordered_map<std::string, int> vertex_of_;
};

/// Neighbours of each junction, in the form of METIS.
struct JunctionGraph {
  std::vector<idx_t> start, next;

  JunctionGraph(int vertices, const std::vector<std::array<int, 2>>& pairs) : start(vertices + 1, 0) {
    for (const auto& pair : pairs)
      for (int vertex : pair) ++start[vertex + 1];
    for (int v = 0; v < vertices; ++v) start[v + 1] += start[v];
    next.resize(start[vertices]);
    std::vector<idx_t> place(start.begin(), start.end() - 1);
    for (const auto& [a, b] : pairs) {
      next[place[a]++] = b;
      next[place[b]++] = a;
    }
  }
  int size() const { return static_cast<int>(start.size()) - 1; }
};

/// Position of each junction in the elimination.
std::vector<idx_t> elimination_order(JunctionGraph& graph) {
  idx_t count = graph.size();
  std::vector<idx_t> order(count), place(count);
  if (graph.next.empty() || METIS_NodeND(&count, graph.start.data(), graph.next.data(), nullptr, nullptr, order.data(),
                                         place.data()) != METIS_OK)
    for (idx_t v = 0; v < count; ++v) order[v] = place[v] = v;
  return place;
}

/// (position): unknowns below the diagonal in the columns of the junction there. Row by row along the elimination tree
/// (T. Davis, Direct Methods for Sparse Linear Systems, 2006, section 4.2).
std::vector<double> columns_of_factor(const JunctionGraph& graph, const std::vector<idx_t>& place,
                                      const std::vector<int>& free) {
  const int count = graph.size();
  std::vector<int> at(count), parent(count, -1), seen(count, -1);
  for (int v = 0; v < count; ++v) at[place[v]] = v;
  std::vector<double> below(count, 0.0);
  double pairs = 0.0;
  for (int row = 0; row < count && pairs < kMostPairs; ++row) {
    seen[row] = row;
    const int v = at[row];
    for (idx_t k = graph.start[v]; k < graph.start[v + 1]; ++k)
      for (int column = place[graph.next[k]]; column < row && seen[column] != row; column = parent[column]) {
        if (parent[column] < 0) parent[column] = row;
        seen[column] = row;
        below[column] += free[v];
        pairs += 1.0;
      }
  }
  return below;
}

}  // namespace

JunctionFactor junction_factor(const Scene& scene, double most) {
  const PointGraph points(scene);
  const ChainStructure chains(points.links, points.kept);
  std::vector<int> junction(points.kept.size(), -1);
  std::vector<int> free;
  const auto number = [&](int vertex) {
    if (junction[vertex] < 0) {
      junction[vertex] = static_cast<int>(free.size());
      free.push_back(points.free[vertex]);
    }
    return junction[vertex];
  };
  std::vector<std::array<int, 2>> pairs;
  const auto add = [&](const std::array<int, 2>& ends) {
    const std::array<int, 2> pair = {number(ends[0]), number(ends[1])};
    if (pair[0] != pair[1]) pairs.push_back({std::min(pair[0], pair[1]), std::max(pair[0], pair[1])});
  };
  for (const RemainingLink& link : chains.remaining()) add(link.vertex);
  for (const auto& joint : points.joints) add(joint);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  JunctionGraph graph(static_cast<int>(free.size()), pairs);
  JunctionFactor factor;
  factor.junctions = graph.size();
  factor.matrix = kDofs * kDofs * static_cast<double>(graph.size() + graph.next.size());
  factor.is_larger = factor_entries(graph.start, graph.next) > most;
  if (factor.is_larger) return factor;
  const std::vector<idx_t> place = elimination_order(graph);
  const std::vector<double> below = columns_of_factor(graph, place, free);
  for (int v = 0; v < graph.size(); ++v) {
    const double own = free[v], column = below[place[v]];
    factor.entries += own * (0.5 * (own + 1.0) + column);
    factor.operations += 0.5 * own * (column + own) * (column + own);
  }
  return factor;
}

}  // namespace mixbeam
