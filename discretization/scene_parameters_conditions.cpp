/// Declaration of everything that acts on a structure: supports, joints, loads, eigenstrains.

#include "discretization/scene_reader_conditions.hpp"

namespace mixbeam {
namespace {

const Teuchos::Array<std::string> kAllAxes = Teuchos::tuple<std::string>("x", "y", "z");
const Teuchos::Array<double> kZero(3, 0.0);
constexpr int kMostStages = 1000;

ParameterSpec stage(const std::string& what) {
  return integer("Stage")
      .at_least(1)
      .at_most(kMostStages)
      .by_default(1)
      .means(what + " from zero to full while the load factor goes from stage - 1 to stage, and stays after that.");
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

void add_condition_lists(ListSpec& spec) {
  spec.add_list("Supports", ListSpec("Supports.").with_named_lists("support", support_spec(), 1), Presence::required);
  spec.add_list("Point Loads", ListSpec("Loads at points.").with_named_lists("load", point_load_spec()));
  spec.add_list("Distributed Loads",
                ListSpec("Loads along members.").with_named_lists("load", distributed_load_spec()));
}

}  // namespace mixbeam
