#include "discretization/scene_parameters.hpp"

#include "discretization/scene_reader_conditions.hpp"
#include "discretization/scene_reader_sections.hpp"

namespace mixbeam {
namespace {

constexpr double kLargestCoordinate = 1e100;  // squares of lengths must not overflow
constexpr double kLargestAngle = 1e6;         // beyond that sine and cosine lose the digits that ends are compared with

/// A position or a direction.
ParameterSpec bounded_vector(const std::string& name) {
  return vector3(name).at_least(-kLargestCoordinate).at_most(kLargestCoordinate);
}

ListSpec curve_spec() {
  ListSpec spec("Undeformed centerline of the member, from its start point to its end point.");
  spec.add(choice("Shape", {"line", "arc", "helix"})
               .by_default("line")
               .means("line: straight; arc: part of a circle; helix: part of a circular helix."));
  spec.add(bounded_vector("Center").means("arc: centre of the circle; helix: a point of its axis [length]."));
  spec.add(bounded_vector("Axis").means(
      "arc: normal of its plane; helix: direction of its axis; the curve turns right-handed about it (any length)."));
  spec.add(real("Angle").above(0.0).at_most(kLargestAngle).means("arc, helix: angle swept about the axis [radian]."));
  spec.add(real("Rise")
               .at_least(-kLargestCoordinate)
               .at_most(kLargestCoordinate)
               .means("helix: length gained along the axis over the whole angle, with sign [length]."));
  return spec;
}

ListSpec member_spec() {
  ListSpec spec("A beam between two points, rigidly joined to all members that share a point with it.");
  spec.add(text("Start").required().means("Name of the point where the member starts."));
  spec.add(
      text("End").required().means("Name of the point where it ends; for arc and helix a new name is allowed, the "
                                   "position follows from the curve."));
  spec.add(text("Section").required().means("Name of its section."));
  spec.add(integer("Order").at_least(1).at_most(8).by_default(2).means("Polynomial order k of its elements."));
  spec.add(integer("Elements")
               .at_least(1)
               .at_most(kMostElements)
               .by_default(1)
               .means("Number of elements of equal length."));
  spec.add(choice("Force Integration", {"full", "axial reduced", "shear reduced", "both reduced"})
               .by_default("both reduced")
               .means("Which part of the force-strain energy takes k instead of k + 1 Gauss points; only 'both "
                      "reduced' is free of locking."));
  spec.add(bounded_vector("Second Axis")
               .means("Direction that section axis 2 takes at the start, as nearly as the tangent permits; the program "
                      "chooses one "
                      "if it is absent."));
  spec.add_list("Curve", curve_spec());
  return spec;
}

}  // namespace

ListSpec scene_spec() {
  ListSpec spec(
      "The structure, its supports and its loads; any consistent units, angles in radians, global axes x, y, z.");
  spec.add_list("Sections", ListSpec("Cross sections.").with_named_lists("section", section_spec(), 1),
                Presence::required);
  spec.add_list(
      "Points",
      ListSpec("Points of the undeformed structure.")
          .with_named_parameters("point", bounded_vector("").required().means("Global coordinates [length]."), 1),
      Presence::required);
  spec.add_list("Members", ListSpec("Beams.").with_named_lists("member", member_spec(), 1), Presence::required);
  add_condition_lists(spec);
  return spec;
}

}  // namespace mixbeam
