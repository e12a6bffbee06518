#include "discretization/reading/read_scene.hpp"

#include "discretization/reading/conditions/read_conditions.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/reading/members.hpp"
#include "discretization/reading/patterns.hpp"
#include "discretization/reading/sections.hpp"
#include "discretization/scene/limits.hpp"

namespace mixbeam {
ListSpec scene_spec() {
  ListSpec spec(
      "The structure, its supports and its loads; any consistent units, angles in radians, global axes x, y, z.");
  spec.add_list("Sections", ListSpec("Cross sections.").with_named_lists("section", section_spec(), 1),
                Presence::required);
  spec.add_list("Points", ListSpec("Points of the undeformed structure; at least one here or by Import.")
                              .with_named_parameters(
                                  "point", bounded_vector("").required().means("Global coordinates [length].")));
  spec.add_list(
      "Members",
      ListSpec("Beams; at least one here or by Import.").with_named_lists("member", member_parameters().spec));
  spec.add_list("Import", import_spec(), Presence::optional);
  spec.add_list("Patterns", patterns_spec(), Presence::optional);
  spec.add(real("Accuracy").above(kBestAccuracy).below(1.0),
           "Wanted error of displacements over the largest of them, at the end of the path: order and number of "
           "elements are chosen for every member that does not give them itself.");
  add_condition_lists(spec);
  return spec;
}

}  // namespace mixbeam
