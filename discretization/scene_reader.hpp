/// The work behind read_scene (scene_parameters.hpp): one pass over a validated list, with every check that needs more
/// than one parameter at a time. Supports, loads and all else that acts are in scene_reader_conditions.hpp.
#pragma once

#include "discretization/parameter_source.hpp"
#include "discretization/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>
#include <unordered_map>
#include <vector>

namespace mixbeam {

class SceneReader {
 public:
  SceneReader(const Teuchos::ParameterList& list, const ParameterSource& source, ParameterPath path);

  Scene read();

 private:
  using List = Teuchos::ParameterList;
  using Index = std::unordered_map<std::string, std::size_t>;

  void read_sections();
  void read_points();
  void read_members();
  void place_curve_ends();
  void check_members();
  void check_points_are_used() const;

  Curve read_curve(const List& list, const ParameterPath& path) const;
  void place_curve_end(std::size_t member_index);
  void check_curve(const Member& member) const;
  void check_line(const Member& member) const;
  void check_second_axis(const Member& member) const;

  InputError unknown(const ParameterPath& path, const std::string& what, const std::string& name,
                     const Index& known) const;
  ParameterPath member_path(const Member& member, const std::string& parameter = "") const;
  const Vector3& position_of(const std::string& point) const;

  const List& list_;
  const ParameterSource& source_;
  const ParameterPath path_;
  Scene scene_;
  Index section_index_, point_index_, member_index_;
  std::vector<bool> point_touched_;
};

}  // namespace mixbeam
