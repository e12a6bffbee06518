/// Sizes of a scene, and the list that its warnings are collected in.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/scene/names.hpp"

#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mixbeam {

/// Curves, lengths and names of a scene that read_scene accepted. The scene must outlive it.
struct SceneSurvey {
  explicit SceneSurvey(const Scene& surveyed);

  const Section& section_of(const Member& member) const { return *sections.at(member.section); }
  /// Reference length of the member's shortest and longest element.
  std::array<double, 2> element_lengths(std::size_t member) const;
  /// Length of the element at the start (0) or end (1) of the member.
  double end_element_length(std::size_t member, int end) const;

  const Scene& scene;
  SceneNames names;
  std::unordered_map<std::string, const Section*> sections;
  std::vector<ReferenceCurve> curves;  ///< of the members
  double size = 0.0;                   ///< diagonal of the box around all points, or the longest member if that is more
};

/// Warnings in the order in which they were found, those of a kind cut off after the first few.
class WarningList {
 public:
  /// `kind` names what many warnings have in common: "coincident members".
  void add(const std::string& kind, const std::string& text) {
    if (++count_[kind] <= kMostOfAKind) texts_.push_back(text);
  }

  std::vector<std::string> finished() const {
    std::vector<std::string> all = texts_;
    for (const auto& [kind, count] : count_)
      if (count > kMostOfAKind) all.push_back("... and " + std::to_string(count - kMostOfAKind) + " more " + kind);
    return all;
  }

 private:
  static constexpr std::size_t kMostOfAKind = 5;  // further ones add nothing

  std::vector<std::string> texts_;
  std::map<std::string, std::size_t> count_;
};

/// `Sections / tube: `
std::string warned_place(const std::string& list, const std::string& name);

/// Loads of impossible size against the stiffnesses: usually a slip of units. Scenes on which nothing acts.
void add_load_warnings(const SceneSurvey& survey, WarningList& list);

/// Connections that were probably meant but are not there: points that all but coincide, members that lie on each
/// other, points that lie on a member which does not know them.
void add_geometry_warnings(const SceneSurvey& survey, WarningList& list);

}  // namespace mixbeam
