/// The part of SceneReader that reads members, apart from where they are.

#include "discretization/parameters/access.hpp"
#include "discretization/parameters/input_place.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/reading/scene_reader.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace mixbeam {
namespace {

using namespace vector_algebra;

constexpr int kLargestOrder = 8;
constexpr double kSameTwist = 1e-6;  // of twists, which are written with six digits. [radian]

void bind_section_along(BoundList<Member>& member) {
  member.bind(&Member::section, text("Section"), "Name of its section; may be absent where the scene has only one.")
      .column("Section of the members whose record names none; may be absent where the scene has only one.");
  member.bind(&Member::end_section, text("End Section"),
              "Name of the section at its end: the section changes from start to end.");
  member.bind(&Member::taper, text("Taper").or_other("a formula"),
              "with End Section: its weight as a formula of x = arc length over length of the member, 0 for the "
              "section of the start, 1 for that of the end; x itself if absent.");
}

void bind_division(BoundList<Member>& member) {
  member
      .bind(&Member::order, integer("Order").at_least(1).at_most(kLargestOrder).by_default(),
            "Polynomial order k of its elements.")
      .marks(&Member::keeps_order)
      .column("Order of their elements.");
  member
      .bind(&Member::elements, integer("Elements").at_least(1).at_most(kMostElements).by_default(),
            "Number of elements: of equal length, or as equal as the inner points permit, at least one between two of "
            "them; a polyline shares them out by length, at least one for each line.")
      .marks(&Member::keeps_elements)
      .column("Number of their elements.");
  member
      .bind(&Member::stations, array("Stations", ParameterType::real_array).at_least(0.0).at_most(1.0),
            "Ends of all elements as arc length over length of the member, from 0 to 1, instead of Elements; inner "
            "points must be among them.")
      .marks(&Member::keeps_elements)
      .not_compared();
  member.bind_named(
      &Member::inner_points, "Inner Points",
      "Points inside the member, where other members may join and supports and loads may act.", "point",
      real("").above(0.0).below(1.0).required().means("Arc length over length of the member; the name may be new."),
      &InnerPoint::point, &InnerPoint::position);
}

BoundList<Member> declared_member_parameters() {
  BoundList<Member> member("A beam between two points, rigidly joined to all members that share a point with it.");
  member.bind(&Member::start_point, text("Start").required(), "Name of the point where the member starts.")
      .column()
      .not_compared();
  member
      .bind(&Member::end_point, text("End").required(),
            "Name of the point where it ends; a new name is allowed where the position follows from the curve: helix, "
            "parametric, arc by Angle.")
      .column()
      .not_compared();
  bind_section_along(member);
  bind_division(member);
  member.bind(&Member::force_integration, text("Force Integration").by_default(),
              "Which part of the force-strain energy takes k instead of k + 1 Gauss points; only 'both reduced' is "
              "free of locking.",
              {{"full", ForceIntegration::full},
               {"axial reduced", ForceIntegration::axial_reduced},
               {"shear reduced", ForceIntegration::shear_reduced},
               {"both reduced", ForceIntegration::both_reduced}});
  member
      .bind(&Member::second_axis, direction("Second Axis"),
            "Direction that section axis 2 takes at the start, as nearly as the tangent permits; the program chooses "
            "one if it is absent.")
      .not_compared();
  member
      .bind(&Member::twist, real("Twist").at_least(-kLargestAngle).at_most(kLargestAngle),
            "Pre-twist: angle by which the section turns about the tangent from start to end [radian].")
      .compared_within(kSameTwist);
  member.spec.add_list("Curve", curve_parameters().spec, Presence::optional);
  return member;
}

/// `frame[2]`
std::string numbered(const std::string& name, std::size_t number) { return name + "[" + std::to_string(number) + "]"; }

}  // namespace

const BoundList<Member>& member_parameters() {
  static const BoundList<Member> parameters = declared_member_parameters();
  return parameters;
}

void SceneReader::read_members() {
  const List& members = list_.sublist("Members");
  list_names_ = names_of(members);
  for (std::size_t i = 0; i < list_names_.size(); ++i) {
    const std::string& name = list_names_[i];
    const List& list = members.sublist(name);
    const InputPlace place = place_["Members"][name];
    Member member = member_parameters().read(list);
    member.name = name;
    CurveDraft draft;
    const bool is_right = place.attempt([&] {
      check_name(name, place_["Members"]);
      complete(member, list, place);
      if (list.isSublist("Curve")) draft = read_curve(list.sublist("Curve"), place["Curve"]);
      if (draft.is_polyline) check_plain(list, place);
    });
    if (!is_right && list.isSublist("Curve")) place.source().cannot_mend();
    if (draft.is_polyline) {
      add_polyline(member, draft, i);
      continue;
    }
    if (draft.arc) open_arcs_.emplace(scene_.members.size(), *draft.arc);
    member.curve = std::move(draft.curve);
    add_member(std::move(member), {false, i});
  }
}

void SceneReader::complete(Member& member, const List& list, const InputPlace& place) const {
  take_only_section(member);
  check_taper(member, place);
  check_inner_points(member, place["Inner Points"]);
  if (list.isParameter("Stations")) read_stations(member, list, place);
}

void SceneReader::take_only_section(Member& member) const {
  if (member.section.empty() && scene_.sections.size() == 1) member.section = scene_.sections.front().name;
}

void SceneReader::check_taper(const Member& member, const InputPlace& place) const {
  if (member.taper.empty()) return;
  const InputPlace taper = place["Taper"];
  if (member.end_section.empty())
    throw taper.error("value \"" + excerpt(member.taper) + "\" without \"End Section\"; allowed: with it only");
  const Expression weight = checked_formula(member.taper, {"x"}, taper);
  check_finite(weight, {"x"}, {{0.0}, {0.25}, {0.5}, {0.75}, {1.0}}, taper);
}

/// Puts them in the order of the member too.
void SceneReader::check_inner_points(Member& member, const InputPlace& place) const {
  auto& inner = member.inner_points;
  for (const auto& [point, position] : inner)
    if (point == member.start_point || point == member.end_point)
      throw place[point].error("an end of the member too; allowed: another point");
  std::stable_sort(inner.begin(), inner.end(),
                   [](const InnerPoint& a, const InnerPoint& b) { return a.position < b.position; });
  for (std::size_t i = 0; i < inner.size(); ++i) {
    const double before = i == 0 ? 0.0 : inner[i - 1].position;
    const double after = i + 1 == inner.size() ? 1.0 : 2.0;
    if (inner[i].position - before > kStationTolerance && after - inner[i].position > kStationTolerance) continue;
    throw place[inner[i].point].error(
        "value " + shortest(inner[i].position) +
        "; allowed: between 0 and 1, and further than 1e-9 from the ends and other inner points");
  }
}

void SceneReader::read_stations(Member& member, const List& list, const InputPlace& place) const {
  const int elements = static_cast<int>(member.stations.size()) - 1;
  if (is_given(list, "Elements") && member.elements != elements) {
    throw place["Elements"].error("value " + std::to_string(member.elements) + ", but \"Stations\" has " +
                                  std::to_string(member.stations.size()) +
                                  " entries; allowed: one less than these, or only one of the two");
  }
  member.elements = elements;
  try {
    divide(member);
  } catch (const std::invalid_argument& problem) {
    throw place["Stations"].error("value " + excerpt(to_text(binding::value_from(member.stations))) + ": " +
                                  problem.what());
  }
}

/// What a polyline shares out among its lines cannot be said for the whole of it.
void SceneReader::check_plain(const List& list, const InputPlace& place) const {
  for (const std::string name : {"Twist", "Stations", "End Section", "Taper", "Inner Points"}) {
    if (!list.isParameter(name) && !list.isSublist(name)) continue;
    throw place[name].error("given for a polyline, which becomes several members; allowed: for a single curve");
  }
}

std::vector<std::string> SceneReader::polyline_points(const Member& whole, const CurveDraft& draft,
                                                      const InputPlace& place) {
  std::vector<std::string> points = {whole.start_point};
  points.insert(points.end(), draft.corner_names.begin(), draft.corner_names.end());
  for (std::size_t i = 0; i < draft.corners.size(); ++i) {
    points.push_back(numbered(whole.name, i + 1));
    if (add_point(points.back(), draft.corners[i])) continue;
    throw place["Curve"]["Through"].error(
        "corner " + std::to_string(i + 1) + " would be point \"" + excerpt(points.back()) +
        "\", which exists already; allowed: another name of the point or of the member");
  }
  points.push_back(whole.end_point);
  return points;
}

void SceneReader::add_polyline(const Member& whole, const CurveDraft& draft, std::size_t list_name) {
  const InputPlace place = place_["Members"][whole.name];
  const std::vector<std::string> points = polyline_points(whole, draft, place);
  const std::size_t lines = points.size() - 1;
  polylines_.push_back({scene_.members.size(), lines, whole.elements});
  for (std::size_t i = 0; i < lines; ++i) {
    Member line = whole;
    line.name = numbered(whole.name, i + 1);
    line.start_point = points[i];
    line.end_point = points[i + 1];
    // the whole of it counts at once, and is shared out when all positions are known
    line.elements = i == 0 ? std::max(1, whole.elements - static_cast<int>(lines) + 1) : 1;
    if (member_index_.count(line.name) > 0 || list_.sublist("Members").isSublist(line.name)) {
      throw place.error("line " + std::to_string(i + 1) + " of the polyline would be member \"" + excerpt(line.name) +
                        "\", which exists already; allowed: another name");
    }
    add_member(std::move(line), {false, list_name});
  }
}

void SceneReader::import_members() {
  if (!list_.isSublist("Import") || !list_.sublist("Import").isParameter("Members File")) return;
  const List& list = list_.sublist("Import");
  imported_members_.emplace(members_table(list, place_["Import"]));
  std::map<std::array<std::string, 3>, std::string> seen;  // by their points in alphabetical order, and the section
  imported_members_->for_each([&](const CsvRecord& record) {
    Member member = imported_member(*imported_members_, record, list, variables_);
    take_only_section(member);
    const auto [low, high] = std::minmax(member.start_point, member.end_point);
    const auto [first, is_new] = seen.try_emplace({low, high, member.section}, member.name);
    if (!is_new)
      throw imported_members_->error(record, "name",
                                     "member \"" + excerpt(member.name) + "\" of section \"" + excerpt(member.section) +
                                         "\" is the same line as \"" + excerpt(first->second) + "\", from \"" +
                                         excerpt(low) + "\" to \"" + excerpt(high) +
                                         "\"; allowed: one of them, or different sections");
    if (member_index_.count(member.name) > 0) {
      throw imported_members_->error(
          record, "name",
          "value \"" + excerpt(member.name) + "\" is the name of another member; allowed: names that differ");
    }
    add_member(std::move(member), {true, static_cast<std::size_t>(record.line)});
  });
}

void SceneReader::add_member(Member member, Origin origin) {
  origins_.push_back(origin);
  const int pieces = static_cast<int>(member.inner_points.size()) + 1;
  elements_ += std::max(member.elements, pieces);
  member_index_.emplace(member.name, scene_.members.size());
  scene_.members.push_back(std::move(member));
  if (elements_ <= kMostElements) return;
  const std::size_t last = scene_.members.size() - 1;
  throw member_error(last, {"Elements"},
                     "value " + std::to_string(scene_.members.back().elements) + " brings the scene to " +
                         std::to_string(elements_) + " elements; allowed: " + std::to_string(kMostElements));
}

}  // namespace mixbeam
