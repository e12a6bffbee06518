#include "discretization/scene_parameters.hpp"

namespace mixbeam {
namespace {

const Teuchos::Array<std::string> kAllAxes = Teuchos::tuple<std::string>("x", "y", "z");
const Teuchos::Array<double> kZero(3, 0.0);
constexpr int kMostStages = 1000;
constexpr double kLargestCoordinate = 1e100;  // squares of lengths must not overflow
constexpr double kLargestAngle = 1e6;         // beyond that sine and cosine lose the digits that ends are compared with

/// A position or a direction.
ParameterSpec bounded_vector(const std::string& name) {
  return vector3(name).at_least(-kLargestCoordinate).at_most(kLargestCoordinate);
}

ParameterSpec stage(const std::string& what) {
  return integer("Stage")
      .at_least(1)
      .at_most(kMostStages)
      .by_default(1)
      .means(what + " from zero to full while the load factor goes from stage - 1 to stage, and stays after that.");
}

ListSpec section_spec() {
  ListSpec spec("Linear elastic section: a stiffness for each strain, in the section's own axes 1 (along), 2, 3.");
  spec.add(real("EA").above(0.0).or_infinite().means(
      "Axial stiffness [force]; inf or the switch Inextensible for none of the strain."));
  spec.add(real("GA2").above(0.0).or_infinite().means(
      "Shear stiffness in direction 2 [force]; inf or the switch Shear Rigid for none of the strain."));
  spec.add(real("GA3").above(0.0).or_infinite().means(
      "Shear stiffness in direction 3 [force]; inf or the switch Shear Rigid for none of the strain."));
  spec.add(real("GIt").above(0.0).required().means("Torsional stiffness [force * length^2]."));
  spec.add(real("EI2").above(0.0).required().means("Bending stiffness about axis 2 [force * length^2]."));
  spec.add(real("EI3").above(0.0).required().means("Bending stiffness about axis 3 [force * length^2]."));
  spec.add(boolean("Inextensible").by_default(false).means("True: no axial strain; EA must then not be given."));
  spec.add(boolean("Shear Rigid")
               .by_default(false)
               .means("True: no shear strain, sections stay normal to the axis; GA2 and GA3 must then not be given."));
  return spec;
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

ListSpec support_spec() {
  ListSpec spec("What keeps a point in place, in global axes; without further parameters a clamp.");
  spec.add(text("Point").required().means("Name of the point."));
  spec.add(subset("Fixed Displacement", {"x", "y", "z"})
               .by_default(kAllAxes)
               .means("Directions in which the point cannot move freely; {} for none."));
  spec.add(
      subset("Fixed Rotation", {"x", "y", "z"})
          .by_default(kAllAxes)
          .means(
              "Axes about which it cannot turn freely; {} for a ball joint, two of them for a hinge about the third."));
  spec.add(vector3("Prescribed Displacement")
               .by_default(kZero)
               .means("Displacement at the end of the stage, in fixed directions only [length]."));
  spec.add(
      vector3("Prescribed Rotation")
          .by_default(kZero)
          .means(
              "Rotation vector at the end of the stage, may exceed a turn; needs all three rotations fixed [radian]."));
  spec.add(stage("The prescribed motion grows"));
  return spec;
}

ListSpec point_load_spec() {
  ListSpec spec("A concentrated force and moment.");
  spec.add(text("Point").required().means("Name of the point."));
  spec.add(vector3("Force").by_default(kZero).means("Force [force]."));
  spec.add(vector3("Moment").by_default(kZero).means("Moment [force * length]."));
  spec.add(choice("Frame", {"dead", "follower"})
               .by_default("dead")
               .means("dead: components in global axes, direction kept; follower: components in the triad of Member at "
                      "this point, "
                      "which turns with it."));
  spec.add(text("Member").means("follower only: name of the member whose triad the components refer to."));
  spec.add(stage("The load grows"));
  return spec;
}

ListSpec distributed_load_spec() {
  ListSpec spec("A dead load per unit of undeformed length along a whole member, in global axes.");
  spec.add(text("Member").required().means("Name of the member."));
  spec.add(vector3("Force").by_default(kZero).means("Force per length [force / length]."));
  spec.add(vector3("Couple").by_default(kZero).means("Moment per length [force]."));
  spec.add(stage("The load grows"));
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
  spec.add_list("Supports", ListSpec("Supports.").with_named_lists("support", support_spec(), 1), Presence::required);
  spec.add_list("Point Loads", ListSpec("Loads at points.").with_named_lists("load", point_load_spec()));
  spec.add_list("Distributed Loads",
                ListSpec("Loads along members.").with_named_lists("load", distributed_load_spec()));
  return spec;
}

}  // namespace mixbeam
