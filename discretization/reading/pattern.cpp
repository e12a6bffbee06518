#include "discretization/reading/pattern.hpp"

#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/scene/limits.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"

namespace mixbeam {
namespace {

BoundList<Pattern> declared_pattern_parameters() {
  BoundList<Pattern> pattern("Copies of members with their points; acts on the copies of the patterns before it too.");
  pattern.bind(&Pattern::members, array("Members", ParameterType::text_array).by_default(),
               "Names of the members; " + kWildcards + ".");
  pattern.bind(
      &Pattern::kind, text("Kind").required(),
      "repeat: translated by Vector, repeatedly; rotate: about an axis; mirror: reflected in a plane. Points and "
      "members of copies that coincide with existing ones become one with them.",
      {{"repeat", PatternKind::repeat}, {"rotate", PatternKind::rotate}, {"mirror", PatternKind::mirror}});
  pattern.bind(&Pattern::count, integer("Count").at_least(2).at_most(kMostElements),
               "repeat, rotate: number of instances of the members, the original included.");
  pattern.bind(&Pattern::vector, direction("Vector"), "repeat: from each copy to the next [length].");
  pattern.bind(&Pattern::center, bounded_vector("Center"), "rotate: a point of the axis [length].");
  pattern.bind(&Pattern::axis, direction("Axis"), "rotate: direction of the axis; right-handed (any length).");
  pattern.bind(&Pattern::angle, real("Angle").at_least(-kLargestAngle).at_most(kLargestAngle),
               "rotate: from each copy to the next [radian]; a whole turn over Count if absent.");
  pattern.bind(&Pattern::point, bounded_vector("Point"), "mirror: a point of the plane [length].");
  pattern.bind(&Pattern::normal, direction("Normal"), "mirror: normal of the plane (any length).");
  pattern.bind(
      &Pattern::scope, text("Copy").by_default(),
      "members: these with their points; joints: these as well; all: supports, loads and eigenstrains too, their "
      "directions turned with the copy, unless they act there by their names already.",
      {{"members", CopyScope::members}, {"joints", CopyScope::joints}, {"all", CopyScope::all}});
  pattern.spec.with_forms("Kind", {{"repeat", {{{"Vector", "Count"}}}},
                                   {"rotate", {{{"Center", "Axis", "Count"}, {"Angle"}}}},
                                   {"mirror", {{{"Point", "Normal"}}}}});
  return pattern;
}

}  // namespace

const BoundList<Pattern>& pattern_parameters() {
  static const BoundList<Pattern> parameters = declared_pattern_parameters();
  return parameters;
}

ListSpec patterns_spec() {
  return ListSpec("Copies of members, made in this order.").with_named_lists("pattern", pattern_parameters().spec);
}

std::vector<Isometry> motions_of(const Pattern& pattern) {
  if (pattern.kind == PatternKind::mirror) return {Isometry::reflection(pattern.point, pattern.normal)};
  std::vector<Isometry> motions;
  for (int i = 1; i < pattern.count; ++i) {
    const double angle = pattern.angle ? i * *pattern.angle : 2.0 * kPi * i / pattern.count;
    motions.push_back(pattern.kind == PatternKind::repeat ? Isometry::shift(vector_algebra::scaled(i, pattern.vector))
                                                          : Isometry::rotation(pattern.center, pattern.axis, angle));
  }
  return motions;
}

}  // namespace mixbeam
