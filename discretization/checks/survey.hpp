/// Sizes of a scene that its warnings refer to.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/scene/names.hpp"

#include <unordered_map>

namespace mixbeam {

/// Curves, lengths and names of a scene that read_scene accepted. The scene must outlive it.
struct SceneSurvey {
  explicit SceneSurvey(const Scene& surveyed);

  const Section& section_of(const Member& member) const { return *sections.at(member.section); }
  /// Reference length of the member's shortest and longest element.
  std::array<double, 2> element_lengths(std::size_t member) const;
  /// Of the element at the start (0) or end (1) of the member.
  double end_element_length(std::size_t member, int end) const;

  const Scene& scene;
  SceneNames names;
  std::unordered_map<std::string, const Section*> sections;
  std::vector<ReferenceCurve> curves;  ///< of the members
  double size = 0.0;                   ///< diagonal of the box around all points, or the longest member if that is more
};

}  // namespace mixbeam
