#include "discretization/reading/curves.hpp"

#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/parameters/access.hpp"
#include "discretization/parameters/formula.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <array>

namespace mixbeam {
namespace {

using Teuchos::ParameterList;
using namespace vector_algebra;

/// One way to write a curve of a shape.
struct Form {
  std::vector<std::string> needed;
  std::vector<std::string> optional{};
};

const std::vector<std::string> kGeometry = {"Center",        "Axis",        "Angle",   "Rise",  "Radius", "Through",
                                            "Start Tangent", "End Tangent", "Formula", "Range", "Corners"};

const std::map<std::string, std::vector<Form>> kForms = {{"line", {{{}}}},
                                                         {"arc",
                                                          {{{"Center", "Axis", "Angle"}},
                                                           {{"Through"}},
                                                           {{"Axis", "Radius"}},
                                                           {{"Start Tangent", "Axis", "Radius", "Angle"}}}},
                                                         {"helix", {{{"Center", "Axis", "Angle", "Rise"}}}},
                                                         {"spline", {{{"Through"}, {"Start Tangent", "End Tangent"}}}},
                                                         {"parametric", {{{"Formula"}, {"Range"}}}},
                                                         {"polyline", {{{"Through"}}, {{"Corners"}}}}};

const std::map<std::string, CurveShape> kShapes = {
    {"line", CurveShape::line},     {"arc", CurveShape::circular_arc},      {"helix", CurveShape::helix},
    {"spline", CurveShape::spline}, {"parametric", CurveShape::parametric}, {"polyline", CurveShape::line}};

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// `"Center", "Axis", "Angle"; or "Through"`
std::string described(const std::vector<Form>& forms) {
  std::string text;
  for (const Form& form : forms) {
    std::vector<std::string> names = form.needed;
    names.insert(names.end(), form.optional.begin(), form.optional.end());
    text += (text.empty() ? "" : "; or ") + (names.empty() ? std::string("nothing else") : quoted_list(names));
  }
  return text;
}

class CurveReader {
 public:
  CurveReader(const ParameterList& list, const ParameterSource& source, const ParameterPath& path)
      : list_(list), source_(source), path_(path), shape_(list.get<std::string>("Shape")) {}

  CurveDraft read() const {
    check_form();
    CurveDraft draft;
    Curve& curve = draft.curve;
    curve.shape = kShapes.at(shape_);
    draft.is_polyline = shape_ == "polyline";
    if (list_.isParameter("Center")) curve.center = get_vector(list_, "Center");
    if (list_.isParameter("Axis")) curve.axis = direction("Axis");
    if (list_.isParameter("Angle")) curve.angle = list_.get<double>("Angle");
    if (list_.isParameter("Rise")) curve.rise = list_.get<double>("Rise");
    if (shape_ == "arc") draft.arc = arc_definition();
    if (shape_ == "spline") read_spline(curve);
    if (shape_ == "parametric") read_formula(curve);
    if (draft.is_polyline) read_corners(draft);
    return draft;
  }

 private:
  InputError error(const std::string& parameter, const std::string& problem) const {
    return source_.error(child(path_, parameter), problem);
  }

  /// What keeps the given parameters from being of this form: those missing and those too many.
  std::pair<std::vector<std::string>, std::vector<std::string>> misfits(const Form& form) const {
    std::vector<std::string> missing, too_many;
    for (const std::string& name : form.needed)
      if (!list_.isParameter(name)) missing.push_back(name);
    for (const std::string& name : kGeometry)
      if (list_.isParameter(name) && !contains(form.needed, name) && !contains(form.optional, name))
        too_many.push_back(name);
    return {missing, too_many};
  }

  void check_form() const {
    const std::vector<Form>& forms = kForms.at(shape_);
    const auto misfit_count = [this](const Form& form) {
      const auto [missing, too_many] = misfits(form);
      return missing.size() + too_many.size();
    };
    const auto nearest = std::min_element(
        forms.begin(), forms.end(), [&](const Form& a, const Form& b) { return misfit_count(a) < misfit_count(b); });
    const auto [missing, too_many] = misfits(*nearest);
    if (missing.empty() && too_many.empty()) return;
    const std::string problem = missing.empty() ? "given, but has no meaning for" : "missing; needed for";
    throw error(missing.empty() ? too_many.front() : missing.front(),
                problem + " \"Shape\" = \"" + shape_ + "\"; allowed with it: " + described(forms));
  }

  Vector3 direction(const std::string& name) const {
    const Vector3 vector = get_vector(list_, name);
    if (norm(vector) >= kShortestLength) return vector;
    throw error(name, "value " + to_text(vector) + " has no direction; allowed: any vector but zero");
  }

  std::vector<Vector3> positions(const std::string& name) const {
    const auto& values = list_.get<Teuchos::Array<double>>(name);
    if (values.size() % 3 != 0) {
      throw error(name, std::to_string(values.size()) + " numbers; allowed: three coordinates for each point");
    }
    std::vector<Vector3> read;
    for (Teuchos::Ordinal i = 0; i < values.size(); i += 3) read.push_back({values[i], values[i + 1], values[i + 2]});
    return read;
  }

  std::optional<ArcDefinition> arc_definition() const {
    if (list_.isParameter("Center")) return std::nullopt;
    ArcDefinition arc;
    if (list_.isParameter("Through")) {
      const std::vector<Vector3> points = positions("Through");
      if (points.size() != 1)
        throw error("Through", std::to_string(points.size()) + " points; allowed: one point for \"Shape\" = \"arc\"");
      arc.vector = points.front();
      return arc;
    }
    arc.radius = list_.get<double>("Radius");
    arc.given = ArcDefinition::Given::radius;
    if (list_.isParameter("Start Tangent")) {
      arc.given = ArcDefinition::Given::tangent;
      arc.vector = direction("Start Tangent");
    }
    return arc;
  }

  void read_spline(Curve& curve) const {
    curve.through = positions("Through");
    if (list_.isParameter("Start Tangent")) curve.end_tangents[0] = direction("Start Tangent");
    if (list_.isParameter("End Tangent")) curve.end_tangents[1] = direction("End Tangent");
  }

  void read_formula(Curve& curve) const {
    const auto& formula = list_.get<Teuchos::Array<std::string>>("Formula");
    if (list_.isParameter("Range")) {
      const auto& range = list_.get<Teuchos::Array<double>>("Range");
      curve.range = {range[0], range[1]};
    }
    if (curve.range[0] == curve.range[1])
      throw error("Range", "both ends are " + shortest(curve.range[0]) + "; allowed: two different numbers");
    constexpr int kSamples = 8;
    std::vector<std::vector<double>> samples;
    for (int i = 0; i <= kSamples; ++i)
      samples.push_back({curve.range[0] + (curve.range[1] - curve.range[0]) * i / kSamples});
    for (std::size_t i = 0; i < 3; ++i) {
      curve.formula[i] = formula[static_cast<Teuchos::Ordinal>(i)];
      const ParameterPath path = child(path_, "Formula");
      check_finite(checked_formula(curve.formula[i], {"t"}, source_, path), {"t"}, samples, source_, path);
    }
  }

  void read_corners(CurveDraft& draft) const {
    if (list_.isParameter("Through")) {
      draft.corners = positions("Through");
    } else {
      const auto& names = list_.get<Teuchos::Array<std::string>>("Corners");
      draft.corner_names.assign(names.begin(), names.end());
    }
  }

  const ParameterList& list_;
  const ParameterSource& source_;
  const ParameterPath& path_;
  const std::string shape_;
};

}  // namespace

ListSpec curve_spec() {
  ListSpec spec("Undeformed centerline of the member, from its start point to its end point.");
  spec.add(choice("Shape", {"line", "arc", "helix", "spline", "parametric", "polyline"})
               .by_default("line")
               .means("line: straight; arc: part of a circle; helix: part of a circular helix; spline: smooth through "
                      "given points; parametric: by formulas; polyline: lines through given corners, each of which "
                      "becomes a member \"<member>[1]\", \"<member>[2]\", ..., rigidly joined."));
  spec.add(bounded_vector("Center").means("arc: centre of the circle; helix: a point of its axis [length]."));
  spec.add(bounded_vector("Axis").means(
      "arc: normal of its plane; helix: direction of its axis; the curve turns right-handed about it (any length)."));
  spec.add(real("Angle").above(0.0).at_most(kLargestAngle).means("arc, helix: angle swept about the axis [radian]."));
  spec.add(real("Rise")
               .at_least(-kLargestCoordinate)
               .at_most(kLargestCoordinate)
               .means("helix: length gained along the axis over the whole angle, with sign [length]."));
  spec.add(real("Radius")
               .above(0.0)
               .at_most(kLargestCoordinate)
               .means("arc: with Axis, the arc of at most half a turn between the two points; with Axis, Start Tangent "
                      "and Angle, the "
                      "arc that leaves the start point in this direction [length]."));
  spec.add(array("Through", ParameterType::real_array)
               .at_least(-kLargestCoordinate)
               .at_most(kLargestCoordinate)
               .means("Coordinates of points between start and end, three for each: one point of an arc, the points "
                      "of a spline, the corners of a polyline, which become points \"<member>[1]\", ... [length]."));
  spec.add(array("Corners", ParameterType::text_array)
               .means("polyline: names of points between start and end, instead of Through."));
  spec.add(bounded_vector("Start Tangent")
               .means("arc with Radius: its direction at the start; spline: likewise, no curvature there if absent "
                      "(any length)."));
  spec.add(bounded_vector("End Tangent")
               .means("spline: its direction at the end; no curvature there if absent (any length)."));
  spec.add(array("Formula", ParameterType::text_array, 3)
               .means("parametric: x, y and z as formulas of t, in global axes; the start point must be where they "
                      "begin [length]."));
  spec.add(array("Range", ParameterType::real_array, 2)
               .at_least(-kLargestCoordinate)
               .at_most(kLargestCoordinate)
               .means("parametric: t at start and end; {0, 1} if absent."));
  return spec;
}

CurveDraft read_curve(const ParameterList& list, const ParameterSource& source, const ParameterPath& path) {
  return CurveReader(list, source, path).read();
}

}  // namespace mixbeam
