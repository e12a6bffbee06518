/// Location of an entry of the mixed system in the structure, for messages: vertex or element, and names of its
/// equation and unknown. Slow, for a few entries only.
#pragma once

#include "discretization/assembly/tangent.hpp"

#include <optional>
#include <string>

namespace mixbeam {

/// Row of the mixed system: an equation, and the unknown at the same place in an increment.
enum class RowKind {
  vertex_displacement,  ///< balance of forces
  vertex_rotation,      ///< balance of moments
  held_displacement,    ///< condition of a support or joint
  held_rotation,        ///< same for a rotation
  element_force,        ///< force strain of the motion versus that of the force
  element_moment,       ///< same for the moment strain: a relative rotation
  element_rotation,     ///< balance of moments inside the element
  element_displacement  ///< balance of forces inside the element
};
RowKind kind_of_vertex_row(int component, bool fixed);
RowKind kind_of_interior_row(const InteriorLayout& layout, int row);
/// Scale of a row; `h`: length of the element, for element rows.
double scale_of(RowKind kind, const ResidualScales& scales, double h);

struct EquationPlace {
  RowKind kind = RowKind::vertex_displacement;
  int component = 0;        ///< 0, 1, 2: spatial, or along the axes of a support or joint; material inside elements
  std::string point{};      ///< name of the vertex, if it has one
  std::string member{};     ///< that of the element, or one that meets the vertex
  int element = -1;         ///< counted from 0 at the start of the member; -1: a vertex
  double along = 0.0;       ///< relative arc length of the vertex or element midpoint in `member`
  Vector3 position{};       ///< undeformed, spatial
  int global_vertex = -1;   ///< in Mesh; -1: an element
  int global_element = -1;  ///< in Mesh; -1: a vertex
};

/// Entry of a scaled residual, also in units: force, moment, length or angle, strain.
struct ResidualPeak {
  EquationPlace place;
  double scaled = 0.0;  ///< dimensionless
  double value = 0.0;
};

/// Largest finite entry of a residual scaled by `scales`. Empty if all finite entries are zero. Collective.
std::optional<ResidualPeak> largest_row(const Model& model, const MixedVector& scaled_residual,
                                        const ResidualScales& scales);

/// First entry that is not finite: inside elements first (an error in an element soon reaches its vertices), or at
/// vertices first. Collective.
enum class SearchOrder { elements_first, vertices_first };
std::optional<EquationPlace> first_not_finite(const Model& model, const MixedVector& vector, SearchOrder order);

/// First element whose condensed tangent is not finite. Collective.
std::optional<EquationPlace> first_tangent_not_finite(const Tangent& tangent);

/// Place of a vertex of the mesh, without kind and component. Collective.
EquationPlace place_of_vertex(const Model& model, int global_vertex);

/// Relative rotation between an element and its vertices, with its element.
struct EndAngle {
  double angle = 0.0;
  std::string member{};
  int element = 0;  ///< in the member
};
/// Largest end angle of all ranks.
EndAngle largest_end_angle(const Model& model, const EvaluationPoint& point);
/// Largest end angle of every member, in the order of the scene. Collective.
std::vector<EndAngle> end_angles_of_members(const Model& model, const EvaluationPoint& point);

/// Describes the place: `point "tip"`, `member "beam" at 0.25 of its length`, `element 3 of member "beam"`.
std::string text_of(const EquationPlace& place);

/// Names the unbalanced equation: `balance of forces, x`, `strain from force, axial`.
std::string equation_text(const EquationPlace& place);

/// Names the unknown: `displacement x`, `force, axial`.
std::string unknown_text(const EquationPlace& place);

}  // namespace mixbeam
