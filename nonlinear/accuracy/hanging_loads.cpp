#include "nonlinear/accuracy/hanging_loads.hpp"

#include <algorithm>
#include <utility>

namespace mixbeam {

namespace {

/// Vertices and what joins them: first the elements, then the joints. All supported vertices are one, the ground.
class LoadWays {
 public:
  LoadWays(const Scene& scene, const Mesh& mesh) : node_(mesh.vertices()) {
    for (int v = 0; v < mesh.vertices(); ++v) node_[v] = v + 1;
    for (const Support& support : scene.supports) node_[vertex_of(mesh, support.point)] = kGround;
    for (const MeshElement& element : mesh.elements)
      ends_.emplace_back(node_[element.vertex[0]], node_[element.vertex[1]]);
    for (const MeshJoint& joint : mesh.joints) ends_.emplace_back(node_[joint.master], node_[joint.slave]);
    first_.assign(nodes() + 1, 0);
    for (const auto& [a, b] : ends_) {
      ++first_[a + 1];
      ++first_[b + 1];
    }
    for (int n = 0; n < nodes(); ++n) first_[n + 1] += first_[n];
    std::vector<int> next(first_.begin(), first_.end() - 1);
    ways_.resize(2 * ends_.size());
    for (int way = 0; way < static_cast<int>(ends_.size()); ++way) {
      ways_[next[ends_[way].first]++] = way;
      ways_[next[ends_[way].second]++] = way;
    }
  }

  static constexpr int kGround = 0;
  int nodes() const { return static_cast<int>(node_.size()) + 1; }
  int node_of(int vertex) const { return node_[vertex]; }
  int first(int node) const { return first_[node]; }
  int way(int place) const { return ways_[place]; }
  int ways() const { return static_cast<int>(ends_.size()); }
  int other_end(int way, int node) const { return ends_[way].first == node ? ends_[way].second : ends_[way].first; }

 private:
  std::vector<int> node_;                  ///< (vertex)
  std::vector<std::pair<int, int>> ends_;  ///< (way) nodes
  std::vector<int> first_, ways_;          ///< ways that meet at a node: ways_[first_[node] .. first_[node + 1])
};

/// A node on the way of the search from the ground.
struct Visit {
  int node, from_way, next;  ///< next: place of the way that is looked at next
};

}  // namespace

void LoadSum::add(const LoadSum& other) {
  force += other.force;
  moment += other.moment;
  for (int i = 0; i < 3; ++i) force_moment[i] += other.force_moment[i];
}

Vector3 LoadSum::place() const { return {force_moment[0] / force, force_moment[1] / force, force_moment[2] / force}; }

// Depth first from the ground. A way is a bridge, and what was found behind it hangs on it, where no way from there
// leads back to a node that was found before (Tarjan, A note on finding the bridges of a graph, 1974).
std::vector<std::optional<LoadSum>> hanging_loads(const Scene& scene, const Mesh& mesh,
                                                  const std::vector<LoadSum>& load) {
  const LoadWays graph(scene, mesh);
  std::vector<LoadSum> behind(graph.nodes());  // the node and all that was found from it
  for (int v = 0; v < mesh.vertices(); ++v) behind[graph.node_of(v)].add(load[v]);
  std::vector<int> found(graph.nodes(), -1), earliest(graph.nodes(), -1);
  std::vector<std::optional<LoadSum>> hanging(graph.ways());
  int count = 0;
  std::vector<Visit> visits;
  const auto visit = [&](int node, int from_way) {
    found[node] = earliest[node] = count++;
    visits.push_back({node, from_way, graph.first(node)});
  };
  visit(LoadWays::kGround, -1);
  while (!visits.empty()) {
    Visit& here = visits.back();
    if (here.next < graph.first(here.node + 1)) {
      const int way = graph.way(here.next++);
      if (way == here.from_way) continue;
      const int node = graph.other_end(way, here.node);
      if (found[node] < 0)
        visit(node, way);
      else
        earliest[here.node] = std::min(earliest[here.node], found[node]);
      continue;
    }
    const Visit done = here;
    visits.pop_back();
    if (visits.empty()) break;
    const int before = visits.back().node;
    if (earliest[done.node] > found[before]) hanging[done.from_way] = behind[done.node];
    earliest[before] = std::min(earliest[before], earliest[done.node]);
    behind[before].add(behind[done.node]);
  }
  hanging.resize(mesh.elements.size());
  return hanging;
}

}  // namespace mixbeam
