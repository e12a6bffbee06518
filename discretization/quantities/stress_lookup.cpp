#include "discretization/quantities/stress_lookup.hpp"

#include "discretization/geometry/vector_algebra.hpp"

#include <algorithm>
#include <limits>

namespace mixbeam {

namespace {

const Section& section_named(const Scene& scene, const std::string& name) {
  return *std::find_if(scene.sections.begin(), scene.sections.end(),
                       [&name](const Section& section) { return section.name == name; });
}

}  // namespace

bool is_stress(const std::string& kind) {
  return kind == "normal stress" || kind == "shear stress" || kind == "von Mises stress" || kind == "utilisation";
}

bool has_stress(const Scene& scene, const Member& member, const std::string& kind) {
  for (const std::string& name : {member.section, member.end_section}) {
    if (name.empty()) continue;
    const Section& section = section_named(scene, name);
    const bool is_known = member.end_section.empty() ? has_stresses(section) : section.shape.has_value();
    if (!is_known || (kind == "utilisation" && !strength_of(section))) return false;
  }
  return true;
}

StressLookup::Known StressLookup::known_of(const Section& section) {
  Known known;
  if (!has_stresses(section)) return known;
  known.stresses.emplace(section);
  known.strength = strength_of(section).value_or(0.0);
  return known;
}

const StressLookup::Known& StressLookup::section_at(const PointSample& sample, int index) {
  const Member& member = scene_.members[static_cast<std::size_t>(index)];
  if (!member.end_section.empty()) {
    const SectionLaw& law = tapers_.try_emplace(index, scene_, member).first->second;
    const double x = sample.arc_length / mesh_.member_length[static_cast<std::size_t>(index)];
    local_ = known_of(law.section(std::clamp(x, 0.0, 1.0)));
    return local_;
  }
  const auto found = sections_.find(member.section);
  if (found != sections_.end()) return found->second;
  return sections_.emplace(member.section, known_of(section_named(scene_, member.section))).first->second;
}

double StressLookup::of(const std::string& kind, const PointSample& sample, int member) {
  const Known& section = section_at(sample, member);
  if (!section.stresses) return std::numeric_limits<double>::quiet_NaN();
  using vector_algebra::to_array;
  const LargestStresses largest = section.stresses->largest({to_array(sample.force), to_array(sample.moment)});
  if (kind == "normal stress") return largest.normal.value;
  if (kind == "shear stress") return largest.shear.value;
  if (kind == "von Mises stress") return largest.von_mises.value;
  return section.strength > 0.0 ? largest.von_mises.value / section.strength : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace mixbeam
