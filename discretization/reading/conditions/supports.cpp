/// The part of ConditionReader that reads supports.

#include "discretization/parameters/access.hpp"
#include "discretization/reading/conditions/condition_reader.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
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

}  // namespace mixbeam
