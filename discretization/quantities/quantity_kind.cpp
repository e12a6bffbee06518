#include "discretization/quantities/quantity_kind.hpp"

#include "discretization/quantities/quantity_set.hpp"

#include <algorithm>
#include <limits>

namespace mixbeam {

namespace {

using vector_algebra::to_array;

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

using Part = Vec3<double> PointSample::*;

template <Part part>
Vector3 own(const PointSample& sample, const MeshMember&) {
  return to_array(sample.*part);
}
/// Vector in global axes from the axes of the section.
template <Part part>
Vector3 turned(const PointSample& sample, const MeshMember&) {
  return to_array(rotation_matrix(sample.triad) * (sample.*part));
}

QuantityKind along_members(const char* name, QuantitySource source, const char* unit,
                           Vector3 (*field)(const PointSample&, const MeshMember&),
                           std::vector<Vector3> MemberSamples::*recorded = nullptr) {
  QuantityKind kind{name, source, unit, field};
  kind.recorded = recorded;
  return kind;
}

QuantityKind stress_of(const char* name, const char* unit, double (*stress)(const LargestStresses&, double)) {
  QuantityKind kind{name, QuantitySource::stress, unit};
  kind.stress = stress;
  return kind;
}

QuantityKind reaction_of(const char* name, const char* unit, Vector3 RecordedReaction::*reaction) {
  QuantityKind kind{name, QuantitySource::reaction, unit};
  kind.reaction = reaction;
  return kind;
}

QuantityKind of_structure(const char* name, const char* unit, double (*value)(const QuantityState&)) {
  QuantityKind kind{name, QuantitySource::structure, unit};
  kind.of_structure = value;
  return kind;
}

std::vector<QuantityKind> all_kinds() {
  using S = PointSample;
  using Largest = LargestStresses;
  using State = QuantityState;
  const QuantitySource motion = QuantitySource::motion, section = QuantitySource::section;
  return {along_members("displacement", motion, "L", own<&S::displacement>, &MemberSamples::displacement),
          along_members("position", motion, "L", own<&S::position>, &MemberSamples::position),
          along_members("rotation", motion, "rad",
                        [](const S& s, const MeshMember& m) {
                          return to_array(log_quaternion(s.triad * conjugate(m.curve.triad(s.arc_length))));
                        }),
          along_members("material force", section, "F", own<&S::force>, &MemberSamples::material_force),
          along_members("material moment", section, "F L", own<&S::moment>, &MemberSamples::material_moment),
          along_members("material strain", section, "", own<&S::force_strain>, &MemberSamples::force_strain),
          along_members("material curvature", section, "1/L", own<&S::moment_strain>, &MemberSamples::moment_strain),
          along_members("spatial force", section, "F", turned<&S::force>),
          along_members("spatial moment", section, "F L", turned<&S::moment>),
          along_members("spatial strain", section, "", turned<&S::force_strain>),
          along_members("spatial curvature", section, "1/L", turned<&S::moment_strain>),
          {"triad", QuantitySource::triad, ""},
          stress_of("normal stress", "F/L\u00b2", [](const Largest& s, double) { return s.normal.value; }),
          stress_of("shear stress", "F/L\u00b2", [](const Largest& s, double) { return s.shear.value; }),
          stress_of("von Mises stress", "F/L\u00b2", [](const Largest& s, double) { return s.von_mises.value; }),
          stress_of("utilisation", "",
                    [](const Largest& s, double strength) {
                      return strength > 0.0 ? s.von_mises.value / strength : kNotKnown;
                    }),
          reaction_of("reaction force", "F", &RecordedReaction::force),
          reaction_of("reaction moment", "F L", &RecordedReaction::moment),
          {"distance", QuantitySource::between, "L"},
          {"angle", QuantitySource::between, "rad"},
          {"length", QuantitySource::length, "L"},
          of_structure("strain energy", "F L", [](const State& at) { return at.energy.force + at.energy.moment; }),
          of_structure("force energy", "F L", [](const State& at) { return at.energy.force; }),
          of_structure("moment energy", "F L", [](const State& at) { return at.energy.moment; }),
          of_structure("load factor", "", [](const State& at) { return at.load_factor; }),
          of_structure("jumps", "", [](const State& at) { return static_cast<double>(at.jumps); }),
          of_structure("negative eigenvalues", "",
                       [](const State& at) { return at.negative < 0 ? kNotKnown : static_cast<double>(at.negative); }),
          {"natural frequency", QuantitySource::mode, ""},
          {"formula", QuantitySource::formula, ""}};
}

}  // namespace

std::string QuantityKind::unit_of(const std::string& length, const std::string& force) const {
  std::string text;
  for (const char c : unit) text += c == 'L' ? length : c == 'F' ? force : std::string(1, c);
  return text;
}

const std::vector<QuantityKind>& quantity_kinds() {
  static const std::vector<QuantityKind> kinds = all_kinds();
  return kinds;
}

const QuantityKind& quantity_kind(const std::string& name) {
  return *std::find_if(quantity_kinds().begin(), quantity_kinds().end(),
                       [&name](const QuantityKind& kind) { return kind.name == name; });
}

bool is_stress(const std::string& kind) { return quantity_kind(kind).is(QuantitySource::stress); }

bool has_stress(const Scene& scene, const Member& member, const std::string& kind) {
  for (const std::string& name : {member.section, member.end_section}) {
    if (name.empty()) continue;
    const Section& section = *std::find_if(scene.sections.begin(), scene.sections.end(),
                                           [&name](const Section& one) { return one.name == name; });
    const bool has_rows = section.stress_points && section.stress_points->points.front().stress;
    const bool is_known = member.end_section.empty() ? has_stresses(section) : section.shape.has_value() || has_rows;
    if (!is_known || (quantity_kind(kind).needs_strength() && !strength_of(section))) return false;
  }
  return true;
}

}  // namespace mixbeam
