/// Declaration of everything that acts on a structure: supports, joints, loads, eigenstrains, load cases.

#include "discretization/reading/conditions/read_conditions.hpp"

namespace mixbeam {
namespace {

const Teuchos::Array<std::string> kAllAxes = Teuchos::tuple<std::string>("x", "y", "z");
const Teuchos::Array<double> kZero(3, 0.0);
constexpr int kMostStages = 1000;
constexpr double kLargestDirection = 1e100;  // squares of its components must not overflow

/// What follows the name of a point or member that may stand for many.
const std::string kWildcard = "; * stands for any characters, and every match is meant.";

ParameterSpec direction(const std::string& name) {
  return vector3(name).at_least(-kLargestDirection).at_most(kLargestDirection);
}

ParameterSpec formulas(const std::string& name) { return array(name, ParameterType::text_array, 3); }

/// Stage, amplitude and case of whatever acts.
void add_schedule(ListSpec& spec, const std::string& what) {
  spec.add(integer("Stage")
               .at_least(1)
               .at_most(kMostStages)
               .by_default(1)
               .means(what +
                      " from zero to full while the load factor goes from stage - 1 to stage, and stays after that; "
                      "with an amplitude: the load factor runs at least up to this number."));
  spec.add(text("Amplitude")
               .means("Factor of all components as a formula of t = load factor, like sin(pi*t); instead "
                      "of the growth in one stage."));
  spec.add(text("Case").means("Load case, one of \"Load Cases\", in which alone it acts; in all of them if absent."));
}

ListSpec support_spec() {
  ListSpec spec(
      "What keeps a point in place, along global axes unless Axes are given; without further parameters a "
      "clamp.");
  spec.add(text("Point").required().means("Name of the point" + kWildcard));
  spec.add(subset("Fixed Displacement", {"x", "y", "z"})
               .by_default(kAllAxes)
               .means("Directions in which the point cannot move freely; {} for none."));
  spec.add(subset("Fixed Rotation", {"x", "y", "z"})
               .by_default(kAllAxes)
               .means("Axes about which it cannot turn freely; {} for a ball joint, two of them for a hinge about the "
                      "third, one of them to hold that component of the rotation vector at zero."));
  spec.add(array("Axes", ParameterType::real_array, 6)
               .at_least(-kLargestDirection)
               .at_most(kLargestDirection)
               .means("Directions of the support's own axes x and y in global components, {x1, x2, x3, y1, y2, y3}, of "
                      "any length; of y only the part normal to x counts, and z = x cross y. All other parameters of "
                      "the support refer to these axes."));
  spec.add(vector3("Prescribed Displacement")
               .by_default(kZero)
               .means("Displacement at the end of the stage, in fixed directions only [length]."));
  spec.add(
      vector3("Prescribed Rotation")
          .by_default(kZero)
          .means(
              "Rotation vector at the end of the stage, may exceed a turn; needs all three rotations fixed [radian]."));
  spec.add(vector3("Displacement Stiffness")
               .at_least(0.0)
               .by_default(kZero)
               .means("Springs to the ground in directions that are not fixed; 0 for none [force / length]."));
  spec.add(vector3("Rotation Stiffness")
               .at_least(0.0)
               .by_default(kZero)
               .means("Springs on the components of the rotation vector that are not fixed; 0 for none [force * length "
                      "/ radian]."));
  add_schedule(spec, "The prescribed motion grows");
  return spec;
}

ListSpec joint_spec() {
  ListSpec spec(
      "A connection that gives way: each listed member ends in its own joint with the rest of what meets at "
      "the point; members not listed stay rigidly connected, and supports and loads of the point act on them.");
  spec.add(text("Point").required().means("Name of the point."));
  spec.add(array("Members", ParameterType::text_array)
               .required()
               .means("Names of members that have one end at the point, like {strut 1, strut 2}" + kWildcard));
  spec.add(choice("Kind", {"hinge", "ball", "slider"})
               .required()
               .means("hinge: free to turn about Axis; ball: free to turn about any axis; slider: free to move along "
                      "Axis, not to turn."));
  spec.add(
      direction("Axis").means("hinge, slider: direction in the undeformed structure, in global components, of any "
                              "length; it turns with the members not listed."));
  spec.add(real("Stiffness")
               .at_least(0.0)
               .by_default(0.0)
               .means("hinge, slider: of a spring against the free motion [force * length / radian, force / length]."));
  spec.add(boolean("Together")
               .by_default(false)
               .means("Whether the listed members stay rigidly connected to each other and share one joint, like the "
                      "halves of a bar that crosses another one at a pin; otherwise each has its own."));
  return spec;
}

ListSpec point_load_spec() {
  ListSpec spec("A concentrated force and moment.");
  spec.add(text("Point").required().means("Name of the point" + kWildcard));
  spec.add(vector3("Force").by_default(kZero).means("Force [force]."));
  spec.add(vector3("Moment").by_default(kZero).means("Moment [force * length]."));
  spec.add(choice("Frame", {"dead", "follower"})
               .by_default("dead")
               .means("dead: components in global axes, direction kept; follower: components in the triad of Member at "
                      "this point, which turns with it."));
  spec.add(
      text("Member").means("follower only: name of the member whose triad the components refer to; * stands for "
                           "any characters, but must leave one member at each point."));
  add_schedule(spec, "The load grows");
  return spec;
}

ListSpec distributed_load_spec() {
  ListSpec spec("A load per unit of undeformed length along a whole member.");
  spec.add(text("Member").required().means("Name of the member" + kWildcard));
  spec.add(vector3("Force").by_default(kZero).means("Force per length [force / length]."));
  spec.add(vector3("Couple").by_default(kZero).means("Moment per length [force]."));
  spec.add(formulas("Force Formula")
               .means("Instead of Force: its components as formulas of s = arc length from the start of the member and "
                      "x = s / length, like {0, 0, -3*(1 - x)}."));
  spec.add(formulas("Couple Formula").means("Instead of Couple: its components as formulas of s and x."));
  spec.add(choice("Frame", {"dead", "follower"})
               .by_default("dead")
               .means("dead: components in global axes, direction kept; follower: components in the triad of the "
                      "section on which the load acts, which turns with it."));
  add_schedule(spec, "The load grows");
  return spec;
}

ListSpec eigenstrain_spec() {
  ListSpec spec(
      "Strain of a whole member without any stress: temperature, growth, actuation; components in the axes 1 "
      "(along), 2, 3 of the section.");
  spec.add(text("Member").required().means("Name of the member" + kWildcard));
  spec.add(vector3("Strain").by_default(kZero).means("Axial strain and the shear strains in directions 2 and 3 [1]."));
  spec.add(vector3("Curvature")
               .by_default(kZero)
               .means("Twist and the curvatures about axes 2 and 3, on top of those of the undeformed member [radian / "
                      "length]."));
  spec.add(formulas("Strain Formula")
               .means("Instead of Strain: its components as formulas of s = arc length from the start of the member "
                      "and x = s / length."));
  spec.add(formulas("Curvature Formula").means("Instead of Curvature: its components as formulas of s and x."));
  spec.add(real("Temperature")
               .means("Change of temperature; adds itself times Expansion Coefficient to the axial "
                      "strain [kelvin]."));
  spec.add(real("Expansion Coefficient").means("With Temperature: axial strain for each degree [1 / kelvin]."));
  add_schedule(spec, "The strain grows");
  return spec;
}

}  // namespace

void add_condition_lists(ListSpec& spec) {
  spec.add(
      array("Load Cases", ParameterType::text_array)
          .or_empty()
          .means("Names of alternatives that are solved one by one, each from the undeformed structure, like {wind, "
                 "snow}; what acts says by Case to which of them it belongs."));
  spec.add_list("Supports", ListSpec("Supports.").with_named_lists("support", support_spec(), 1), Presence::required);
  spec.add_list("Joints", ListSpec("Connections that are not rigid.").with_named_lists("joint", joint_spec()));
  spec.add_list("Point Loads", ListSpec("Loads at points.").with_named_lists("load", point_load_spec()));
  spec.add_list("Distributed Loads",
                ListSpec("Loads along members.").with_named_lists("load", distributed_load_spec()));
  spec.add_list("Eigenstrains",
                ListSpec("Strains without stress.").with_named_lists("eigenstrain", eigenstrain_spec()));
}

}  // namespace mixbeam
