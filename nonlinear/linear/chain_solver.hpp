/// Direct solution in two parts: kernels condense chains of elements to their ends, and a sparse solver solves the
/// remaining system.
#pragma once

#include "discretization/assembly/condensed_system.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <functional>

namespace mixbeam {

/// Solves with the tangents of one model.
class TangentSolver : public Solver {
 public:
  /// Factorises the tangent, which must outlive the solves with it. `first`: a right-hand side to condense in the same
  /// pass, if that is cheaper. Throws LinearSolverError.
  virtual void factorize(const Tangent& tangent, const FirstSolve& first = {}) = 0;
  /// Estimates how much rounding in the rows of the remaining system may change x . K x for a motion x; 0: unknown.
  /// Collective.
  virtual double rounding_of_form(const DofVector&) const { return 0.0; }
  /// Its storage for chains, which others may use until the next factorize(); null: it has none.
  virtual CondensedSystem* chains() { return nullptr; }
  /// Its storage if that holds the symmetric chains of the tangent, with reliable pivots; else null.
  virtual CondensedSystem* condensed_chains() { return nullptr; }
};

/// Makes the solver of the remaining system.
using RemainingSolver = std::function<std::unique_ptr<LinearSolver>(const CondensedSystem& system)>;

/// Condenses chains and solves the remaining system. Falls back to factorising the whole tangent if a chain pivot is
/// too small, the reduced matrix looks singular or a solution fails its check, unless the tangent is too large for
/// factors. `method`: an Amesos2 name for both.
class ChainSolver : public TangentSolver {
 public:
  /// `solver`: replaces the direct solver that belongs to `method`.
  ChainSolver(const Model& model, const std::string& method, double residual_tolerance,
              const RemainingSolver& solver = {});

  void factorize(const Tangent& tangent, const FirstSolve& first = {}) override;
  double solve(const DofVector& b, DofVector& x, double energy_reduction = 0.0) override;
  bool iterates() const override { return remaining_->iterates(); }
  bool tries_iteration() const override { return remaining_->tries_iteration(); }
  void allow_iteration(bool allowed) override { remaining_->allow_iteration(allowed); }
  bool counts_by_solves() const override { return !uses_whole_ && remaining_->counts_by_solves(); }
  void reset_factors() override { remaining_->reset_factors(); }
  void adopt_factors_of(Solver& other) override {
    if (auto* chains = dynamic_cast<ChainSolver*>(&other)) remaining_->adopt_factors_of(*chains->remaining_);
  }
  std::optional<long> negative_eigenvalues() override;
  double rounding_of_form(const DofVector& x) const override;

  /// Number of tangents that had to be factorised as a whole.
  int fallback_factorizations() const { return fallback_factorizations_; }
  const CondensedSystem& system() const { return system_; }
  CondensedSystem* chains() override { return &system_; }
  CondensedSystem* condensed_chains() override { return uses_whole_ || system_.is_unsymmetric() ? nullptr : &system_; }

 private:
  double solve_condensed(const DofVector& b, DofVector& x, double energy_reduction);
  void solve_once(const DofVector& b, DofVector& x, double energy_reduction, double& remaining_error);
  void factorize_whole();

  const Model& model_;
  const Tangent* tangent_ = nullptr;
  std::string method_;
  double tolerance_;
  CondensedSystem system_;
  std::unique_ptr<LinearSolver> remaining_;
  std::unique_ptr<TangentSolver> whole_;
  bool uses_whole_ = false;
  int fallback_factorizations_ = 0;
  Teuchos::RCP<DofVector> diagonal_, remaining_b_, remaining_x_;
};

/// The solver for the tangents of a model: "chains", or an Amesos2 name for the whole matrix.
std::unique_ptr<TangentSolver> make_direct_tangent_solver(const Model& model, const std::string& method,
                                                          double residual_tolerance);

/// Name of the method that condenses chains, and the solver of the remaining system.
inline constexpr const char* kChains = "chains";
inline constexpr const char* kSparseSolver = kAutomatic;
/// Name of the method that iterates: see multilevel/network_solver.hpp.
inline constexpr const char* kIterative = "iterative";
/// Solver of a whole matrix for a method of tangents, for make_direct_solver(). (A whole tangent needs a solver by
/// name: kAutomatic means chains there.)
inline std::string sparse_solver_of(const std::string& method) {
  return method == kChains || method == kIterative ? kSparseSolver : method;
}

}  // namespace mixbeam
