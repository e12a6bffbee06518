#include "discretization/quantities/quantity_fields.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>

namespace mixbeam {

namespace {

using vector_algebra::to_array;

Vector3 turned(const PointSample& sample, const Vec3<double>& v) { return to_array(rotation_matrix(sample.triad) * v); }

const std::map<std::string, Field>& fields() {
  using S = PointSample;
  using M = MeshMember;
  static const std::map<std::string, Field> table = {
      {"displacement", [](const S& s, const M&) { return to_array(s.displacement); }},
      {"position", [](const S& s, const M&) { return to_array(s.position); }},
      {"rotation",
       [](const S& s, const M& m) {
         return to_array(log_quaternion(s.triad * conjugate(m.curve.triad(s.arc_length))));
       }},
      {"material force", [](const S& s, const M&) { return to_array(s.force); }},
      {"material moment", [](const S& s, const M&) { return to_array(s.moment); }},
      {"material strain", [](const S& s, const M&) { return to_array(s.force_strain); }},
      {"material curvature", [](const S& s, const M&) { return to_array(s.moment_strain); }},
      {"spatial force", [](const S& s, const M&) { return turned(s, s.force); }},
      {"spatial moment", [](const S& s, const M&) { return turned(s, s.moment); }},
      {"spatial strain", [](const S& s, const M&) { return turned(s, s.force_strain); }},
      {"spatial curvature", [](const S& s, const M&) { return turned(s, s.moment_strain); }}};
  return table;
}

/// Fields that stand in the samples of a record as they are asked for.
const std::map<std::string, std::vector<Vector3> MemberSamples::*> kRecordedFields = {
    {"displacement", &MemberSamples::displacement},     {"position", &MemberSamples::position},
    {"material force", &MemberSamples::material_force}, {"material moment", &MemberSamples::material_moment},
    {"material strain", &MemberSamples::force_strain},  {"material curvature", &MemberSamples::moment_strain}};

}  // namespace

Field field_of(const std::string& kind) {
  const auto found = fields().find(kind);
  return found == fields().end() ? nullptr : found->second;
}

std::vector<Vector3> MemberSamples::*recorded_field(const std::string& kind) {
  const auto found = kRecordedFields.find(kind);
  return found == kRecordedFields.end() ? nullptr : found->second;
}

bool is_motion(const std::string& kind) {
  return kind == "displacement" || kind == "position" || kind == "rotation" || kind == "triad";
}
bool is_reaction(const std::string& kind) { return kind == "reaction force" || kind == "reaction moment"; }

std::string unit_of(const std::string& kind, const std::string& length, const std::string& force) {
  const auto is_one_of = [&kind](std::initializer_list<const char*> kinds) {
    return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
  };
  if (is_one_of({"displacement", "position", "distance", "length"})) return length;
  if (is_one_of({"rotation", "angle"})) return "rad";
  if (is_one_of({"material force", "spatial force", "reaction force"})) return force;
  if (is_one_of(
          {"material moment", "spatial moment", "reaction moment", "strain energy", "force energy", "moment energy"}))
    return force + " " + length;
  if (is_one_of({"material curvature", "spatial curvature"})) return "1/" + length;
  if (is_one_of({"normal stress", "shear stress", "von Mises stress"})) return force + "/" + length + "\u00b2";
  return "";
}

std::vector<int> numbers_of(const Quantity& quantity) {
  static const std::map<std::string, std::vector<int>> of_component = {
      {"x", {0}}, {"y", {1}},        {"z", {2}},        {"1", {0}},        {"2", {1}},
      {"3", {2}}, {"norm", {kNorm}}, {"g1", {0, 1, 2}}, {"g2", {3, 4, 5}}, {"g3", {6, 7, 8}}};
  if (!quantity.component.empty()) return of_component.at(quantity.component);
  if (quantity.kind == "triad") return {0, 1, 2, 3, 4, 5, 6, 7, 8};
  if (is_reaction(quantity.kind) || field_of(quantity.kind) != nullptr) return {0, 1, 2};
  return {0};
}

std::vector<std::string> endings_of(const Quantity& quantity) {
  const std::size_t count = numbers_of(quantity).size();
  if (count == 1) return {""};
  if (count == 9) return {".g1.x", ".g1.y", ".g1.z", ".g2.x", ".g2.y", ".g2.z", ".g3.x", ".g3.y", ".g3.z"};
  if (quantity.kind.rfind("material ", 0) == 0) return {".1", ".2", ".3"};
  return {".x", ".y", ".z"};
}

double picked(const Numbers& numbers, int which) {
  return which == kNorm ? std::hypot(numbers[0], numbers[1], numbers[2]) : numbers[static_cast<std::size_t>(which)];
}

Numbers numbers_from(const Vector3& v) { return {v[0], v[1], v[2]}; }

Numbers numbers_from(const Mat3<double>& axes) {
  Numbers numbers{};
  for (int g = 0; g < 3; ++g)
    for (int i = 0; i < 3; ++i) numbers[static_cast<std::size_t>(3 * g + i)] = axes(i, g);
  return numbers;
}

}  // namespace mixbeam
