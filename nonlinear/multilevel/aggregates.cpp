#include "nonlinear/multilevel/aggregates.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>

namespace mixbeam {

namespace {

/// Networks with eight nodes for each aggregate, three of them along each direction of space or two, need the least
/// time: eigenproblems grow with the cube of this number, levels with its logarithm.
constexpr int kAggregateSize = 8;
/// Unknowns of a level with fewer nodes are few enough for a direct solver, whatever the modes of a node are.
constexpr int kSmallGraph = 64;
/// A level with more aggregates than this share of its nodes is not worth having.
constexpr double kLeastCoarsening = 0.5;

/// An aggregate that stayed smaller joins a neighbour.
constexpr int kLeastSize = 4;
/// A walk of two links counts as this share of a link: enough to close squares before lines grow longer.
constexpr double kWalk = 0.25;

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

/// Grows aggregates one after the other: each takes the node that hangs together most closely with what it has; the
/// next one begins where the fewest nodes are left around, so that no holes stay behind.
class Growth {
 public:
  explicit Growth(const Graph& graph) : graph_(graph), aggregate_(graph.nodes(), -1), left_(graph.nodes()) {
    double sum = 0.0;
    for (double w : graph.weight) sum += w;
    walk_ = graph.weight.empty() ? 0.0 : kWalk * static_cast<double>(graph.weight.size()) / sum;
    closeness_.assign(graph.nodes(), 0.0);
    linked_.assign(graph.nodes(), 0);
    for (int v = 0; v < graph.nodes(); ++v) left_[v] = graph.start[v + 1] - graph.start[v];
  }

  /// (node): its aggregate.
  std::vector<int> run(int& aggregates) {
    for (int v = 0; v < graph_.nodes(); ++v) {
      if (aggregate_[v] >= 0) continue;
      seeds_.push({left_[v], v});
      while (!seeds_.empty()) {
        const auto [left, seed] = seeds_.top();
        seeds_.pop();
        if (aggregate_[seed] < 0 && left == left_[seed]) grow(seed);
      }
    }
    merge_small_ones();
    aggregates = 0;
    std::vector<int> number(sizes_.size(), -1);
    for (int& a : aggregate_) {
      if (number[a] < 0) number[a] = aggregates++;
      a = number[a];
    }
    return aggregate_;
  }

 private:
  void grow(int seed) {
    const int mine = static_cast<int>(sizes_.size());
    sizes_.push_back(0);
    touched_.clear();
    for (int node = seed; node >= 0;) {
      aggregate_[node] = mine;
      for (int k = graph_.start[node]; k < graph_.start[node + 1]; ++k) --left_[graph_.neighbour[k]];
      if (++sizes_[mine] == kAggregateSize) break;
      come_closer(node);
      node = -1;
      for (int c : touched_)
        if (aggregate_[c] < 0 && linked_[c] != 0 &&
            (node < 0 || closeness_[c] > closeness_[node] || (closeness_[c] == closeness_[node] && c < node)))
          node = c;
    }
    for (int c : touched_) {
      closeness_[c] = 0.0;
      linked_[c] = 0;
      if (aggregate_[c] < 0) seeds_.push({left_[c], c});
    }
  }

  void come_closer(int node) {
    const auto add = [this](int c, double share) {
      if (closeness_[c] == 0.0) touched_.push_back(c);
      closeness_[c] += share;
    };
    for (int k = graph_.start[node]; k < graph_.start[node + 1]; ++k) {
      const int middle = graph_.neighbour[k];
      add(middle, graph_.weight[k]);
      linked_[middle] = 1;
      for (int j = graph_.start[middle]; j < graph_.start[middle + 1]; ++j)
        if (graph_.neighbour[j] != node) add(graph_.neighbour[j], walk_ * graph_.weight[k] * graph_.weight[j]);
    }
  }

  void merge_small_ones() {
    for (int v = 0; v < graph_.nodes(); ++v) {
      if (sizes_[aggregate_[v]] >= kLeastSize) continue;
      int best = -1;
      double most = 0.0;
      for (int k = graph_.start[v]; k < graph_.start[v + 1]; ++k) {
        const int other = aggregate_[graph_.neighbour[k]];
        if (other == aggregate_[v] || sizes_[other] < kLeastSize || sizes_[other] >= kAggregateSize + kLeastSize)
          continue;
        if (graph_.weight[k] > most) most = graph_.weight[k], best = other;
      }
      if (best < 0) continue;
      --sizes_[aggregate_[v]];
      aggregate_[v] = best;
      ++sizes_[best];
    }
  }

  const Graph& graph_;
  double walk_ = 0.0;
  std::vector<int> aggregate_, left_, sizes_, touched_;
  std::vector<double> closeness_;
  std::vector<unsigned char> linked_;
  std::priority_queue<std::pair<int, int>, std::vector<std::pair<int, int>>, std::greater<>> seeds_;
};

}  // namespace

Nesting nest(int nodes, const LinkEnds& ends) {
  std::vector<std::vector<int>> aggregate;  // (level)(node): before anything is renumbered
  std::vector<int> counts = {nodes};
  LinkEnds links = ends;
  std::vector<double> weights;
  while (counts.back() > kSmallGraph) {
    const Graph graph = graph_of(counts.back(), links, weights);
    int coarse = 0;
    std::vector<int> of_node = Growth(graph).run(coarse);
    if (coarse > kLeastCoarsening * counts.back()) break;
    links.clear();
    weights.clear();
    for (int v = 0; v < graph.nodes(); ++v)
      for (int k = graph.start[v]; k < graph.start[v + 1]; ++k)
        if (of_node[v] < of_node[graph.neighbour[k]]) {
          links.push_back({of_node[v], of_node[graph.neighbour[k]]});
          weights.push_back(graph.weight[k]);
        }
    aggregate.push_back(std::move(of_node));
    counts.push_back(coarse);
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
