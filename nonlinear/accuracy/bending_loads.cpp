#include "nonlinear/accuracy/bending_loads.hpp"

#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/text/expression.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace mixbeam {

namespace {

using vector_algebra::distance;
using vector_algebra::norm;

/// A member of length L under a force F at a distance d has errors as if it turned evenly by f sqrt(F d L / EI): where
/// the force bends it most, its curvature is sqrt(2 F / EI) at most, and higher there than anywhere else. Measured with
/// the elastica, arcs and frames: f is 1.7 to 2.1, and small loads leave errors as if it turned by 2. [radian]
constexpr double kTurningByForce = 2.0, kLeastTurningByLoad = 2.0;
/// A force turns a member into its own direction and no further. How thin the layers at the ends of a cable are is left
/// to the estimate. [radian]
constexpr double kMostTurningByForce = 8.0;
/// A hundred coils are few enough to try; more would rather be a moment that others than this member carry. [radian]
constexpr double kMostTurningByMoment = 600.0;
/// In a structure of more members in closed loops a load bends those next to it, about as far from it as some of their
/// lengths.
constexpr int kMembersOfAFrame = 8;
constexpr double kLeverOfALattice = 3.0;
/// Points of a member at which the formula of a load is looked at.
constexpr int kPointsOfAFormula = 16;

/// Mean size of a vector that may depend on the place along a member of this length.
double mean_size(const Vector3& constant, const std::array<std::string, 3>& formula, double length) {
  if (std::all_of(formula.begin(), formula.end(), [](const std::string& text) { return text.empty(); }))
    return norm(constant);
  double sum = 0.0;
  for (int point = 0; point < kPointsOfAFormula; ++point) {
    const double x = (point + 0.5) / kPointsOfAFormula;
    Vector3 value = constant;
    for (int i = 0; i < 3; ++i)
      if (!formula[i].empty()) value[i] = Expression(formula[i], {"s", "x"})({x * length, x});
    if (std::isfinite(norm(value))) sum += norm(value);
  }
  return sum / kPointsOfAFormula;
}

/// Sums of loads by their sizes, whatever their directions, and where they act on average.
struct LoadSum {
  double force = 0.0, moment = 0.0;
  Vector3 force_moment{};  ///< sum of |force| x place

  void add(const LoadSum& other) {
    force += other.force;
    moment += other.moment;
    for (int i = 0; i < 3; ++i) force_moment[i] += other.force_moment[i];
  }
  /// Of a force that is not zero.
  Vector3 place() const { return {force_moment[0] / force, force_moment[1] / force, force_moment[2] / force}; }
};

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

/// (mesh element): the loads that it carries to the supports alone, because without it they would have none; nothing
/// for elements beside which others carry. `load`: (vertex). Supported vertices are the ends of all ways; joints lead
/// on like rigid corners.
///
/// Depth first from the ground. A way is a bridge, and what was found behind it hangs on it, where no way from there
/// leads back to a node that was found before (Tarjan, A note on finding the bridges of a graph, 1974).
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

LoadSum load_at(const Vector3& place, double force, double moment) {
  return {force, moment, {force * place[0], force * place[1], force * place[2]}};
}

/// The loads of a scene, by their sizes.
struct BendingLoads {
  std::vector<LoadSum> single;     ///< each one by itself, line loads in the middle of their members
  std::vector<LoadSum> at_vertex;  ///< (vertex), line loads at those of their elements

  BendingLoads(const Scene& scene, const Mesh& mesh) : at_vertex(mesh.vertices()) {
    for (const PointLoad& load : scene.point_loads) {
      const int vertex = vertex_of(mesh, load.point);
      single.push_back(load_at(mesh.vertex_position[vertex], norm(load.force), norm(load.moment)));
      at_vertex[vertex].add(single.back());
    }
    for (const DistributedLoad& load : scene.distributed_loads)
      add_line_load(mesh, mesh.members[member_index(scene, load.member)], load);
  }

 private:
  void add_line_load(const Mesh& mesh, const MeshMember& member, const DistributedLoad& load) {
    const double length = member.curve.length, force = length * mean_size(load.force, load.force_formula, length),
                 couple = length * mean_size(load.couple, load.couple_formula, length);
    const Vec3<double> middle = member.curve.position(0.5 * length);
    single.push_back(load_at({middle[0], middle[1], middle[2]}, force, couple));
    for (int i = 0; i < member.elements; ++i) {
      const double half = 0.5 * member.element_length(i) / length;
      for (const int vertex : mesh.elements[member.first_element + i].vertex)
        at_vertex[vertex].add(load_at(mesh.vertex_position[vertex], half * force, half * couple));
    }
  }
};

/// What bends a member: forces times levers, and moments.
struct Bending {
  double by_forces = 0.0, by_moments = 0.0;
};

/// Lever of a force to the far end of a member.
double lever_of(const Mesh& mesh, const MeshMember& member, const Vector3& place) {
  const auto end = [&](int element, int side) {
    return mesh.vertex_position[mesh.elements[member.first_element + element].vertex[side]];
  };
  return std::max(
      {distance(place, end(0, 0)), distance(place, end(member.elements - 1, 1)), 0.5 * member.curve.length});
}

Bending bending_by(const Mesh& mesh, const MeshMember& member, const LoadSum& load) {
  return {load.force > 0.0 ? load.force * lever_of(mesh, member, load.place()) : 0.0, load.moment};
}

/// Of a member that alone carries what hangs on it; none where one of its elements has others beside it.
std::optional<Bending> bending_of_carrier(const Mesh& mesh, const MeshMember& member,
                                          const std::vector<std::optional<LoadSum>>& hanging) {
  Bending largest;
  for (int i = 0; i < member.elements; ++i) {
    const std::optional<LoadSum>& load = hanging[member.first_element + i];
    if (!load) return std::nullopt;
    const Bending here = bending_by(mesh, member, *load);
    largest = {std::max(largest.by_forces, here.by_forces), std::max(largest.by_moments, here.by_moments)};
  }
  return largest;
}

/// By all loads of a frame.
Bending bending_in_frame(const Mesh& mesh, const MeshMember& member, const std::vector<LoadSum>& loads) {
  Bending sum;
  for (const LoadSum& load : loads) {
    const Bending here = bending_by(mesh, member, load);
    sum.by_forces += here.by_forces;
    sum.by_moments += here.by_moments;
  }
  return sum;
}

/// By the largest load of a lattice.
Bending bending_in_lattice(const MeshMember& member, const LoadSum& largest) {
  return {largest.force * kLeverOfALattice * member.curve.length, largest.moment};
}

LoadSum largest_of(const std::vector<LoadSum>& loads) {
  LoadSum largest;
  for (const LoadSum& load : loads) {
    largest.force = std::max(largest.force, load.force);
    largest.moment = std::max(largest.moment, load.moment);
  }
  return largest;
}

double turning_by(const Bending& bending, double compliance) {
  const double by_forces = std::min(kMostTurningByForce, kTurningByForce * std::sqrt(bending.by_forces * compliance));
  const double by_moments = std::min(kMostTurningByMoment, bending.by_moments * compliance);
  return std::max(kLeastTurningByLoad, std::hypot(by_forces, by_moments));
}

}  // namespace

double bending_compliance(const Scene& scene, const Member& member) {
  for (const Section& section : scene.sections)
    if (section.name == member.section)
      return 1.0 / std::min({section.bending_stiffness[0], section.bending_stiffness[1], section.torsional_stiffness});
  return 1.0;
}

std::vector<double> turning_by_loads(const Scene& scene, const Mesh& mesh) {
  const BendingLoads loads(scene, mesh);
  const auto hanging = hanging_loads(scene, mesh, loads.at_vertex);
  const LoadSum largest = largest_of(loads.single);
  const bool is_frame = scene.members.size() <= kMembersOfAFrame;
  std::vector<double> turning;
  for (size_t m = 0; m < scene.members.size(); ++m) {
    const MeshMember& member = mesh.members[m];
    std::optional<Bending> bending = bending_of_carrier(mesh, member, hanging);
    if (!bending)
      bending = is_frame ? bending_in_frame(mesh, member, loads.single) : bending_in_lattice(member, largest);
    turning.push_back(turning_by(*bending, member.curve.length * bending_compliance(scene, scene.members[m])));
  }
  for (const Eigenstrain& strain : scene.eigenstrains) {
    const int m = member_index(scene, strain.member);
    turning[m] += std::min(kMostTurningByMoment, norm(strain.curvature) * mesh.members[m].curve.length);
  }
  return turning;
}

}  // namespace mixbeam
