#include "nonlinear/linear/chain_solver.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Response (see below) above which the remaining matrix is singular up to rounding. Condensation leaves rounding
/// errors where a mechanism has a zero, which no sparse solver can detect. The condition of the remaining system of
/// real structures is far below (capped force stiffness 1e5 or 1e7, ratios of sections), that of rounding errors 1e11
/// and more.
constexpr double kResponseOfRounding = 1e10;

/// Computes max |x_i| sqrt(|A_ii|) / max(|b_i| / sqrt(|A_ii|)), a lower bound of the condition of the matrix scaled to
/// a unit diagonal. Collective.
double response(const DofVector& diagonal, const DofVector& b, const DofVector& x) {
  const KernelView<const double*> a = MixedVector::view_of(diagonal), rhs = MixedVector::view_of(b),
                                  solution = MixedVector::view_of(x);
  double most[2] = {0.0, 0.0};
  for (size_t i = 0; i < a.extent(0); ++i) {
    const double root = std::sqrt(std::abs(a(i)));
    most[0] = std::max(most[0], std::abs(solution(i)) * root);
    if (root > 0.0) most[1] = std::max(most[1], std::abs(rhs(i)) / root);
  }
  const Teuchos::Comm<int>& comm = *diagonal.getMap()->getComm();
  const double largest = maximum_over_ranks(comm, most[0]);
  return largest == 0.0 ? 0.0 : largest / maximum_over_ranks(comm, most[1]);
}

/// Solves with the matrix over all vertices, gathered anew for every factorisation.
class WholeSolver : public TangentSolver {
 public:
  WholeSolver(const Model& model, const std::string& method, double tolerance)
      : matrix_(whole_matrix(model)), solver_(make_direct_solver(matrix_.matrix(), method, tolerance, model.times())) {}
  void factorize(const Tangent& tangent, const FirstSolve& /*first*/ = {}) override {
    tangent.gather(matrix_);
    solver_->factorize();
  }
  double solve(const DofVector& b, DofVector& x, double energy_reduction) override {
    return solver_->solve(b, x, energy_reduction);
  }
  std::optional<long> negative_eigenvalues() override { return solver_->negative_eigenvalues(); }

 private:
  VertexMatrix matrix_;
  std::unique_ptr<LinearSolver> solver_;
};

}  // namespace

ChainSolver::ChainSolver(const Model& model, const std::string& method, double residual_tolerance,
                         const RemainingSolver& solver)
    : model_(model),
      method_(method),
      tolerance_(residual_tolerance),
      system_(model),
      remaining_(solver ? solver(system_)
                        : make_direct_solver(system_.matrix(), method, residual_tolerance, model.times())),
      diagonal_(Teuchos::rcp(new DofVector(system_.matrix()->getRowMap()))),
      remaining_b_(Teuchos::rcp(new DofVector(system_.matrix()->getRangeMap()))),
      remaining_x_(Teuchos::rcp(new DofVector(system_.matrix()->getDomainMap()))) {}

void ChainSolver::factorize_whole() {
  if (iterates())
    throw LinearSolverError("a chain or a junction has no stiffness, and the tangent is too large for factors");
  if (whole_ == nullptr) whole_ = std::make_unique<WholeSolver>(model_, method_, tolerance_);
  uses_whole_ = true;
  ++fallback_factorizations_;
  whole_->factorize(*tangent_);
}

void ChainSolver::factorize(const Tangent& tangent, const FirstSolve& first) {
  tangent_ = &tangent;
  uses_whole_ = false;
  const double unreliable = system_.condense(tangent, false, {}, first) ? 0.0 : 1.0;
  if (maximum_over_ranks(*model_.map()->getComm(), unreliable) != 0.0) return factorize_whole();
  system_.matrix()->getLocalDiagCopy(*diagonal_);
  try {
    remaining_->factorize();
  } catch (const LinearSolverError&) {
    if (iterates()) throw;
    factorize_whole();
  }
}

void ChainSolver::solve_once(const DofVector& b, DofVector& x, double energy_reduction, double& remaining_error) {
  system_.condense_rows(b, *remaining_b_, x);
  try {
    remaining_error = remaining_->solve(*remaining_b_, *remaining_x_, energy_reduction);
  } catch (const LinearSolverError&) {  // the whole matrix may be solvable nevertheless
    if (iterates()) throw;
    remaining_error = std::numeric_limits<double>::infinity();
  }
  if (!(response(*diagonal_, *remaining_b_, *remaining_x_) <= kResponseOfRounding))
    remaining_error = std::numeric_limits<double>::infinity();
  system_.expand(*remaining_x_, x);
}

/// Backward error after at most one refinement in the chains.
double ChainSolver::solve_condensed(const DofVector& b, DofVector& x, double energy_reduction) {
  double remaining_error = 0.0, ignored = 0.0;
  solve_once(b, x, energy_reduction, remaining_error);
  double error = system_.chain_error(b, x);
  if (remaining_error <= std::max(tolerance_, energy_reduction) && !(error <= tolerance_)) {
    DofVector residual(model_.map()), correction(model_.map());  // rarely needed
    system_.chain_residual(b, x, residual);
    solve_once(residual, correction, energy_reduction, ignored);
    x.update(1.0, correction, 1.0);
    system_.condense_rows(b, *remaining_b_, correction);  // makes the condensed rows at the ends those of b again
    error = system_.chain_error(b, x);
  }
  return std::max(error, remaining_error);
}

double ChainSolver::solve(const DofVector& b, DofVector& x, double energy_reduction) {
  if (!uses_whole_) {
    const double error = solve_condensed(b, x, energy_reduction);
    if (error <= std::max(tolerance_, energy_reduction)) return error;
    factorize_whole();
  }
  return whole_->solve(b, x);
}

std::optional<long> ChainSolver::negative_eigenvalues() {
  if (uses_whole_ || system_.is_unsymmetric()) return {};
  const std::optional<long> remaining = remaining_->negative_eigenvalues();
  if (!remaining) return {};
  long of_chains = 0;
  const long here = system_.negative_pivots();
  Teuchos::reduceAll(*model_.map()->getComm(), Teuchos::REDUCE_SUM, 1, &here, &of_chains);
  return *remaining + of_chains;
}

double ChainSolver::rounding_of_form(const DofVector& x) const {
  system_.remaining_values(x, *remaining_x_);
  return std::numeric_limits<double>::epsilon() * form_of_sizes(*system_.matrix(), *remaining_x_);
}

std::unique_ptr<TangentSolver> make_direct_tangent_solver(const Model& model, const std::string& method,
                                                          double residual_tolerance) {
  if (method == kChains || method == kAutomatic || method == kIterative)
    return std::make_unique<ChainSolver>(model, kSparseSolver, residual_tolerance);
  return std::make_unique<WholeSolver>(model, method, residual_tolerance);
}

}  // namespace mixbeam
