#include "discretization/state/acting.hpp"

#include "discretization/scene/section_law.hpp"
#include "discretization/text/expression.hpp"

#include <array>
#include <map>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace mixbeam {

namespace {

/// Finds places of points. Members that are joined at a point follow all others.
class PlaceFinder {
 public:
  PlaceFinder(const Scene& scene, const Mesh& mesh) : mesh_(mesh) {
    std::set<std::pair<std::string, std::string>> joined;  // point, member
    for (const Joint& joint : scene.joints)
      for (const std::string& member : joint.members) joined.emplace(joint.point, member);
    for (std::size_t m = 0; m < scene.members.size(); ++m) {
      const Member& member = scene.members[m];
      index_.emplace(member.name, static_cast<int>(m));
      const double length = mesh.member_length[m];
      const auto add = [&](const std::string& point, double s) {
        const bool is_joined = !joined.empty() && joined.count({point, member.name}) > 0;
        auto& places = is_joined ? joined_ : free_;
        places[point].emplace_back(static_cast<int>(m), s);
      };
      add(member.start_point, 0.0);
      for (const InnerPoint& inner : member.inner_points) add(inner.point, inner.position * length);
      add(member.end_point, length);
    }
  }

  int member(const std::string& name) const { return index_.at(name); }
  PlaceOnMember place(const std::string& point, const std::string& member = "") const {
    for (const auto* places : {&free_, &joined_}) {
      const auto found = places->find(point);
      if (found == places->end()) continue;
      for (const auto& [index, s] : found->second)
        if (member.empty() || index == index_.at(member)) return {index, s, position_of(point)};
    }
    return {0, 0.0, position_of(point)};  // of a scene whose points were not checked
  }

 private:
  using Places = std::unordered_map<std::string, std::vector<std::pair<int, double>>>;

  Vector3 position_of(const std::string& point) const { return mesh_.vertex_position[vertex_of(mesh_, point)]; }

  const Mesh& mesh_;
  Places free_, joined_;
  std::unordered_map<std::string, int> index_;
};

/// Values at the places of a line load.
std::vector<Vector3> sampled_values(const Vector3& constant, const std::array<std::string, 3>& formula, double length) {
  std::vector<Vector3> values(kPlacesAlongMember, constant);
  for (std::size_t i = 0; i < 3; ++i) {
    if (formula[i].empty()) continue;
    const Expression component(formula[i], {"s", "x"});
    for (int place = 0; place < kPlacesAlongMember; ++place) {
      const double x = static_cast<double>(place) / (kPlacesAlongMember - 1);
      values[place][i] = component({x * length, x});
    }
  }
  return values;
}

SampledSection sampled_section(const Scene& scene, const Member& member) {
  const SectionLaw law(scene, member);
  SampledSection sampled;
  for (int place = 0; place < kPlacesAlongMember; ++place) {
    const Section section = law.section(static_cast<double>(place) / (kPlacesAlongMember - 1));
    sampled.name = section.name;
    if (section.shape) sampled.shape.push_back(*section.shape);
  }
  return sampled;
}

void add_sections(const Scene& scene, Acting& acting) {
  std::map<std::tuple<std::string, std::string, std::string>, int> known;
  for (const Member& member : scene.members) {
    const auto [section, is_new] =
        known.try_emplace({member.section, member.end_section, member.taper}, static_cast<int>(acting.sections.size()));
    if (is_new) acting.sections.push_back(sampled_section(scene, member));
    acting.section_of_member.push_back(section->second);
  }
}

}  // namespace

Acting acting_on(const Scene& scene, const Mesh& mesh) {
  const PlaceFinder places(scene, mesh);
  Acting acting;
  acting.units = scene.units;
  for (const Support& support : scene.supports) acting.supports.push_back({support, places.place(support.point)});
  for (const Joint& joint : scene.joints)
    for (const std::string& member : joint.members) acting.joints.push_back({joint, places.place(joint.point, member)});
  for (const PointLoad& load : scene.point_loads) {
    const bool follows = load.frame == LoadFrame::follower;
    acting.point_loads.push_back({load, places.place(load.point, follows ? load.member : "")});
  }
  for (const DistributedLoad& load : scene.distributed_loads) {
    const int member = places.member(load.member);
    const double length = mesh.member_length[member];
    acting.line_loads.push_back({load, member, sampled_values(load.force, load.force_formula, length),
                                 sampled_values(load.couple, load.couple_formula, length)});
  }
  for (const Eigenstrain& strain : scene.eigenstrains) {
    const int member = places.member(strain.member);
    const double length = mesh.member_length[member];
    acting.eigenstrains.push_back({strain, member, sampled_values(strain.strain, strain.strain_formula, length),
                                   sampled_values(strain.curvature, strain.curvature_formula, length)});
  }
  add_sections(scene, acting);
  return acting;
}

}  // namespace mixbeam
