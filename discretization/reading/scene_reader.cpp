#include "discretization/checks/mechanism.hpp"
#include "discretization/geometry/placement.hpp"
#include "discretization/geometry/reference_curve.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/reading/variables.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <unordered_map>

namespace mixbeam {

namespace {

constexpr std::size_t kLongestUnit = 16;  // letters: labels of axes have no more room

/// Example of a clamp at this point, in the language of the scene.
std::string example_of_support(const std::string& point, InputLanguage language) {
  const std::string inside = "in \"Scene\" a list \"Supports\", like ";
  if (language == InputLanguage::yaml) return inside + "Supports: {base: {Point: " + excerpt(point) + "}}";
  if (language == InputLanguage::python) return "scene.supports[\"base\"] = dict(point=\"" + excerpt(point) + "\")";
  return inside +
         R"(<ParameterList name="Supports"><ParameterList name="base"><Parameter name="Point" type="string" )" +
         "value=\"" + excerpt(point) + R"("/></ParameterList></ParameterList>)";
}

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
    stations.bind(&SectionStations::position, coordinates("Position"),
                  "Places from 0 to 1, or to the length of the member; ascending.");
    stations.bind(&SectionStations::section, array("Section", ParameterType::text_array),
                  "Name of the section at each.");
    stations.bind(&SectionStations::twist, coordinates("Twist"),
                  "Angle by which the section is turned there about the line from start to end, from Second Axis "
                  "[radian]; 0 if absent.");
    for (std::size_t i = 0; i < 2; ++i)
      stations.bind(
          [i](auto& s) -> auto& { return s.offset[i]; }, coordinates("Offset " + std::to_string(i + 2)),
          "How far the axis of the member lies there from that line, along axis " + std::to_string(i + 2) +
              " without twist [length]; 0 if absent.");
    stations.bind(&SectionStations::table, text("Table"),
                  "CSV with these columns in place of them: position, section, twist, offset 2, offset 3; relative to "
                  "the folder of the scene.");
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
      .bind(&Member::second_axis_from, coordinates("Second Axis From", 6),
            "A point of a line and its direction, in place of Second Axis: section axis 2 points away from that line "
            "at every place, as the normal of a cylinder about it does.")
      .not_compared();
  member
      .bind(&Member::twist, real("Twist").at_least(-kLargestAngle).at_most(kLargestAngle),
            "Pre-twist: angle by which the section turns about the tangent from start to end [radian].")
      .compared_within(kSameTwist);
  for (const std::string end : {"Start", "End"})
    member.spec.add(
        bounded_vector(end + " Offset"),
        "Vector from the point " + end +
            " to where the axis of the member begins or ends: a rigid arm, which turns with the point [length].");
  member.spec.add_list("Curve", curve_parameters().spec, Presence::optional);
  member.spec.add_list("Section Stations", section_stations_parameters().spec, Presence::optional);
  return member;
}

/// `frame[2]`
std::string numbered(const std::string& name, std::size_t number) { return name + "[" + std::to_string(number) + "]"; }

/// Reads section stations, from a table in place of the arrays if there is one.
SectionStations read_section_stations(const Teuchos::ParameterList& list, const InputPlace& place,
                                      Variables& variables) {
  SectionStations stations = section_stations_parameters().read(list);
  if (!stations.table.empty()) {
    for (const std::string name : {"Position", "Section", "Twist", "Offset 2", "Offset 3"})
      if (list.isParameter(name)) throw place[name].error("given beside \"Table\"; allowed: one of the two");
    const ImportTable table =
        import_table(list, "Table", place, {"position", "section", "twist", "offset 2", "offset 3"}, 2);
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

// Below this share of the coordinates, a length consists of rounding errors.
constexpr double kShortestRelativeLength = 1e-12;

/// Assigns one element to each length, the others where they are longest. Costs the logarithm of the number of lines
/// for each line, and nothing for each element.
std::vector<int> shared_by_length(int elements, const std::vector<double>& lengths) {
  const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  const int spare = elements - static_cast<int>(lengths.size());
  std::vector<int> shares(lengths.size(), 1);
  if (spare <= 0 || !(whole > 0.0)) return shares;
  std::priority_queue<std::pair<double, std::size_t>> longest;
  int left = elements;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    shares[i] = std::max(1, static_cast<int>(spare * (lengths[i] / whole)));
    left -= shares[i];
    longest.emplace(lengths[i] / shares[i], i);
  }
  for (; left > 0; --left) {
    const std::size_t i = longest.top().second;
    longest.pop();
    longest.emplace(lengths[i] / ++shares[i], i);
  }
  return shares;
}

/// Names in the order of the scene.
std::vector<std::string> in_order(const std::unordered_map<std::string, std::size_t>& index) {
  std::vector<std::string> names(index.size());
  for (const auto& [name, i] : index) names[i] = name;
  return names;
}

/// Reads a validated list in one pass, with every check that involves more than one parameter. Supports, joints and
/// loads are in conditions.cpp.
class SceneReader {
 public:
  SceneReader(const Teuchos::ParameterList& list, const InputPlace& place, Variables& variables)
      : list_(list), place_(place), variables_(variables) {}

  Scene read() {
    place_.source().collect([this] { read_lists(); });
    return std::move(scene_);
  }

  /// Remarks on what was left out at the ends of patterns, and why.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  using List = Teuchos::ParameterList;
  using Index = std::unordered_map<std::string, std::size_t>;

  /// Origin of a member: a list of "Members", or a line of the imported table.
  struct Origin {
    bool is_imported;
    std::size_t place;  ///< in list_names_, or the line of the table
  };

  /// The lines that a polyline becomes.
  struct Polyline {
    std::size_t first_member, lines;
    int elements;  ///< of all of them
  };

  // The scene, sections, points.
  void read_lists() {
    scene_.name = place_.source().root_name();
    if (list_.isParameter("Accuracy")) scene_.accuracy = list_.get<double>("Accuracy");
    const ParameterSource& source = place_.source();
    if (list_.isParameter("Accuracy Of")) scene_.accuracy_of = list_.get<std::string>("Accuracy Of");
    place_["Accuracy Of"].attempt([this] {
      if (!scene_.accuracy_of.empty() && !scene_.accuracy)
        throw place_["Accuracy Of"].error("given without \"Accuracy\"; allowed: with it");
    });
    place_["Units"].attempt([this] { read_units(); });
    read_sections();
    read_points();
    import_points();
    read_members();
    import_members();
    source.require_mended();
    if (scene_.members.empty())
      throw place_["Members"].error("no member; allowed: at least one, here or by \"Import\"");
    place_members();
    share_out_elements();
    check_members();
    source.require_mended();
    std::vector<CopiedPattern> copies;
    if (list_.isSublist("Patterns") || list_.isSublist("Imperfection")) source.require_none();
    if (list_.isSublist("Patterns")) copies = apply_patterns(list_.sublist("Patterns"), place_["Patterns"], scene_);
    if (list_.isSublist("Imperfection"))
      apply_imperfection(list_.sublist("Imperfection"), place_["Imperfection"], scene_);
    notes_ = read_conditions(list_, place_, scene_, copies);
    if (!source.has_mistakes()) check_points_are_used();
  }

  void read_units() {
    if (!list_.isParameter("Units")) return;
    scene_.units = list_.get<std::string>("Units");
    const std::size_t comma = scene_.units.find(',');
    const auto is_word = [](const std::string& word) {
      const bool is_line = std::none_of(word.begin(), word.end(), [](unsigned char c) { return c < ' ' || c == 127; });
      return is_line && !trimmed(word).empty() && word.size() <= kLongestUnit && word.find(',') == std::string::npos;
    };
    if (comma != std::string::npos && is_word(scene_.units.substr(0, comma)) && is_word(scene_.units.substr(comma + 1)))
      return;
    throw place_["Units"].error("value \"" + excerpt(scene_.units) +
                                "\"; allowed: a unit of length, a comma and a unit of force, as \"m, N\"");
  }

  void read_sections() {
    scene_.sections = mixbeam::read_sections(list_.sublist("Sections"), place_["Sections"],
                                             profile_finder(list_, place_, scene_.units));
    if (scene_.sections.empty())
      throw place_["Sections"].error("no section; allowed: at least one, here or by \"Import\"");
    for (std::size_t i = 0; i < scene_.sections.size(); ++i) section_index_.emplace(scene_.sections[i].name, i);
  }

  void read_points() {
    const List& points = list_.sublist("Points");
    for (const std::string& name : names_of(points)) {
      place_["Points"][name].attempt([&] { check_name(name, place_["Points"]); });
      add_point(name, get_vector(points, name));
    }
  }

  void import_points() {
    declared_points_ = scene_.points.size();
    if (!list_.isSublist("Import") || !list_.sublist("Import").isParameter("Points File")) return;
    const ImportTable table = points_table(list_.sublist("Import"), place_["Import"]);
    table.for_each([&](const CsvRecord& record) {
      const Point point = imported_point(table, record, variables_);
      if (add_point(point.name, point.position)) return;
      throw table.error(
          record, "name",
          "value \"" + excerpt(point.name) + "\" is the name of another point; allowed: names that differ");
    });
  }

  /// A table may hold more points than members use; an unused point written in the scene itself is a slip.
  void check_points_are_used() {
    for (std::size_t i = origins_.size(); i < scene_.members.size(); ++i) {  // copies of patterns
      const Member& copy = scene_.members[i];
      touch_point(copy.start_point);
      touch_point(copy.end_point);
      for (const InnerPoint& inner : copy.inner_points) touch_point(inner.point);
    }
    for (std::size_t i = 0; i < declared_points_; ++i) {
      if (point_touched_[i]) continue;
      const InputPlace place = place_["Points"][scene_.points[i].name];
      place.source().keep(place.error(
          "unused: no member, imported or copied ones included, starts or ends here; allowed: points of members"));
    }
  }

  void touch_point(const std::string& point) {
    const auto found = point_index_.find(point);  // patterns make points of their own, too
    if (found != point_index_.end()) point_touched_[found->second] = true;
  }

  /// Checks the name of an entry of the list at `place`.
  void check_name(const std::string& name, const InputPlace& place) const {
    const Problem problem = result_name_problem(name);
    if (!problem.empty()) throw place[name].error("name " + problem);
  }

  /// Adds a point; false if there is one of this name.
  bool add_point(const std::string& name, const Vector3& position) {
    if (!point_index_.emplace(name, scene_.points.size()).second) return false;
    scene_.points.push_back(Point{name, position});
    return true;
  }

  const Vector3& position_of(const std::string& point) const {
    const auto found = point_index_.find(point);  // its mistake may have been kept
    if (found == point_index_.end()) throw place_["Points"].error("no point \"" + excerpt(point) + "\"");
    return scene_.points[found->second].position;
  }

  // Members, without their positions.
  void read_members() {
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
      member.curve = std::move(static_cast<Curve&>(draft));
      add_member(std::move(member), {false, i});
    }
  }

  /// Completes a member with the checks that involve several parameters.
  void complete(Member& member, const List& list, const InputPlace& place) const {
    take_only_section(member);
    check_taper(member, place);
    check_orientation(member, place);
    check_inner_points(member, place["Inner Points"]);
    if (list.isParameter("Stations")) read_stations(member, list, place);
  }

  /// Gives a member without section the only section of the scene.
  void take_only_section(Member& member) const {
    if (member.section.empty() && scene_.sections.size() - section_index_.count(kRigidArm) == 1)
      member.section = scene_.sections.front().name;
  }

  /// Checks inner points and sorts them along the member.
  void check_inner_points(Member& member, const InputPlace& place) const {
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

  void read_stations(Member& member, const List& list, const InputPlace& place) const {
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

  void check_taper(const Member& member, const InputPlace& place) const {
    if (member.taper.empty()) return;
    const InputPlace taper = place["Taper"];
    if (member.end_section.empty())
      throw taper.error("value \"" + excerpt(member.taper) + "\" without \"End Section\"; allowed: with it only");
    const Expression weight = checked_formula(member.taper, {"x"}, taper);
    check_finite(weight, {"x"}, {{0.0}, {0.25}, {0.5}, {0.75}, {1.0}}, taper);
  }

  void check_orientation(const Member& member, const InputPlace& place) const {
    const bool has_axis = !vector_algebra::is_zero(member.second_axis);
    if (member.keeps_second_axis && !has_axis)
      throw place["Keep Second Axis"].error("true without \"Second Axis\"; allowed: with it only");
    if (!member.second_axis_from) return;
    const std::array<double, 6>& line = *member.second_axis_from;
    if (has_axis) throw place["Second Axis From"].error("given beside \"Second Axis\"; allowed: one of the two");
    if (line[3] == 0.0 && line[4] == 0.0 && line[5] == 0.0)
      throw place["Second Axis From"].error("the direction of the line, its last three numbers, is zero");
  }

  /// Moves an end of the member away from its point, to the end of a rigid member between the two.
  void add_arm(Member& member, bool at_start, const Vector3& offset, const InputPlace& place, std::size_t list_name) {
    std::string& end = at_start ? member.start_point : member.end_point;
    const auto known = point_index_.find(end);
    if (known == point_index_.end())
      throw place.error("the position of point \"" + excerpt(end) +
                        "\" follows from a curve; allowed: at points of the list \"Points\" or of a table");
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
      throw place.error("it would be member \"" + excerpt(arm.name) +
                        "\", which exists already; allowed: another name");
    add_member(std::move(arm), {false, list_name});
  }

  /// Section that is rigid in all components.
  std::string rigid_section() {
    if (!section_index_.try_emplace(kRigidArm, scene_.sections.size()).second) return kRigidArm;
    constexpr double kRigid = std::numeric_limits<double>::infinity();
    Section section;
    section.name = kRigidArm;
    set_diagonal(section, {kRigid, kRigid, kRigid, kRigid, kRigid, kRigid});
    scene_.sections.push_back(section);
    return kRigidArm;
  }

  void add_stations(Member whole, const List& list, const InputPlace& place, std::size_t list_name) {
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

  void add_polyline(const Member& whole, const CurveDraft& draft, std::size_t list_name) {
    const InputPlace place = place_["Members"][whole.name];
    const std::vector<std::string> points = polyline_points(whole, draft, place);
    const std::size_t lines = points.size() - 1;
    polylines_.push_back({scene_.members.size(), lines, whole.elements});
    for (std::size_t i = 0; i < lines; ++i) {
      Member line = whole;
      line.name = numbered(whole.name, i + 1);
      line.start_point = points[i];
      line.end_point = points[i + 1];
      // elements of the whole count at once, and are distributed when all positions are known
      line.elements = i == 0 ? std::max(1, whole.elements - static_cast<int>(lines) + 1) : 1;
      if (member_index_.count(line.name) > 0 || list_.sublist("Members").isSublist(line.name)) {
        throw place.error("line " + std::to_string(i + 1) + " of the polyline would be member \"" + excerpt(line.name) +
                          "\", which exists already; allowed: another name");
      }
      add_member(std::move(line), {false, list_name});
    }
  }

  std::vector<std::string> polyline_points(const Member& whole, const CurveDraft& draft, const InputPlace& place) {
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

  /// Refuses parameters that a polyline as a whole cannot have.
  void check_plain(const List& list, const InputPlace& place) const {
    for (const std::string name : {"Twist", "Stations", "End Section", "Taper", "Inner Points"}) {
      if (!list.isParameter(name) && !list.isSublist(name)) continue;
      throw place[name].error("given for a polyline, which becomes several members; allowed: for a single curve");
    }
  }

  void import_members() {
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
                                       "member \"" + excerpt(member.name) + "\" of section \"" +
                                           excerpt(member.section) + "\" is the same line as \"" +
                                           excerpt(first->second) + "\", from \"" + excerpt(low) + "\" to \"" +
                                           excerpt(high) + "\"; allowed: one of them, or different sections");
      if (member_index_.count(member.name) > 0) {
        throw imported_members_->error(
            record, "name",
            "value \"" + excerpt(member.name) + "\" is the name of another member; allowed: names that differ");
      }
      add_member(std::move(member), {true, static_cast<std::size_t>(record.line)});
    });
  }

  void add_member(Member member, Origin origin) {
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

  // Positions of members.
  void place_members() {
    const auto needed = [this](const Member& member) { return points_needed(member); };
    for (const std::size_t member : placement_order(scene_, needed))
      if (!geometry_of(member).attempt([&] { place_member(member); })) place_.source().cannot_mend();
  }

  void place_member(std::size_t index) {
    const CurveShape shape = scene_.members[index].curve.shape;
    if (shape == CurveShape::circular_arc) complete_open_arc(index);
    if (shape == CurveShape::circular_arc || shape == CurveShape::helix) check_curve(index);
    const Member& member = scene_.members[index];
    if (shape == CurveShape::line && !member.inner_points.empty()) check_line(index);
    const Vector3 start = position_of(member.start_point);  // a copy: points are added
    for (const PointOfMember& point : points_of_member(member, start, [&] { return reference_curve_of(index); }))
      place_point(point, index);
  }

  /// Points that must be known before a member can be placed.
  std::vector<std::string> points_needed(const Member& member) const {
    const auto arc = open_arcs_.find(member_index_.at(member.name));
    const bool needs_end = arc == open_arcs_.end() ? !defines_end(member.curve) : arc->second.needs_end();
    if (needs_end && member.end_point != member.start_point) return {member.start_point, member.end_point};
    return {member.start_point};
  }

  void complete_open_arc(std::size_t index) {
    const auto arc = open_arcs_.find(index);
    if (arc == open_arcs_.end()) return;
    Member& member = scene_.members[index];
    const Vector3 start = position_of(member.start_point);
    const Vector3 end = arc->second.needs_end() ? position_of(member.end_point) : start;
    try {
      complete_arc(member.curve, arc->second, start, end);
    } catch (const std::invalid_argument& problem) {
      const std::string name = arc->second.given == ArcDefinition::Given::point ? "Through" : "Radius";
      throw member_error(index, {"Curve", name}, std::string("there is no such arc: ") + problem.what());
    }
  }

  /// An arc of more than a turn overlaps itself: its angle is probably in degrees.
  static std::string degrees_hint(const Curve& curve) {
    if (curve.shape != CurveShape::circular_arc || curve.angle <= 2.0 * kPi) return "";
    return "; \"Angle\" is in radian, did you mean \"=" + shortest(curve.angle) + " deg\"?";
  }

  /// Adds the point, or checks the position of an existing one.
  void place_point(const PointOfMember& placed, std::size_t member) {
    using Role = PointOfMember::Role;
    const Role role = placed.role;
    const ParameterPath parameter = role == Role::start ? ParameterPath{"Start"}
                                    : role == Role::end ? ParameterPath{"End"}
                                                        : ParameterPath{"Inner Points", placed.point};
    const Problem problem = result_name_problem(placed.point);
    if (!problem.empty()) throw member_error(member, parameter, "name " + problem);
    if (add_point(placed.point, placed.position)) return;
    const Vector3& declared = position_of(placed.point);
    if (norm(difference(declared, placed.position)) <= kPlaceTolerance * placed.length) return;
    const std::string where = role == Role::start ? "formulas begin at "
                              : role == Role::end ? "curve ends at "
                                                  : "curve passes at ";
    throw member_error(member, parameter,
                       "value \"" + excerpt(placed.point) + "\" is at " + to_text(declared) + ", but the " + where +
                           to_text(placed.position) + "; allowed: equal to 1e-9 of the curve length " +
                           shortest(placed.length) + (role == Role::start ? "" : ", or a new name") +
                           degrees_hint(scene_.members[member].curve));
  }

  /// Curve of a member whose points are known as far as it needs them.
  ReferenceCurve reference_curve_of(std::size_t index) const {
    const Member& member = scene_.members[index];
    const Vector3& start = position_of(member.start_point);
    const auto end = point_index_.find(member.end_point);
    try {
      return make_reference_curve(member, start,
                                  end == point_index_.end() ? start : scene_.points[end->second].position);
    } catch (const std::invalid_argument& problem) {
      throw member_error(index, {"Curve"},
                         std::string(problem.what()) + "; allowed: a smooth curve that never stops or turns back");
    }
  }

  /// Distributes the elements of polylines: one for each line, the others in proportion to the lengths.
  void share_out_elements() {
    for (const Polyline& polyline : polylines_) {
      std::vector<double> lengths;
      for (std::size_t i = 0; i < polyline.lines; ++i) {
        const Member& line = scene_.members[polyline.first_member + i];
        const auto start = point_index_.find(line.start_point), end = point_index_.find(line.end_point);
        if (start == point_index_.end() || end == point_index_.end()) return;  // reported by check_members
        lengths.push_back(norm(difference(scene_.points[end->second].position, scene_.points[start->second].position)));
      }
      const std::vector<int> elements = shared_by_length(polyline.elements, lengths);
      for (std::size_t i = 0; i < polyline.lines; ++i) scene_.members[polyline.first_member + i].elements = elements[i];
    }
  }

  void check_members() {
    point_touched_.assign(scene_.points.size(), false);
    for (std::size_t i = 0; i < scene_.members.size(); ++i) {
      check_known(i, &Member::start_point, "Start", "point", point_index_);
      check_known(i, &Member::end_point, "End", "point", point_index_);
      check_known(i, &Member::section, "Section", "section", section_index_);
      if (!scene_.members[i].end_section.empty())
        check_known(i, &Member::end_section, "End Section", "section", section_index_);
      place_.source().require_mended();
      geometry_of(i).attempt([&] { check_member(i); });
    }
  }

  void check_member(std::size_t i) {
    const Member& member = scene_.members[i];
    touch_point(member.start_point);
    touch_point(member.end_point);
    for (const InnerPoint& inner : member.inner_points) touch_point(inner.point);
    if (!member.end_section.empty()) check_taper_values(i);
    if (member.curve.shape == CurveShape::line) check_line(i);
    if (member.curve.shape == CurveShape::spline || member.keeps_second_axis || member.second_axis_from)
      reference_curve_of(i);
    if (!is_zero(member.second_axis)) check_second_axis(i);
  }

  /// Place of mistakes in a member's geometry: the whole scene if there are others, from which they may follow.
  InputPlace geometry_of(std::size_t member) const {
    return place_.source().has_mistakes() ? place_ : place_["Members"][scene_.members[member].name];
  }

  /// Keeps a mistake if nothing has the name, and replaces it by the nearest one.
  void check_known(std::size_t index, std::string Member::*name, const std::string& parameter, const std::string& what,
                   const Index& known) {
    Member& member = scene_.members[index];
    std::string& given = member.*name;
    if (known.count(given) > 0) return;
    std::vector<std::string> names = in_order(known);
    names.erase(std::remove(names.begin(), names.end(), kRigidArm), names.end());
    place_["Members"][member.name][parameter].attempt([&] {
      const std::string seen =
          given.empty() ? "missing " + what : "value \"" + excerpt(given) + "\" is not a " + what + " of the scene";
      throw member_error(index, {parameter}, seen + "; allowed: " + quoted_list(names) + did_you_mean(given, names));
    });
    const std::string nearest = nearest_name(given, names);
    const bool is_anywhere = member.curve.shape != CurveShape::line || !member.inner_points.empty();
    if (names.empty() || (what == "point" && is_anywhere)) return place_.source().cannot_mend();
    given = nearest.empty() ? names.front() : nearest;
  }

  void check_curve(std::size_t index) const {
    const Member& member = scene_.members[index];
    const Curve& curve = member.curve;
    const Vector3 start = position_of(member.start_point);
    const Vector3 from_center = difference(start, curve.center);
    const double radius = norm(radius_vector(curve, start));
    if (radius < kShortestLength || radius <= kShortestRelativeLength * (norm(from_center) + norm(start))) {
      throw member_error(index, {"Curve", "Center"},
                         "value " + to_text(curve.center) + ": the start point \"" + excerpt(member.start_point) +
                             "\" lies on the axis; allowed: a radius > 0");
    }
    const double height = dot(from_center, axis_direction(curve));
    if (curve.shape == CurveShape::circular_arc && std::abs(height) > kPlaceTolerance * radius) {
      const Vector3 center = sum(curve.center, scaled(height, axis_direction(curve)));
      throw member_error(index, {"Curve", "Center"},
                         "value " + to_text(curve.center) + " is not in the plane of the arc; allowed: " +
                             to_text(center) + " for this start point and axis");
    }
    const double arc = radius * curve.angle;
    if (arc < kShortestLength || arc < kShortestRelativeLength * norm(start)) {
      throw member_error(index, {"Curve", "Angle"},
                         "value " + shortest(curve.angle) + ": the member has no length; allowed: larger");
    }
  }

  void check_line(std::size_t index) const {
    const Member& member = scene_.members[index];
    const Vector3& start = position_of(member.start_point);
    const Vector3& end = position_of(member.end_point);
    const double length = norm(difference(end, start));
    if (length >= kShortestLength && length > kShortestRelativeLength * std::max(norm(start), norm(end))) return;
    throw member_error(index, {},
                       "no length: it starts at \"" + excerpt(member.start_point) + "\" " + to_text(start) +
                           " and ends at \"" + excerpt(member.end_point) + "\" " + to_text(end) +
                           "; allowed: two different positions");
  }

  /// Checks vertices and samples of the elements; between them the elements check themselves.
  void check_taper_values(std::size_t index) const {
    constexpr int kMostPlaces = 20'000;  // of a member: a hundredth of a second
    const Member& member = scene_.members[index];
    const int places = std::min(kMostPlaces, member.elements) * std::max(4, 2 * member.order);
    try {
      const SectionLaw law(scene_, member);
      for (int i = 0; i <= places; ++i) law.compliance(static_cast<double>(i) / places);
    } catch (const std::invalid_argument& problem) {
      throw member_error(index, {member.taper.empty() ? "End Section" : "Taper"}, problem.what());
    }
  }

  void check_second_axis(std::size_t index) const {
    const Member& member = scene_.members[index];
    if (member.curve.shape == CurveShape::spline || member.curve.shape == CurveShape::parametric) return;  // done
    const Vector3 tangent = start_tangent(member.curve, position_of(member.start_point), position_of(member.end_point));
    if (norm(cross(tangent, scaled(1.0 / norm(member.second_axis), member.second_axis))) >= kSmallestSecondAxisAngle)
      return;
    throw member_error(index, {"Second Axis"},
                       "value " + to_text(member.second_axis) + " is parallel to the start tangent " +
                           to_text(tangent) + "; allowed: any other direction");
  }

  InputError member_error(std::size_t member, const ParameterPath& parameter, const std::string& problem) const {
    const std::string& name = scene_.members[member].name;
    const Origin& origin = origins_[member];
    if (origin.is_imported) {
      std::string column = parameter.empty() ? "name" : parameter.front();
      column[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(column[0])));
      return imported_members_->error(static_cast<int>(origin.place), column,
                                      "member \"" + excerpt(name) + "\": " + problem);
    }
    const std::string& list_name = list_names_[origin.place];
    InputPlace place = place_["Members"][list_name];
    for (const std::string& part : parameter) place = place[part];
    return place.error((name == list_name ? "" : "line \"" + excerpt(name) + "\": ") + problem);
  }

  const List& list_;
  const InputPlace place_;
  Variables& variables_;
  std::vector<std::string> notes_;
  Scene scene_;
  Index section_index_, point_index_, member_index_;
  std::vector<bool> point_touched_;
  std::vector<std::string> list_names_;  ///< of the list "Members"
  std::vector<Origin> origins_;          ///< of every member
  std::optional<ImportTable> imported_members_;
  std::size_t declared_points_ = 0;  ///< those of the list "Points", which come first
  long long elements_ = 0;           ///< of all members so far
  std::vector<Polyline> polylines_;
  std::unordered_map<std::size_t, ArcDefinition> open_arcs_;  ///< member -> data that define its centre, axis, angle
};

}  // namespace

ListSpec scene_spec() {
  ListSpec spec(
      "The structure, its supports and its loads; any consistent units, angles in radians, global axes x, y, z.");
  spec.add_list("Variables", variables_spec(), Presence::optional);
  spec.add_list(
      "Sections",
      ListSpec("Cross sections; at least one here or by Import.").with_named_lists("section", section_spec()));
  spec.add_list("Points", ListSpec("Points of the undeformed structure; at least one here or by Import.")
                              .with_named_parameters(
                                  "point", bounded_vector("").required().means("Global coordinates [length].")));
  spec.add_list(
      "Members",
      ListSpec("Beams; at least one here or by Import.").with_named_lists("member", member_parameters().spec));
  spec.add_list("Import", import_spec(), Presence::optional);
  spec.add_list("Patterns", patterns_spec(), Presence::optional);
  spec.add_list("Imperfection", imperfection_spec(), Presence::optional);
  spec.add(real("Accuracy").above(kBestAccuracy).below(1.0),
           "Wanted error of displacements over the largest of them, at the end of the path: order and number of "
           "elements are chosen for every member that does not give them itself.");
  spec.add(text("Accuracy Of"),
           "With Accuracy: name of an entry of the list Quantities whose error over its size counts in place of that "
           "of displacements, or stress: the largest von Mises stress.");
  spec.add(text("Units"),
           "Units of length and force, as \"m, N\": words for the labels of pictures and for reports. Nothing is "
           "converted but the dimensions of a Profile.");
  add_condition_lists(spec);
  return spec;
}

Scene read_scene(Teuchos::ParameterList& scene_list, const ParameterSource& source, const ParameterPath& path,
                 const SceneRemarks& remarks) {
  Scene scene;
  source.collect([&] {
    static const ListSpec spec = scene_spec();
    Variables variables(scene_list, source, path);
    variables.resolve(scene_list, spec, path);
    validate(scene_list, spec, source, path);
    source.require_mended();
    SceneReader reader(scene_list, {source, path}, variables);
    scene = reader.read();
    if (remarks.notes != nullptr) *remarks.notes = reader.notes();
    source.require_none();
    try {
      if (scene.supports.empty())
        throw source.error(child(path, "Supports"),
                           "no support: the whole structure can move freely; needed: " +
                               example_of_support(scene.points.front().name, source.language()));
      check_supports(scene, source, path);
    } catch (const InputError& error) {
      if (remarks.loose == nullptr) throw;
      *remarks.loose = error.what();
    }
  });
  source.require_mended();
  return scene;
}

const BoundList<Member>& member_parameters() {
  static const BoundList<Member> parameters = declared_member_parameters();
  return parameters;
}

}  // namespace mixbeam
