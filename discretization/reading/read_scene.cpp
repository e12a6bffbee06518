#include "discretization/reading/read_scene.hpp"

#include "discretization/reading/conditions/read_conditions.hpp"
#include "discretization/reading/curves.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/reading/patterns.hpp"
#include "discretization/reading/sections.hpp"
#include "discretization/scene/limits.hpp"

namespace mixbeam {
namespace {

void add_section_along(ListSpec& spec) {
  spec.add(text("Section").required().means("Name of its section."));
  spec.add(text("End Section").means("Name of the section at its end: the section changes from start to end."));
  spec.add(
      text("Taper").means("with End Section: its weight as a formula of x = arc length over length of the member, "
                          "0 for the section of the start, 1 for that of the end; x itself if absent."));
}

void add_division(ListSpec& spec) {
  spec.add(integer("Order").at_least(1).at_most(8).by_default(2).means("Polynomial order k of its elements."));
  spec.add(integer("Elements")
               .at_least(1)
               .at_most(kMostElements)
               .by_default(1)
               .means("Number of elements: of equal length, or as equal as the inner points permit, at least one "
                      "between two of them; a polyline shares them out by length, at least one for each line."));
  spec.add(array("Stations", ParameterType::real_array)
               .at_least(0.0)
               .at_most(1.0)
               .means("Ends of all elements as arc length over length of the member, from 0 to 1, instead of Elements; "
                      "inner points must be among them."));
  spec.add_list("Inner Points",
                ListSpec("Points inside the member, where other members may join and supports and loads may act.")
                    .with_named_parameters("point", real("").above(0.0).below(1.0).required().means(
                                                        "Arc length over length of the member; the name may be new.")),
                Presence::optional);
}

ListSpec member_spec() {
  ListSpec spec("A beam between two points, rigidly joined to all members that share a point with it.");
  spec.add(text("Start").required().means("Name of the point where the member starts."));
  spec.add(text("End").required().means(
      "Name of the point where it ends; a new name is allowed where the position follows from the curve: helix, "
      "parametric, arc by Angle."));
  add_section_along(spec);
  add_division(spec);
  spec.add(choice("Force Integration", {"full", "axial reduced", "shear reduced", "both reduced"})
               .by_default("both reduced")
               .means("Which part of the force-strain energy takes k instead of k + 1 Gauss points; only 'both "
                      "reduced' is free of locking."));
  spec.add(bounded_vector("Second Axis")
               .means("Direction that section axis 2 takes at the start, as nearly as the tangent permits; the program "
                      "chooses one if it is absent."));
  spec.add(real("Twist")
               .at_least(-kLargestAngle)
               .at_most(kLargestAngle)
               .means("Pre-twist: angle by which the section turns about the tangent from start to end [radian]."));
  spec.add_list("Curve", curve_spec(), Presence::optional);
  return spec;
}

}  // namespace

ListSpec scene_spec() {
  ListSpec spec(
      "The structure, its supports and its loads; any consistent units, angles in radians, global axes x, y, z.");
  spec.add_list("Sections", ListSpec("Cross sections.").with_named_lists("section", section_spec(), 1),
                Presence::required);
  spec.add_list("Points", ListSpec("Points of the undeformed structure; at least one here or by Import.")
                              .with_named_parameters(
                                  "point", bounded_vector("").required().means("Global coordinates [length].")));
  spec.add_list("Members",
                ListSpec("Beams; at least one here or by Import.").with_named_lists("member", member_spec()));
  spec.add_list("Import", import_spec(), Presence::optional);
  spec.add_list("Patterns", patterns_spec(), Presence::optional);
  spec.add(
      real("Accuracy")
          .above(kBestAccuracy)
          .below(1.0)
          .means("Wanted error of displacements over the largest of them, at the end of the path: order and number "
                 "of elements are chosen for every member that does not give them itself."));
  add_condition_lists(spec);
  return spec;
}

}  // namespace mixbeam
