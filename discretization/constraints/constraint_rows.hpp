/// All supports and joints of one rank as equations in place of rows of the assembled system: see support_rows.hpp and
/// joint_rows.hpp. Loops over supports and joints only; without any of them there is nothing to do.
#pragma once

#include "discretization/constraints/joint_rows.hpp"
#include "discretization/constraints/support_rows.hpp"

#include <vector>

namespace mixbeam {

/// A vertex whose forces and moments are balanced by more than loads, by supports or joints.
struct CarriedForce {
  int vertex = 0;
  Vec force{}, moment{};
  Vec joined_moment{};  ///< with the slaves at the vertex
};
using CarriedForces = std::vector<CarriedForce>;  ///< ascending vertices

class ConstraintRows {
 public:
  ConstraintRows() = default;
  explicit ConstraintRows(const Conditions& conditions);

  void mark_fixed(const KernelView<unsigned char*>& fixed) const;

  /// Spatial forces and moments of all vertices, point loads subtracted, as the equations take them; zero in the rows
  /// of constraints. Linear in `rows`.
  void project(const State& state, const KernelView<double*>& rows) const;
  /// Springs and constraints of a state, after project().
  void set(const State& state, double load_factor, const KernelView<double*>& rows) const;
  /// Derivatives of the constraints with respect to the load factor, after project().
  void set_slopes(double load_factor, const KernelView<double*>& rows) const;

  /// From the spatial rows of a state, as project() gets them: the tangent has terms of these forces.
  CarriedForces carried(const State& state, const KernelView<double*>& rows) const;

  /// The derivative of the equations from that of the spatial rows.
  void project(const State& state, const CarriedForces& carried, const MatrixRows& rows) const;

 private:
  int index_of(int vertex) const;

  std::vector<VertexSupport> supports_;
  std::vector<VertexJoint> joints_;
  CarriedForces unloaded_;  ///< the vertices, without forces
};

}  // namespace mixbeam
