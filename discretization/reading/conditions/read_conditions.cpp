#include "discretization/reading/scene_parts.hpp"

#include "discretization/parameters/access.hpp"
#include "discretization/parameters/input_place.hpp"
#include "discretization/reading/conditions/condition_reader.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

using namespace vector_algebra;

const std::vector<std::string> kAxisNames = {"x", "y", "z"};

// Below this angle between them, two axes span a plane made of rounding errors. [radian]
constexpr double kSmallestAngle = 1e-6;

BoundList<Support> support_parameters() {
  BoundList<Support> support(
      "Support of a point, along global axes unless Axes are given; without further parameters a clamp.");
  support.bind(&Support::point, text("Point").required(), "Name of the point" + kWildcard);
  support.bind(&Support::displacement_fixed,
               subset("Fixed Displacement", kAxisNames).by_default(Teuchos::Array<std::string>(kAxisNames)),
               "Directions in which the displacement is fixed or prescribed; {} for none.");
  support.bind(
      &Support::rotation_fixed,
      subset("Fixed Rotation", kAxisNames).by_default(Teuchos::Array<std::string>(kAxisNames)),
      "Axes about which the rotation is fixed or prescribed; {} for a ball joint, two of them for a hinge about "
      "the third, one of them to fix that component of the rotation vector at zero.");
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
      array("Axes", ParameterType::real_array, 6).at_least(-kLargestCoordinate).at_most(kLargestCoordinate),
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
}

std::ptrdiff_t number_of(const std::array<bool, 3>& fixed) { return std::count(fixed.begin(), fixed.end(), true); }

BoundList<Joint> joint_parameters() {
  BoundList<Joint> joint(
      "A connection that is not rigid: each listed member ends in its own joint with the rest of what meets at the "
      "point; "
      "members not listed stay rigidly connected, and supports and loads of the point act on them.");
  joint.bind(&Joint::point, text("Point").required(), "Name of the point.");
  joint.bind(&Joint::members, array("Members", ParameterType::text_array).required(),
             "Names of members that have one end at the point, like {strut 1, strut 2}" + kWildcard);
  joint.bind(
      &Joint::kind, text("Kind").required(),
      "hinge: free rotation about Axis; ball: free rotation about any axis; slider: free translation along Axis, "
      "no rotation.",
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
}

/// Components in the triad of a mirrored section, whose axis 3 is the opposite of the image of axis 3: of vectors, and
/// of axial ones (moments, curvatures).
constexpr Vector3 kMirroredVector{1, 1, -1}, kMirroredAxial{-1, -1, 1};

bool says_anything(const Formulas& formula) {
  return std::any_of(formula.begin(), formula.end(), [](const std::string& text) { return !text.empty(); });
}

Vector3 product(const Vector3& a, const Vector3& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }

/// The image of a field under `turn`, which is linear.
template <class Turn>
void turn_field(const Turn& turn, Vector3& constant, Formulas& formula) {
  constant = turn(constant);
  if (!says_anything(formula)) return;
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

/// The vectors of a load: in space, or in the triads of members.
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

/// Its axes go with it, right-handed; a clamp or ball without springs and motion is the same along any axes.
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

}  // namespace

const BoundList<Support> kSupportParameters = support_parameters();
void ConditionReader::read_supports() {
  for_each("Supports", [this](const std::string& name, const List& list, const InputPlace& place) {
    const std::vector<std::string> points = points_meant(list, place);
    Support support = read_support(list, place);
    for (const std::string& point : points) {
      claim_support(point, name, place);
      support.point = point;
      add(support, name);
    }
  });
  copy_supports();
}

Support ConditionReader::read_support(const List& list, const InputPlace& place) {
  Support support = kSupportParameters.read(list);
  if (list.isParameter("Axes")) complete_axes(support.axes, place["Axes"]);
  check_support(support, place);
  if (prescribes_motion(support))
    check_schedule(support, list, place);
  else
    check_holds_still(list, place);
  return support;
}

void ConditionReader::claim_support(const std::string& point, const std::string& name, const InputPlace& place) {
  const auto [earlier, is_new] = support_at_.emplace(point, name);
  if (is_new) return;
  throw place["Point"].error("value \"" + excerpt(point) + "\" is supported by \"" + excerpt(earlier->second) +
                             "\" already; allowed: one support per point");
}

void ConditionReader::check_support(const Support& support, const InputPlace& place) const {
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

void ConditionReader::check_springs(const Vector3& stiffness, const std::array<bool, 3>& fixed,
                                    const std::string& parameter, const std::string& fixing,
                                    const InputPlace& place) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (stiffness[i] == 0.0 || !fixed[i]) continue;
    throw place[parameter].error("value " + to_text(stiffness) + " is a spring in direction " + kAxisNames[i] +
                                 ", which \"" + fixing + "\" fixes (all three if absent); allowed: zero there, or " +
                                 kAxisNames[i] + " not fixed");
  }
}

void ConditionReader::check_holds_still(const List& list, const InputPlace& place) const {
  for (const std::string parameter : {"Stage", "Amplitude", "Case"}) {
    if (!is_given(list, parameter) || (parameter == "Stage" && list.get<int>("Stage") == 1)) continue;
    throw place[parameter].error(
        "given, but nothing is prescribed; a support acts from the beginning and in every load case");
  }
}

/// From two directions as they were given to three unit vectors.
void ConditionReader::complete_axes(Axes& axes, const InputPlace& place) const {
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

const BoundList<Joint> kJointParameters = joint_parameters();
void ConditionReader::read_joints() {
  for_each("Joints", [this](const std::string& name, const List& list, const InputPlace& place) {
    scene_.joints.push_back(read_joint(list, place));
    scene_.joints.back().name = name;
  });
  copy_joints();
  if (place_.source().has_mistakes()) return;
  // Only now: several joints at a point must not take its last member.
  for (const Joint& joint : scene_.joints) check_someone_is_left(joint);
}

bool ConditionReader::is_someone_left(const Joint& joint) const {
  std::set<std::string> touching;
  for (const Member* member : *names_.members_at(joint.point)) touching.insert(member->name);
  return joined_at_.at(joint.point).size() < touching.size();
}

void ConditionReader::check_someone_is_left(const Joint& joint) const {
  if (is_someone_left(joint)) return;
  throw place_["Joints"][joint.name]["Members"].error(
      "all members at \"" + excerpt(joint.point) +
      "\" are in joints, and none is left that they could be joined to; allowed: at least one of them not listed");
}

Joint ConditionReader::read_joint(const List& list, const InputPlace& place) {
  Joint joint = kJointParameters.read(list);
  if (names_.members_at(joint.point) == nullptr)
    throw unknown_name(place["Point"], "point with members", joint.point, names_.point_names());
  for (const std::string& text : std::exchange(joint.members, {})) join(text, joint, place);
  if (joint.together && joint.members.size() < 2)
    throw place["Together"].error("value true, but \"Members\" names only \"" + excerpt(joint.members.front()) +
                                  "\"; allowed: for two members or more");
  return joint;
}

/// Adds the members that `text` means.
void ConditionReader::join(const std::string& text, Joint& joint, const InputPlace& joint_place) {
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

/// An entry acts once at each place: where it is already, by its name or as another copy, nothing is added.
template <class Acting>
void ConditionReader::copy_with_patterns() {
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

void ConditionReader::note_left_out(const std::string& list, const std::string& entry, const std::string& point,
                                    const std::string& why) {
  notes_.push_back("\"" + list + " / " + excerpt(entry) + "\" is not copied to \"" + excerpt(point) + "\": " + why);
}

void ConditionReader::copy_supports() { copy_with_patterns<Support>(); }

void ConditionReader::copy_loads() {
  for_each_kind([this](auto kind) {
    using Load = typename std::decay_t<decltype(scene_.*kind.list)>::value_type;
    if constexpr (!kind.stays) copy_with_patterns<Load>();
  });
  copy_with_patterns<PointMass>();
}

bool ConditionReader::goes_along(Support& copy, const PatternCopy&, const std::string& entry) {
  claim_support(copy.point, entry, place_["Supports"][entry]);
  return true;
}

bool ConditionReader::goes_along(PointLoad& copy, const PatternCopy& made, const std::string& entry) {
  if (copy.frame == LoadFrame::dead) return true;
  const auto image = made.members.find(copy.member);
  if (image == made.members.end())
    note_left_out("Point Loads", entry, copy.point,
                  "no copy of the member \"" + excerpt(copy.member) + "\" that it turns with");
  else
    copy.member = image->second;
  return image != made.members.end();
}

bool ConditionReader::goes_along(DistributedLoad& copy, const PatternCopy&, const std::string& entry) {
  divide_at(copy.member, copy.range, place_["Distributed Loads"][entry]["Range"]);
  return true;
}

/// The elements and arc lengths of a table are those of the member for which it was made; in a scene that a rest shape
/// left, each copy has tables of its own.
bool ConditionReader::goes_along(Eigenstrain& copy, const PatternCopy&, const std::string& entry) {
  if (!copy.strain_table && !copy.curvature_table) return true;
  if (with_tables_.count(copy.member) == 0)
    note_left_out("Eigenstrains", entry, copy.member, "its tables belong to one member");
  return false;
}

/// Each listed member takes its joint with it, also to a point that the pattern leaves where it is. Where a pattern
/// ends there may be nobody whom a copy could be joined to.
void ConditionReader::copy_joints() {
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

void add_condition_lists(ListSpec& spec) {
  spec.add(array("Load Cases", ParameterType::text_array).or_empty(),
           "Names of alternatives that are solved one by one, each from the undeformed structure, like {wind, snow}; "
           "what acts says by Case to which of them it belongs.");
  spec.add_list(
      "Combinations",
      ListSpec("Load cases that act together, each with a factor, beside whatever belongs to no case; each "
               "combination is solved by itself.")
          .with_named_lists("combination", ListSpec("Factors of its load cases.")
                                               .with_named_parameters(
                                                   "case",
                                                   real("").required().means("Factor of this load case, or, as "
                                                                             "\"Stage 2\", of what acts in a stage."),
                                                   1)),
      Presence::optional);
  spec.add_list("Gravity", gravity_spec(), Presence::optional);
  spec.add_list("Rotating Frame", rotating_frame_spec(), Presence::optional);
  spec.add_list(
      "Supports",
      ListSpec("Supports; at least one here or by Import.").with_named_lists("support", kSupportParameters.spec));
  spec.add_list("Joints", ListSpec("Connections that are not rigid.").with_named_lists("joint", kJointParameters.spec));
  add_load_lists(spec);
}

std::vector<std::string> read_conditions(const Teuchos::ParameterList& scene_list, const InputPlace& place,
                                         Scene& scene, const std::vector<CopiedPattern>& copies) {
  return ConditionReader(scene_list, place, scene, copies).read();
}

std::vector<std::string> ConditionReader::read() {
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

void ConditionReader::read_load_cases() {
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

void ConditionReader::read_combinations() {
  if (!scene_list_.isSublist("Combinations")) return;
  const List& list = scene_list_.sublist("Combinations");
  const std::vector<std::string>& cases = scene_.load_cases;
  const std::string stage = "Stage ";
  const auto read_one = [&](const std::string& name, const InputPlace& place) {
    if (const Problem problem = file_name_problem(name); !problem.empty()) throw place.error("name " + problem);
    if (std::find(cases.begin(), cases.end(), name) != cases.end())
      throw place.error("the name of a load case too; allowed: names that differ");
    Combination& combination = scene_.combinations.emplace_back();
    combination.name = name;
    for (const std::string& entry : names_of(list.sublist(name))) {
      const double factor = list.sublist(name).get<double>(entry);
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
  };
  for (const std::string& name : names_of(list)) {
    const InputPlace place = place_["Combinations"][name];
    place.attempt([&] { read_one(name, place); });
  }
}

/// Modes of buckling belong to the loads of one of several cases.
void ConditionReader::check_case_of_modes() const {
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

void ConditionReader::check_schedule(Stage stage, const std::string& amplitude, const std::string& load_case,
                                     const List& list, const InputPlace& place) {
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

void ConditionReader::check_stages() {
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

void ConditionReader::check_stages_of_case(const std::set<std::string>& acting) const {
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

void ConditionReader::check_amplitudes() const {
  std::vector<std::vector<double>> samples;
  for (int i = 0; i <= kSamplesPerStage * scene_.stages; ++i)
    samples.push_back({static_cast<double>(i) / kSamplesPerStage});
  std::set<std::string> checked;  // many loads may share one
  for (const auto& [text, place] : amplitudes_) {
    if (!checked.insert(text).second) continue;
    check_finite(checked_formula(text, {"t"}, place), {"t"}, samples, place);
  }
}

std::vector<std::string> ConditionReader::points_meant(const List& list, const InputPlace& list_place) {
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

std::vector<const Member*> ConditionReader::members_meant(const List& list, const InputPlace& list_place) {
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

void ConditionReader::count(std::size_t more, const InputPlace& place) {
  conditions_ += more;
  if (conditions_ <= kMostConditions) return;
  throw place.error("brings the scene to " + std::to_string(conditions_) +
                    " loads and supports; allowed: " + std::to_string(kMostConditions));
}

void ConditionReader::check_any_given(const List& list, const std::vector<std::string>& parameters,
                                      const std::string& problem, const InputPlace& place) const {
  const bool any = std::any_of(parameters.begin(), parameters.end(),
                               [&](const std::string& parameter) { return is_given(list, parameter); });
  if (!any) throw place.error(problem + "; allowed: one or more of " + quoted_list(parameters));
}

}  // namespace mixbeam
