/// A structure in equilibrium, undeformed or under the loads of its first stages, with the stresses of its linear
/// response to the loads that follow: what linear buckling is computed of.
#pragma once

#include "nonlinear/newton/step.hpp"
#include "nonlinear/stability/eigen_mode.hpp"

#include <memory>
#include <vector>

namespace mixbeam {

/// Load factors count from that of the state on. All functions are collective. Throws LinearSolverError when the
/// structure is not stable there.
class StressedStructure {
 public:
  /// `state`: in equilibrium at `load_factor`, where the loads that follow begin to act.
  StressedStructure(BeamProblem& problem, const State& state, double load_factor);
  StressedStructure(const StressedStructure&) = delete;
  StressedStructure& operator=(const StressedStructure&) = delete;

 protected:
  /// All tangents have the cap of the reference state: else their differences would be those of their caps.
  Tangent tangent_at(const State& state, double load_factor = 0.0) {
    return Tangent(model_, point_at(state, load_factor), cap_, {true, true});
  }
  EvaluationPoint point_at(const State& state, double load_factor) {
    EvaluationPoint point = mixed_residual(model_, state, base_ + load_factor, work_);
    point.scales = scales_;
    return point;
  }
  std::vector<double> stiffness_at(const State& state, double load_factor = 0.0) {
    return symmetric_part(unknowns_.reduce(tangent_at(state, load_factor)));
  }
  /// The state with the stresses of a load factor.
  State state_at(double load_factor) { return model_.apply(reference_, response_, load_factor); }

  double largest_stress() const;
  std::vector<double> geometric_stiffness(double t);
  Tangent tangent_under_stress(double load_factor);
  InertiaSolver::Signs factorize_under_stress();

  BeamProblem& problem_;
  const Model& model_;
  IndependentUnknowns unknowns_;
  State reference_;
  double base_;  ///< its load factor
  ResidualScales scales_;
  Cap cap_;
  MixedVector response_, work_;
  bool symmetric_ = true;  ///< rank 0
  std::vector<double> stiffness_, by_loads_;
  SparseMatrix matrix_, under_stress_;
  std::unique_ptr<InertiaSolver> solver_, moving_solver_;

 private:
  std::vector<double> symmetric_part(const SparseMatrix& matrix) const;
  void factorize();
  void keep_stresses();
  void find_response();
};

}  // namespace mixbeam
