/// The list "Imperfection": a stress-free geometry that differs from the perfect one.

#include "discretization/geometry/point_grid.hpp"
#include "discretization/geometry/reference_curve.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

namespace mixbeam {

namespace {

using namespace vector_algebra;

/// A direction nearer to the member than this has no part across it. [1]
constexpr double kAcross = 1e-6;

/// Distance of equal points over the size of the structure: measured coordinates have six digits.
constexpr double kSamePoint = 1e-6;

struct Bow {
  std::string member{};
  std::optional<double> amplitude{}, share{};
  Vector3 direction{};
};
struct Sway {
  double ratio = 0.0;
  Vector3 direction{}, up{0, 0, 1};
};

BoundList<Bow> bow_parameters() {
  BoundList<Bow> bow("A half sine over the length of a straight member.");
  bow.bind(&Bow::member, text("Member").required(), "Name of the member; " + kWildcards + ".");
  bow.bind(&Bow::amplitude, real("Amplitude"), "Offset of the middle [length].");
  bow.bind(&Bow::share, real("Share"), "Instead of Amplitude: the offset over the length of the member, like 0.002.");
  bow.bind(&Bow::direction, direction("Direction").required(), "Of the offset; its part across the member counts.");
  return bow;
}

BoundList<Sway> sway_parameters() {
  BoundList<Sway> sway("Initial sway of the whole structure: each point is offset by its height times a ratio.");
  sway.bind(&Sway::ratio, real("Ratio").required(), "Offset over height, like 0.005.");
  sway.bind(&Sway::direction, direction("Direction").required(), "Of the offset (any length).");
  sway.bind(&Sway::up, direction("Up").by_default(), "Direction in which heights grow, from the lowest point.");
  return sway;
}

BoundList<ModeImperfection> mode_parameters() {
  BoundList<ModeImperfection> mode("A mode in which the structure as it was drawn buckles.");
  mode.bind(&ModeImperfection::mode, integer("Mode").at_least(1).at_most(100),
            "Number of the mode of linear buckling, by growing positive load factor.");
  mode.bind(&ModeImperfection::critical_point, integer("Critical Point").at_least(1).at_most(100),
            "Instead of Mode: number of the limit point or bifurcation, counted from 1, on the path of the structure "
            "as it was drawn, which is followed first; its mode with the sign that result files have.");
  mode.bind(&ModeImperfection::amplitude, real("Amplitude").required(),
            "Largest displacement of a vertex, with a sign [length].");
  return mode;
}

std::string in_formula(double number) { return "(" + shortest(number) + ")"; }

/// Moves the perfect geometry; members and points of the scene are complete.
class Imperfection {
 public:
  Imperfection(const Teuchos::ParameterList& list, const InputPlace& place, Scene& scene)
      : list_(list), place_(place), scene_(scene), names_(scene) {
    for (std::size_t i = 0; i < scene.points.size(); ++i) point_index_[scene.points[i].name] = i;
  }

  void apply() {
    if (list_.isSublist("Sway")) lean(sway_parameters().read(list_.sublist("Sway")));
    if (list_.isSublist("Points")) shift(list_.sublist("Points"));
    if (list_.isParameter("Points File")) shift_by_table();
    for (const std::string& name : names_in("Bows"))
      bend(bow_parameters().read(list_.sublist("Bows").sublist(name)), place_["Bows"][name]);
    for (const std::string& name : names_in("Modes")) add_mode(name);
    if (list_.isParameter("Case")) scene_.imperfection_case = list_.get<std::string>("Case");
  }

 private:
  void add_mode(const std::string& name) {
    ModeImperfection mode = mode_parameters().read(list_.sublist("Modes").sublist(name));
    mode.name = name;
    if (mode.mode && mode.critical_point)
      throw place_["Modes"][name].error("both of \"Mode\" and \"Critical Point\" given; allowed: exactly one");
    if (!mode.mode && !mode.critical_point)
      throw place_["Modes"][name]["Mode"].error("missing; needed: its number, or that of a \"Critical Point\"");
    scene_.imperfection_modes.push_back(mode);
  }

  std::vector<std::string> names_in(const std::string& list) const {
    return list_.isSublist(list) ? names_of(list_.sublist(list)) : std::vector<std::string>{};
  }
  Vector3& position(const std::string& point) { return scene_.points[point_index_.at(point)].position; }

  void require_line(const Member& member, const InputPlace& place, const std::string& what) const {
    if (member.curve.shape == CurveShape::line) return;
    throw place.error("member \"" + excerpt(member.name) + "\" is curved; allowed for " + what +
                      ": straight members (\"Modes\" bend curved ones too)");
  }

  void lean(const Sway& sway) {
    for (const Member& member : scene_.members) require_line(member, place_["Sway"], "a sway");
    const Vector3 up = unit(sway.up), along = unit(sway.direction);
    if (norm(cross(up, along)) < kAcross)
      throw place_["Sway"]["Direction"].error("along \"Up\"; allowed: across it, as what leans does");
    double lowest = std::numeric_limits<double>::infinity();
    for (const Point& point : scene_.points) lowest = std::min(lowest, dot(point.position, up));
    for (Point& point : scene_.points)
      point.position = sum(point.position, scaled(sway.ratio * (dot(point.position, up) - lowest), along));
  }

  using Refused = std::function<InputError(const std::string& problem)>;

  void shift(const Teuchos::ParameterList& points) {
    for (const std::string& name : names_of(points)) {
      const InputPlace place = place_["Points"][name];
      if (point_index_.count(name) == 0) throw unknown_name(place, "point", name, names_.point_names());
      shift(name, get_vector(points, name), [&](const std::string& problem) { return place.error(problem); });
    }
  }

  void shift(const std::string& name, const Vector3& offset, const Refused& refused) {
    if (const auto* members = names_.members_at(name))
      for (const Member* member : *members) {
        if (member->curve.shape != CurveShape::line)
          throw refused("member \"" + excerpt(member->name) +
                        "\" is curved; allowed for a point that moves: straight " +
                        "members (\"Modes\" bend curved ones too)");
        if (!member->inner_points.empty())
          throw refused("member \"" + excerpt(member->name) +
                        "\" has inner points, which would leave it; allowed: ends of members without");
      }
    position(name) = sum(position(name), offset);
  }

  void shift_by_table() {
    const ImportTable table = import_table(list_, "Points File", place_, {"dx", "dy", "dz", "name", "x", "y", "z"}, 3);
    Box box;
    for (const Point& point : scene_.points) box.enclose(point.position);
    const double tolerance = std::max(kSamePoint * box.diagonal(), kShortestLength);
    const std::vector<Point> drawn = scene_.points;
    const PointGrid grid(drawn, 4.0 * tolerance);
    table.for_each([&](const CsvRecord& record) {
      std::string name = table.cell(record, "name");
      const std::string column = name.empty() ? "x" : "name";
      if (!name.empty() && point_index_.count(name) == 0)
        throw table.error(
            record, column,
            "value \"" + excerpt(name) + "\" is not a point of the scene" + did_you_mean(name, names_.point_names()));
      if (name.empty()) {
        const Vector3 there = imported_vector(table, record, {"x", "y", "z"});
        double nearest = tolerance;
        grid.around(there, tolerance, [&](std::size_t i) {
          const double distance = norm(difference(drawn[i].position, there));
          if (distance <= nearest) name = drawn[i].name;
          nearest = std::min(nearest, distance);
        });
        if (name.empty())
          throw table.error(record, column,
                            "no point of the scene lies at " + to_text(there) + "; allowed: within " +
                                shortest(tolerance) + " of one, or its \"name\"");
      }
      shift(name, imported_vector(table, record, {"dx", "dy", "dz"}),
            [&](const std::string& problem) { return table.error(record, column, problem); });
    });
  }

  void bend(const Bow& bow, const InputPlace& place) {
    if (bow.amplitude.has_value() == bow.share.has_value())
      throw place.error(std::string(bow.share ? "both" : "neither") +
                        " of \"Amplitude\" and \"Share\" given; allowed: exactly one");
    const std::vector<std::string> known = names_.member_names();
    const std::vector<std::string> meant = names_meant(bow.member, known);
    if (meant.empty()) throw unknown_name(place["Member"], "member", bow.member, known);
    const std::set<std::string> chosen(meant.begin(), meant.end());
    for (Member& member : scene_.members)
      if (chosen.count(member.name) > 0) bend(member, bow, place);
  }

  void bend(Member& member, const Bow& bow, const InputPlace& place) {
    require_line(member, place["Member"], "a bow");
    const Vector3 start = position(member.start_point), end = position(member.end_point);
    const Vector3 chord = difference(end, start), tangent = unit(chord);
    const Vector3 wanted = unit(bow.direction);
    const Vector3 across = difference(wanted, scaled(dot(wanted, tangent), tangent));
    if (norm(across) < kAcross)
      throw place["Direction"].error("along the member \"" + excerpt(member.name) + "\"; allowed: across it");
    const Quaternion<double> triad = make_reference_curve(member, start, end).triad(0.0);
    const auto axes = rotation_matrix(triad);
    member.second_axis = {axes(0, 1), axes(1, 1), axes(2, 1)};  // as before, whatever the new tangent suggests
    const Vector3 offset = scaled(bow.share ? *bow.share * norm(chord) : *bow.amplitude, unit(across));
    member.curve.shape = CurveShape::parametric;
    for (std::size_t i = 0; i < 3; ++i)
      member.curve.formula[i] =
          in_formula(start[i]) + " + " + in_formula(chord[i]) + " * t + " + in_formula(offset[i]) + " * sin(pi * t)";
    try {
      const ReferenceCurve curve = make_reference_curve(member, start, end);
      for (const InnerPoint& inner : member.inner_points)
        if (point_index_.count(inner.point) > 0)
          position(inner.point) = to_array(curve.position(inner.position * curve.length));
    } catch (const std::invalid_argument& problem) {  // extreme numbers
      throw place.error("of member \"" + excerpt(member.name) + "\": " + problem.what());
    }
  }

  const Teuchos::ParameterList& list_;
  const InputPlace& place_;
  Scene& scene_;
  const SceneNames names_;
  std::map<std::string, std::size_t> point_index_;
};

}  // namespace

ListSpec imperfection_spec() {
  ListSpec spec(
      "Geometric imperfections: the structure without stress differs from the one that was drawn, first by Sway and "
      "Points, then by Bows, then by Modes.");
  spec.add_list("Bows", ListSpec("Members that are not straight.").with_named_lists("bow", bow_parameters().spec),
                Presence::optional);
  spec.add_list("Sway", sway_parameters().spec, Presence::optional);
  spec.add_list("Points",
                ListSpec("Points that are not where they were drawn; straight members go with them.")
                    .with_named_parameters("point", bounded_vector("").required().means("Offset [length].")),
                Presence::optional);
  spec.add(text("Points File"),
           "Table (CSV) of such points, relative to the folder of the scene; its first line names the columns: dx, dy, "
           "dz of the offset, and name, or x, y, z of the point as it was drawn.");
  spec.add_list("Modes",
                ListSpec("Modes of linear buckling, added to each other; they bend members of every shape.")
                    .with_named_lists("mode", mode_parameters().spec),
                Presence::optional);
  spec.add(
      text("Case"),
      "With Modes: the load case or combination under which the structure buckles; needed where the scene has some.");
  return spec;
}

void apply_imperfection(const Teuchos::ParameterList& list, const InputPlace& place, Scene& scene) {
  Imperfection(list, place, scene).apply();
}

}  // namespace mixbeam
