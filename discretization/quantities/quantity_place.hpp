/// Places of quantities: resolves the words of a user in a scene.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/scene/names.hpp"

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

inline constexpr double kRoundingOfLength = 1e-9;  ///< share of a member by which a written arc length may exceed it

/// A point, or a place along a member.
struct QuantityPlace {
  std::string label{};                 ///< as the user would write it: "tip", "rod@50%"
  std::string point{};                 ///< name; empty: a place along a member
  int member = -1;                     ///< in the scene
  double position = 0.0;               ///< arc length over length of the member
  std::optional<double> arc_length{};  ///< the arc length that was asked for in place of that share [length]
};

class QuantityPlaces {
 public:
  /// The scene must outlive it.
  explicit QuantityPlaces(const Scene& scene);

  /// Resolves `text` (a point, MEMBER@s, MEMBER@p%, or a pattern of either). Throws InputError at `place`.
  std::vector<QuantityPlace> places(const std::string& text, const InputPlace& place) const;
  /// Resolves `text` to places on members, for quantities of a section: a point must have one member only.
  std::vector<QuantityPlace> places_in_members(const std::string& text, const InputPlace& place) const;
  /// Members that a name or pattern stands for.
  std::vector<int> members(const std::string& text, const InputPlace& place) const;
  /// Supported points that a name or pattern stands for.
  std::vector<QuantityPlace> supported(const std::string& text, const InputPlace& place) const;
  /// The place `position` (arc length over length) of a member.
  QuantityPlace at(int member, double position) const;

 private:
  std::vector<QuantityPlace> along_members(const std::string& text, const InputPlace& place) const;
  double length_of(const Member& member) const;

  const Scene& scene_;
  SceneNames names_;
  std::vector<std::string> points_{};  ///< that members touch
};

}  // namespace mixbeam
