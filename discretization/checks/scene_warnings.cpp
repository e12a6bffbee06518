#include "discretization/checks/scene_warnings.hpp"

#include "discretization/checks/survey.hpp"
#include "discretization/scene/amplitude.hpp"
#include "discretization/scene/section_shape.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_set>

namespace mixbeam {
namespace {

using namespace vector_algebra;

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
    list.add("sections with unusual shear stiffness", at + "GA / EA = " + number(ratio) +
                                                          ", 0.3 to 0.5 for massive sections; usually one of them is "
                                                          "in other units, or E and G are mixed up");
    break;
  }
  const double torsion = section.torsional_stiffness / smallest(section.bending_stiffness);
  if (torsion < kLeastTorsionRatio || torsion > kMostTorsionRatio)
    list.add(
        "sections with unusual torsional stiffness",
        at + "GIt over the smaller EI = " + number(torsion) +
            ", 0.77 for a circle; usually one of them is in other units, or It is the sum of I2 and I3 of a section "
            "that is not round");
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
    if (member.order * static_cast<double>(member.elements) > kManyUnknowns)
      list.add("members with many elements", at + std::to_string(member.elements) + " elements of order " +
                                                 std::to_string(member.order) +
                                                 "; usually 10 to 100 per member are enough");
    // a rigid arm is exact with any mesh
    const bool bends = std::isfinite(survey.section_of(member).bending_stiffness[0]);
    if (bends && member.order == 1 && member.elements < kFewElementsOfOrderOne)
      list.add("members with few elements of order 1", at + std::to_string(member.elements) +
                                                           " element(s) of order 1 are coarse; order 3 or 4 "
                                                           "costs little more");
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

/// A spring as a bending stiffness: moment per angle times length, force per way times its third power.
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
  const auto formulas = [](const auto& texts) {
    return std::any_of(texts.begin(), texts.end(), [](const std::string& text) { return !text.empty(); });
  };
  for (const Point& other : survey.scene.points)
    if (std::abs(dot(difference(other.position, point), normal)) > kInPlane * survey.size) return false;
  for (const PointLoad& load : survey.scene.point_loads)
    if (load.frame == LoadFrame::follower || is_across(load.force) || is_along(load.moment)) return false;
  for (const DistributedLoad& load : survey.scene.distributed_loads)
    if (load.frame == LoadFrame::follower || is_across(load.force) || is_along(load.couple) ||
        formulas(load.force_formula) || formulas(load.couple_formula))
      return false;
  return true;
}

/// Forces act at the centroid as if it were the shear centre: of a T in the plane of its web it makes no difference,
/// nor of a U in its plane of symmetry.
void add_shear_centre_warnings(const SceneSurvey& survey, WarningList& list) {
  for (std::size_t m = 0; m < survey.curves.size() && anything_acts(survey.scene); ++m) {
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
                 ") is not its centroid, and neither this distance nor warping counts: "
                 "where loads or supports twist the member, its twist and the stresses of it are too small");
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
