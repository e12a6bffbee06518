#include "discretization/checks/rigid_parts.hpp"

#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/mesh/mesh.hpp"
#include "discretization/scene/joined_ends.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

namespace mixbeam {
namespace {

using namespace vector_algebra;

/// Sets that grow together (union-find with path halving).
class Groups {
 public:
  std::size_t add() {
    parent_.push_back(parent_.size());
    return parent_.size() - 1;
  }
  std::size_t group_of(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) { parent_[group_of(i)] = group_of(j); }

 private:
  std::vector<std::size_t> parent_;
};

/// Numbers groups in the order in which they are met.
class Numbering {
 public:
  std::size_t of(std::size_t group) { return number_.emplace(group, number_.size()).first->second; }

 private:
  std::unordered_map<std::size_t, std::size_t> number_;
};

/// Points, and ends of members with a joint, grouped into parts by members, and parts into assemblies by joints.
class Nodes {
 public:
  explicit Nodes(const Scene& scene) : scene_(scene), joints_(joined_ends(scene)) {
    for (const Point& point : scene.points) positions_.emplace(point.name, point.position);
    for (const auto& [point, ends] : joints_) {
      std::size_t node = 0;
      for (const JoinedEnd& end : ends) {
        if (!end.shares) node = parts_.add();
        slaves_.emplace(std::make_pair(point, end.member), node);
      }
    }
    for (std::size_t m = 0; m < scene.members.size(); ++m) {
      const Member& member = scene.members[m];
      const std::size_t start = end_node(member.start_point, m);
      parts_.join(start, end_node(member.end_point, m));
      for (const InnerPoint& inner : member.inner_points) parts_.join(start, point_node(inner.point));
    }
    together_ = parts_;
    for (const auto& [end, node] : slaves_) together_.join(node, point_node(end.first));
  }

  std::vector<RigidAssembly> assemblies() {
    std::vector<RigidAssembly> all;
    for (std::size_t m = 0; m < scene_.members.size(); ++m) {
      const std::size_t node = end_node(scene_.members[m].start_point, m);
      add_member(part_at(all, node).first, part_at(all, node).second, m);
    }
    for (std::size_t i = 0; i < scene_.supports.size(); ++i) {
      const auto node = node_of_point_.find(scene_.supports[i].point);
      if (node != node_of_point_.end()) part_at(all, node->second).first->supports.push_back(i);
    }
    for (const auto& [end, node] : slaves_) add_link(all, end.first, end.second, node);
    for (RigidAssembly& assembly : all)
      for (RigidPart& part : assembly.parts) measure(part);
    return all;
  }

 private:
  std::size_t point_node(const std::string& point) {
    const auto found = node_of_point_.find(point);
    return found != node_of_point_.end() ? found->second : node_of_point_.emplace(point, parts_.add()).first->second;
  }
  std::size_t end_node(const std::string& point, std::size_t member) {
    const auto slave = slaves_.find({point, static_cast<int>(member)});
    return slave == slaves_.end() ? point_node(point) : slave->second;
  }

  struct Place {
    std::size_t assembly = 0, part = 0;
  };
  /// The part of a node and its number over all assemblies; made when it is met for the first time.
  std::pair<RigidPart*, std::size_t> part_at(std::vector<RigidAssembly>& all, std::size_t node) {
    const std::size_t number = part_number_.of(parts_.group_of(node));
    if (number == places_.size()) {
      const std::size_t assembly = assembly_number_.of(together_.group_of(node));
      if (assembly == all.size()) all.emplace_back();
      places_.push_back({assembly, all[assembly].parts.size()});
      all[assembly].parts.emplace_back();
    }
    const Place& place = places_[number];
    return {&all[place.assembly].parts[place.part], number};
  }

  void add_member(RigidPart* part, std::size_t number, std::size_t index) {
    const Member& member = scene_.members[index];
    part->members.push_back(index);
    const auto add = [&](const std::string& point) {
      if (!seen_.emplace(number, point).second) return;
      part->points.push_back(point);
      part->positions.push_back(position(point));
    };
    add(member.start_point);
    for (const InnerPoint& inner : member.inner_points) add(inner.point);
    add(member.end_point);
  }

  void add_link(std::vector<RigidAssembly>& all, const std::string& point, int member, std::size_t node) {
    const std::size_t slave = part_at(all, node).second, master = part_at(all, point_node(point)).second;
    for (const JoinedEnd& end : joints_.at(point))
      if (end.member == member && !end.shares)
        all[places_[slave].assembly].links.push_back(
            {places_[master].part, places_[slave].part, static_cast<std::size_t>(end.joint), position(point)});
  }

  /// Ends of curves and inner points may follow from their members.
  const Vector3& position(const std::string& point) {
    if (!positions_.count(point))
      for (const auto& [name, vertex] : mesh().vertex_of_point)
        positions_.emplace(name, mesh().vertex_position[vertex]);
    return positions_.at(point);
  }
  const Mesh& mesh() {
    if (!mesh_) mesh_ = build_mesh(scene_);
    return *mesh_;
  }

  void measure(RigidPart& part) {
    for (const Vector3& position : part.positions) part.center = sum(part.center, position);
    part.center = scaled(1.0 / static_cast<double>(part.positions.size()), part.center);
    for (const Vector3& position : part.positions)
      part.size = std::max(part.size, norm(difference(position, part.center)));
    for (const std::size_t i : part.members)  // a closed ring has one point only
      if (scene_.members[i].start_point == scene_.members[i].end_point)
        part.size = std::max(part.size, mesh().members[i].curve.length);
  }

  const Scene& scene_;
  JointTable joints_;
  std::unordered_map<std::string, Vector3> positions_;
  std::unordered_map<std::string, std::size_t> node_of_point_;
  std::map<std::pair<std::string, int>, std::size_t> slaves_;
  Groups parts_, together_;
  Numbering part_number_, assembly_number_;
  std::vector<Place> places_;
  std::set<std::pair<std::size_t, std::string>> seen_;
  std::optional<Mesh> mesh_;
};

}  // namespace

std::vector<RigidAssembly> rigid_assemblies(const Scene& scene) { return Nodes(scene).assemblies(); }

}  // namespace mixbeam
