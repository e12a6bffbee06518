/// Mixed residual of a state, and the reference values that make it dimensionless, theory (39). Rows are divided by the
/// large terms of the current state, not by a fixed stiffness: one tolerance means the same accuracy for any units,
/// slenderness and load.
#pragma once

#include "discretization/assembly/model.hpp"
#include "kernels/element/row_scales.hpp"

namespace mixbeam {

/// Magnitudes of a state and its loads (maxima over all ranks).
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

/// Scales from magnitudes. `tolerance`: scaled residual that counts as converged; floors keep round-off below it.
ResidualScales residual_scales(const StateMagnitude& state, double length, double shortest_element,
                               double bending_stiffness, double tolerance);

/// Scales of the rows of a state. Collective.
ResidualScales scales_of(const Model& model, const State& state, double load_factor);

/// Divides rows by their scales.
void scale_rows(const Model& model, const ResidualScales& scales, MixedVector& rows);
/// Converts scaled rows to forces, moments and integrals of strains.
void unscale_rows(const Model& model, const ResidualScales& scales, MixedVector& rows);
/// Divides only the rows of the vertices.
void scale_vertex_rows(const Model& model, const ResidualScales& scales, const KernelView<double*>& rows);

/// Largest force or moment row of a scaled residual: equilibrium without compatibility and supports.
double equilibrium_norm(const Model& model, const MixedVector& scaled_residual);
/// Largest row of N or M of a scaled residual: compatibility and constitutive law.
double compatibility_norm(const Model& model, const MixedVector& scaled_residual);

/// State under its loads, with results of the evaluation other than the rows.
struct EvaluationPoint {
  State state{};
  double load_factor = 0.0;
  ResidualScales scales{};                         ///< divisors of the rows
  KernelView<double* [3]> line_fields {};          ///< at the load factor (StructureViews::field_value)
  std::shared_ptr<const CarriedForces> carried{};  ///< by supports and joints: not visible in the rows
  KernelView<double*> end_angles{};                ///< (local element): relative rotation between element and vertices
};

/// Computes the rows, each divided by its scale.
EvaluationPoint mixed_residual(const Model& model, const State& state, double load_factor, MixedVector& rows);

/// d(scaled residual)/d(load factor).
void load_derivative(const Model& model, const State& state, double load_factor, const ResidualScales& scales,
                     MixedVector& rows);

/// Loads on elements between their vertices.
enum class ElementLoads { none, line_loads, with_centrifugal };

/// Unscaled rows of the elements, without point loads and supports: spatial forces and moments at each vertex that keep
/// the elements in equilibrium, and the interior rows.
void element_rows(const Model& model, const State& state, double load_factor, ElementLoads loads, MixedVector& rows);

/// Rows of N and M of each element, or all others.
enum class RowsOf { forces, motions };
/// Clears these interior rows of a residual or increment.
void clear_rows(const Structure& structure, const KernelView<double*>& interior, RowsOf which);

}  // namespace mixbeam
