#include "discretization/reading/scene_parts.hpp"

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/reading/import.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/expression.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <unordered_map>
#include <utility>

namespace mixbeam {

namespace {

using namespace vector_algebra;

/// Text behind the name of a point or member that may be a pattern.
const std::string kWildcard = "; " + kWildcards + ", and every match is meant.";

/// Binds stage, amplitude and case of anything that acts.
template <class Acting>
void bind_schedule(BoundList<Acting>& list, const std::string& what) {
  constexpr int kMostStages = 1000;
  list.bind(&Acting::stage, integer("Stage").at_least(1).at_most(kMostStages).by_default(),
            what +
                " from zero to full while the load factor goes from stage - 1 to stage, and stays after that; with an "
                "amplitude: the load factor runs at least up to this number.");
  list.bind(&Acting::amplitude, text("Amplitude").or_other("a formula"),
            "Factor of all components as a formula of t = load factor and stage = Stage, like sin(pi*t); instead of "
            "the growth in one stage.");
  list.bind(&Acting::load_case, text("Case"),
            "Load case, one of \"Load Cases\", in which alone it acts; in all of them if absent.");
}

/// An eigenstrain as written.
struct EigenstrainDraft : Eigenstrain {
  std::optional<double> temperature{}, expansion_coefficient{};
  std::string strain_file{}, curvature_file{};
  Vector3 start_turn{}, end_turn{};
};

const std::vector<std::string> kAxisNames = {"x", "y", "z"};

// Below this angle between them, two axes span a plane made of rounding errors. [radian]
constexpr double kSmallestAngle = 1e-6;

const BoundList<Support> kSupportParameters = [] {
  BoundList<Support> support(
      "Support of a point, along global axes unless Axes are given; without further parameters a clamp.");
  support.bind(&Support::point, text("Point").required(), "Name of the point" + kWildcard);
  support.bind(&Support::displacement_fixed,
               subset("Fixed Displacement", kAxisNames).by_default(Teuchos::Array<std::string>(kAxisNames)),
               "Directions in which the displacement is fixed or prescribed; {} for none.");
  support.bind(&Support::rotation_fixed,
               subset("Fixed Rotation", kAxisNames).by_default(Teuchos::Array<std::string>(kAxisNames)),
               "Axes about which the rotation is fixed or prescribed; {} for a ball joint, two of them for a hinge "
               "about the third, one of them to fix that component of the rotation vector at zero.");
  support.bind_by(
      [](Support& s, const ParameterValue& value) {
        const auto& given = std::get<Teuchos::Array<double>>(value);
        for (std::size_t i = 0; i < 6; ++i) s.axes[i / 3][i % 3] = given[static_cast<Teuchos::Ordinal>(i)];
      },
      [](const Support& s) {
        Teuchos::Array<double> held(s.axes[0].begin(), s.axes[0].end());
        held.insert(held.end(), s.axes[1].begin(), s.axes[1].end());
        return ParameterValue(held);
      },
      coordinates("Axes", 6),
      "Directions of the support's own axes x and y in global components, {x1, x2, x3, y1, y2, y3}, of any length; of "
      "y only the part normal to x counts, and z = x cross y. All other parameters of the support refer to these "
      "axes.");
  support.bind(&Support::prescribed_displacement, vector3("Prescribed Displacement").by_default(),
               "Displacement at the end of the stage, in fixed directions only [length].");
  support.bind(&Support::prescribed_rotation, vector3("Prescribed Rotation").by_default(),
               "Rotation vector at the end of the stage, may exceed a turn; needs all three rotations fixed [radian].");
  support.bind(&Support::displacement_stiffness, vector3("Displacement Stiffness").at_least(0.0).by_default(),
               "Springs to the ground in directions that are not fixed; 0 for none [force / length].");
  support.bind(
      &Support::rotation_stiffness, vector3("Rotation Stiffness").at_least(0.0).by_default(),
      "Springs on the components of the rotation vector that are not fixed; 0 for none [force * length / radian].");
  bind_schedule(support, "The prescribed motion grows");
  return support;
}();

std::ptrdiff_t number_of(const std::array<bool, 3>& fixed) { return std::count(fixed.begin(), fixed.end(), true); }

const BoundList<Joint> kJointParameters = [] {
  BoundList<Joint> joint(
      "A connection that is not rigid: each listed member ends in its own joint with the rest of what meets at the "
      "point; members not listed stay rigidly connected, and supports and loads of the point act on them.");
  joint.bind(&Joint::point, text("Point").required(), "Name of the point.");
  joint.bind(&Joint::members, array("Members", ParameterType::text_array).required(),
             "Names of members that have one end at the point, like {strut 1, strut 2}" + kWildcard);
  joint.bind(&Joint::kind, text("Kind").required(),
             "hinge: free rotation about Axis; ball: free rotation about any axis; slider: free translation along "
             "Axis, no rotation.",
             {{"hinge", JointKind::hinge}, {"ball", JointKind::ball}, {"slider", JointKind::slider}});
  joint.bind(&Joint::axis, direction("Axis"),
             "hinge, slider: direction in the undeformed structure, in global components, of any length; it rotates "
             "with the members not listed.");
  joint.bind(&Joint::stiffness, real("Stiffness").at_least(0.0).by_default(),
             "hinge, slider: of a spring against the free motion [force * length / radian, force / length].");
  joint.bind(&Joint::together, boolean("Together").by_default(),
             "Whether the listed members stay rigidly connected to each other and share one joint, like the halves of "
             "a bar that crosses another one at a pin; otherwise each has its own.");
  const Form about_axis{{"Axis"}, {"Stiffness"}};
  joint.spec.with_forms("Kind", {{"hinge", {about_axis}}, {"slider", {about_axis}}, {"ball", {Form{}}}});
  return joint;
}();

/// Factors of components in the triad of a mirrored section, whose axis 3 is opposite to the image of axis 3: of
/// vectors, and of axial ones (moments, curvatures).
constexpr Vector3 kMirroredVector{1, 1, -1}, kMirroredAxial{-1, -1, 1};

Vector3 product(const Vector3& a, const Vector3& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }

/// Replaces a field by its image under the linear map `turn`.
template <class Turn>
void turn_field(const Turn& turn, Vector3& constant, Formulas& formula) {
  constant = turn(constant);
  if (!is_given(formula)) return;
  const std::array<Vector3, 3> images = {turn(Vector3{1, 0, 0}), turn(Vector3{0, 1, 0}), turn(Vector3{0, 0, 1})};
  Formulas turned;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      if (images[j][i] != 0.0 && !formula[j].empty())
        turned[i] += (turned[i].empty() ? "(" : " + (") + shortest(images[j][i]) + ") * (" + formula[j] + ")";
    if (turned[i].empty()) turned[i] = "0";
  }
  formula = turned;
}

/// Maps the vectors of a load, in space or in the triads of members.
template <class Load>
void turn(const Isometry& motion, Load& load) {
  const bool in_triad = ActingKind<Load>::is_in_triad(load);
  ActingKind<Load>::for_each_vector(load, [&](Vector3& constant, Formulas* formula, VectorRole role) {
    const auto image = [&](const Vector3& v) {
      if (!in_triad) return is_axial(role) ? motion.turning_axis(v) : motion.direction(v);
      return motion.mirrors() ? product(is_axial(role) ? kMirroredAxial : kMirroredVector, v) : v;
    };
    Formulas none;
    turn_field(image, constant, formula != nullptr ? *formula : none);
  });
}

/// Maps the axes, which stay right-handed; a clamp or ball without springs and motion is the same along any axes.
void turn(const Isometry& motion, Support& support) {
  if (motion.is_shift()) return;
  const auto all_alike = [](const std::array<bool, 3>& fixed) { return fixed[0] == fixed[1] && fixed[1] == fixed[2]; };
  const bool is_isotropic = all_alike(support.displacement_fixed) && all_alike(support.rotation_fixed) &&
                            is_zero(support.prescribed_displacement) && is_zero(support.prescribed_rotation) &&
                            is_zero(support.displacement_stiffness) && is_zero(support.rotation_stiffness);
  if (is_isotropic) return;
  for (Vector3& axis : support.axes) axis = motion.direction(axis);
  if (!motion.mirrors()) return;
  support.axes[2] = scaled(-1.0, support.axes[2]);
  turn<Support>(motion, support);
}

void turn(const Isometry& motion, PointMass& body) {
  for (Vector3& axis : body.axes) axis = motion.direction(axis);  // their signs do not matter
}

// Wildcards multiply: a line of text must not fill the memory.
constexpr std::size_t kMostConditions = 2'000'000;
constexpr std::size_t kMostLoadCases = 1000;
constexpr std::size_t kLongestPattern = 1000;  // matching takes time in proportion to it
constexpr int kSamplesPerStage = 8;            // of an amplitude: catches a pole at simple fractions

const std::vector<std::pair<std::string, LoadFrame>> kFrames = {{"dead", LoadFrame::dead},
                                                                {"follower", LoadFrame::follower}};
const std::vector<std::string> kAlongMember = {"s", "x", "X", "Y", "Z"};
constexpr int kSamplesPerMember = 4;     // intervals: ends, middle, quarters
constexpr std::size_t kMostOfPiece = 9;  // lines of an element in a table: the points of order 8

bool has_both_ends_at(const Member& member, const std::string& point) {
  return member.start_point == point && member.end_point == point;
}

/// Values of kAlongMember at the ends of the intervals.
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

const BoundList<PointLoad> kPointLoadParameters = [] {
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
}();

const BoundList<DistributedLoad> kGravityParameters = [] {
  BoundList<DistributedLoad> gravity(
      "Weight of all members whose sections have a mass (Density of the material, or Mass); several by names of your "
      "own, of which each has a Stage or Case.");
  gravity.bind(&DistributedLoad::force, vector3("Acceleration").required(),
               "Acceleration of free fall, in global axes: {0, 0, -9.81} [length / time^2].");
  bind_schedule(gravity, "The weight grows");
  return gravity;
}();

/// A rotating frame as written.
struct RotatingFrameDraft : RotatingFrame {
  Vector3 axis{};
  double speed = 0.0;
};

const BoundList<RotatingFrameDraft> kRotatingFrameParameters = [] {
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
}();

const BoundList<DistributedLoad> kDistributedLoadParameters = [] {
  BoundList<DistributedLoad> load("A load per unit of undeformed length along a member, or a part of it.");
  load.bind(&DistributedLoad::member, text("Member").required(), "Name of the member" + kWildcard);
  load.bind(&DistributedLoad::force, vector3("Force").by_default(), "Force per length [force / length].");
  load.bind(&DistributedLoad::couple, vector3("Couple").by_default(), "Moment per length [force].");
  load.bind(
      &DistributedLoad::force_formula, formulas("Force Formula"),
      "Instead of Force: its components as formulas of s = arc length from the start of the member, x = s / length, "
      "the place X, Y, Z of the undeformed member in global axes and stage = Stage, like {0, 0, -3*(1 - x)}.");
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
}();

const BoundList<PointMass> kPointMassParameters = [] {
  BoundList<PointMass> body("Body at a point, rigidly joined to what meets there.");
  body.bind(&PointMass::point, text("Point").required(), "Name of the point" + kWildcard);
  body.bind(&PointMass::mass, real("Mass").at_least(0.0).by_default(), "Its mass, on which Gravity acts.");
  body.bind(
      &PointMass::inertia, vector3("Inertia").at_least(0.0).by_default(),
      "Moments of inertia about the global axes through the point, of the undeformed structure [mass * length^2].");
  return body;
}();

const BoundList<EigenstrainDraft> kEigenstrainParameters = [] {
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
      "a polynomial. Instead of ";
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
}();

/// Reads in one pass all that acts on a scene whose points and members are complete.
class ConditionReader {
 public:
  /// `copies`: those by patterns that also copy joints or loads.
  ConditionReader(const Teuchos::ParameterList& scene_list, const InputPlace& place, Scene& scene,
                  const std::vector<CopiedPattern>& copies)
      : scene_list_(scene_list), place_(place), scene_(scene), copies_(copies), names_(scene) {}

  /// Returns what was left out at the ends of patterns, and why.
  std::vector<std::string> read() {
    place_["Load Cases"].attempt([this] { read_load_cases(); });
    read_combinations();
    place_["Imperfection"]["Case"].attempt([this] { check_case_of_modes(); });
    read_supports();
    read_joints();
    read_loads();
    place_["Gravity"].attempt([this] { read_gravity(); });
    place_["Rotating Frame"].attempt([this] { read_rotating_frame(); });
    if (place_.source().has_mistakes()) return {};
    check_stages();
    check_amplitudes();
    return std::move(notes_);
  }

 private:
  using List = Teuchos::ParameterList;

  /// Stages in which something acts: with an amplitude, every stage up to its own.
  struct UsedStage {
    Stage first = 1, last = 1;
    std::string load_case;
    InputPlace place;
  };

  /// Calls `action` with name, list and place of each list inside the list `lists`.
  template <class Action>
  void for_each(const std::string& lists, const Action& action) const {
    const List& all = scene_list_.sublist(lists);
    for (const std::string& name : names_of(all)) {
      const InputPlace place = place_[lists][name];
      place.attempt([&] { action(name, all.sublist(name), place); });
    }
  }

  void read_load_cases() {
    if (!scene_list_.isParameter("Load Cases")) return;
    const InputPlace place = place_["Load Cases"];
    const auto& names = scene_list_.get<Teuchos::Array<std::string>>("Load Cases");
    if (static_cast<std::size_t>(names.size()) > kMostLoadCases)
      throw place.error(std::to_string(names.size()) + " names; allowed: " + std::to_string(kMostLoadCases));
    std::set<std::string> seen;
    for (const std::string& name : names) {
      if (!seen.insert(name).second) throw place.error("names \"" + excerpt(name) + "\" twice; allowed: once");
      const Problem problem = file_name_problem(name);
      if (!problem.empty()) throw place.error("value " + problem);
      scene_.load_cases.push_back(name);
    }
  }

  void read_combinations() {
    if (!scene_list_.isSublist("Combinations")) return;
    const std::vector<std::string>& cases = scene_.load_cases;
    const std::string stage = "Stage ";
    for_each("Combinations", [&](const std::string& name, const List& list, const InputPlace& place) {
      if (const Problem problem = file_name_problem(name); !problem.empty()) throw place.error("name " + problem);
      if (std::find(cases.begin(), cases.end(), name) != cases.end())
        throw place.error("the name of a load case too; allowed: names that differ");
      Combination& combination = scene_.combinations.emplace_back();
      combination.name = name;
      for (const std::string& entry : names_of(list)) {
        const double factor = list.get<double>(entry);
        int number = 0;
        const bool is_case = std::find(cases.begin(), cases.end(), entry) != cases.end();
        const bool is_stage = entry.rfind(stage, 0) == 0 && parse_number(entry.substr(stage.size()), number).empty();
        if (is_case)
          combination.cases.emplace_back(entry, factor);
        else if (is_stage && number >= 1)
          combination.stages.emplace_back(number, factor);
        else
          throw place[entry].error("not a load case of the scene; allowed: names in \"Load Cases\": " +
                                   quoted_list(cases) + ", or \"Stage 1\", ..." + did_you_mean(entry, cases));
      }
    });
  }

  void read_supports() {
    for_each("Supports", [this](const std::string& name, const List& list, const InputPlace& place) {
      const std::vector<std::string> points = points_meant(list, place);
      Support support = read_support(list, place);
      for (const std::string& point : points) {
        claim_support(point, name, place);
        support.point = point;
        add(support, name);
      }
    });
    copy_with_patterns<Support>();
  }

  void read_joints() {
    for_each("Joints", [this](const std::string& name, const List& list, const InputPlace& place) {
      scene_.joints.push_back(read_joint(list, place));
      scene_.joints.back().name = name;
    });
    copy_joints();
    if (place_.source().has_mistakes()) return;
    // Only now: several joints at a point must not take its last member.
    for (const Joint& joint : scene_.joints) check_someone_is_left(joint);
  }

  void read_loads() {
    read_point_loads();
    read_point_masses();
    read_distributed_loads();
    read_eigenstrains();
    for_each_kind([this](auto kind) {
      using Load = typename std::decay_t<decltype(scene_.*kind.list)>::value_type;
      if constexpr (!kind.stays) copy_with_patterns<Load>();
    });
    copy_with_patterns<PointMass>();
  }

  void read_point_loads() {
    for_each("Point Loads", [this](const std::string& name, const List& list, const InputPlace& place) {
      const std::vector<std::string> points = points_meant(list, place);
      check_any_given(list, {"Force", "Moment"}, "loads nothing", place);
      PointLoad load = kPointLoadParameters.read(list);
      check_schedule(load, list, place);
      for (const std::string& point : points) {
        PointLoad one = load;
        one.point = point;
        if (one.frame == LoadFrame::follower) one.member = follower_member(one.member, point, place);
        add(one, name);
      }
    });
  }

  void read_point_masses() {
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

  void read_distributed_loads() {
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

  void check_part(const DistributedLoad& load, const List& list, const InputPlace& place) const {
    if (list.isParameter("Range") && !(load.range[1] - load.range[0] > kStationTolerance))
      throw place["Range"].error("value {" + shortest(load.range[0]) + ", " + shortest(load.range[1]) +
                                 "}; allowed: where it begins, then where it ends, between 0 and 1");
    if (!load.is_projected) return;
    if (load.frame == LoadFrame::follower)
      throw place["Per"].error("value \"projected length\" for a follower load; allowed: for dead ones");
    const bool is_constant = !list.isParameter("Force Formula") && !is_zero(load.force);
    if (!is_constant || !is_zero(load.couple) || list.isParameter("Couple Formula"))
      throw place["Per"].error("value \"projected length\"; allowed: with \"Force\", whose direction it is, alone");
  }

  /// Makes the ends of a load vertices of its member.
  void divide_at(const std::string& name, const std::array<double, 2>& range, const InputPlace& place) {
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

  /// One weight, or several by name, with stages and cases of their own.
  void read_gravity() {
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

  void read_weight(const List& list, const InputPlace& place) {
    DistributedLoad gravity = kGravityParameters.read(list);
    check_schedule(gravity, list, place);
    std::unordered_map<std::string, double> masses;
    for (const Section& section : scene_.sections) masses[section.name] = section.mass;
    bool is_any = false;
    for (const Member& member : scene_.members) {
      const double mass = reference_mass(masses[member.section], masses[member.end_section]);
      if (mass == 0.0) continue;
      is_any = true;
      DistributedLoad weight = gravity;
      weight.member = member.name;
      weight.force = scaled(mass, gravity.force);
      weight.is_weight = !member.end_section.empty();
      scene_.distributed_loads.push_back(weight);
    }
    for (const PointMass& body : scene_.point_masses) {
      if (body.mass == 0.0) continue;
      is_any = true;
      PointLoad& weight = scene_.point_loads.emplace_back();
      weight.point = body.point;
      weight.force = scaled(body.mass, gravity.force);
      weight.stage = gravity.stage;
      weight.amplitude = gravity.amplitude;
      weight.load_case = gravity.load_case;
    }
    if (!is_any)
      throw place.error("no section has a mass; allowed: \"Density\" in \"Material\", or \"Mass\", of some section");
    scene_.gravity = std::max(scene_.gravity, norm(gravity.force));
  }

  void read_rotating_frame() {
    if (!scene_list_.isSublist("Rotating Frame")) return;
    const List& list = scene_list_.sublist("Rotating Frame");
    const InputPlace place = place_["Rotating Frame"];
    RotatingFrameDraft frame = kRotatingFrameParameters.read(list);
    const double length = norm(frame.axis);
    if (length == 0.0) throw place["Axis"].error("value {0, 0, 0} has no direction; allowed: any other vector");
    frame.velocity = scaled(frame.speed / length, frame.axis);
    check_schedule<RotatingFrame>(frame, list, place);
    const bool has_mass =
        std::any_of(scene_.sections.begin(), scene_.sections.end(), [](const Section& s) { return s.mass > 0.0; }) ||
        !scene_.point_masses.empty();
    if (!has_mass)
      throw place.error(
          "nothing has a mass; allowed: \"Density\" in \"Material\", or \"Mass\", of some section, or \"Point "
          "Masses\"");
    scene_.rotating_frames.push_back(frame);
  }

  void read_eigenstrains() {
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
        if (const double turn = norm(strain.end_turns[end ? 1 : 0]); counts_whole && !(turn < kPi))
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

  /// Adds one of the kinds of scene/what_acts.hpp.
  template <class Acting>
  void add(const Acting& one, const std::string& entry) {
    (scene_.*ActingKind<Acting>::list).push_back(one);
    entries_[ActingKind<Acting>::name].push_back(entry);
  }

  /// Copies what acts. An entry acts once at each place: nothing is added where it acts by name or by another copy.
  template <class Acting>
  void copy_with_patterns() {
    if (copies_.empty()) return;
    using Kind = ActingKind<Acting>;
    auto& all = scene_.*Kind::list;
    std::vector<std::string>& entries = entries_[Kind::name];
    std::set<std::pair<std::string, std::string>> acts;
    for (std::size_t i = 0; i < all.size(); ++i) acts.emplace(entries[i], all[i].*Kind::target);
    for (const CopiedPattern& pattern : copies_) {
      const std::size_t originals = all.size();
      for (const PatternCopy& made : pattern)
        for (std::size_t i = 0; i < originals && !made.joints_alone; ++i) {
          const auto& images = Kind::along_member ? made.members : made.points;
          const auto image = images.find(all[i].*Kind::target);
          if (image == images.end() || !acts.emplace(entries[i], image->second).second) continue;
          Acting copy = all[i];
          copy.*Kind::target = image->second;
          turn(made.motion, copy);
          if (!goes_along(copy, made, entries[i])) continue;
          count(1, place_);
          add(copy, std::string(entries[i]));
        }
    }
  }

  void note_left_out(const std::string& list, const std::string& entry, const std::string& point,
                     const std::string& why) {
    notes_.push_back("\"" + list + " / " + excerpt(entry) + "\" is not copied to \"" + excerpt(point) + "\": " + why);
  }

  /// Copies the joint of each listed member, also at a point that the pattern leaves in place. Where a pattern ends
  /// there may be no member to which a copy could be joined.
  void copy_joints() {
    std::set<std::string> written;  // points of joints that no pattern made
    for (const Joint& joint : scene_.joints) written.insert(joint.point);
    const std::size_t first_copy = scene_.joints.size();
    for (const CopiedPattern& pattern : copies_) {
      const std::size_t originals = scene_.joints.size();
      for (const PatternCopy& made : pattern)
        for (std::size_t i = 0; i < originals; ++i) {
          const auto point = made.points.find(scene_.joints[i].point);
          if (point == made.points.end()) continue;
          Joint copy = scene_.joints[i];
          copy.point = point->second;
          copy.axis = made.motion.turning_axis(copy.axis);
          for (const std::string& member : std::exchange(copy.members, {})) {
            const auto image = made.members.find(member);
            if (image != made.members.end() && joined_at_[copy.point].insert(image->second).second)
              copy.members.push_back(image->second);
          }
          if (copy.members.empty()) continue;
          count(copy.members.size(), place_);
          scene_.joints.push_back(std::move(copy));
        }
    }
    std::set<std::string> alone;
    const auto is_left_out = [&](const Joint& joint) {
      if (written.count(joint.point) > 0 || is_someone_left(joint)) return false;
      alone.insert(joint.point);
      note_left_out("Joints", joint.name, joint.point, "no members there that it could be joined to");
      return true;
    };
    const auto first = scene_.joints.begin() + static_cast<std::ptrdiff_t>(first_copy);
    const auto end = std::remove_if(first, scene_.joints.end(), is_left_out);
    scene_.joints.erase(end, scene_.joints.end());
    for (const std::string& point : alone) joined_at_.erase(point);
  }

  /// Completes a copy; false: it is left out.
  template <class Acting>
  bool goes_along(const Acting&, const PatternCopy&, const std::string&) {
    return true;
  }

  bool goes_along(Support& copy, const PatternCopy&, const std::string& entry) {
    claim_support(copy.point, entry, place_["Supports"][entry]);
    return true;
  }

  bool goes_along(PointLoad& copy, const PatternCopy& made, const std::string& entry) {
    if (copy.frame == LoadFrame::dead) return true;
    const auto image = made.members.find(copy.member);
    if (image == made.members.end())
      note_left_out("Point Loads", entry, copy.point,
                    "no copy of the member \"" + excerpt(copy.member) + "\" that it turns with");
    else
      copy.member = image->second;
    return image != made.members.end();
  }

  bool goes_along(DistributedLoad& copy, const PatternCopy&, const std::string& entry) {
    divide_at(copy.member, copy.range, place_["Distributed Loads"][entry]["Range"]);
    return true;
  }

  /// Leaves out copies of tables, whose elements and arc lengths are those of one member; in a scene that a rest shape
  /// left, each copy has tables of its own.
  bool goes_along(Eigenstrain& copy, const PatternCopy&, const std::string& entry) {
    if (!copy.strain_table && !copy.curvature_table) return true;
    if (with_tables_.count(copy.member) == 0)
      note_left_out("Eigenstrains", entry, copy.member, "its tables belong to one member");
    return false;
  }

  Support read_support(const List& list, const InputPlace& place) {
    Support support = kSupportParameters.read(list);
    if (list.isParameter("Axes")) complete_axes(support.axes, place["Axes"]);
    check_support(support, place);
    if (prescribes_motion(support))
      check_schedule(support, list, place);
    else
      check_holds_still(list, place);
    return support;
  }

  void claim_support(const std::string& point, const std::string& name, const InputPlace& place) {
    const auto [earlier, is_new] = support_at_.emplace(point, name);
    if (is_new) return;
    throw place["Point"].error("value \"" + excerpt(point) + "\" is supported by \"" + excerpt(earlier->second) +
                               "\" already; allowed: one support per point");
  }

  void check_support(const Support& support, const InputPlace& place) const {
    const auto rotations = number_of(support.rotation_fixed);
    check_springs(support.displacement_stiffness, support.displacement_fixed, "Displacement Stiffness",
                  "Fixed Displacement", place);
    check_springs(support.rotation_stiffness, support.rotation_fixed, "Rotation Stiffness", "Fixed Rotation", place);
    const bool springs = !is_zero(support.displacement_stiffness) || !is_zero(support.rotation_stiffness);
    if (number_of(support.displacement_fixed) + rotations == 0 && !springs)
      throw place.error("fixes nothing; allowed: at least one direction, or a spring");
    for (std::size_t i = 0; i < 3; ++i) {
      if (support.prescribed_displacement[i] == 0.0 || support.displacement_fixed[i]) continue;
      throw place["Prescribed Displacement"].error(
          "value " + to_text(support.prescribed_displacement) + " moves direction " + kAxisNames[i] +
          ", which \"Fixed Displacement\" leaves free; allowed: zero there, or " + kAxisNames[i] + " fixed");
    }
    if (!is_zero(support.prescribed_rotation) && rotations != 3) {
      throw place["Prescribed Rotation"].error("value " + to_text(support.prescribed_rotation) +
                                               "; allowed: only with \"Fixed Rotation\" = {x, y, z}");
    }
  }

  void check_springs(const Vector3& stiffness, const std::array<bool, 3>& fixed, const std::string& parameter,
                     const std::string& fixing, const InputPlace& place) const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (stiffness[i] == 0.0 || !fixed[i]) continue;
      throw place[parameter].error("value " + to_text(stiffness) + " is a spring in direction " + kAxisNames[i] +
                                   ", which \"" + fixing + "\" fixes (all three if absent); allowed: zero there, or " +
                                   kAxisNames[i] + " not fixed");
    }
  }

  void check_holds_still(const List& list, const InputPlace& place) const {
    for (const std::string parameter : {"Stage", "Amplitude", "Case"}) {
      if (!is_given(list, parameter) || (parameter == "Stage" && list.get<int>("Stage") == 1)) continue;
      throw place[parameter].error(
          "given, but nothing is prescribed; a support acts from the beginning and in every load case");
    }
  }

  /// Completes two given directions to three unit vectors.
  void complete_axes(Axes& axes, const InputPlace& place) const {
    const Vector3 x = axes[0], y = axes[1];
    const double length = norm(x), width = norm(y);
    const auto refused = [&](const std::string& problem) {
      return place.error("axis x = " + to_text(x) + ", axis y = " + to_text(y) + ": " + problem +
                         "; allowed: two directions that differ");
    };
    if (length < kShortestLength || width < kShortestLength) throw refused("one of them has no direction");
    axes[0] = scaled(1.0 / length, x);
    const Vector3 normal = cross(axes[0], scaled(1.0 / width, y));
    const double sine = norm(normal);
    if (sine < kSmallestAngle) throw refused("they are parallel");
    axes[2] = scaled(1.0 / sine, normal);
    axes[1] = cross(axes[2], axes[0]);
  }

  Joint read_joint(const List& list, const InputPlace& place) {
    Joint joint = kJointParameters.read(list);
    if (names_.members_at(joint.point) == nullptr)
      throw unknown_name(place["Point"], "point with members", joint.point, names_.point_names());
    for (const std::string& text : std::exchange(joint.members, {})) join(text, joint, place);
    if (joint.together && joint.members.size() < 2)
      throw place["Together"].error("value true, but \"Members\" names only \"" + excerpt(joint.members.front()) +
                                    "\"; allowed: for two members or more");
    return joint;
  }

  /// Adds the members that `text` matches.
  void join(const std::string& text, Joint& joint, const InputPlace& joint_place) {
    const InputPlace place = joint_place["Members"];
    std::vector<std::string> candidates;
    for (const Member* member : *names_.members_at(joint.point))
      if (has_one_end_at(*member, joint.point)) candidates.push_back(member->name);
    const std::vector<std::string> meant = names_meant(text, candidates);
    if (meant.empty() && names_.member(text) == nullptr && !has_wildcard(text))
      throw unknown_name(place, "member", text, names_.member_names());
    if (meant.empty()) {
      throw place.error("value \"" + excerpt(text) + "\"; allowed: members with one end at \"" + excerpt(joint.point) +
                        "\": " + quoted_list(candidates) + did_you_mean(text, candidates));
    }
    count(meant.size(), place);
    for (const std::string& member : meant) {
      if (!joined_at_[joint.point].insert(member).second) {
        throw place.error("member \"" + excerpt(member) + "\" is in a joint at \"" + excerpt(joint.point) +
                          "\" already; allowed: once");
      }
      joint.members.push_back(member);
    }
  }

  bool is_someone_left(const Joint& joint) const {
    std::set<std::string> touching;
    for (const Member* member : *names_.members_at(joint.point)) touching.insert(member->name);
    return joined_at_.at(joint.point).size() < touching.size();
  }

  void check_someone_is_left(const Joint& joint) const {
    if (is_someone_left(joint)) return;
    throw place_["Joints"][joint.name]["Members"].error(
        "all members at \"" + excerpt(joint.point) +
        "\" are in joints, and none is left that they could be joined to; allowed: at least one of them not listed");
  }

  /// The only member matching `text` that ends at the point once, or passes it. The load acts on the point: members in
  /// a joint there rotate without it.
  std::string follower_member(const std::string& text, const std::string& point, const InputPlace& place) const {
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

  /// Checks the three formulas of `name` + " Formula", which replace the constant `name`.
  void check_field(const List& list, const std::string& name, const std::vector<const Member*>& members,
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

  ReferenceCurve curve_of(const Member& member) const {
    try {
      return make_reference_curve(member, names_.position(member.start_point), names_.position(member.end_point));
    } catch (const std::invalid_argument& error) {  // extreme numbers, where the checks of the curve see no fault
      throw place_["Members"][member.name].error(error.what());
    }
  }

  /// Replaces X, Y and Z in formulas by formulas of x along this member.
  Formulas along(const Member& member, Formulas formula, const InputPlace& place) const {
    const std::string axes = "XYZ";
    for (std::string& component : formula)
      if (component.find_first_of(axes) != std::string::npos)
        component = with_names_replaced(component, [&](const std::string& name) {
          if (name.size() != 1 || axes.find(name) == std::string::npos) return name;
          const std::string text =
              coordinate_along(member, names_.position(member.start_point), names_.position(member.end_point),
                               static_cast<int>(axes.find(name)));
          if (!text.empty()) return text;
          throw place.error("value \"" + excerpt(component) + "\" names " + name + ", and the curve of \"" +
                            excerpt(member.name) + "\" is a spline or parametric; allowed there: s and x");
        });
    return formula;
  }

  void add_temperature(EigenstrainDraft& strain, const InputPlace& place) const {
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

  /// Table of a field; null if the list names none.
  std::shared_ptr<const FieldTable> read_field_table(const List& list, const std::string& field,
                                                     const std::vector<const Member*>& members,
                                                     const InputPlace& place) const {
    const std::string parameter = field + " Table";
    if (!list.isParameter(parameter)) return {};
    for (const std::string& other : {field, field + " Formula", std::string("Temperature")})
      if (is_given(list, other) && (other != "Temperature" || field == "Strain"))
        throw place[parameter].error("given beside \"" + other + "\"; allowed: one of the two");
    double length = curve_of(*members.front()).length;
    for (const Member* member : members) length = std::min(length, curve_of(*member).length);
    const ImportTable table = import_table(list, parameter, place, {"element", "s", "1", "2", "3"}, 5);
    FieldTable result;
    std::string element;
    table.for_each([&](const CsvRecord& record) {
      const double s = imported_number(table, record, "s");
      const bool begins = result.pieces.empty() || table.cell(record, "element") != element;
      const double before = result.pieces.empty() ? -1.0 : result.pieces.back().s.back();
      const bool is_after = s > before || (begins && s == before);
      if (!is_after || !(s >= 0.0) || !(s <= length * (1.0 + kStationTolerance)))
        throw table.error(record, "s",
                          "value " + shortest(s) + "; allowed: growing arc lengths from 0 to that of the member, " +
                              shortest(length));
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

  void check_any_given(const List& list, const std::vector<std::string>& parameters, const std::string& problem,
                       const InputPlace& place) const {
    const bool any = std::any_of(parameters.begin(), parameters.end(),
                                 [&](const std::string& parameter) { return is_given(list, parameter); });
    if (!any) throw place.error(problem + "; allowed: one or more of " + quoted_list(parameters));
  }

  /// Replaces `stage` in formulas by its number; checks and remembers when the load acts.
  template <class Acting>
  void check_schedule(Acting& acting, const List& list, const InputPlace& place) {
    const auto put_stage = [&acting](std::string& formula) {
      formula = with_names_replaced(
          formula, [&](const std::string& name) { return name == "stage" ? std::to_string(acting.stage) : name; });
    };
    put_stage(acting.amplitude);
    using Kind = std::conditional_t<std::is_base_of_v<Eigenstrain, Acting>, Eigenstrain, Acting>;
    ActingKind<Kind>::for_each_vector(acting, [&](Vector3&, Formulas* formula, VectorRole) {
      if (formula != nullptr) std::for_each(formula->begin(), formula->end(), put_stage);
    });
    check_schedule(acting.stage, acting.amplitude, acting.load_case, list, place);
  }

  void check_schedule(Stage stage, const std::string& amplitude, const std::string& load_case, const List& list,
                      const InputPlace& place) {
    const std::vector<std::string>& cases = scene_.load_cases;
    if (list.isParameter("Case") && std::find(cases.begin(), cases.end(), load_case) == cases.end()) {
      throw place["Case"].error("value \"" + excerpt(load_case) +
                                "\" is not a load case of the scene; allowed: names in \"Load Cases\": " +
                                quoted_list(cases) + did_you_mean(load_case, cases));
    }
    if (list.isParameter("Amplitude")) {
      checked_formula(amplitude, {"t"}, place["Amplitude"]);
      amplitudes_.emplace_back(amplitude, place["Amplitude"]);
    }
    stages_used_.push_back({amplitude.empty() ? stage : 1, stage, load_case, place["Stage"]});
  }

  /// Buckling modes belong to one load case if there are several.
  void check_case_of_modes() const {
    const std::vector<std::string> known = alternatives(scene_);
    const std::string& chosen = scene_.imperfection_case;
    const InputPlace place = place_["Imperfection"]["Case"];
    if (chosen.empty() && !known.empty() && !scene_.imperfection_modes.empty())
      throw place.error("missing; needed with \"Modes\", one of: " + quoted_list(known));
    if (chosen.empty() || std::find(known.begin(), known.end(), chosen) != known.end()) return;
    throw place.error("value \"" + excerpt(chosen) + "\" is not a load case or combination of the scene; allowed: " +
                      (known.empty() ? "none, the scene has no load cases" : quoted_list(known)) +
                      did_you_mean(chosen, known));
  }

  void check_stages() {
    std::stable_sort(stages_used_.begin(), stages_used_.end(),
                     [](const UsedStage& a, const UsedStage& b) { return a.first < b.first; });
    std::vector<std::string> cases = scene_.load_cases;
    if (cases.empty()) cases.emplace_back();
    for (const std::string& load_case : cases) check_stages_of_case({load_case});
    for (const Combination& combination : scene_.combinations) {
      std::set<std::string> acting;
      for (const auto& [load_case, factor] : combination.cases) acting.insert(load_case);
      check_stages_of_case(acting);
    }
    scene_.stages = stages_in_use(scene_);
    for (const Combination& combination : scene_.combinations)
      for (const auto& [stage, factor] : combination.stages)
        if (stage > scene_.stages)
          throw place_["Combinations"][combination.name]["Stage " + std::to_string(stage)].error(
              "nothing acts in this stage; allowed: 1 to " + std::to_string(scene_.stages));
  }

  void check_stages_of_case(const std::set<std::string>& acting) const {
    Stage last = 0;
    for (const UsedStage& used : stages_used_) {
      if (!used.load_case.empty() && acting.count(used.load_case) == 0) continue;
      if (used.first > last + 1) {
        const std::vector<std::string> names(acting.begin(), acting.end());
        const bool has_case = !names.empty() && !names.front().empty();
        const std::string inside = has_case ? " of load case " + quoted_list(names) : "";
        throw used.place.error("value " + std::to_string(used.first) + ", but nothing acts in stage " +
                               std::to_string(last + 1) + inside + "; allowed: stages 1, 2, 3, ... without gaps");
      }
      last = std::max(last, used.last);
    }
  }

  void check_amplitudes() const {
    std::vector<std::vector<double>> samples;
    for (int i = 0; i <= kSamplesPerStage * scene_.stages; ++i)
      samples.push_back({static_cast<double>(i) / kSamplesPerStage});
    std::set<std::string> checked;  // many loads may share one
    for (const auto& [text, place] : amplitudes_) {
      if (!checked.insert(text).second) continue;
      check_finite(checked_formula(text, {"t"}, place), {"t"}, samples, place);
    }
  }

  /// Points that the parameter "Point" matches. Throws for points without members.
  std::vector<std::string> points_meant(const List& list, const InputPlace& list_place) {
    const InputPlace place = list_place["Point"];
    const auto& text = list.get<std::string>("Point");
    if (names_.members_at(text) != nullptr) {
      count(1, place);
      return {text};
    }
    if (names_.has_point(text)) {
      if (place.source().has_mistakes()) return {text};  // a member with one of them may be meant to touch it
      throw place.error("value \"" + excerpt(text) + "\": no member starts or ends there; allowed: points of members");
    }
    const std::vector<std::string> points = has_wildcard(text) && text.size() <= kLongestPattern
                                                ? names_meant(text, names_.point_names())
                                                : std::vector<std::string>{};
    const std::string what = names_.member(text) == nullptr ? "point" : "point, but a member,";
    if (points.empty()) throw unknown_name(place, what, text, names_.point_names());
    count(points.size(), place);
    return points;
  }

  std::vector<const Member*> members_meant(const List& list, const InputPlace& list_place) {
    const InputPlace place = list_place["Member"];
    const auto& text = list.get<std::string>("Member");
    std::vector<const Member*> members;
    if (const Member* const member = names_.member(text))
      members.push_back(member);
    else if (text.size() <= kLongestPattern)
      for (const std::string& name : names_meant(text, names_.member_names())) members.push_back(names_.member(name));
    const std::string what = names_.has_point(text) ? "member, but a point," : "member";
    if (members.empty()) throw unknown_name(place, what, text, names_.member_names());
    count(members.size(), place);
    return members;
  }

  void count(std::size_t more, const InputPlace& place) {
    conditions_ += more;
    if (conditions_ <= kMostConditions) return;
    throw place.error("brings the scene to " + std::to_string(conditions_) +
                      " loads and supports; allowed: " + std::to_string(kMostConditions));
  }

  const List& scene_list_;
  const InputPlace& place_;
  Scene& scene_;
  const std::vector<CopiedPattern>& copies_;
  const SceneNames names_;
  /// Kind -> names of the entries of all that acts, except weights.
  std::unordered_map<std::string, std::vector<std::string>> entries_;
  std::unordered_map<std::string, std::string> support_at_;           ///< point -> name of its support
  std::unordered_map<std::string, std::set<std::string>> joined_at_;  ///< point -> members in a joint there
  std::set<std::string> with_tables_;                                 ///< members that have tables of strains
  std::vector<UsedStage> stages_used_;
  std::vector<std::pair<std::string, InputPlace>> amplitudes_;
  std::size_t conditions_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace

void add_condition_lists(ListSpec& spec) {
  spec.add(array("Load Cases", ParameterType::text_array).or_empty(),
           "Names of alternatives that are solved one by one, each from the undeformed structure, like {wind, snow}; "
           "what acts says by Case to which of them it belongs.");
  spec.add_list(
      "Combinations",
      ListSpec("Load cases that act together, each with a factor, beside whatever belongs to no case; each combination "
               "is solved by itself.")
          .with_named_lists(
              "combination",
              ListSpec("Factors of its load cases.")
                  .with_named_parameters("case",
                                         real("").required().means(
                                             "Factor of this load case, or, as \"Stage 2\", of what acts in a stage."),
                                         1)),
      Presence::optional);
  ListSpec gravity = kGravityParameters.spec;
  for (ParameterSpec& parameter : gravity.parameters)
    if (parameter.presence == Presence::required) parameter.presence = Presence::optional;
  spec.add_list("Gravity", gravity.with_named_lists("weight", kGravityParameters.spec), Presence::optional);
  spec.add_list("Rotating Frame", kRotatingFrameParameters.spec, Presence::optional);
  spec.add_list(
      "Supports",
      ListSpec("Supports; at least one here or by Import.").with_named_lists("support", kSupportParameters.spec));
  spec.add_list("Joints", ListSpec("Connections that are not rigid.").with_named_lists("joint", kJointParameters.spec));
  spec.add_list("Point Loads", ListSpec("Loads at points.").with_named_lists("load", kPointLoadParameters.spec));
  spec.add_list("Point Masses", ListSpec("Bodies at points, for the list Gravity and for Modes.")
                                    .with_named_lists("body", kPointMassParameters.spec));
  spec.add_list("Distributed Loads",
                ListSpec("Loads along members.").with_named_lists("load", kDistributedLoadParameters.spec));
  spec.add_list("Eigenstrains",
                ListSpec("Strains without stress.").with_named_lists("eigenstrain", kEigenstrainParameters.spec));
}

std::vector<std::string> read_conditions(const Teuchos::ParameterList& scene_list, const InputPlace& place,
                                         Scene& scene, const std::vector<CopiedPattern>& copies) {
  return ConditionReader(scene_list, place, scene, copies).read();
}

}  // namespace mixbeam
