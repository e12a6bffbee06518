/// Factors of network matrices by MUMPS, on all ranks that share their rows.
#pragma once

#include "discretization/assembly/phase_timer.hpp"
#include "nonlinear/linear/inertia_solver.hpp"
#include "nonlinear/linear/linear_solver.hpp"

namespace mixbeam {

/// Eliminates prescribed unknowns first. The remaining matrix is symmetric, and factorised as L D L^T, unless supports
/// stand at an angle, joints take part, or loads have no potential; then as L U. The order of elimination and the
/// structure of the factors are kept as long as the same unknowns are eliminated first. If a factorisation costs many
/// solves, old factors without negative eigenvalues precondition conjugate gradients on the new matrix, until these
/// take too many iterations, reset_factors() is called or eigenvalues are asked for.
class NetworkFactors : public LinearSolver {
 public:
  NetworkFactors(const Teuchos::RCP<DofMatrix>& matrix, PhaseTimes& times);

  void factorize() override;
  /// Solves without a check and returns zero.
  double solve(const DofVector& b, DofVector& x, double energy_reduction = 0.0) override;
  /// Known if the matrix is symmetric and the unknowns eliminated first have a positive diagonal.
  std::optional<long> negative_eigenvalues() override;
  void reset_factors() override { reusable_ = false; }
  /// Adopts the factors of a matrix of the same structure like those of an earlier matrix.
  void adopt_factors_of(Solver& other) override;
  /// Number of unknowns that were not eliminated first, in the last matrix; see is_symmetric() for theirs.
  int unknowns() const { return share_.rows.total(); }
  int factorizations() const { return factors_ == nullptr ? 0 : factors_->factorizations(); }
  bool is_symmetric() const { return kind_ == InertiaSolver::Kind::symmetric; }
  /// Number of iterations of the last solve by conjugate gradients.
  int iterations() const { return iterations_; }

 private:
  struct Iteration;
  void factorize_now();
  bool iterate(std::vector<double>& b);
  std::vector<unsigned char> rows_alone() const;
  void take_out(std::vector<unsigned char> alone);
  void number_columns();
  void find_mirrors();
  void find_mirrors_of_others();
  void complete(std::vector<double>& values) const;
  bool on_all_ranks(bool here) const;
  bool has_symmetry() const;
  bool diagonal_is_positive() const;

  Teuchos::RCP<DofMatrix> matrix_;
  PhaseTimes& times_;
  std::vector<unsigned char> alone_;  ///< (row): 1 if it is eliminated first
  std::vector<int> column_;  ///< (remaining row here, then remaining column of other ranks): its column in the matrix
  SparseMatrix remaining_;
  RowsOfRanks share_;
  std::vector<size_t> entry_;  ///< (entry of remaining_): its position in the matrix
  std::vector<int> mirror_;    ///< (entry of remaining_): number of its transpose, -1 if there is none; numbers after
                               ///< the entries here are those of the border entries of all ranks, see borders_
  std::vector<int> border_;    ///< entries of remaining_ in columns owned by other ranks
  GatherPlan borders_;
  InertiaSolver::Kind kind_ = InertiaSolver::Kind::symmetric;
  std::shared_ptr<InertiaSolver> factors_;  ///< as preconditioner shared with solvers that have adopted them
  std::optional<long> negative_;
  bool reusable_ = false;     ///< factors_ may precondition the next matrix
  bool is_earlier_ = false;   ///< factors_ belong to an earlier matrix
  int iteration_budget_ = 0;  ///< number of iterations that are still cheaper than factors of the present matrix
  int iterations_ = 0;
};

}  // namespace mixbeam
