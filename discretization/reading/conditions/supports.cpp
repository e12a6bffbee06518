/// The part of ConditionReader that reads supports.

#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/parameters/access.hpp"
#include "discretization/reading/conditions/condition_reader.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>

namespace mixbeam {
namespace {

using namespace vector_algebra;

const std::vector<std::string> kAxisNames = {"x", "y", "z"};

// Below this angle between them, two axes span a plane made of rounding errors. [radian]
constexpr double kSmallestAngle = 1e-6;

std::array<bool, 3> get_axes(const Teuchos::ParameterList& list, const std::string& name) {
  const auto& words = list.get<Teuchos::Array<std::string>>(name);
  std::array<bool, 3> axes{};
  for (std::size_t i = 0; i < 3; ++i) axes[i] = std::find(words.begin(), words.end(), kAxisNames[i]) != words.end();
  return axes;
}

std::ptrdiff_t number_of(const std::array<bool, 3>& fixed) { return std::count(fixed.begin(), fixed.end(), true); }

}  // namespace

void ConditionReader::read_supports() {
  const List& supports = scene_list_.sublist("Supports");
  for (const std::string& name : names_of(supports)) {
    const List& list = supports.sublist(name);
    const ParameterPath path = child(child(path_, "Supports"), name);
    const std::vector<std::string> points = points_meant(list, path);
    Support support = read_support(list, path);
    for (const std::string& point : points) {
      claim_support(point, name, path);
      support.point = point;
      scene_.supports.push_back(support);
    }
  }
}

Support ConditionReader::read_support(const List& list, const ParameterPath& path) {
  Support support;
  support.displacement_fixed = get_axes(list, "Fixed Displacement");
  support.rotation_fixed = get_axes(list, "Fixed Rotation");
  support.prescribed_displacement = get_vector(list, "Prescribed Displacement");
  support.prescribed_rotation = get_vector(list, "Prescribed Rotation");
  support.displacement_stiffness = get_vector(list, "Displacement Stiffness");
  support.rotation_stiffness = get_vector(list, "Rotation Stiffness");
  support.axes = read_axes(list, path);
  check_support(support, path);
  if (!prescribes_motion(support)) {
    check_holds_still(list, path);
    return support;
  }
  const Schedule schedule = read_schedule(list, path);
  schedule.assign_to(support);
  return support;
}

void ConditionReader::claim_support(const std::string& point, const std::string& name, const ParameterPath& path) {
  const auto [earlier, is_new] = support_at_.emplace(point, name);
  if (is_new) return;
  throw source_.error(child(path, "Point"), "value \"" + excerpt(point) + "\" is supported by \"" +
                                                excerpt(earlier->second) +
                                                "\" already; allowed: one support per point");
}

void ConditionReader::check_support(const Support& support, const ParameterPath& path) const {
  const auto rotations = number_of(support.rotation_fixed);
  check_springs(support.displacement_stiffness, support.displacement_fixed, "Displacement Stiffness",
                "Fixed Displacement", path);
  check_springs(support.rotation_stiffness, support.rotation_fixed, "Rotation Stiffness", "Fixed Rotation", path);
  const bool springs = !is_zero(support.displacement_stiffness) || !is_zero(support.rotation_stiffness);
  if (number_of(support.displacement_fixed) + rotations == 0 && !springs)
    throw source_.error(path, "fixes nothing; allowed: at least one direction, or a spring");
  for (std::size_t i = 0; i < 3; ++i) {
    if (support.prescribed_displacement[i] == 0.0 || support.displacement_fixed[i]) continue;
    throw source_.error(child(path, "Prescribed Displacement"),
                        "value " + to_text(support.prescribed_displacement) + " moves direction " + kAxisNames[i] +
                            ", which \"Fixed Displacement\" leaves free; allowed: zero there, or " + kAxisNames[i] +
                            " fixed");
  }
  if (!is_zero(support.prescribed_rotation) && rotations != 3) {
    throw source_.error(child(path, "Prescribed Rotation"), "value " + to_text(support.prescribed_rotation) +
                                                                "; allowed: only with \"Fixed Rotation\" = {x, y, z}");
  }
}

void ConditionReader::check_springs(const Vector3& stiffness, const std::array<bool, 3>& fixed,
                                    const std::string& parameter, const std::string& fixing,
                                    const ParameterPath& path) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (stiffness[i] == 0.0 || !fixed[i]) continue;
    throw source_.error(child(path, parameter), "value " + to_text(stiffness) + " is a spring in direction " +
                                                    kAxisNames[i] + ", which \"" + fixing +
                                                    "\" fixes (all three if absent); allowed: zero there, or " +
                                                    kAxisNames[i] + " not fixed");
  }
}

void ConditionReader::check_holds_still(const List& list, const ParameterPath& path) const {
  for (const std::string parameter : {"Stage", "Amplitude", "Case"}) {
    if (!is_given(list, parameter) || (parameter == "Stage" && list.get<int>("Stage") == 1)) continue;
    throw source_.error(child(path, parameter),
                        "given, but nothing is prescribed; a support holds from the beginning and in every load case");
  }
}

Axes ConditionReader::read_axes(const List& list, const ParameterPath& path) const {
  if (!list.isParameter("Axes")) return kGlobalAxes;
  const auto& given = list.get<Teuchos::Array<double>>("Axes");
  const Vector3 x{given[0], given[1], given[2]};
  const Vector3 y{given[3], given[4], given[5]};
  const double length = norm(x), width = norm(y);
  const auto refused = [&](const std::string& problem) {
    return source_.error(child(path, "Axes"), "axis x = " + to_text(x) + ", axis y = " + to_text(y) + ": " + problem +
                                                  "; allowed: two directions that differ");
  };
  if (length < kShortestLength || width < kShortestLength) throw refused("one of them has no direction");
  Axes axes{};
  axes[0] = scaled(1.0 / length, x);
  const Vector3 normal = cross(axes[0], scaled(1.0 / width, y));
  const double sine = norm(normal);
  if (sine < kSmallestAngle) throw refused("they are parallel");
  axes[2] = scaled(1.0 / sine, normal);
  axes[1] = cross(axes[2], axes[0]);
  return axes;
}

}  // namespace mixbeam
