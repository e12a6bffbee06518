#include "discretization/reading/scene_parts.hpp"

#include "discretization/parameters/source.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/text/number_text.hpp"

#include <map>

namespace mixbeam {
namespace {

using Teuchos::ParameterList;

/// Parameters that each shape takes.
const std::map<std::string, std::vector<Form>> kForms = {{"line", {Form{}}},
                                                         {"arc",
                                                          {{{"Center", "Axis", "Angle"}},
                                                           {{"Through"}},
                                                           {{"Axis", "Radius"}},
                                                           {{"Start Tangent", "Axis", "Radius", "Angle"}}}},
                                                         {"helix", {{{"Center", "Axis", "Angle", "Rise"}}}},
                                                         {"spline", {{{"Through"}, {"Start Tangent", "End Tangent"}}}},
                                                         {"parametric", {{{"Formula"}, {"Range"}}}},
                                                         {"polyline", {{{"Through"}}, {{"Corners"}}}}};

BoundList<CurveDraft> declared_curve_parameters() {
  BoundList<CurveDraft> draft("Undeformed centerline of the member, from its start point to its end point.");
  draft.bind(&CurveDraft::shape, text("Shape").by_default(),
             "line: straight; arc: part of a circle; helix: part of a circular helix; spline: smooth through given "
             "points; parametric: by formulas; polyline: lines through given corners, each of which becomes a member "
             "\"<member>[1]\", \"<member>[2]\", ..., rigidly joined.",
             {{"line", CurveShape::line},
              {"arc", CurveShape::circular_arc},
              {"helix", CurveShape::helix},
              {"spline", CurveShape::spline},
              {"parametric", CurveShape::parametric},
              {"polyline", CurveShape::line}});
  draft.bind(&CurveDraft::center, bounded_vector("Center"),
             "arc: centre of the circle; helix: a point of its axis [length].");
  draft.bind(
      &CurveDraft::axis, direction("Axis"),
      "arc: normal of its plane; helix: direction of its axis; the curve turns right-handed about it (any length).");
  draft.bind(&CurveDraft::angle, real("Angle").above(0.0).at_most(kLargestAngle),
             "arc, helix: angle swept about the axis [radian].");
  draft.bind(&CurveDraft::rise, real("Rise").at_least(-kLargestCoordinate).at_most(kLargestCoordinate),
             "helix: rise along the axis over the whole angle, with sign [length].");
  draft.bind(&CurveDraft::radius, real("Radius").above(0.0).at_most(kLargestCoordinate),
             "arc: with Axis, the arc of at most half a turn between the two points; with Axis, Start Tangent and "
             "Angle, the arc that leaves the start point in this direction [length].");
  draft.bind(&CurveDraft::through_numbers, coordinates("Through"),
             "Coordinates of points between start and end, three for each: one point of an arc, the points of a "
             "spline, the corners of a polyline, which become points \"<member>[1]\", ... [length].");
  draft.bind(&CurveDraft::corner_names, array("Corners", ParameterType::text_array),
             "polyline: names of points between start and end, instead of Through.");
  draft.bind(
      [](auto& d) -> auto& { return d.end_tangents[0]; }, direction("Start Tangent"),
      "arc with Radius: its direction at the start; spline: likewise, no curvature there if absent (any length).");
  draft.bind(
      [](auto& d) -> auto& { return d.end_tangents[1]; }, direction("End Tangent"),
      "spline: its direction at the end; no curvature there if absent (any length).");
  draft.bind(
      &CurveDraft::formula, array("Formula", ParameterType::text_array, 3).or_other("a formula"),
      "parametric: x, y and z as formulas of t, in global axes; the start point must be where they begin [length].");
  draft.bind(&CurveDraft::range, coordinates("Range", 2), "parametric: t at start and end; {0, 1} if absent.");
  draft.spec.with_forms("Shape", kForms);
  return draft;
}

class CurveReader {
 public:
  CurveReader(const ParameterList& list, const InputPlace& place) : list_(list), place_(place) {}

  CurveDraft read() const {
    CurveDraft draft = curve_parameters().read(list_);
    const auto& shape = list_.get<std::string>("Shape");
    draft.is_polyline = shape == "polyline";
    if (shape == "arc") draft.arc = arc_definition(draft);
    if (shape == "spline") draft.through = positions(draft.through_numbers);
    if (shape == "parametric") check_formula(draft);
    if (draft.is_polyline) draft.corners = positions(draft.through_numbers);
    return draft;
  }

 private:
  InputError error(const std::string& parameter, const std::string& problem) const {
    return place_[parameter].error(problem);
  }

  std::vector<Vector3> positions(const std::vector<double>& values) const {
    if (values.size() % 3 != 0)
      throw error("Through", std::to_string(values.size()) + " numbers; allowed: three coordinates for each point");
    std::vector<Vector3> read;
    for (std::size_t i = 0; i < values.size(); i += 3) read.push_back({values[i], values[i + 1], values[i + 2]});
    return read;
  }

  std::optional<ArcDefinition> arc_definition(const CurveDraft& draft) const {
    if (list_.isParameter("Center")) return std::nullopt;
    ArcDefinition arc;
    if (list_.isParameter("Through")) {
      const std::vector<Vector3> points = positions(draft.through_numbers);
      if (points.size() != 1)
        throw error("Through", std::to_string(points.size()) + " points; allowed: one point for \"Shape\" = \"arc\"");
      arc.vector = points.front();
      return arc;
    }
    arc.radius = draft.radius;
    arc.given = ArcDefinition::Given::radius;
    if (list_.isParameter("Start Tangent")) {
      arc.given = ArcDefinition::Given::tangent;
      arc.vector = draft.end_tangents[0];
    }
    return arc;
  }

  void check_formula(const Curve& curve) const {
    if (curve.range[0] == curve.range[1])
      throw error("Range", "both ends are " + shortest(curve.range[0]) + "; allowed: two different numbers");
    constexpr int kSamples = 8;
    std::vector<std::vector<double>> samples;
    for (int i = 0; i <= kSamples; ++i)
      samples.push_back({curve.range[0] + (curve.range[1] - curve.range[0]) * i / kSamples});
    const InputPlace place = place_["Formula"];
    for (const std::string& formula : curve.formula)
      check_finite(checked_formula(formula, {"t"}, place), {"t"}, samples, place);
  }

  const ParameterList& list_;
  const InputPlace& place_;
};

}  // namespace

const BoundList<CurveDraft>& curve_parameters() {
  static const BoundList<CurveDraft> parameters = declared_curve_parameters();
  return parameters;
}

CurveDraft read_curve(const ParameterList& list, const InputPlace& place) { return CurveReader(list, place).read(); }

}  // namespace mixbeam
