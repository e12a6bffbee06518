/// The kinds of quantities: one row each.
#pragma once

#include "discretization/state/member_stresses.hpp"
#include "discretization/state/sampling.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <string>
#include <vector>

namespace mixbeam {

struct QuantityState;

/// Place at which a quantity is taken.
enum class QuantitySource {
  motion,     ///< vector, at points and along members
  triad,      ///< the same, of nine numbers
  section,    ///< vector of a section, along members
  stress,     ///< number of a section, along members
  reaction,   ///< vector, at supported points
  between,    ///< number, of two or three places
  length,     ///< number, of a member
  structure,  ///< number
  mode,       ///< number, of a natural mode
  formula     ///< of other quantities
};

struct QuantityKind {
  std::string name{};
  QuantitySource source = QuantitySource::formula;
  std::string unit{};  ///< L: that of length, F: that of force
  /// Vectors along members: computed at a place, and the record that holds them unchanged; null if there is none.
  Vector3 (*field)(const PointSample&, const MeshMember&) = nullptr;
  std::vector<Vector3> MemberSamples::*recorded = nullptr;
  double (*stress)(const LargestStresses&, double strength) = nullptr;  ///< NaN where it is not known
  Vector3 RecordedReaction::*reaction = nullptr;
  double (*of_structure)(const QuantityState&) = nullptr;

  bool is(QuantitySource one) const { return source == one; }
  bool is_material() const { return name.rfind("material ", 0) == 0; }
  bool needs_strength() const { return name == "utilisation"; }
  bool is_vector() const { return field != nullptr || reaction != nullptr; }
  /// Unit by the names of those of length and force: "kN m"; empty if it has none.
  std::string unit_of(const std::string& length, const std::string& force) const;
};

const std::vector<QuantityKind>& quantity_kinds();
/// Kind of an existing name.
const QuantityKind& quantity_kind(const std::string& name);

/// Whether a kind is a stress: "normal stress" (the largest over the section, with its sign), "shear stress", "von
/// Mises stress", "utilisation" (von Mises stress over Strength).
bool is_stress(const std::string& kind);

/// Whether a member has such a quantity: stresses of its section are known (for a taper: by shapes), and a strength if
/// it needs one.
bool has_stress(const Scene& scene, const Member& member, const std::string& kind);

}  // namespace mixbeam
