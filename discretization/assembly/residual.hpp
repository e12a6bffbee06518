/// The mixed residual of a state.
#pragma once

#include "discretization/assembly/row_scales.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// A state under its loads, and what its equations tell besides their rows.
struct EvaluationPoint {
  State state{};
  double load_factor = 0.0;
  ResidualScales scales{};                         ///< what the rows are divided by
  std::shared_ptr<const CarriedForces> carried{};  ///< by supports and joints: the rows do not show them
  KernelView<double*> end_angles{};                ///< (local element): relative rotation between element and vertices
};

/// Every row divided by its scale.
EvaluationPoint mixed_residual(const Model& model, const State& state, double load_factor, MixedVector& rows);

/// d(scaled residual)/d(load factor).
void load_derivative(const Model& model, const State& state, double load_factor, const ResidualScales& scales,
                     MixedVector& rows);

/// Unscaled rows of the elements alone, without point loads and supports: the forces and moments (spatial) that hold
/// the elements at each vertex in place, and the interior rows. `with_line_loads` false: as if the members carried
/// none.
void element_rows(const Model& model, const State& state, double load_factor, bool with_line_loads, MixedVector& rows);

/// Gives the line fields in the blocks of the structure (ElementBlock::field_value) their values at a load factor.
void set_line_fields(const Model& model, double load_factor);

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

}  // namespace mixbeam
