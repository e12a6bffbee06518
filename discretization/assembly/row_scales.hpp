/// Reference values that make the mixed residual dimensionless, theory (39), so that the same tolerance means the same
/// accuracy for any units, slenderness and load: rows are divided by what is large in the present state, not by a fixed
/// stiffness.
#pragma once

#include "discretization/assembly/model.hpp"
#include "kernels/element/row_scales.hpp"

namespace mixbeam {

/// What a state and its loads look like in size (maxima over all ranks).
struct StateMagnitude {
  double force = 0.0;         ///< largest |N| component
  double moment = 0.0;        ///< largest |M| component
  double displacement = 0.0;  ///< largest |u| component
  double rotation = 0.0;      ///< largest vertex rotation angle
  double load_force = 0.0;    ///< largest applied force, point or line load times length
  double load_moment = 0.0;
  double eigenstrain = 0.0;  ///< largest eigenstrain, or eigencurvature times length
};

/// Collective.
StateMagnitude magnitude_of(const Model& model, const State& state, double load_factor);

/// `tolerance`: the scaled residual that will count as converged; floors keep round-off below it.
ResidualScales residual_scales(const StateMagnitude& state, double length, double shortest_element,
                               double bending_stiffness, double tolerance);

/// Scales of the rows of a state. Collective.
ResidualScales scales_of(const Model& model, const State& state, double load_factor);

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

/// Divides rows by their scales.
void scale_rows(const Model& model, const ResidualScales& scales, MixedVector& rows);
/// Takes scaled rows to forces, moments and integrals of strains.
void unscale_rows(const Model& model, const ResidualScales& scales, MixedVector& rows);
/// Divides the rows of the vertices alone.
void scale_vertex_rows(const Model& model, const ResidualScales& scales, const KernelView<double*>& rows);

/// Largest force or moment row of a scaled residual: equilibrium without compatibility and supports.
double equilibrium_norm(const Model& model, const MixedVector& scaled_residual);
/// Largest row of N or M of a scaled residual: compatibility and the constitutive law.
double compatibility_norm(const Model& model, const MixedVector& scaled_residual);

}  // namespace mixbeam
