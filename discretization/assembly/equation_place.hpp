/// Place of an entry of the mixed system in the structure, for messages: vertex or element, what its equation balances
/// and what its unknown is. Slow, for a few entries only.
#pragma once

#include "discretization/assembly/tangent.hpp"

#include <optional>
#include <string>

namespace mixbeam {

/// A row of the mixed system: an equation, and the unknown of the same place in an increment.
enum class RowKind {
  vertex_displacement,  ///< balance of forces
  vertex_rotation,      ///< balance of moments
  held_displacement,    ///< a condition of a support or joint
  held_rotation,        ///< likewise
  element_force,        ///< force strain from the motion against that from the force
  element_moment,       ///< likewise for the moment strain: a relative rotation
  element_rotation,     ///< balance of moments inside the element
  element_displacement  ///< balance of forces inside the element
};
RowKind kind_of_vertex_row(int component, bool fixed);
RowKind kind_of_interior_row(const InteriorLayout& layout, int row);
/// `h`: length of the element, for rows of an element.
double scale_of(RowKind kind, const ResidualScales& scales, double h);

struct EquationPlace {
  RowKind kind = RowKind::vertex_displacement;
  int component = 0;        ///< 0, 1, 2: spatial, or along the axes of a support or joint; material inside elements
  std::string point{};      ///< name of the vertex, if it has one
  std::string member{};     ///< the element's, or one that meets the vertex
  int element = -1;         ///< counted from 0 at the start of the member; -1: a vertex
  double along = 0.0;       ///< relative arc length of vertex or middle of the element in `member`
  Vector3 position{};       ///< undeformed, spatial
  int global_vertex = -1;   ///< in Mesh; -1: an element
  int global_element = -1;  ///< in Mesh; -1: a vertex
};

/// An entry of a scaled residual, in units too: force, moment, length or angle, strain.
struct ResidualPeak {
  EquationPlace place;
  double scaled = 0.0;  ///< without dimension
  double value = 0.0;
};

/// Largest finite entry of a scaled residual; `scales`: those it was divided by. Nothing if no entry is finite and not
/// zero. Collective.
std::optional<ResidualPeak> largest_row(const Model& model, const MixedVector& scaled_residual,
                                        const ResidualScales& scales);

/// First entry that is not a finite number: inside elements first (what is wrong in an element is soon wrong at its
/// vertices too), or at vertices first. Collective.
enum class SearchOrder { elements_first, vertices_first };
std::optional<EquationPlace> first_not_finite(const Model& model, const MixedVector& vector, SearchOrder order);

/// First element whose condensed tangent holds something that is not a finite number. Collective.
std::optional<EquationPlace> first_tangent_not_finite(const Tangent& tangent);

/// A vertex of the mesh, without kind and component. Collective.
EquationPlace place_of_vertex(const Model& model, int global_vertex);

/// A relative rotation between an element and its vertices, and where.
struct EndAngle {
  double angle = 0.0;
  std::string member{};
  int element = 0;  ///< in the member
};
/// The largest of all ranks.
EndAngle largest_end_angle(const Model& model, const EvaluationPoint& point);
/// The largest of every member, in the order of the scene. Collective.
std::vector<EndAngle> end_angles_of_members(const Model& model, const EvaluationPoint& point);

/// `point "tip"`, `member "beam" at 0.25 of its length`, `element 3 of member "beam"`.
std::string text_of(const EquationPlace& place);

/// Names the equation that is not fulfilled: `balance of forces, x`, `strain from force, axial`.
std::string equation_text(const EquationPlace& place);

/// Names the unknown: `displacement x`, `force, axial`.
std::string unknown_text(const EquationPlace& place);

}  // namespace mixbeam
