/// The parts of a scene as parameters: declarations, and reading each from its validated list at `place`. All of these
/// throw InputError.
#pragma once

#include "discretization/geometry/isometry.hpp"
#include "discretization/geometry/placement.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace mixbeam {

/// Declaration of one section: stiffness values, or a shape with a material, or a stiffness matrix.
ListSpec section_spec();
/// Parameters of a section that a profile of the catalogue gives: its shape, then lengths.
const std::vector<std::string>& profile_parameters();
/// Replaces the parameter "Profile" in the list of a section by the parameters of that profile.
using ProfileFinder =
    std::function<Teuchos::ParameterList(const Teuchos::ParameterList& section, const InputPlace& place)>;
/// The list "Sections".
std::vector<Section> read_sections(const Teuchos::ParameterList& sections, const InputPlace& place,
                                   const ProfileFinder& profile);

/// A curve as written; some curves are complete only when the positions of their ends are known.
struct CurveDraft : Curve {
  std::optional<ArcDefinition> arc{};  ///< an arc without centre or angle
  double radius = 0.0;
  std::vector<double> through_numbers{};  ///< three coordinates for each point
  bool is_polyline = false;
  std::vector<Vector3> corners{};           ///< polyline: positions of its inner corners ...
  std::vector<std::string> corner_names{};  ///< ... or their names
};
/// Parameters of the list "Curve".
const BoundList<CurveDraft>& curve_parameters();
CurveDraft read_curve(const Teuchos::ParameterList& list, const InputPlace& place);

/// Parameters of one member. A new property of members is a field of Member, a line there, and its use.
const BoundList<Member>& member_parameters();

/// One copy by a pattern: names of originals and of their images. Members are those that were made; a point may have
/// existed before.
struct PatternCopy {
  Isometry motion;
  std::unordered_map<std::string, std::string> points{}, members{};
  bool joints_alone = false;  ///< supports and loads are not copied
};
using CopiedPattern = std::vector<PatternCopy>;

/// Declaration of the list "Patterns": copies of members and their points, so that lattices are short to write.
ListSpec patterns_spec();
/// Applies patterns in order to a scene whose members are complete and checked; a later pattern also copies what
/// earlier ones made.
///
/// Copy number i of "strut" is "strut (i)", that of a copy "strut (i, j)"; points likewise. A point of a copy that
/// coincides (to 1e-9 of the size of the structure) with a point that existed before this copy is merged with it, and a
/// member that coincides with an existing one is not added again. Two such members must agree in section, order and
/// elements, and in the direction of axis 2 up to sign if the section has one. Returns the copies by those patterns
/// that also copy joints or loads.
std::vector<CopiedPattern> apply_patterns(const Teuchos::ParameterList& patterns, const InputPlace& place,
                                          Scene& scene);

/// Declaration of the list "Imperfection".
ListSpec imperfection_spec();
/// Moves points and members of a complete scene; modes are left to with_mode_shapes().
void apply_imperfection(const Teuchos::ParameterList& list, const InputPlace& place, Scene& scene);

/// Declares the lists "Supports", "Joints", "Point Loads", ... inside the list "Scene": what acts on the structure.
void add_condition_lists(ListSpec& scene_spec);
/// Reads those lists into a scene that has all its points and members, and copies their entries with `copies`. `place`:
/// of the list "Scene". Returns what was left out at the ends of patterns, and why.
std::vector<std::string> read_conditions(const Teuchos::ParameterList& scene_list, const InputPlace& place,
                                         Scene& scene, const std::vector<CopiedPattern>& copies);

}  // namespace mixbeam
