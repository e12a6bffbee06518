/// The work behind read_scene (reading/read_scene.hpp): one pass over a validated list, with every check that needs
/// more than one parameter at a time. What acts on the structure is in conditions/, see scene_parts.hpp.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/reading/variables.hpp"
#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>
#include <unordered_map>
#include <vector>

namespace mixbeam {

class SceneReader {
 public:
  SceneReader(const Teuchos::ParameterList& list, const InputPlace& place, Variables& variables);

  Scene read();
  /// What was left out where patterns end, and why.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  using List = Teuchos::ParameterList;
  using Index = std::unordered_map<std::string, std::size_t>;

  /// Where a member was written: a list of "Members", or a line of the imported table.
  struct Origin {
    bool is_imported;
    std::size_t place;  ///< in list_names_, or the line of the table
  };

  /// The lines that a polyline becomes.
  struct Polyline {
    std::size_t first_member, lines;
    int elements;  ///< of all of them
  };

  // The scene, sections, points.
  void read_lists();
  void read_units();
  void read_sections();
  void read_points();
  void import_points();
  void check_points_are_used();
  void touch_point(const std::string& point);
  void check_name(const std::string& name, const InputPlace& place) const;
  /// False if there is a point of this name.
  bool add_point(const std::string& name, const Vector3& position);
  const Vector3& position_of(const std::string& point) const;

  // Members, apart from where they are.
  void read_members();
  /// What its parameters say together.
  void complete(Member& member, const List& list, const InputPlace& place) const;
  /// Of a member that names none: where the scene has one section, that is meant.
  void take_only_section(Member& member) const;
  void check_inner_points(Member& member, const InputPlace& place) const;
  void read_stations(Member& member, const List& list, const InputPlace& place) const;
  void check_taper(const Member& member, const InputPlace& place) const;
  void check_orientation(const Member& member, const InputPlace& place) const;
  void add_arm(Member& member, bool at_start, const Vector3& offset, const InputPlace& place, std::size_t list_name);
  std::string rigid_section();
  void add_stations(Member whole, const List& list, const InputPlace& place, std::size_t list_name);
  void add_polyline(const Member& whole, const CurveDraft& draft, std::size_t list_name);
  std::vector<std::string> polyline_points(const Member& whole, const CurveDraft& draft, const InputPlace& place);
  void check_plain(const List& list, const InputPlace& place) const;
  void import_members();
  void add_member(Member member, Origin origin);

  // Where members are.
  void place_members();
  void place_member(std::size_t member);
  std::vector<std::string> points_needed(const Member& member) const;
  void complete_open_arc(std::size_t member);
  void place_point(const PointOfMember& placed, std::size_t member);
  ReferenceCurve reference_curve_of(std::size_t member) const;
  void share_out_elements();
  void check_members();
  void check_member(std::size_t member);
  InputPlace geometry_of(std::size_t member) const;
  /// A mistake unless something bears the name; the nearest one then stands in its place.
  void check_known(std::size_t member, std::string Member::*name, const std::string& parameter, const std::string& what,
                   const Index& known);
  void check_curve(std::size_t member) const;
  void check_line(std::size_t member) const;
  void check_taper_values(std::size_t member) const;
  void check_second_axis(std::size_t member) const;

  InputError member_error(std::size_t member, const ParameterPath& parameter, const std::string& problem) const;

  const List& list_;
  const InputPlace place_;
  Variables& variables_;
  std::vector<std::string> notes_;
  Scene scene_;
  Index section_index_, point_index_, member_index_;
  std::vector<bool> point_touched_;
  std::vector<std::string> list_names_;  ///< of the list "Members"
  std::vector<Origin> origins_;          ///< of every member
  std::optional<ImportTable> imported_members_;
  std::size_t declared_points_ = 0;  ///< those of the list "Points", which come first
  long long elements_ = 0;           ///< of all members so far
  std::vector<Polyline> polylines_;
  std::unordered_map<std::size_t, ArcDefinition> open_arcs_;  ///< member -> what its centre, axis, angle follow from
};

}  // namespace mixbeam
