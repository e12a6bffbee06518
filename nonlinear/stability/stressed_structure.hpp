/// The undeformed structure with the stresses of its linear response to the loads: what linear buckling is computed of.
#pragma once

#include "nonlinear/newton/step.hpp"
#include "nonlinear/stability/eigen_mode.hpp"

#include <memory>
#include <vector>

namespace mixbeam {

/// A matrix whose entries are this symmetric, see Stability, is treated so.
inline constexpr double kNearlySymmetric = 1e-9;

/// All functions are collective. Throws LinearSolverError when the unloaded structure is not stable.
class StressedStructure {
 public:
  explicit StressedStructure(BeamProblem& problem);
  StressedStructure(const StressedStructure&) = delete;
  StressedStructure& operator=(const StressedStructure&) = delete;

 protected:
  /// All tangents have the cap of the reference state: else their differences would be those of their caps.
  Tangent tangent_at(const State& state, double load_factor) {
    return Tangent(model_, point_at(state, load_factor), cap_, {true, true});
  }
  EvaluationPoint point_at(const State& state, double load_factor) {
    EvaluationPoint point = mixed_residual(model_, state, load_factor, work_);
    point.scales = scales_;
    return point;
  }
  std::vector<double> stiffness_at(const State& state, double load_factor) {
    return unknowns_.reduce(tangent_at(state, load_factor)).value;
  }
  /// The undeformed structure with the stresses of a load factor.
  State state_at(double load_factor) { return model_.apply(reference_, response_, load_factor); }

  double largest_stress() const;
  std::vector<double> geometric_stiffness(double t);
  Tangent tangent_under_stress(double load_factor);
  InertiaSolver::Signs factorize_under_stress();

  BeamProblem& problem_;
  const Model& model_;
  IndependentUnknowns unknowns_;
  State reference_;
  ResidualScales scales_;
  Cap cap_;
  MixedVector response_, work_;
  bool symmetric_ = true;  ///< rank 0
  std::vector<double> stiffness_, by_loads_;
  SparseMatrix matrix_, under_stress_;
  std::unique_ptr<InertiaSolver> solver_, moving_solver_;

 private:
  void factorize();
  void keep_stresses();
  void find_response();
};

}  // namespace mixbeam
