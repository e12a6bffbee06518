/// Solutions with stiffness and inertia about a state, with no mass condensed: theory (72).
#pragma once

#include "discretization/assembly/condensed_system.hpp"
#include "discretization/assembly/masses.hpp"
#include "nonlinear/newton/beam_problem.hpp"
#include "nonlinear/stability/independent_unknowns.hpp"

#include <optional>
#include <vector>

namespace mixbeam {

/// Applies (K + shift M)^-1 with K the true stiffness, rigid sections included. All functions are collective, and throw
/// LinearSolverError if equations cannot be solved.
class VibrationOperator {
 public:
  /// A motion, and its independent unknowns of remaining vertices (rank 0).
  struct Response {
    MixedVector motion;
    std::vector<double> y{};

    void add(double factor, const Response& other);
  };

  /// `in_plane`: without out-of-plane motions, for a planar model. The model must outlive the operator.
  VibrationOperator(const Model& model, const State& state, double load_factor, bool in_plane);

  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  const Masses& masses() const { return masses_; }
  const IndependentUnknowns& unknowns() const { return unknowns_; }
  const Tangent& tangent() const { return *tangent_; }

  /// Condenses K + shift M of the elements, with the cap multiplied by `raise`.
  void linearize(double shift, double raise, VibrationUse use);
  /// Also reduces and factorises it, unsymmetrically if loads have no potential. Returns the number of its negative
  /// eigenvalues, -1 if uncertain or unsymmetric; those inside elements are included for VibrationUse::counted alone.
  long factorize(double shift, double raise, VibrationUse use);

  /// Whether velocities cause forces: by damping, or in a rotating frame.
  bool has_forces_of_velocity() const {
    return masses_.is_damped() || norm(model_.frame().at(point_.load_factor)) > 0.0;
  }
  /// Whether the loads have a potential in the last factors.
  bool symmetric() const { return symmetric_; }

  /// Contribution of springs, loads and constraints to K, without the elements, in the unknowns of a Response (rank 0).
  /// Overwrites what linearize() condensed.
  SparseMatrix outside();

  /// Computes (K + shift M)^-1 G^T times momenta (Masses::momenta()) with the last factors, corrected for the cap as in
  /// theory (38), g = E x with x = x_0 + S g.
  /// `strains`: rows of stresses, Masses::damped_strains() of them; null: zero.
  Response respond(const double* momenta, const double* strains = nullptr);
  /// Replaces columns of momenta by G (K + shift M)^-1 G^T times them, like respond() but with one pass over the
  /// elements, which are condensed for all columns.
  void apply(double* momenta, int columns);
  std::vector<double> momenta_of(const MixedVector& motion) const { return masses_.momenta_of(state_, motion); }

  /// Computes phi . (K - square M) phi for motions of the operator `of`, on the same mesh, with their free motions,
  /// interiors and vertices in chains. One process only.
  std::vector<double> forms(const VibrationOperator& of, const std::vector<Response>& motions, double square);

 private:
  Response solve(MixedVector& rows);
  Response solve_interior(const MixedVector& rows);
  void solve(MomentumColumns& of);
  bool correct(MomentumColumns& of);
  std::vector<double> condense(MixedVector& rows, DofVector& motion);
  void expand(const double* y, DofVector& motion);
  void correct_by_gmres(MixedVector excess, double norm, double reduction, Response& found);
  void solve_reduced(std::vector<double>& y, int columns);
  double cap_left() const;

  const Model& model_;
  State state_;
  MixedVector residual_;
  EvaluationPoint point_;
  Masses masses_;
  CondensedSystem system_;
  IndependentUnknowns unknowns_;  ///< of the remaining vertices
  DofVector remaining_;
  std::optional<Tangent> tangent_;
  std::unique_ptr<InertiaSolver> of_symmetric_, of_general_;  ///< rank 0
  std::vector<double> correction_;                            ///< momenta of the last correction
  bool symmetric_ = true;
  bool corrects_slowly_ = false;  ///< corrections for the cap converge slowly with the last factors
};

}  // namespace mixbeam
