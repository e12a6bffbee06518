/// Solutions with the transposed tangent of a state, rigid sections included: the change of a quantity of the state if
/// an equation is perturbed, theory (80).
#pragma once

#include "discretization/assembly/condensed_system.hpp"
#include "discretization/quantities/quantity_derivative.hpp"
#include "kernels/vibration/vibration.hpp"
#include "nonlinear/newton/beam_problem.hpp"
#include "nonlinear/stability/independent_unknowns.hpp"

#include <optional>
#include <vector>

namespace mixbeam {

/// The adjoint of one quantity: t of theory (80), with dq/dp = q_p + t . R_p for rows R that are gradients of the
/// functional (those of N weighted).
struct Adjoint {
  MixedVector field;           ///< motions of vertices and increments of interiors
  std::vector<double> free{};  ///< its independent unknowns, see IndependentUnknowns
  std::vector<double> held{};  ///< (6 * vertex + component): q_x + R_x^T t, spatial; zero for vertices without support

  void add(double factor, const Adjoint& other) {
    field.update(factor, other.field, 1.0);
    for (size_t i = 0; i < free.size(); ++i) free[i] += factor * other.free[i];
    for (size_t i = 0; i < held.size(); ++i) held[i] += factor * other.held[i];
  }
};

/// Returns (number of N of an element): weight of its Gauss point times h / 2, if it is integrated there.
std::vector<double> weights_of(const ElementView& element);
/// Multiplies rows of N, which are strains, by the weights of their points, theory (16), or divides them; rows of
/// components without a point there become zero.
void weigh_force_rows(const Structure& structure, bool divides, MixedVector& rows);

/// Solves adjoint equations. One process only. Throws LinearSolverError if equations cannot be solved.
class AdjointOperator {
 public:
  /// The problem must outlive it. `transposed` false: solves with the tangent itself, which differs for follower loads.
  AdjointOperator(BeamProblem& problem, const State& state, double load_factor, bool transposed = true);

  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  double load_factor() const { return point_.load_factor; }
  bool is_symmetric() const;

  /// Solves for the adjoint. `projected`: additional part of the quantity in projected rows, for vertices whose free
  /// motions rotate with the state. `imposed`: motions of supports that replace the quantity's part in held rows.
  Adjoint solve(const StateDerivative& quantity, const DofVector* projected = nullptr,
                const DofVector* imposed = nullptr);
  /// Computes free . Z^T rows, for projected rows of supports and joints (6 * vertex + component).
  double work_of_free(const Adjoint& adjoint, const DofVector& projected);
  /// Motion whose work with the rows of the equations is the part of a quantity due to held rows.
  DofVector held_motion(const StateDerivative& quantity) const;

 private:
  using Entries = std::vector<double>;  ///< of the remaining matrix

  bool is_planar_for(const MixedVector& rows, const DofVector& held) const;
  void linearize(bool in_space);
  template <class Action>
  void for_each_part(bool condenses, const Action& action) const;
  DofVector& condense(const MixedVector& rows);
  void recover(const MixedVector& rows, MixedVector& motion) const;
  Adjoint respond(const MixedVector& rows, const DofVector* held = nullptr, const DofVector* projected = nullptr);
  void take_out_cap(Adjoint& adjoint);
  void excess_rows(const MixedVector& motion, MixedVector& rows) const;
  void add_at_vertices(const KernelView<double*>& vertex) const;
  void add_product(const Entries& matrix, const DofVector& motion, const KernelView<double*>& rows) const;
  void add_turning(const DofVector& held, const KernelView<double*>& rows) const;
  std::vector<double> held_rows(const MixedVector& rows, const Adjoint& adjoint) const;

  const Model& model_;
  State state_;
  bool transposed_;
  MixedVector residual_;
  EvaluationPoint point_;
  std::optional<Tangent> tangent_{};
  KernelView<double* [12]> vertex_rows_;   ///< (local element)
  std::shared_ptr<TangentSolver> lender_;  ///< solver whose memory for chains is used
  std::optional<CondensedSystem> own_{};
  CondensedSystem& system_;
  IndependentUnknowns unknowns_;
  DofVector remaining_;
  std::unique_ptr<InertiaSolver> solver_;
  Entries whole_, outside_;  ///< spatial rows: of the whole tangent, and without elements
};

}  // namespace mixbeam
