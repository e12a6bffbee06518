#include "discretization/mesh/vertex_partition.hpp"

#include "discretization/mesh/row_lists.hpp"

#include <metis.h>

#include <algorithm>
#include <numeric>

namespace mixbeam {

namespace {

/// Vertices, and elements between them, as a METIS graph. Slaves of joints are merged into their masters.
struct VertexGraph {
  std::vector<idx_t> node;  ///< (vertex)
  std::vector<idx_t> ends;  ///< (node): ends of elements there, which cost memory and time
  std::vector<idx_t> start, next, price;

  explicit VertexGraph(const Mesh& mesh) : node(mesh.vertices(), 0) {
    for (const MeshJoint& joint : mesh.joints) node[joint.slave] = -1;
    idx_t nodes = 0;
    for (idx_t& number : node) number = number < 0 ? -1 : nodes++;
    for (const MeshJoint& joint : mesh.joints) node[joint.slave] = node[joint.master];
    ends.assign(nodes, 0);
    for (const MeshElement& element : mesh.elements)
      for (int vertex : element.vertex) ++ends[node[vertex]];
    const auto inside_chain = [this](idx_t n) { return ends[n] == 2 ? 1 : 0; };
    const Graph<idx_t> graph = joined_links<idx_t>(static_cast<int>(nodes), [&](const auto& add) {
      for (const MeshElement& element : mesh.elements)
        for (int end = 0; end < 2; ++end) {
          const idx_t here = node[element.vertex[end]], there = node[element.vertex[1 - end]];
          // a cut element is evaluated on both sides, and its ends are not eliminated
          add(static_cast<int>(here), {static_cast<int>(there), 1 + inside_chain(here) + inside_chain(there)});
        }
    });
    start.assign(graph.start.begin(), graph.start.end());
    next.assign(graph.neighbour.begin(), graph.neighbour.end());
    price = graph.weight;
  }
};

/// First vertex of a contiguous share.
int first_of_share(int rank, int ranks, const Mesh& mesh) {
  const auto is_slave = [&](int vertex) {  // slaves ascend
    const auto joint = std::lower_bound(mesh.joints.begin(), mesh.joints.end(), vertex,
                                        [](const MeshJoint& j, int v) { return j.slave < v; });
    return joint != mesh.joints.end() && joint->slave == vertex;
  };
  int first = static_cast<int>(static_cast<long long>(mesh.vertices()) * rank / ranks);
  while (is_slave(first)) ++first;  // stays with its master on the rank before
  return first;
}

/// (vertex): its rank; empty if METIS fails.
std::vector<idx_t> parts_of_graph(int ranks, const Mesh& mesh) {
  VertexGraph graph(mesh);
  idx_t nodes = static_cast<idx_t>(graph.ends.size()), constraints = 1, parts = ranks, cut = 0;
  std::vector<idx_t> part(nodes), of_vertex(mesh.vertices());
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  if (METIS_PartGraphRecursive(&nodes, &constraints, graph.start.data(), graph.next.data(), graph.ends.data(), nullptr,
                               graph.price.data(), &parts, nullptr, nullptr, options, &cut, part.data()) != METIS_OK)
    return {};
  for (int v = 0; v < mesh.vertices(); ++v) of_vertex[v] = part[graph.node[v]];
  return of_vertex;
}

}  // namespace

double independent_loops(const Mesh& mesh) {
  return static_cast<double>(mesh.elements.size() + mesh.joints.size()) - mesh.vertices() + 1.0;
}

VertexPartition::VertexPartition(int rank, int ranks, const Mesh& mesh) {
  first_ = first_of_share(rank, ranks, mesh);
  end_ = first_of_share(rank + 1, ranks, mesh);
  if (ranks == 1 || independent_loops(mesh) < kLeastLoopsOfNetwork) return;
  const std::vector<idx_t> part = parts_of_graph(ranks, mesh);
  if (part.empty()) return;
  is_contiguous_ = false;
  for (int v = 0; v < mesh.vertices(); ++v)
    if (part[v] == rank) vertices_.push_back(v);
}

std::vector<int> connected_parts(const Mesh& mesh, const std::vector<MeshJoint>& joints) {
  std::vector<int> parent(mesh.vertices());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root_of = [&parent](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  const auto connect = [&](int a, int b) {
    a = root_of(a);
    b = root_of(b);
    parent[std::max(a, b)] = std::min(a, b);
  };
  for (const MeshElement& element : mesh.elements) connect(element.vertex[0], element.vertex[1]);
  for (const MeshJoint& joint : joints) connect(joint.master, joint.slave);
  std::vector<int> part(mesh.vertices());
  int parts = 0;
  for (int v = 0; v < mesh.vertices(); ++v) part[v] = parent[v] == v ? parts++ : part[root_of(v)];
  return part;
}

int VertexPartition::place(int vertex) const {
  if (is_contiguous_) return vertex >= first_ && vertex < end_ ? vertex - first_ : -1;
  const auto found = std::lower_bound(vertices_.begin(), vertices_.end(), vertex);
  return found != vertices_.end() && *found == vertex ? static_cast<int>(found - vertices_.begin()) : -1;
}

}  // namespace mixbeam
