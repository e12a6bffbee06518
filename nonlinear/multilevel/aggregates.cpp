#include "nonlinear/multilevel/aggregates.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace mixbeam {

namespace {

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double distance(const Vector3& a, const Vector3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

/// Unknowns of a level with fewer nodes are few enough for a direct solver, whatever the modes of a node are.
constexpr int kSmallGraph = 64;
/// A level with more aggregates than this share of its nodes is not worth having.
constexpr double kLeastCoarsening = 0.5;

/// Pairs of pairs of pairs: eight nodes for each aggregate, of which networks need the least time: eigenproblems grow
/// with the cube of this number, levels with its logarithm.
constexpr int kRounds = 3;
/// An aggregate that stayed smaller joins a neighbour, as long as both together are not larger than that: the ends of
/// odd rows beside whole cubes.
constexpr int kLeastSize = 5, kMostSize = 12;
/// A direction that lattices do not have, nor sums of theirs with small numbers.
constexpr Vector3 kDirection = {0.7799, 0.5515, 0.2948};
/// Twice as many links count more than any direction: squares before rows of four.
constexpr double kWeightPower = 4.0;
/// Weight of a link across the direction, beside the squared cosine of the angle to it.
constexpr double kAcross = 0.01;
/// A neighbour is as good as the best one, which is taken, if its closeness is this share of it: a lattice whose nodes
/// are displaced has no better ones in its rows.
constexpr double kCloseEnough = 0.5;
constexpr double kLeastDistance = 1e-300;  ///< against division by zero

struct Graph {
  std::vector<int> start, neighbour;
  std::vector<double> weight;  ///< number of links
  int nodes() const { return static_cast<int>(start.size()) - 1; }
};

/// Each pair of nodes once for each direction, neighbours ascending. (link): its weight; empty: all one.
Graph graph_of(int nodes, const LinkEnds& ends, const std::vector<double>& weights) {
  std::vector<int> count(nodes + 1, 0);
  for (const auto& [a, b] : ends) {
    ++count[a + 1];
    ++count[b + 1];
  }
  std::partial_sum(count.begin(), count.end(), count.begin());
  std::vector<std::pair<int, double>> all(count.back());
  std::vector<int> next(count.begin(), count.end() - 1);
  for (size_t l = 0; l < ends.size(); ++l)
    for (int end = 0; end < 2; ++end)
      all[next[ends[l][end]]++] = {ends[l][1 - end], weights.empty() ? 1.0 : weights[l]};
  Graph graph;
  graph.start.push_back(0);
  for (int v = 0; v < nodes; ++v) {
    std::sort(all.begin() + count[v], all.begin() + count[v + 1]);
    for (int k = count[v]; k < count[v + 1]; ++k) {
      if (all[k].first == v) continue;
      if (static_cast<int>(graph.neighbour.size()) > graph.start.back() && graph.neighbour.back() == all[k].first) {
        graph.weight.back() += all[k].second;
        continue;
      }
      graph.neighbour.push_back(all[k].first);
      graph.weight.push_back(all[k].second);
    }
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

/// Nodes or groups of them.
struct Groups {
  std::vector<int> of_node;    ///< (node): its group
  std::vector<Vector3> place;  ///< (group): mean place of its nodes
  std::vector<int> size;       ///< (group): its nodes
};

/// Joins groups to pairs, in the order in which they lie along a direction: each with the neighbour with the most
/// links; of several with that which closes a square beside another pair, or lies along the direction. In a lattice
/// pairs are therefore parallel and side by side, pairs of pairs squares, and pairs of those cubes. One whose best
/// neighbours are all taken stays single: the last one of an odd row. (group): its pair, and how many there are.
std::vector<int> pairs_of(const Graph& graph, const std::vector<Vector3>& place, int& count) {
  const int n = graph.nodes();
  std::vector<double> along(n);
  for (int v = 0; v < n; ++v) along[v] = dot(place[v], kDirection);
  std::vector<int> order(n), pair(n, -1), partner(n, -1), squares(n, 0);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return std::tie(along[a], a) < std::tie(along[b], b); });
  const auto for_each_square = [&](int v, const auto& action) {
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
      const int a = graph.neighbour[k], b = partner[a];
      if (b < 0) continue;
      for (int j = graph.start[b]; j < graph.start[b + 1]; ++j)
        if (graph.neighbour[j] != a) action(squares[graph.neighbour[j]]);
    }
  };
  count = 0;
  for (const int v : order) {
    if (pair[v] >= 0) continue;
    for_each_square(v, [](int& number) { ++number; });
    int best = -1;
    double most = 0.0, most_free = 0.0;
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
      const int w = graph.neighbour[k];
      const double cosine = (along[w] - along[v]) / std::max(distance(place[v], place[w]), kLeastDistance);
      const double closeness = std::pow(graph.weight[k], kWeightPower) * (cosine * cosine + kAcross + squares[w]);
      most = std::max(most, closeness);
      if (pair[w] < 0 && closeness > most_free) most_free = closeness, best = w;
    }
    for_each_square(v, [](int& number) { number = 0; });
    pair[v] = count;
    if (most_free >= kCloseEnough * most && best >= 0) {
      pair[best] = count;
      partner[v] = best;
      partner[best] = v;
    }
    ++count;
  }
  return pair;
}

/// Joins groups of few nodes to the neighbour with the most links. (group): its new number, and how many there are.
std::vector<int> without_small_ones(const Graph& graph, std::vector<int> size, int& count) {
  const int n = graph.nodes();
  std::vector<int> joined(n), number(n, -1);
  std::iota(joined.begin(), joined.end(), 0);
  const auto root = [&joined](int v) {
    while (joined[v] != v) v = joined[v];
    return v;
  };
  for (int v = 0; v < n; ++v) {
    if (size[v] >= kLeastSize) continue;  // of what has joined it, too
    int best = -1;
    double most = 0.0;
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
      const int w = root(graph.neighbour[k]);
      if (w == v || size[w] + size[v] > kMostSize || !(graph.weight[k] > most)) continue;
      most = graph.weight[k];
      best = w;
    }
    if (best < 0) continue;
    joined[v] = best;
    size[best] += size[v];
  }
  count = 0;
  for (int v = 0; v < n; ++v)
    if (joined[v] == v) number[v] = count++;
  std::vector<int> group(n);
  for (int v = 0; v < n; ++v) group[v] = number[root(v)];
  return group;
}

/// The graph over groups of its nodes.
Graph contracted(const Graph& graph, const std::vector<int>& group, int groups) {
  LinkEnds links;
  std::vector<double> weights;
  for (int v = 0; v < graph.nodes(); ++v)
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k)
      if (group[v] < group[graph.neighbour[k]]) {
        links.push_back({group[v], group[graph.neighbour[k]]});
        weights.push_back(graph.weight[k]);
      }
  return graph_of(groups, links, weights);
}

/// Groups of groups.
void join(Graph& graph, Groups& groups, const std::vector<int>& joined, int count) {
  graph = contracted(graph, joined, count);
  std::vector<Vector3> place(count, Vector3{});
  std::vector<int> size(count, 0);
  for (size_t g = 0; g < joined.size(); ++g) {
    size[joined[g]] += groups.size[g];
    for (int i = 0; i < 3; ++i) place[joined[g]][i] += groups.size[g] * groups.place[g][i];
  }
  for (int g = 0; g < count; ++g)
    for (double& x : place[g]) x /= size[g];
  groups.place = std::move(place);
  groups.size = std::move(size);
  for (int& g : groups.of_node) g = joined[g];
}

}  // namespace

Nesting nest(const std::vector<Vector3>& places, const LinkEnds& ends) {
  const int nodes = static_cast<int>(places.size());
  std::vector<std::vector<int>> aggregate;  // (level)(node): before anything is renumbered
  std::vector<int> counts = {nodes};
  Graph graph = graph_of(nodes, ends, {});
  Groups groups;
  groups.place = places;
  while (counts.back() > kSmallGraph) {
    groups.of_node.resize(counts.back());
    std::iota(groups.of_node.begin(), groups.of_node.end(), 0);
    groups.size.assign(counts.back(), 1);
    int count = 0;
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<int> pair = pairs_of(graph, groups.place, count);
      join(graph, groups, pair, count);
    }
    const std::vector<int> joined = without_small_ones(graph, groups.size, count);
    join(graph, groups, joined, count);
    if (count > kLeastCoarsening * counts.back()) break;
    aggregate.push_back(groups.of_node);
    counts.push_back(count);
  }
  Nesting nesting;
  nesting.first.resize(aggregate.size());
  std::vector<int> place(counts.back());
  std::iota(place.begin(), place.end(), 0);
  nesting.order = place;
  for (size_t level = aggregate.size(); level-- > 0;) {
    std::vector<int>& first = nesting.first[level];
    first.assign(counts[level + 1] + 1, 0);
    for (int a : aggregate[level]) ++first[place[a] + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<int> next(first.begin(), first.end() - 1), finer(counts[level]);
    for (int v = 0; v < counts[level]; ++v) finer[v] = next[place[aggregate[level][v]]]++;
    place = std::move(finer);
  }
  nesting.order.resize(nodes);
  for (int v = 0; v < nodes; ++v) nesting.order[place[v]] = v;
  return nesting;
}

}  // namespace mixbeam
