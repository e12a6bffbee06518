/// Solutions with stiffness and inertia about a state, of which no mass is condensed: theory (72).
#pragma once

#include "discretization/assembly/condensed_system.hpp"
#include "discretization/assembly/masses.hpp"
#include "nonlinear/newton/beam_problem.hpp"
#include "nonlinear/stability/independent_unknowns.hpp"

#include <optional>
#include <vector>

namespace mixbeam {

/// (K + shift M)^-1 with K the true stiffness, rigid sections included; all functions are collective, and throw
/// LinearSolverError where equations cannot be solved.
class VibrationOperator {
 public:
  /// A motion, and its independent unknowns where no chain is eliminated (rank 0).
  struct Response {
    MixedVector motion;
    std::vector<double> y{};

    void add(double factor, const Response& other);
  };

  /// `in_plane`: without motions that leave the plane of the model, where it has one. The model must outlive it.
  VibrationOperator(const Model& model, const State& state, double load_factor, bool in_plane);

  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  const Masses& masses() const { return masses_; }
  const IndependentUnknowns& unknowns() const { return unknowns_; }
  const Tangent& tangent() const { return *tangent_; }

  /// Condenses K + shift M of the elements, with the cap raised by a factor.
  void linearize(double shift, double raise, VibrationUse use);
  /// Also reduces and factorises it, without symmetry where loads have no potential. Returns the number of its negative
  /// eigenvalues, -1 where they are uncertain or not real; those inside of elements are left out where they are not
  /// counted.
  long factorize(double shift, double raise, VibrationUse use);

  /// Whether velocities make forces: by damping, or in a frame that turns.
  bool has_forces_of_velocity() const {
    return masses_.is_damped() || norm(model_.frame().at(point_.load_factor)) > 0.0;
  }
  /// Whether the loads have a potential in the last factors.
  bool symmetric() const { return symmetric_; }

  /// What springs, loads and constraints add to K, in place of the elements that linearize() condensed, in the unknowns
  /// of a Response (rank 0).
  SparseMatrix outside();

  /// (K + shift M)^-1 G^T times momenta (Masses::momenta()) with the last factors: what the cap leaves out is solved
  /// for as in theory (38), g = E x with x = x_0 + S g.
  /// `strains`: rows of stresses, Masses::damped_strains() of them; null: zero.
  Response respond(const double* momenta, const double* strains = nullptr);
  /// Replaces columns of momenta by G (K + shift M)^-1 G^T times them: respond() with one pass over the elements, which
  /// are condensed for columns.
  void apply(double* momenta, int columns);
  std::vector<double> momenta_of(const MixedVector& motion) const { return masses_.momenta_of(state_, motion); }

  /// phi . (K - square M) phi of motions of the operator `of`, on the same mesh: their free motions, interiors and
  /// vertices in chains are kept. One process only.
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
  IndependentUnknowns unknowns_;  ///< of the vertices that chains leave
  DofVector remaining_;
  std::optional<Tangent> tangent_;
  std::unique_ptr<InertiaSolver> of_symmetric_, of_general_;  ///< rank 0
  std::vector<double> correction_;                            ///< momenta of the last one
  bool symmetric_ = true;
  bool corrects_slowly_ = false;  ///< the cap, in the last factors
};

}  // namespace mixbeam
