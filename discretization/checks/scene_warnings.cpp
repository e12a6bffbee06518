#include "discretization/checks/scene_warnings.hpp"

#include "discretization/geometry/point_grid.hpp"
#include "discretization/geometry/reference_curve.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "discretization/scene/amplitude.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/formula_pieces.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/section_shape.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace mixbeam {
namespace {

using namespace vector_algebra;

/// Curves, lengths and names of a scene that read_scene accepted. The scene must outlive it.
struct SceneSurvey {
  explicit SceneSurvey(const Scene& surveyed);

  const Section& section_of(const Member& member) const { return *sections.at(member.section); }
  /// Reference length of the member's shortest and longest element.
  std::array<double, 2> element_lengths(std::size_t member) const;
  /// Whether the member's elements are the program's choice, about which a user need not be warned.
  bool is_divided_by_program(const Member& member) const {
    return !member.keeps_elements && (scene.accuracy || !names_mesh);
  }
  /// Length of the element at the start (0) or end (1) of the member.
  double end_element_length(std::size_t member, int end) const;

  const Scene& scene;
  SceneNames names;
  std::unordered_map<std::string, const Section*> sections;
  std::vector<ReferenceCurve> curves;  ///< of the members
  double size = 0.0;                   ///< diagonal of the box around all points, or the longest member if that is more
  bool names_mesh = false;             ///< some member that bends keeps an order or elements
};

/// Warnings in the order in which they were found, those of a kind cut off after the first few.
class WarningList {
 public:
  /// `kind` names what many warnings have in common: "coincident members".
  void add(const std::string& kind, const std::string& text) {
    if (++count_[kind] <= kMostOfAKind) texts_.push_back(text);
  }

  std::vector<std::string> finished() const {
    std::vector<std::string> all = texts_;
    for (const auto& [kind, count] : count_)
      if (count > kMostOfAKind) all.push_back("... and " + std::to_string(count - kMostOfAKind) + " more " + kind);
    return all;
  }

 private:
  static constexpr std::size_t kMostOfAKind = 5;  // further ones add nothing

  std::vector<std::string> texts_;
  std::map<std::string, std::size_t> count_;
};

SceneSurvey::SceneSurvey(const Scene& surveyed) : scene(surveyed), names(surveyed) {
  for (const Section& section : scene.sections) sections.emplace(section.name, &section);
  Box box;
  for (const Point& point : scene.points) box.enclose(point.position);
  size = box.diagonal();
  curves.reserve(scene.members.size());
  for (const Member& member : scene.members) {
    curves.push_back(
        make_reference_curve(member, names.position(member.start_point), names.position(member.end_point)));
    size = std::max(size, curves.back().length);
    const bool bends = std::isfinite(section_of(member).bending_stiffness[0]);
    names_mesh = names_mesh || (bends && (member.keeps_order || member.keeps_elements));
  }
}

std::array<double, 2> SceneSurvey::element_lengths(std::size_t member) const {
  const std::vector<double>& stations = scene.members[member].stations;
  const double length = curves[member].length;
  if (stations.empty()) return {length / scene.members[member].elements, length / scene.members[member].elements};
  double shortest = 1.0, longest = 0.0;
  for (std::size_t i = 1; i < stations.size(); ++i) {
    shortest = std::min(shortest, stations[i] - stations[i - 1]);
    longest = std::max(longest, stations[i] - stations[i - 1]);
  }
  return {shortest * length, longest * length};
}

double SceneSurvey::end_element_length(std::size_t member, int end) const {
  const std::vector<double>& stations = scene.members[member].stations;
  const double length = curves[member].length;
  if (stations.size() < 2) return length / scene.members[member].elements;
  const std::size_t last = stations.size() - 1;
  return length * (end == 0 ? stations[1] - stations[0] : stations[last] - stations[last - 1]);
}

/// `Sections / tube: `
std::string warned_place(const std::string& list, const std::string& name) {
  return list + " / " + excerpt(name) + ": ";
}

// Geometry.

// Coordinates typed by people agree to six digits if they are intended to be equal.
constexpr double kSamePlace = 1e-6;            // of the size of the structure
constexpr double kMostRoundingOfPlace = 1e-9;  // of that size: below the usual errors of Newton's method and meshes
// Walking along all members takes time in proportion to this number; beyond it the search is left out.
constexpr double kMostSteps = 3e6;
constexpr int kProjections = 8;  // each squares the error of a point's foot on a smooth curve; lines need one
constexpr std::size_t kMostOnOneMember = 100;  // between the same points: all pairs are compared

void add_close_points(const SceneSurvey& survey, WarningList& list) {
  const std::vector<Point>& points = survey.scene.points;
  const double tolerance = kSamePlace * survey.size;
  const PointGrid grid(points, tolerance);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::set<std::size_t> seen;  // two cells with one key would be visited twice
    grid.around(points[i].position, tolerance, [&](std::size_t j) {
      const double distance = norm(difference(points[i].position, points[j].position));
      if (j <= i || distance > tolerance || seen.size() > kMostOnOneMember || !seen.insert(j).second) return;
      list.add("pairs of coincident points",
               "Points / " + excerpt(points[j].name) + ": lies at " + to_text(points[j].position) + ", " +
                   shortest(distance) + " from \"" + excerpt(points[i].name) +
                   "\", but members at them are not connected; usually they should be one point");
    });
  }
}

void add_equal_members(const SceneSurvey& survey, WarningList& list) {
  const std::vector<Member>& members = survey.scene.members;
  std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> between;
  for (std::size_t i = 0; i < members.size(); ++i) {
    std::vector<std::size_t>& same_ends = between[std::minmax(members[i].start_point, members[i].end_point)];
    for (const std::size_t j : same_ends) {
      const bool reversed = members[i].start_point != members[j].start_point;
      if (!coincide(survey.curves[i], survey.curves[j], reversed, kSamePlace * survey.size)) continue;
      list.add("coincident members", "Members / " + excerpt(members[i].name) + ": lies on \"" +
                                         excerpt(members[j].name) +
                                         "\" all along; usually one of them was copied by mistake");
      break;
    }
    if (same_ends.size() < kMostOnOneMember) same_ends.push_back(i);
  }
}

/// Arc length of the point's foot on the curve near `s`, inside the curve.
double foot(const ReferenceCurve& curve, const Vector3& point, double s) {
  for (int i = 0; i < kProjections; ++i) {
    const Vector3 offset = difference(point, to_array(curve.position(s)));
    s = std::clamp(s + dot(offset, to_array(curve.tangent(s))), 0.0, curve.length);
  }
  return s;
}

bool knows(const Member& member, const std::string& point) {
  return member.start_point == point || member.end_point == point ||
         std::any_of(member.inner_points.begin(), member.inner_points.end(),
                     [&](const InnerPoint& inner) { return inner.point == point; });
}

/// Warns of points on a member that it does not name.
void add_points_on(std::size_t index, const SceneSurvey& survey, const PointGrid& grid, double step,
                   WarningList& list) {
  const Member& member = survey.scene.members[index];
  const ReferenceCurve& curve = survey.curves[index];
  const double tolerance = kSamePlace * survey.size;
  std::set<std::size_t> seen;
  const int steps = static_cast<int>(std::ceil(curve.length / step));
  for (int i = 0; i <= steps; ++i) {
    const double start = curve.length * i / steps;
    const Vector3 sample = to_array(curve.position(start));
    grid.around(sample, step, [&](std::size_t p) {
      const Point& point = survey.scene.points[p];
      // Every point of the curve is within half a step of a sample.
      if (norm(difference(point.position, sample)) > 0.5 * step + tolerance) return;
      if (seen.count(p) > 0 || knows(member, point.name)) return;
      const double s = foot(curve, point.position, start);
      if (norm(difference(point.position, to_array(curve.position(s)))) > tolerance) return;
      if (s <= tolerance || s >= curve.length - tolerance) return;  // at its ends: two points at one place
      seen.insert(p);
      list.add(
          "points on members",
          "Points / " + excerpt(point.name) + ": lies on \"" + excerpt(member.name) + "\", " +
              shortest(s / curve.length) +
              " of its length from the start, but is not connected with it; usually it should be an inner point of it");
    });
  }
}

void add_points_on_members(const SceneSurvey& survey, WarningList& list) {
  double total = 0.0;
  for (const ReferenceCurve& curve : survey.curves) total += curve.length;
  // Few points in each cell, if they fill the space, and if they form a chain, whose box is nearly empty.
  const double filled = survey.size / std::cbrt(static_cast<double>(survey.scene.points.size()));
  const double step = std::min(filled, total / static_cast<double>(survey.curves.size()));
  if (total / step + static_cast<double>(survey.curves.size()) > kMostSteps) {
    list.add("searches", "the scene is large: not searched for points that lie on members without being connected");
    return;
  }
  const PointGrid grid(survey.scene.points, step);
  for (std::size_t i = 0; i < survey.curves.size(); ++i) add_points_on(i, survey, grid, step, list);
}

/// Warns of a far origin: lengths are differences of coordinates, which have sixteen digits.
void add_far_origin(const SceneSurvey& survey, WarningList& list) {
  double farthest = 0.0;
  for (const Point& point : survey.scene.points)
    for (const double x : point.position) farthest = std::max(farthest, std::abs(x));
  const double rounding = std::numeric_limits<double>::epsilon() * farthest;
  if (rounding > kMostRoundingOfPlace * survey.size)
    list.add("scenes", "Points: coordinates up to " + rounded(farthest, 3) + " are rounded to about " +
                           rounded(rounding / survey.size, 2) +
                           " of the size of the structure, and so are lengths; an origin near it keeps all digits");
}

/// Warns of connections that are probably missing: points that nearly coincide, members that lie on each other, points
/// on a member that does not name them.
void add_geometry_warnings(const SceneSurvey& survey, WarningList& list) {
  add_far_origin(survey, list);
  add_close_points(survey, list);
  add_equal_members(survey, list);
  add_points_on_members(survey, list);
}

// Loads.

constexpr double kMostLoad = 1e6;  // F L^2 / EI; a strut buckles at 2.5 to 40, a coil of ten turns needs 4e3
// Steel breaks at 1 %, wood and glass below; the law of the section, linear in its strains, says little beyond.
constexpr double kMostStrain = 0.1;
// Only with F l^2 / EI far above buckling: strains of thick members may be intended.
constexpr double kLoadOfStrain = 100.0;
// F l^2 / EI below which no deflection could be measured: a millionth of a millimetre on a metre.
constexpr double kLeastLoad = 1e-6;
// Gravity of the earth in m/s^2 beside an E that no solid has in kN/m^2 (diamond 1e9): the scene is in m, N and kg.
constexpr double kLeastOfEarth = 9.5, kMostOfEarth = 10.1, kLeastModulusInPascal = 2e9;
// E over density, square of the speed of sound [m^2/s^2]: metals and wood 3e7, carbon fibres 2e8, diamond 3e8.
constexpr double kMostSpecificStiffness = 1e9;
// Share of a formula that the points of a mesh may miss: a jump inside an element does, and hardly matters.
constexpr double kMissedOfFormula = 0.01;

struct ActingForce {
  std::string at;
  double force, moment;
};

/// Forces known without a computation: loads without formulas.
struct ForceSurvey {
  std::vector<ActingForce> forces{};
  bool has_formulas = false;
};

ForceSurvey forces_of(const SceneSurvey& survey) {
  ForceSurvey found;
  for (const PointLoad& load : survey.scene.point_loads) {
    if (!load.amplitude.empty()) found.has_formulas = true;
    found.forces.push_back({warned_place("Point Loads", "at " + load.point), norm(load.force), norm(load.moment)});
  }
  for (const DistributedLoad& load : survey.scene.distributed_loads) {
    const auto member = static_cast<std::size_t>(survey.names.member(load.member) - survey.scene.members.data());
    const double length = survey.curves[member].length;
    if (!load.amplitude.empty() || is_given(load.force_formula) || is_given(load.couple_formula))
      found.has_formulas = true;
    found.forces.push_back({warned_place("Distributed Loads", "on " + load.member), norm(load.force) * length,
                            norm(load.couple) * length});
  }
  return found;
}

/// Largest and smallest values of all members; infinite ones do not count, and zero or infinity stays if all are.
struct StiffnessRange {
  double most_bending = 0.0, most_axial = 0.0;
  double least_bending = std::numeric_limits<double>::infinity();
  double longest = 0.0;  ///< member
};

StiffnessRange stiffness_range(const SceneSurvey& survey) {
  StiffnessRange found;
  for (std::size_t i = 0; i < survey.scene.members.size(); ++i) {
    const Section& section = survey.section_of(survey.scene.members[i]);
    for (const double bending : section.bending_stiffness) {
      if (std::isfinite(bending)) found.most_bending = std::max(found.most_bending, bending);
      found.least_bending = std::min(found.least_bending, bending);
    }
    found.most_axial = std::max(found.most_axial, section.axial_stiffness);
    found.longest = std::max(found.longest, survey.curves[i].length);
  }
  return found;
}

/// Strain of fibres at twice the radius of gyration r (a round rod) of a member of length l bent by a force: as a
/// lever, 2 F l r / EI, but at most that of the elastica, whose curvature stays below sqrt(2 F / EI). Zero unless the
/// force is far above what the member bears.
double strain_by(double force, const StiffnessRange& stiffness) {
  const double bending = stiffness.most_bending, axial = stiffness.most_axial, length = stiffness.longest;
  if (bending == 0.0 || !std::isfinite(axial) || force * length * length < kLoadOfStrain * bending) return 0.0;
  const double radius = std::sqrt(bending / axial);
  const double curvature = std::min(force * length / bending, std::sqrt(2.0 * force / bending));
  return std::max(force / axial, 2.0 * radius * curvature);
}

void warn_of_large(const ForceSurvey& found, const StiffnessRange& stiffness, double size, WarningList& list) {
  for (const ActingForce& acting : found.forces) {
    const double load = std::max(acting.force * size * size, acting.moment * size) / stiffness.most_bending;
    if (stiffness.most_bending > 0.0 && load > kMostLoad) {
      list.add("loads of unusual size", acting.at + "the load times size of the structure squared over EI is " +
                                            rounded(load, 3) +
                                            "; a strut buckles at about 10; usually units of the load or of EI");
      continue;
    }
    const double strain = found.has_formulas ? 0.0 : strain_by(acting.force, stiffness);
    if (strain > kMostStrain)
      list.add("loads that cause large strains",
               acting.at + "the force strains the stiffest members by about " + rounded(100.0 * strain, 3) +
                   " %; steel yields at 0.2 %; usually units of the load, of E or of the section");
  }
}

void warn_of_small(const ForceSurvey& found, const StiffnessRange& stiffness, WarningList& list) {
  if (found.has_formulas || found.forces.empty() || !std::isfinite(stiffness.least_bending)) return;
  const double length = stiffness.longest;
  double largest = 0.0;
  for (const ActingForce& acting : found.forces)
    largest = std::max(largest, std::max(acting.force * length * length, acting.moment * length));
  const double load = largest / stiffness.least_bending;
  if (load > 0.0 && load < kLeastLoad)
    list.add("scenes", "Point Loads, Distributed Loads: the largest load times length of a member squared over EI is " +
                           rounded(load, 3) +
                           ", so that nothing moves visibly; usually units of the load, of E or of the section");
}

/// Warns of members without mass, to which `what` does not apply.
void warn_of_weightless(const std::string& what, const SceneSurvey& survey, WarningList& list) {
  std::vector<std::string> names;
  for (const Member& member : survey.scene.members) {
    if (member.section == kRigidArm) continue;
    const bool has_taper = !member.end_section.empty();
    if (survey.section_of(member).mass == 0.0 || (has_taper && survey.sections.at(member.end_section)->mass == 0.0))
      names.push_back(member.name);
  }
  if (names.empty()) return;
  list.add("scenes", what + " of " + std::to_string(names.size()) + " of " +
                         std::to_string(survey.scene.members.size()) + " members: " + quoted_list(names) +
                         "; usually \"Density\" in \"Material\", or \"Mass\", of their sections is missing");
}

/// Warns of densities in g/cm^3, if all sections have them: a single one may represent something rigid.
void warn_of_light(const SceneSurvey& survey, WarningList& list) {
  if (survey.scene.gravity < kLeastOfEarth || survey.scene.gravity > kMostOfEarth) return;
  const Section* lightest = nullptr;
  for (const Member& member : survey.scene.members) {
    const Section& section = survey.section_of(member);
    if (!section.shape || section.mass == 0.0 || section.shape->youngs_modulus < kLeastModulusInPascal) continue;
    if (section.shape->youngs_modulus < kMostSpecificStiffness * section.shape->density) return;
    if (lightest == nullptr || section.shape->density < lightest->shape->density) lightest = &section;
  }
  if (lightest == nullptr) return;
  list.add("scenes", warned_place("Sections", lightest->name) + "Density " + rounded(lightest->shape->density, 3) +
                         " beside E = " + rounded(lightest->shape->youngs_modulus, 3) + " and a gravity of " +
                         rounded(survey.scene.gravity, 3) +
                         ": no solid is so light; usually g/cm3, where m, N and kg ask for kg/m3");
}

/// Warns of a formula that the points of the elements do not resolve.
void warn_of_narrow(const Member& member, const FormulaAlong& formula, WarningList& list) {
  const GaussPoints& rule = gauss_points(member.order + 1);
  const std::vector<double> station = divide(member).station;
  const bool is_load = formula.list != "Taper" && formula.list != "Curve";
  MissedIntegral sum, most;
  std::array<double, 2> where{};
  std::vector<double> value;
  for (std::size_t e = 1; e < station.size(); ++e) {
    const double first = station[e - 1], last = station[e], middle = 0.5 * (first + last);
    if (middle < formula.range[0] || middle > formula.range[1]) continue;
    value.clear();
    for (const double xi : rule.xi) value.push_back(formula.function(middle + 0.5 * (last - first) * xi));
    MissedIntegral here =
        integrate_at_points(*formula.pieces, formula.function, first, last, rule.xi, rule.weight, value);
    if (here.total == 0.0)  // smooth
      for (std::size_t q = 0; q < value.size(); ++q)
        here.total += 0.5 * (last - first) * rule.weight[q] * std::abs(value[q]);
    sum.missed += here.missed;
    sum.total += here.total;
    if (here.missed <= most.missed) continue;
    most = here;
    where = {first, last};
  }
  if (!(sum.missed > kMissedOfFormula * sum.total)) return;
  list.add("narrow formulas",
           warned_place(is_load ? formula.list : "Members", (is_load ? "on " : "") + member.name) + "\"" +
               excerpt(formula.text) + "\" changes between the points of the " + std::to_string(station.size() - 1) +
               " elements of order " + std::to_string(member.order) + ": the sum over them misses " +
               rounded(100.0 * sum.missed / sum.total, 3) +
               (formula.list == "Curve" ? " % of its squared curvature" : " % of it") +
               ", most of it from x = " + rounded(where[0], 4) + " to " + rounded(where[1], 4) + "; " +
               (formula.list == "Curve"
                    ? ""
                    : "the integral over each element is used in its place, but not how it varies inside; ") +
               "\"Stations\" there, or \"Accuracy\" without \"Elements\", resolve it");
}

void warn_of_narrow_formulas(const SceneSurvey& survey, WarningList& list) {
  const Scene& scene = survey.scene;
  for (const FormulaAlong& formula : formulas_along(
           scene, [&](const Member& member) { return !scene.accuracy || member.keeps_elements; },
           [&](std::size_t m) -> const ReferenceCurve& { return survey.curves[m]; }, false))
    warn_of_narrow(scene.members[formula.member], formula, list);
}

/// Warns of loads too large or small for the stiffnesses, usually a slip of units, and where nothing acts.
void add_load_warnings(const SceneSurvey& survey, WarningList& list) {
  const Scene& scene = survey.scene;
  const ForceSurvey found = forces_of(survey);
  const StiffnessRange stiffness = stiffness_range(survey);
  warn_of_large(found, stiffness, survey.size, list);
  warn_of_narrow_formulas(survey, list);
  const bool is_moved = imposes_deformation(scene);
  if (!anything_acts(scene)) list.add("scenes", kNothingActs);
  if (!is_moved) warn_of_small(found, stiffness, list);
  if (!scene.rotating_frames.empty()) warn_of_weightless("Rotating Frame: no centrifugal force", survey, list);
  if (scene.gravity == 0.0) return;
  warn_of_weightless("Gravity: no weight", survey, list);
  warn_of_light(survey, list);
}

// Sections, members and names.

// Limits of ratios that real structures keep. A strip 300 times as wide as thick has bending stiffnesses with the ratio
// 1e5; GA/EA is 0.3 to 0.5 for massive sections, a hundredth of it for sandwiches, GIt/EI 0.77 for circles, less for
// thin open sections.
constexpr double kMostBendingRatio = 1e6;
constexpr double kLeastShearRatio = 1e-4, kMostShearRatio = 2.0;
constexpr double kLeastTorsionRatio = 1e-7, kMostTorsionRatio = 4.0;
// Radius of gyration sqrt(EI/EA): 1/4 of the diameter of a round rod. Over the size of the structure, and over the
// length of one member: a hair a kilometre long has 1e-8.
constexpr double kMostGyrationOfSize = 0.2, kLeastGyrationOfLength = 1e-8;
constexpr double kMostGyrationOfElement = 20.0;  // elements much shorter than the section is thick resolve nothing
constexpr double kMostElementRatio = 100.0;      // of neighbours: the longer one decides about the accuracy
constexpr int kManyUnknowns = 1'000'000;         // order times elements of one member
constexpr int kFewElementsOfOrderOne = 4;
constexpr double kMostTurn = 12.6;           // twist, or angle of an arc: two turns of a member
constexpr double kMostAngleOfElement = 1.6;  // pi/2: beyond, one element describes more than a quarter of a circle
// The range that scenes.md states ("Ratios are free in wide ranges"): softer parts are lost in the rounding of the
// rest.
constexpr double kMostStiffnessRatio = 1e12;
constexpr double kNoticeableStart = 1e-12;  // of an amplitude at t = 0: less is rounding of a formula

std::string number(double value) { return rounded(value, 3); }

double largest(const std::array<double, 2>& pair) { return std::max(pair[0], pair[1]); }
double smallest(const std::array<double, 2>& pair) { return std::min(pair[0], pair[1]); }

void add_section_warnings(const Section& section, WarningList& list) {
  const std::string at = warned_place("Sections", section.name);
  const double bending = largest(section.bending_stiffness) / smallest(section.bending_stiffness);
  if (bending > kMostBendingRatio)
    list.add("sections with unequal bending stiffness",
             at + "EI2 and EI3 differ by the factor " + number(bending) + "; usually one of them is in other units");
  for (const double shear : section.shear_stiffness) {
    const double ratio = shear / section.axial_stiffness;
    if (!std::isfinite(ratio) || ratio == 0.0 || (ratio >= kLeastShearRatio && ratio <= kMostShearRatio)) continue;
    list.add("sections with unusual shear stiffness",
             at + "GA / EA = " + number(ratio) +
                 ", 0.3 to 0.5 for massive sections; usually one of them is in other units, or E and G are mixed up");
    break;
  }
  const double torsion = section.torsional_stiffness / smallest(section.bending_stiffness);
  if (torsion < kLeastTorsionRatio || torsion > kMostTorsionRatio)
    list.add("sections with unusual torsional stiffness",
             at + "GIt over the smaller EI = " + number(torsion) +
                 ", 0.77 for a circle; usually one of them is in other units, or It is the sum of I2 and I3 of a "
                 "section that is not round");
}

/// sqrt(EI/EA) of the stiffer axis; zero for an inextensible section.
double gyration_radius(const Section& section) {
  const double radius = std::sqrt(largest(section.bending_stiffness) / section.axial_stiffness);
  return std::isfinite(radius) ? radius : 0.0;
}

void add_slenderness_warnings(const SceneSurvey& survey, WarningList& list) {
  std::set<std::string> seen;  // sections
  for (std::size_t i = 0; i < survey.scene.members.size(); ++i) {
    const Member& member = survey.scene.members[i];
    const double radius = gyration_radius(survey.section_of(member));
    if (radius == 0.0) continue;
    const double shortest = survey.element_lengths(i)[0];
    const std::string radius_text = "radius of gyration sqrt(EI/EA) = " + number(radius);
    if (radius > kMostGyrationOfSize * survey.size && seen.insert(member.section).second) {
      list.add("sections thicker than the structure", warned_place("Sections", member.section) + radius_text +
                                                          " in a structure of size " + number(survey.size) +
                                                          "; usually EA and EI are in different units, as N with mm^2");
    } else if (radius < kLeastGyrationOfLength * survey.curves[i].length && seen.insert(member.section).second) {
      list.add("very thin sections", warned_place("Sections", member.section) + radius_text +
                                         " in a member of length " + number(survey.curves[i].length) +
                                         "; usually EA and EI are in different units");
    } else if (radius > kMostGyrationOfElement * shortest) {
      list.add("members with elements shorter than their thickness",
               warned_place("Members", member.name) + "elements of length " + number(shortest) + ", " + radius_text +
                   "; usually far more elements than needed, or a scene in other units than its section");
    }
  }
}

void add_division_warnings(const SceneSurvey& survey, WarningList& list) {
  for (std::size_t i = 0; i < survey.scene.members.size(); ++i) {
    const Member& member = survey.scene.members[i];
    const std::string at = warned_place("Members", member.name);
    if (survey.is_divided_by_program(member)) {
      const double turn =
          std::abs(member.twist) + (member.curve.shape == CurveShape::circular_arc ? member.curve.angle : 0.0);
      if (turn > kMostTurn)
        list.add("members with a large angle", at + "turns by " + number(turn) + " radian; usually degrees");
      continue;
    }
    if (member.order * static_cast<double>(member.elements) > kManyUnknowns)
      list.add("members with many elements", at + std::to_string(member.elements) + " elements of order " +
                                                 std::to_string(member.order) +
                                                 "; usually 10 to 100 per member are enough");
    // a rigid arm is exact with any mesh
    const bool bends = std::isfinite(survey.section_of(member).bending_stiffness[0]);
    if (bends && member.order == 1 && member.elements < kFewElementsOfOrderOne)
      list.add(
          "members with few elements of order 1",
          at + std::to_string(member.elements) + " element(s) of order 1 are coarse; order 3 or 4 costs little more");
    const double angle = (std::abs(member.twist) + std::abs(member.curve.angle)) / member.elements;
    if (angle > kMostAngleOfElement)
      list.add("members with a large angle per element", at + "each of " + std::to_string(member.elements) +
                                                             " element(s) turns by " + number(angle) +
                                                             " radian; usually too few elements, or degrees");
    const std::array<double, 2> lengths = survey.element_lengths(i);
    if (lengths[1] > kMostElementRatio * lengths[0])
      list.add("members with unequal elements", at + "elements from " + number(lengths[0]) + " to " +
                                                    number(lengths[1]) + "; usually a slip in Stations");
  }
}

void add_neighbour_warnings(const SceneSurvey& survey, WarningList& list) {
  struct Range {
    double shortest = std::numeric_limits<double>::infinity(), longest = 0.0;
    std::string short_member, long_member;
  };
  std::unordered_map<std::string, Range> at_point;
  for (std::size_t i = 0; i < survey.scene.members.size(); ++i) {
    const Member& member = survey.scene.members[i];
    if (survey.is_divided_by_program(member)) continue;
    for (int end = 0; end < 2; ++end) {
      Range& range = at_point[end == 0 ? member.start_point : member.end_point];
      const double length = survey.end_element_length(i, end);
      if (length < range.shortest) range.short_member = member.name;
      if (length > range.longest) range.long_member = member.name;
      range.shortest = std::min(range.shortest, length);
      range.longest = std::max(range.longest, length);
    }
  }
  for (const Point& point : survey.scene.points) {
    const auto found = at_point.find(point.name);
    if (found == at_point.end() || found->second.longest <= kMostElementRatio * found->second.shortest) continue;
    const Range& range = found->second;
    list.add("points where very different elements meet",
             warned_place("Points", point.name) + "an element of length " + number(range.longest) + " (\"" +
                 excerpt(range.long_member) + "\") meets one of " + number(range.shortest) + " (\"" +
                 excerpt(range.short_member) + "\"); usually the longer member needs more elements");
  }
}

/// Springs count as bending stiffnesses: moment per angle times length, force per displacement times its cube.
void add_range_warning(const SceneSurvey& survey, WarningList& list) {
  struct Named {
    double value;
    std::string name;
  };
  Named softest{std::numeric_limits<double>::infinity(), ""}, stiffest{0.0, ""};
  const auto note = [&](double value, const std::string& name) {
    if (!(value > 0.0) || !std::isfinite(value)) return;
    if (value < softest.value) softest = {value, name};
    if (value > stiffest.value) stiffest = {value, name};
  };
  const double size = survey.size, cube = size * size * size;
  for (const Member& member : survey.scene.members) {
    const Section& section = survey.section_of(member);
    const std::string name = "section \"" + excerpt(section.name) + "\"";
    note(section.torsional_stiffness, name);
    for (const double stiffness : section.bending_stiffness) note(stiffness, name);
  }
  for (const Support& support : survey.scene.supports)
    for (int i = 0; i < 3; ++i) {
      const std::string name = "the spring at point \"" + excerpt(support.point) + "\"";
      note(support.rotation_stiffness[i] * size, name);
      note(support.displacement_stiffness[i] * cube, name);
    }
  for (const Joint& joint : survey.scene.joints)
    note(joint.stiffness * (joint.kind == JointKind::slider ? cube : size),
         "the spring of joint \"" + excerpt(joint.name) + "\"");
  const double ratio = stiffest.value / softest.value;
  if (ratio > kMostStiffnessRatio)
    list.add("scenes with stiffnesses too far apart",
             "Sections: " + stiffest.name + " is " + number(ratio) + " times as stiff as " + softest.name +
                 " in a structure of this size; beyond 1e12 (scenes.md, \"Sections\") rounding leaves nothing of the "
                 "softer one; usually one of them is in other units, and 1e9 times as stiff is as good as rigid");
}

template <typename Load>
void add_amplitude_warnings(const std::vector<Load>& loads, const std::string& what, WarningList& list) {
  for (const Load& load : loads) {
    if (load.amplitude.empty()) continue;
    const double start = Amplitude(1, 1, load.amplitude)(0.0);
    if (std::abs(start) <= kNoticeableStart) continue;
    list.add("amplitudes of " + what, what + ": the amplitude \"" + excerpt(load.amplitude) + "\" is " + number(start) +
                                          " at t = 0, so this part acts at once; usually it should start at 0");
  }
}

void add_unused_warnings(const Scene& scene, WarningList& list) {
  std::set<std::string> used;
  for (const Member& member : scene.members) {
    used.insert(member.section);
    used.insert(member.end_section);
  }
  for (const Section& section : scene.sections)
    if (used.count(section.name) == 0)
      list.add("unused sections",
               warned_place("Sections", section.name) + "no member has it; usually a name is misspelt");
  std::unordered_set<std::string> touched;
  for (const Member& member : scene.members) {
    touched.insert({member.start_point, member.end_point});
    for (const InnerPoint& inner : member.inner_points) touched.insert(inner.point);
  }
  for (const Point& point : scene.points)  // imported ones: others are refused
    if (touched.count(point.name) == 0)
      list.add("unused points",
               warned_place("Points", point.name) +
                   "imported, but no member starts, ends or passes there; usually members are missing");
  std::set<std::string> cases;
  for_each_acting(scene, [&](const auto& load, auto) { cases.insert(load.load_case); });
  for (const std::string& name : scene.load_cases)
    if (cases.count(name) == 0)
      list.add("load cases without loads",
               warned_place("Load Cases", name) + "nothing belongs to it; usually \"Case\" is missing");
}

/// Whether a structure and its loads lie in the plane through `point` normal to `normal`: then nothing twists.
bool acts_in_plane(const SceneSurvey& survey, const Vector3& point, const Vector3& normal) {
  constexpr double kInPlane = 1e-6;  // of the size, of the load: numbers are written with six digits
  const auto is_across = [&](const Vector3& v) { return std::abs(dot(v, normal)) > kInPlane * norm(v); };
  const auto is_along = [&](const Vector3& v) { return norm(cross(v, normal)) > kInPlane * norm(v); };
  for (const Point& other : survey.scene.points)
    if (std::abs(dot(difference(other.position, point), normal)) > kInPlane * survey.size) return false;
  for (const PointLoad& load : survey.scene.point_loads)
    if (load.frame == LoadFrame::follower || is_across(load.force) || is_along(load.moment)) return false;
  for (const DistributedLoad& load : survey.scene.distributed_loads)
    if (load.frame == LoadFrame::follower || is_across(load.force) || is_along(load.couple) ||
        is_given(load.force_formula) || is_given(load.couple_formula))
      return false;
  return true;
}

/// Forces act at the centroid as if it were the shear centre, which makes no difference for a T in the plane of its
/// web, nor for a U in its plane of symmetry.
void add_shear_centre_warnings(const SceneSurvey& survey, WarningList& list) {
  if (!anything_acts(survey.scene)) return;
  for (std::size_t m = 0; m < survey.curves.size(); ++m) {
    const Member& member = survey.scene.members[m];
    const Section& section = survey.section_of(member);
    if (!section.shape || !consists_of_rectangles(section.shape->kind)) continue;
    const SectionShapeKind kind = section.shape->kind;
    const Mat3<double> triad = rotation_matrix(survey.curves[m].triad(0.0));
    const int across = kind == SectionShapeKind::t_section ? 1 : 2;
    const Vector3 normal = {triad(0, across), triad(1, across), triad(2, across)};
    if (kind != SectionShapeKind::l_section && acts_in_plane(survey, to_array(survey.curves[m].origin), normal))
      continue;
    list.add("members whose shear centre is not their centroid",
             warned_place("Members", member.name) + "the shear centre of section \"" + excerpt(section.name) + "\" (" +
                 section_shape_word(kind) +
                 ") is not its centroid, and neither this distance nor warping counts: where loads or supports twist "
                 "the member, its twist and the stresses of it are too small");
  }
}

}  // namespace

std::vector<std::string> warnings(const Scene& scene) {
  WarningList list;
  if (scene.points.empty() || scene.members.empty()) return {};
  const SceneSurvey survey(scene);
  for (const Section& section : scene.sections) add_section_warnings(section, list);
  add_slenderness_warnings(survey, list);
  add_division_warnings(survey, list);
  add_neighbour_warnings(survey, list);
  add_geometry_warnings(survey, list);
  add_load_warnings(survey, list);
  add_range_warning(survey, list);
  add_shear_centre_warnings(survey, list);
  for_each_kind([&](auto kind) { add_amplitude_warnings(scene.*kind.list, kind.name, list); });
  add_unused_warnings(scene, list);
  return list.finished();
}

}  // namespace mixbeam
