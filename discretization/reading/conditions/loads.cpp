/// The part of ConditionReader that reads loads and eigenstrains.

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/parameters/access.hpp"
#include "discretization/parameters/input_place.hpp"
#include "discretization/reading/conditions/condition_reader.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/mass.hpp"
#include "discretization/text/formula.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mixbeam {
namespace {

const std::vector<std::pair<std::string, LoadFrame>> kFrames = {{"dead", LoadFrame::dead},
                                                                {"follower", LoadFrame::follower}};
const std::vector<std::string> kAlongMember = {"s", "x", "X", "Y", "Z"};
constexpr int kSamplesPerMember = 4;     // intervals: ends, middle, quarters
constexpr std::size_t kMostOfPiece = 9;  // lines of an element in a table: the points of order 8

bool has_both_ends_at(const Member& member, const std::string& point) {
  return member.start_point == point && member.end_point == point;
}

/// Values of these names at the ends of the intervals.
std::vector<std::vector<double>> samples_along(const ReferenceCurve& curve) {
  std::vector<std::vector<double>> samples;
  for (int k = 0; k <= kSamplesPerMember; ++k) {
    const double x = static_cast<double>(k) / kSamplesPerMember;
    const Vec3<double> position = curve.position(x * curve.length);
    samples.push_back({x * curve.length, x, position[0], position[1], position[2]});
  }
  return samples;
}

/// A coordinate of the undeformed member as a formula of x; empty where there is none.
std::string coordinate_along(const Member& member, const Vector3& start, const Vector3& end, int axis) {
  using namespace vector_algebra;
  const auto number = [](double value) { return "(" + shortest(value) + ")"; };
  const Curve& curve = member.curve;
  if (curve.shape == CurveShape::line) return "(" + number(start[axis]) + "+" + number(end[axis] - start[axis]) + "*x)";
  if (curve.shape != CurveShape::circular_arc && curve.shape != CurveShape::helix) return "";
  const Vector3 normal = axis_direction(curve), radius = radius_vector(curve, start), across = cross(normal, radius);
  const std::string angle = number(curve.angle) + "*x";
  return "(" + number(start[axis] - radius[axis]) + "+" + number(curve.rise * normal[axis]) + "*x+" +
         number(radius[axis]) + "*cos(" + angle + ")+" + number(across[axis]) + "*sin(" + angle + "))";
}

ParameterSpec formulas(const std::string& name) {
  return array(name, ParameterType::text_array, 3).or_other("a formula");
}

BoundList<PointLoad> point_load_parameters() {
  BoundList<PointLoad> load("A concentrated force and moment.");
  load.bind(&PointLoad::point, text("Point").required(), "Name of the point" + kWildcard);
  load.bind(&PointLoad::force, vector3("Force").by_default(), "Force [force].");
  load.bind(&PointLoad::moment, vector3("Moment").by_default(), "Moment [force * length].");
  load.bind(&PointLoad::frame, text("Frame").by_default(),
            "dead: components in global axes, direction kept; follower: components in the triad of Member at this "
            "point, which turns with it.",
            kFrames);
  load.bind(&PointLoad::member, text("Member"),
            "follower only: name of the member whose triad the components refer to; " + kWildcards +
                ", but must leave one member at each point.");
  bind_schedule(load, "The load grows");
  load.spec.with_forms("Frame", {{"dead", {Form{}}}, {"follower", {Form{{}, {"Member"}}}}});
  return load;
}

BoundList<DistributedLoad> gravity_parameters() {
  BoundList<DistributedLoad> gravity(
      "Weight of all members whose sections have a mass (Density of the material, or Mass); several by names of your "
      "own, of which each has a Stage or Case.");
  gravity.bind(&DistributedLoad::force, vector3("Acceleration").required(),
               "Acceleration of free fall, in global axes: {0, 0, -9.81} [length / time^2].");
  bind_schedule(gravity, "The weight grows");
  return gravity;
}

/// As it was written.
struct RotatingFrameDraft : RotatingFrame {
  Vector3 axis{};
  double speed = 0.0;
};

BoundList<RotatingFrameDraft> rotating_frame_parameters() {
  BoundList<RotatingFrameDraft> frame(
      "A frame that turns steadily, in which the structure is at rest: centrifugal forces on all masses (Density of "
      "Material, or Mass, of sections, with their inertia; Point Masses), and Coriolis forces in Modes. Supports, dead "
      "loads and Gravity turn with the frame.");
  frame.bind(&RotatingFrameDraft::point, vector3("Point").by_default(), "A point of the axis [length].");
  frame.bind(&RotatingFrameDraft::axis, vector3("Axis").required(),
             "Direction of the axis, in global axes: {0, 0, 1}, of any length.");
  frame.bind(&RotatingFrameDraft::speed, real("Angular Velocity").required(),
             "About the axis, right-handed [radian / time], the unit of time being that of Density or Mass. It grows "
             "with the load factor, and forces with its square.");
  bind_schedule(frame, "The angular velocity grows");
  return frame;
}

BoundList<DistributedLoad> distributed_load_parameters() {
  BoundList<DistributedLoad> load("A load per unit of undeformed length along a member, or a part of it.");
  load.bind(&DistributedLoad::member, text("Member").required(), "Name of the member" + kWildcard);
  load.bind(&DistributedLoad::force, vector3("Force").by_default(), "Force per length [force / length].");
  load.bind(&DistributedLoad::couple, vector3("Couple").by_default(), "Moment per length [force].");
  load.bind(
      &DistributedLoad::force_formula, formulas("Force Formula"),
      "Instead of Force: its components as formulas of s = arc length from the start of the member, x = s / "
      "length, the place X, Y, Z of the undeformed member in global axes and stage = Stage, like {0, 0, -3*(1 - x)}.");
  load.bind(&DistributedLoad::couple_formula, formulas("Couple Formula"),
            "Instead of Couple: its components likewise.");
  load.bind(&DistributedLoad::frame, text("Frame").by_default(),
            "dead: components in global axes, direction kept; follower: components in the triad of the section on "
            "which the load acts, which turns with it.",
            kFrames);
  load.bind(&DistributedLoad::is_projected, text("Per").by_default(),
            "length: of the undeformed member; projected length: seen along the direction of Force (dead), as of snow.",
            {{"length", false}, {"projected length", true}});
  load.bind(&DistributedLoad::range, array("Range", ParameterType::real_array, 2).at_least(0.0).at_most(1.0),
            "Part of the member on which it acts, as arc length over length: {0.25, 0.5}; its ends become vertices, "
            "points of the name MEMBER@POSITION. All of it if absent.");
  bind_schedule(load, "The load grows");
  return load;
}

BoundList<PointMass> point_mass_parameters() {
  BoundList<PointMass> body("Body at a point, rigidly joined to what meets there.");
  body.bind(&PointMass::point, text("Point").required(), "Name of the point" + kWildcard);
  body.bind(&PointMass::mass, real("Mass").at_least(0.0).by_default(), "Its mass, on which Gravity acts.");
  body.bind(&PointMass::inertia, vector3("Inertia").at_least(0.0).by_default(),
            "Moments of inertia about the global axes through the point, of the undeformed structure "
            "[mass * length^2].");
  return body;
}

BoundList<EigenstrainDraft> eigenstrain_parameters() {
  BoundList<EigenstrainDraft> strain(
      "Strain of a whole member without any stress: temperature, growth, actuation; components in the axes 1 (along), "
      "2, 3 of the section.");
  strain.bind(&EigenstrainDraft::member, text("Member").required(), "Name of the member" + kWildcard);
  strain.bind(&EigenstrainDraft::strain, vector3("Strain").by_default(),
              "Axial strain and the shear strains in directions 2 and 3 [1].");
  strain.bind(
      &EigenstrainDraft::curvature, vector3("Curvature").by_default(),
      "Twist and the curvatures about axes 2 and 3, on top of those of the undeformed member [radian / length].");
  strain.bind(&EigenstrainDraft::strain_formula, formulas("Strain Formula"),
              "Instead of Strain: its components as formulas of s = arc length from the start of the member, x = s / "
              "length, the place X, Y, Z of the undeformed member in global axes and stage = Stage.");
  strain.bind(&EigenstrainDraft::curvature_formula, formulas("Curvature Formula"),
              "Instead of Curvature: its components likewise.");
  strain.bind(&EigenstrainDraft::temperature, real("Temperature"),
              "Change of temperature; adds itself times Expansion Coefficient to the axial strain [kelvin].");
  strain.bind(&EigenstrainDraft::expansion_coefficient, real("Expansion Coefficient"),
              "With Temperature: axial strain for each degree [1 / kelvin].");
  const std::string table =
      ": columns element, s = arc length from the start of the member, 1, 2, 3; the lines of one element are values of "
      "a "
      "polynomial. Instead of ";
  strain.bind(&EigenstrainDraft::strain_file, text("Strain Table"),
              "File, relative to the folder of the scene" + table + "Strain and Strain Formula.");
  strain.bind(&EigenstrainDraft::curvature_file, text("Curvature Table"),
              "File, likewise, in place of Curvature and Curvature Formula.");
  strain.bind(&EigenstrainDraft::start_turn, vector3("Start Turn").by_default(),
              "Curvature concentrated at the start of the member: the rotation vector by which it leaves its point "
              "turned, of a size below pi [radian].");
  strain.bind(&EigenstrainDraft::end_turn, vector3("End Turn").by_default(), "Likewise at its end [radian].");
  bind_schedule(strain, "The strain grows");
  return strain;
}

const BoundList<PointLoad> kPointLoadParameters = point_load_parameters();
const BoundList<PointMass> kPointMassParameters = point_mass_parameters();
const BoundList<DistributedLoad> kDistributedLoadParameters = distributed_load_parameters();
const BoundList<DistributedLoad> kGravityParameters = gravity_parameters();
const BoundList<EigenstrainDraft> kEigenstrainParameters = eigenstrain_parameters();
const BoundList<RotatingFrameDraft> kRotatingFrameParameters = rotating_frame_parameters();

}  // namespace

void add_load_lists(ListSpec& spec) {
  spec.add_list("Point Loads", ListSpec("Loads at points.").with_named_lists("load", kPointLoadParameters.spec));
  spec.add_list("Point Masses", ListSpec("Bodies at points, for the list Gravity and for Modes.")
                                    .with_named_lists("body", kPointMassParameters.spec));
  spec.add_list("Distributed Loads",
                ListSpec("Loads along members.").with_named_lists("load", kDistributedLoadParameters.spec));
  spec.add_list("Eigenstrains",
                ListSpec("Strains without stress.").with_named_lists("eigenstrain", kEigenstrainParameters.spec));
}

void ConditionReader::read_loads() {
  read_at_points(kPointLoadParameters, {"Force", "Moment"}, [this](PointLoad& load, const InputPlace& place) {
    if (load.frame == LoadFrame::follower) load.member = follower_member(load.member, load.point, place);
  });
  read_point_masses();
  read_distributed_loads();
  read_eigenstrains();
  copy_loads();
}

template <class Load, class Complete>
void ConditionReader::read_at_points(const BoundList<Load>& parameters, const std::vector<std::string>& needed,
                                     const Complete& complete) {
  for_each(ActingKind<Load>::name, [&](const std::string& name, const List& list, const InputPlace& place) {
    const std::vector<std::string> points = points_meant(list, place);
    check_any_given(list, needed, "loads nothing", place);
    Load load = parameters.read(list);
    check_schedule(load, list, place);
    for (const std::string& point : points) {
      Load one = load;
      one.point = point;
      complete(one, place);
      add(one, name);
    }
  });
}

void ConditionReader::read_point_masses() {
  for_each("Point Masses", [this](const std::string& name, const List& list, const InputPlace& place) {
    const std::vector<std::string> points = points_meant(list, place);
    check_any_given(list, {"Mass", "Inertia"}, "has no inertia", place);
    PointMass body = kPointMassParameters.read(list);
    if (!is_inertia(body.inertia))
      throw place["Inertia"].error("value " + to_text(body.inertia) +
                                   ": one of the three is larger than the sum of the others, which no body has");
    for (const std::string& point : points) {
      body.point = point;
      add(body, name);
    }
  });
}

/// The one member with one end at the point, or through it, that `text` means. The load acts on the point: members in a
/// joint there turn without it.
std::string ConditionReader::follower_member(const std::string& text, const std::string& point,
                                             const InputPlace& place) const {
  const auto joined = joined_at_.find(point);
  const auto is_joined = [&](const std::string& name) {
    return joined != joined_at_.end() && joined->second.count(name) > 0;
  };
  const std::vector<const Member*>* const members = names_.members_at(point);
  if (members == nullptr) return text;  // a member with a mistake may be meant to touch it
  std::vector<std::string> touching;
  for (const Member* candidate : *members)
    if (!has_both_ends_at(*candidate, point) && !is_joined(candidate->name)) touching.push_back(candidate->name);
  const std::vector<std::string> meant = names_meant(text, touching);
  if (meant.size() == 1) return meant.front();
  const Member* const member = names_.member(text);
  const bool closed = member != nullptr && has_both_ends_at(*member, point);
  const std::string seen = text.empty() ? "missing for a follower load" : "value \"" + excerpt(text) + "\"";
  const std::string problem = closed            ? " has both ends at the point"
                              : is_joined(text) ? " is in a joint at the point, and turns without it"
                              : meant.empty()   ? ""
                                                : " means several of them";
  throw place["Member"].error(seen + problem + "; allowed: a member with one end at \"" + excerpt(point) +
                              "\", or through it, not in a joint there: " + quoted_list(touching) +
                              did_you_mean(text, touching));
}

void ConditionReader::read_distributed_loads() {
  for_each("Distributed Loads", [this](const std::string& name, const List& list, const InputPlace& place) {
    const std::vector<const Member*> members = members_meant(list, place);
    check_any_given(list, {"Force", "Couple", "Force Formula", "Couple Formula"}, "loads nothing", place);
    DistributedLoad load = kDistributedLoadParameters.read(list);
    check_schedule(load, list, place);
    check_field(list, "Force", members, load.force_formula, place);
    check_field(list, "Couple", members, load.couple_formula, place);
    check_part(load, list, place);
    const Formulas force = load.force_formula, couple = load.couple_formula;
    for (const Member* member : members) {
      load.member = member->name;
      load.force_formula = along(*member, force, place["Force Formula"]);
      load.couple_formula = along(*member, couple, place["Couple Formula"]);
      if (list.isParameter("Range")) divide_at(load.member, load.range, place["Range"]);
      add(load, name);
    }
  });
}

void ConditionReader::check_part(const DistributedLoad& load, const List& list, const InputPlace& place) const {
  if (list.isParameter("Range") && !(load.range[1] - load.range[0] > kStationTolerance))
    throw place["Range"].error("value {" + shortest(load.range[0]) + ", " + shortest(load.range[1]) +
                               "}; allowed: where it begins, then where it ends, between 0 and 1");
  if (!load.is_projected) return;
  if (load.frame == LoadFrame::follower)
    throw place["Per"].error("value \"projected length\" for a follower load; allowed: for dead ones");
  const bool is_constant = !list.isParameter("Force Formula") && !vector_algebra::is_zero(load.force);
  if (!is_constant || !vector_algebra::is_zero(load.couple) || list.isParameter("Couple Formula"))
    throw place["Per"].error("value \"projected length\"; allowed: with \"Force\", whose direction it is, alone");
}

/// Makes the ends of a load vertices of its member.
void ConditionReader::divide_at(const std::string& name, const std::array<double, 2>& range, const InputPlace& place) {
  Member& member = scene_.members[static_cast<std::size_t>(names_.member(name) - scene_.members.data())];
  for (const double position : range) {
    const auto is_there = [position](double other) { return std::abs(other - position) <= kStationTolerance; };
    if (is_there(0.0) || is_there(1.0)) continue;
    auto& inner = member.inner_points;
    if (std::any_of(inner.begin(), inner.end(), [&](const InnerPoint& p) { return is_there(p.position); })) continue;
    if (!member.stations.empty()) {
      if (std::any_of(member.stations.begin(), member.stations.end(), is_there)) continue;
      throw place.error("position " + shortest(position) + " is not among the \"Stations\" of \"" + excerpt(name) +
                        "\"; allowed: their values");
    }
    inner.push_back({name + "@" + shortest(position), position});
    std::sort(inner.begin(), inner.end(),
              [](const InnerPoint& a, const InnerPoint& b) { return a.position < b.position; });
  }
}

ListSpec gravity_spec() {
  ListSpec spec = kGravityParameters.spec;
  for (ParameterSpec& parameter : spec.parameters)
    if (parameter.presence == Presence::required) parameter.presence = Presence::optional;
  return spec.with_named_lists("weight", kGravityParameters.spec);
}

/// One weight, or several by names: of stages and cases of their own.
void ConditionReader::read_gravity() {
  if (!scene_list_.isSublist("Gravity")) return;
  const List& list = scene_list_.sublist("Gravity");
  const InputPlace place = place_["Gravity"];
  bool is_any_named = false;
  for (const std::string& name : names_of(list)) is_any_named = is_any_named || list.isSublist(name);
  if (!is_any_named) check_any_given(list, {"Acceleration"}, "weighs nothing", place);
  if (is_given(list, "Acceleration")) read_weight(list, place);
  for (const std::string& name : names_of(list)) {
    if (list.isSublist(name))
      read_weight(list.sublist(name), place[name]);
    else if (is_any_named && is_given(list, name) && !is_given(list, "Acceleration"))
      throw place[name].error("given beside weights of their own names; allowed: in each of them");
  }
}

void ConditionReader::read_weight(const List& list, const InputPlace& place) {
  DistributedLoad gravity = kGravityParameters.read(list);
  check_schedule(gravity, list, place);
  std::unordered_map<std::string, double> mass;
  for (const Section& section : scene_.sections) mass[section.name] = section.mass;
  bool is_any = false;
  for (const Member& member : scene_.members) {
    const bool ends_with_mass = !member.end_section.empty() && mass[member.end_section] > 0.0;
    if (mass[member.section] == 0.0 && !ends_with_mass) continue;
    is_any = true;
    DistributedLoad weight = gravity;
    weight.member = member.name;
    weight.force = vector_algebra::scaled(mass[member.section], gravity.force);
    weight.is_weight = !member.end_section.empty();
    scene_.distributed_loads.push_back(weight);
  }
  for (const PointMass& body : scene_.point_masses) {
    if (body.mass == 0.0) continue;
    is_any = true;
    PointLoad& weight = scene_.point_loads.emplace_back();
    weight.point = body.point;
    weight.force = vector_algebra::scaled(body.mass, gravity.force);
    weight.stage = gravity.stage;
    weight.amplitude = gravity.amplitude;
    weight.load_case = gravity.load_case;
  }
  if (!is_any)
    throw place.error("no section has a mass; allowed: \"Density\" in \"Material\", or \"Mass\", of some section");
  scene_.gravity = std::max(scene_.gravity, vector_algebra::norm(gravity.force));
}

ListSpec rotating_frame_spec() { return kRotatingFrameParameters.spec; }

void ConditionReader::read_rotating_frame() {
  if (!scene_list_.isSublist("Rotating Frame")) return;
  const List& list = scene_list_.sublist("Rotating Frame");
  const InputPlace place = place_["Rotating Frame"];
  RotatingFrameDraft frame = kRotatingFrameParameters.read(list);
  const double length = vector_algebra::norm(frame.axis);
  if (length == 0.0) throw place["Axis"].error("value {0, 0, 0} has no direction; allowed: any other vector");
  frame.velocity = vector_algebra::scaled(frame.speed / length, frame.axis);
  check_schedule<RotatingFrame>(frame, list, place);
  const bool has_mass =
      std::any_of(scene_.sections.begin(), scene_.sections.end(), [](const Section& s) { return s.mass > 0.0; }) ||
      !scene_.point_masses.empty();
  if (!has_mass)
    throw place.error(
        "nothing has a mass; allowed: \"Density\" in \"Material\", or \"Mass\", of some section, or \"Point Masses\"");
  scene_.rotating_frames.push_back(frame);
}

void ConditionReader::read_eigenstrains() {
  for_each("Eigenstrains", [this](const std::string& name, const List& list, const InputPlace& place) {
    const std::vector<const Member*> members = members_meant(list, place);
    check_any_given(list,
                    {"Strain", "Curvature", "Strain Formula", "Curvature Formula", "Temperature", "Strain Table",
                     "Curvature Table", "Start Turn", "End Turn"},
                    "strains nothing", place);
    EigenstrainDraft strain = kEigenstrainParameters.read(list);
    strain.end_turns = {strain.start_turn, strain.end_turn};
    strain.strain_table = read_field_table(list, "Strain", members, place);
    strain.curvature_table = read_field_table(list, "Curvature", members, place);
    check_schedule(strain, list, place);
    check_field(list, "Strain", members, strain.strain_formula, place);
    check_field(list, "Curvature", members, strain.curvature_formula, place);
    add_temperature(strain, place);
    const bool counts_whole = strain.amplitude.empty() && strain.load_case.empty();
    if (counts_whole && strain.strain_formula[0].empty() && strain.strain[0] <= -1.0)
      throw place[strain.temperature ? "Temperature" : "Strain"].error(
          "gives an axial strain of " + shortest(strain.strain[0]) + "; allowed: above -1, where no length is left");
    for (const bool end : {false, true})
      if (const double turn = vector_algebra::norm(strain.end_turns[end ? 1 : 0]); counts_whole && !(turn < kPi))
        throw place[end ? "End Turn" : "Start Turn"].error(
            "turns the end by " + shortest(turn) +
            " rad; allowed: below pi, half a turn, to which an element can be turned against its point");
    const Formulas axial = strain.strain_formula, bending = strain.curvature_formula;
    for (const Member* member : members) {
      strain.member = member->name;
      strain.strain_formula = along(*member, axial, place["Strain Formula"]);
      strain.curvature_formula = along(*member, bending, place["Curvature Formula"]);
      add<Eigenstrain>(strain, name);
      if (strain.strain_table || strain.curvature_table) with_tables_.insert(member->name);
    }
  });
}

/// Null where the list names none.
std::shared_ptr<const FieldTable> ConditionReader::read_field_table(const List& list, const std::string& field,
                                                                    const std::vector<const Member*>& members,
                                                                    const InputPlace& place) const {
  const std::string parameter = field + " Table";
  if (!list.isParameter(parameter)) return {};
  for (const std::string& other : {field, field + " Formula", std::string("Temperature")})
    if (is_given(list, other) && (other != "Temperature" || field == "Strain"))
      throw place[parameter].error("given beside \"" + other + "\"; allowed: one of the two");
  double length = curve_of(*members.front()).length;
  for (const Member* member : members) length = std::min(length, curve_of(*member).length);
  const ImportTable table = field_table(list, parameter, place);
  FieldTable result;
  std::string element;
  table.for_each([&](const CsvRecord& record) {
    const double s = imported_number(table, record, "s");
    const bool begins = result.pieces.empty() || table.cell(record, "element") != element;
    const double before = result.pieces.empty() ? -1.0 : result.pieces.back().s.back();
    const bool is_after = s > before || (begins && s == before);
    if (!is_after || !(s >= 0.0) || !(s <= length * (1.0 + kStationTolerance)))
      throw table.error(
          record, "s",
          "value " + shortest(s) + "; allowed: growing arc lengths from 0 to that of the member, " + shortest(length));
    if (begins) result.pieces.emplace_back();
    element = table.cell(record, "element");
    FieldTable::Piece& piece = result.pieces.back();
    if (piece.s.size() == kMostOfPiece)
      throw table.error(record, "element", "more than " + std::to_string(kMostOfPiece) + " lines of one element");
    piece.s.push_back(s);
    piece.value.push_back(imported_vector(table, record, {"1", "2", "3"}));
  });
  if (result.pieces.empty()) throw place[parameter].error("the table has no lines; allowed: one at least");
  return std::make_shared<const FieldTable>(std::move(result));
}

void ConditionReader::add_temperature(EigenstrainDraft& strain, const InputPlace& place) const {
  const bool heated = strain.temperature.has_value();
  if (heated != strain.expansion_coefficient.has_value()) {
    throw place[heated ? "Expansion Coefficient" : "Temperature"].error(
        "missing; allowed: both \"Temperature\" and \"Expansion Coefficient\", or none");
  }
  if (!heated) return;
  const double expansion = *strain.temperature * *strain.expansion_coefficient;
  if (!std::isfinite(expansion)) throw place["Temperature"].error("gives a strain beyond the range of numbers");
  std::string& formula = strain.strain_formula[0];
  if (formula.empty()) {
    strain.strain[0] += expansion;
    return;
  }
  formula = "(" + formula + ") + (" + shortest(expansion) + ")";
  checked_formula(formula, kAlongMember, place["Strain Formula"]);  // it may have become too long
}

void ConditionReader::check_field(const List& list, const std::string& name, const std::vector<const Member*>& members,
                                  const std::array<std::string, 3>& formula, const InputPlace& list_place) const {
  if (!list.isParameter(name + " Formula")) return;
  const InputPlace place = list_place[name + " Formula"];
  if (is_given(list, name)) throw place.error("given beside \"" + name + "\"; allowed: one of the two");
  std::vector<Expression> parsed;
  for (const std::string& text : formula) parsed.push_back(checked_formula(text, kAlongMember, place));
  for (const Member* member : members) {
    const std::vector<std::vector<double>> samples = samples_along(curve_of(*member));
    for (const Expression& component : parsed) check_finite(component, kAlongMember, samples, place);
  }
}

/// X, Y and Z of formulas as formulas of x along this member.
Formulas ConditionReader::along(const Member& member, Formulas formula, const InputPlace& place) const {
  const std::string axes = "XYZ";
  for (std::string& component : formula)
    if (component.find_first_of(axes) != std::string::npos)
      component = with_names_replaced(component, [&](const std::string& name) {
        if (name.size() != 1 || axes.find(name) == std::string::npos) return name;
        const std::string text = coordinate_along(member, names_.position(member.start_point),
                                                  names_.position(member.end_point), static_cast<int>(axes.find(name)));
        if (!text.empty()) return text;
        throw place.error("value \"" + excerpt(component) + "\" names " + name + ", and the curve of \"" +
                          excerpt(member.name) + "\" is a spline or parametric; allowed there: s and x");
      });
  return formula;
}

ReferenceCurve ConditionReader::curve_of(const Member& member) const {
  try {
    return make_reference_curve(member, names_.position(member.start_point), names_.position(member.end_point));
  } catch (const std::invalid_argument& error) {  // extreme numbers, where the checks of the curve see no fault
    throw place_["Members"][member.name].error(error.what());
  }
}

}  // namespace mixbeam
