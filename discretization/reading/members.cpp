/// The part of SceneReader that reads members, apart from where they are.

#include "discretization/parameters/access.hpp"
#include "discretization/parameters/input_place.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/reading/scene_reader.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace mixbeam {
namespace {

using namespace vector_algebra;

constexpr int kLargestOrder = 8;
constexpr double kSameTwist = 1e-6;   // of twists, which are written with six digits. [radian]
constexpr double kPlaceOfEnd = 1e-6;  // of the last section station, written with six digits, over the length

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

/// Sections along one straight member, as a table of its own.
struct SectionStations {
  std::vector<double> position{}, twist{};
  std::array<std::vector<double>, 2> offset{};  ///< along axes 2 and 3
  std::vector<std::string> section{};
  std::string table{};
};

const BoundList<SectionStations>& section_stations_parameters() {
  static const BoundList<SectionStations> parameters = [] {
    BoundList<SectionStations> stations(
        "Sections of a straight member at places along it, in place of Section: it becomes members \"<member>[1]\", "
        "\"<member>[2]\", ... between them, as a polyline does, each with a taper from one section to the next.");
    const auto numbers = [](const std::string& name) {
      return array(name, ParameterType::real_array).at_least(-kLargestCoordinate).at_most(kLargestCoordinate);
    };
    stations.bind(&SectionStations::position, numbers("Position"),
                  "Places from 0 to 1, or to the length of the member; ascending.");
    stations.bind(&SectionStations::section, array("Section", ParameterType::text_array),
                  "Name of the section at each.");
    stations.bind(
        &SectionStations::twist, numbers("Twist"),
        "Angle by which the section is turned there about the line from start to end, from Second Axis [radian]; "
        "0 if absent.");
    for (std::size_t i = 0; i < 2; ++i)
      stations.bind(
          [i](auto& s) -> auto& { return s.offset[i]; }, numbers("Offset " + std::to_string(i + 2)),
          "How far the axis of the member lies there from that line, along axis " + std::to_string(i + 2) +
              " without twist [length]; 0 if absent.");
    stations.bind(
        &SectionStations::table, text("Table"),
        "CSV with these columns in place of them: position, section, twist, offset 2, offset 3; relative to the "
        "folder of the scene.");
    return stations;
  }();
  return parameters;
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
  member.bind(&Member::keeps_second_axis, boolean("Keep Second Axis"),
              "True: Second Axis holds at every place of a curve, not at its start alone, from where it is carried.");
  member
      .bind(
          &Member::second_axis_from,
          array("Second Axis From", ParameterType::real_array, 6)
              .at_least(-kLargestCoordinate)
              .at_most(kLargestCoordinate),
          "A point of a line and its direction, in place of Second Axis: section axis 2 points away from that line at "
          "every place, as the normal of a cylinder about it does.")
      .not_compared();
  member
      .bind(&Member::twist, real("Twist").at_least(-kLargestAngle).at_most(kLargestAngle),
            "Pre-twist: angle by which the section turns about the tangent from start to end [radian].")
      .compared_within(kSameTwist);
  for (const std::string end : {"Start", "End"})
    member.spec.add(bounded_vector(end + " Offset"),
                    "Vector from the point " + end +
                        " to where the axis of the member begins or ends: a rigid arm, which "
                        "turns with the point [length].");
  member.spec.add_list("Curve", curve_parameters().spec, Presence::optional);
  member.spec.add_list("Section Stations", section_stations_parameters().spec, Presence::optional);
  return member;
}

/// `frame[2]`
std::string numbered(const std::string& name, std::size_t number) { return name + "[" + std::to_string(number) + "]"; }

/// The table in place of the arrays.
SectionStations read_section_stations(const Teuchos::ParameterList& list, const InputPlace& place,
                                      Variables& variables) {
  SectionStations stations = section_stations_parameters().read(list);
  if (!stations.table.empty()) {
    for (const std::string name : {"Position", "Section", "Twist", "Offset 2", "Offset 3"})
      if (list.isParameter(name)) throw place[name].error("given beside \"Table\"; allowed: one of the two");
    const ImportTable table = stations_table(list, place);
    table.for_each([&](const CsvRecord& record) {
      stations.position.push_back(imported_number(table, record, "position", &variables));
      stations.section.push_back(table.cell(record, "section"));
      stations.twist.push_back(imported_number(table, record, "twist", &variables));
      for (std::size_t i = 0; i < 2; ++i)
        stations.offset[i].push_back(imported_number(table, record, "offset " + std::to_string(i + 2), &variables));
    });
  }
  const std::size_t count = stations.position.size();
  if (count < 2) throw place["Position"].error(std::to_string(count) + " places; allowed: at least two");
  const auto check_count = [&](const std::string& name, auto& column, bool required) {
    if (column.empty() && !required) column.resize(count);
    if (column.size() == count) return;
    throw place[name].error(std::to_string(column.size()) + " entries beside " + std::to_string(count) +
                            " of \"Position\"; allowed: as many");
  };
  check_count("Section", stations.section, true);
  check_count("Twist", stations.twist, false);
  check_count("Offset 2", stations.offset[0], false);
  check_count("Offset 3", stations.offset[1], false);
  return stations;
}

bool any_nonzero(const std::vector<double>& numbers) {
  return std::any_of(numbers.begin(), numbers.end(), [](double number) { return number != 0.0; });
}

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
    if (list.isSublist("Section Stations")) {
      const bool is_right = place.attempt([&] {
        check_name(name, place_["Members"]);
        complete(member, list, place);
        add_stations(std::move(member), list, place, i);
      });
      if (!is_right) place.source().cannot_mend();
      continue;
    }
    CurveDraft draft;
    const bool is_right = place.attempt([&] {
      check_name(name, place_["Members"]);
      complete(member, list, place);
      for (const bool at_start : {true, false}) {
        const std::string parameter = at_start ? "Start Offset" : "End Offset";
        if (list.isParameter(parameter)) add_arm(member, at_start, get_vector(list, parameter), place[parameter], i);
      }
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
  check_orientation(member, place);
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

void SceneReader::check_orientation(const Member& member, const InputPlace& place) const {
  const bool has_axis = !vector_algebra::is_zero(member.second_axis);
  if (member.keeps_second_axis && !has_axis)
    throw place["Keep Second Axis"].error("true without \"Second Axis\"; allowed: with it only");
  if (!member.second_axis_from) return;
  const std::array<double, 6>& line = *member.second_axis_from;
  if (has_axis) throw place["Second Axis From"].error("given beside \"Second Axis\"; allowed: one of the two");
  if (line[3] == 0.0 && line[4] == 0.0 && line[5] == 0.0)
    throw place["Second Axis From"].error("the direction of the line, its last three numbers, is zero");
}

/// Lets an end of the member lie away from its point, at the end of a rigid member between the two.
void SceneReader::add_arm(Member& member, bool at_start, const Vector3& offset, const InputPlace& place,
                          std::size_t list_name) {
  std::string& end = at_start ? member.start_point : member.end_point;
  const auto known = point_index_.find(end);
  if (known == point_index_.end())
    throw place.error("the position of point \"" + excerpt(end) +
                      "\" follows from a curve; allowed: at points of the list "
                      "\"Points\" or of a table");
  const std::string which = at_start ? "start" : "end";
  Member arm;
  arm.name = which + " arm of " + member.name;
  arm.section = rigid_section();
  arm.order = 1;
  arm.keeps_order = arm.keeps_elements = true;
  arm.start_point = end;
  arm.end_point = end = which + " of " + member.name;
  if (is_zero(offset)) throw place.error("zero; allowed: a vector that is not, or none at all");
  if (!add_point(arm.end_point, sum(scene_.points[known->second].position, offset)))
    throw place.error("its end would be point \"" + excerpt(arm.end_point) +
                      "\", which exists already; allowed: another name of the point or of the member");
  if (member_index_.count(arm.name) > 0 || list_.sublist("Members").isSublist(arm.name))
    throw place.error("it would be member \"" + excerpt(arm.name) + "\", which exists already; allowed: another name");
  add_member(std::move(arm), {false, list_name});
}

/// A section that gives way in nothing.
std::string SceneReader::rigid_section() {
  if (!section_index_.try_emplace(kRigidArm, scene_.sections.size()).second) return kRigidArm;
  constexpr double kRigid = std::numeric_limits<double>::infinity();
  Section section;
  section.name = kRigidArm;
  set_diagonal(section, {kRigid, kRigid, kRigid, kRigid, kRigid, kRigid});
  scene_.sections.push_back(section);
  return kRigidArm;
}

void SceneReader::add_stations(Member whole, const List& list, const InputPlace& place, std::size_t list_name) {
  for (const std::string name : {"Section", "End Section", "Taper", "Twist", "Stations", "Inner Points", "Curve",
                                 "Start Offset", "End Offset", "Second Axis From"})
    if (list.isParameter(name) || list.isSublist(name))
      throw place[name].error("given beside \"Section Stations\"; allowed: for other members");
  const InputPlace here = place["Section Stations"];
  const SectionStations stations = read_section_stations(list.sublist("Section Stations"), here, variables_);
  for (const std::string& point : {whole.start_point, whole.end_point})
    if (point_index_.count(point) == 0)
      throw here.error("point \"" + excerpt(point) + "\" of the member is not in the list \"Points\" or a table; " +
                       "allowed: such points");
  const std::vector<double>& places = stations.position;
  const Vector3 start = position_of(whole.start_point), along = difference(position_of(whole.end_point), start);
  const double length = norm(along), last = places.back();
  const bool in_lengths = std::abs(last - length) <= kPlaceOfEnd * length;
  if (places.front() != 0.0 || (!in_lengths && std::abs(last - 1.0) > kPlaceOfEnd) ||
      std::adjacent_find(places.begin(), places.end(), std::greater_equal<>()) != places.end())
    throw here["Position"].error("value " + to_text(binding::value_from(places)) +
                                 "; allowed: ascending from 0 to 1, or to the length of the member, " +
                                 shortest(length));
  std::array<Vector3, 2> axes{};
  if (!is_zero(whole.second_axis)) {
    const Vector3 g1 = scaled(1.0 / length, along), third = cross(g1, whole.second_axis);
    if (norm(third) < kSmallestSecondAxisAngle * norm(whole.second_axis))
      throw place["Second Axis"].error("value " + to_text(whole.second_axis) + " is parallel to the member");
    axes = {cross(unit(third), g1), unit(third)};
  } else if (any_nonzero(stations.twist) || any_nonzero(stations.offset[0]) || any_nonzero(stations.offset[1])) {
    throw place["Second Axis"].error("missing; needed where \"Section Stations\" has twists or offsets");
  }
  const auto in_section = [&](double second, double third) {
    return sum(scaled(second, axes[0]), scaled(third, axes[1]));
  };
  const std::size_t pieces = places.size() - 1;
  CurveDraft corners;
  for (std::size_t i = 0; i <= pieces; ++i) {
    const Vector3 offset = in_section(stations.offset[0][i], stations.offset[1][i]);
    if (i > 0 && i < pieces)
      corners.corners.push_back(sum(sum(start, scaled(places[i] / last, along)), offset));
    else if (!is_zero(offset))
      add_arm(whole, i == 0, offset, here, list_name);
  }
  const std::size_t first = scene_.members.size();
  add_polyline(whole, corners, list_name);
  for (std::size_t i = 0; i < pieces; ++i) {
    Member& piece = scene_.members[first + i];
    piece.section = stations.section[i];
    if (stations.section[i + 1] != piece.section) piece.end_section = stations.section[i + 1];
    piece.second_axis = in_section(std::cos(stations.twist[i]), std::sin(stations.twist[i]));
    piece.twist = stations.twist[i + 1] - stations.twist[i];
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
