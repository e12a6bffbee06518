/// Finds points and members of a scene by name, with errors for unknown names.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/scene/scene.hpp"

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

namespace mixbeam {

/// Section of the rigid arms that offsets of members make. Name patterns match neither these members nor their free
/// ends: nothing in a scene refers to them.
inline const std::string kRigidArm = "(rigid arm)";

/// Index of a scene whose points and members are complete. The scene must outlive it, and its points and members must
/// stay as they are.
class SceneNames {
 public:
  explicit SceneNames(const Scene& scene);

  /// Null if there is no member of this name.
  const Member* member(const std::string& name) const;
  bool has_point(const std::string& name) const { return points_.count(name) > 0; }
  /// Position of an existing point.
  const Vector3& position(const std::string& point) const { return scene_.points[points_.at(point)].position; }
  /// Members that start, end, or have an inner point there, one entry for each time; null if there is none.
  const std::vector<const Member*>* members_at(const std::string& point) const;
  /// Names that patterns can match, in the order of the scene.
  std::vector<std::string> member_names() const;
  std::vector<std::string> point_names() const;

 private:
  const Scene& scene_;
  std::unordered_map<std::string, std::size_t> points_, members_;
  std::unordered_map<std::string, std::vector<const Member*>> members_at_;
};

/// Whether exactly one end of the member is at the point.
bool has_one_end_at(const Member& member, const std::string& point);

/// `scene.xml:12: XML path "...": value "tpi" is not a point of the scene; allowed: ...; did you mean "tip"?`
InputError unknown_name(const InputPlace& place, const std::string& what, const std::string& name,
                        const std::vector<std::string>& known);

}  // namespace mixbeam
