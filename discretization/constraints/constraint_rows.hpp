/// All supports and joints of one rank as equations in place of rows of the assembled system: see support_rows.hpp and
/// joint_rows.hpp. Loops over supports and joints only; without any of them there is nothing to do.
#pragma once

#include "discretization/constraints/joint_rows.hpp"
#include "discretization/constraints/support_rows.hpp"

#include <vector>

namespace mixbeam {

class ConstraintRows {
 public:
  ConstraintRows() = default;
  explicit ConstraintRows(const Conditions& conditions);

  void mark_fixed(const KernelView<unsigned char*>& fixed) const;

  /// Spatial forces and moments of all vertices, point loads subtracted, as the equations take them; zero in the rows
  /// of constraints. Linear in `rows`.
  void turn(const State& state, const KernelView<double*>& rows) const;
  /// Springs and constraints of a state, after turn().
  void set(const State& state, double load_factor, const KernelView<double*>& rows) const;
  /// Derivatives of the constraints with respect to the load factor, after turn().
  void set_slopes(double load_factor, const KernelView<double*>& rows) const;

  /// Keeps the spatial rows of a state (as turn() gets them) for the tangent, whose rows turn with them.
  void remember(const State& state, double load_factor, const KernelView<double*>& rows);
  bool remembers(const State& state, double load_factor) const;
  /// What is remembered now belongs to the tangent, whatever is remembered later.
  void keep_for_tangent() { of_tangent_ = watched_; }

  /// The derivative of the equations from that of the spatial rows, at the state of keep_for_tangent().
  void turn(const State& state, const MatrixRows& rows) const;

 private:
  /// A vertex whose forces and moments are balanced by more than loads.
  struct Watched {
    int vertex = 0;
    Vec force{}, moment{};
    Vec joined_moment{};  ///< with the slaves at the vertex
  };
  int watched_index(int vertex) const;

  std::vector<VertexSupport> supports_;
  std::vector<VertexJoint> joints_;
  std::vector<Watched> watched_;  ///< ascending
  std::vector<Watched> of_tangent_;
  State remembered_;
  double remembered_load_factor_ = 0.0;
};

}  // namespace mixbeam
