#include "nonlinear/diagnosis/limp_members.hpp"

#include "discretization/assembly/residual.hpp"
#include "discretization/scene/section_law.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <unordered_set>

namespace mixbeam {

double bending_of(const Section& section) {
  const auto stiffness = diagonal(section);
  return section.matrix ? std::numeric_limits<double>::infinity() : std::min(stiffness[4], stiffness[5]);
}

bool is_limp(const Section& section, double load, double length) {
  // A load at the end of such a cantilever bends it into its direction over less than a hundredth of the length.
  constexpr double kLimp = 5e-5;
  return bending_of(section) < kLimp * load * length * length;
}

std::vector<const Section*> sections_of_members(const Scene& scene) {
  std::unordered_set<std::string> names;
  for (const Member& member : scene.members) names.insert({member.section, member.end_section});
  std::vector<const Section*> sections;
  for (const Section& section : scene.sections)
    if (names.count(section.name) > 0) sections.push_back(&section);
  return sections;
}

bool has_limp_members(const Model& model, const State& state, double load_factor) {
  const double load = magnitude_of(model, state, load_factor).load_force, length = model.structure().length;
  const std::vector<const Section*> sections = sections_of_members(model.scene());
  return std::any_of(sections.begin(), sections.end(),
                     [&](const Section* section) { return is_limp(*section, load, length); });
}

}  // namespace mixbeam
