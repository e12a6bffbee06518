#include "discretization/scene/merged_scene.hpp"

#include "discretization/scene/what_acts.hpp"

namespace mixbeam {

namespace {

/// Adds a scene as one part, whose number goes before all names.
class PartOfScene {
 public:
  PartOfScene(int part, Scene& merged) : prefix_(MergedScene::name_in_part(part, "")), merged_(merged) {}

  void add(const Scene& scene) {
    append(merged_.sections, scene.sections, [this](Section& s) { rename(s.name); });
    append(merged_.points, scene.points, [this](Point& p) { rename(p.name); });
    append(merged_.members, scene.members, [this](Member& m) { rename_member(m); });
    for_each_kind([&](auto kind) {
      append(merged_.*kind.list, scene.*kind.list, [&](auto& load) { rename(load.*kind.target); });
    });
    for (auto load = merged_.point_loads.end() - scene.point_loads.size(); load != merged_.point_loads.end(); ++load)
      rename(load->member);
    append(merged_.point_masses, scene.point_masses, [this](PointMass& body) { rename(body.point); });
    append(merged_.joints, scene.joints, [this](Joint& joint) {
      rename(joint.name);
      rename(joint.point);
      for (std::string& member : joint.members) rename(member);
    });
  }

 private:
  /// An empty name, which means none, stays empty.
  void rename(std::string& name) const {
    if (!name.empty()) name.insert(0, prefix_);
  }
  void rename_member(Member& member) const {
    for (std::string* name :
         {&member.name, &member.start_point, &member.end_point, &member.section, &member.end_section})
      rename(*name);
    for (InnerPoint& inner : member.inner_points) rename(inner.point);
  }
  template <class Entry, class Rename>
  static void append(std::vector<Entry>& all, const std::vector<Entry>& more, const Rename& rename_entry) {
    for (const Entry& entry : more) rename_entry(all.emplace_back(entry));
  }

  std::string prefix_;
  Scene& merged_;
};

}  // namespace

MergedScene merge_scenes(const std::vector<const Scene*>& scenes) {
  MergedScene merged;
  merged.scene.name = scenes.front()->name;
  merged.scene.stages = scenes.front()->stages;
  for (std::size_t part = 0; part < scenes.size(); ++part) {
    PartOfScene(static_cast<int>(part), merged.scene).add(*scenes[part]);
    merged.part_of_member.resize(merged.scene.members.size(), static_cast<int>(part));
  }
  return merged;
}

}  // namespace mixbeam
