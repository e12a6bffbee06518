/// Factors of the matrices of networks by MUMPS, on all ranks that share their rows.
#pragma once

#include "discretization/assembly/phase_timer.hpp"
#include "nonlinear/linear/inertia_solver.hpp"
#include "nonlinear/linear/linear_solver.hpp"

namespace mixbeam {

/// Unknowns that have an equation of their own, as those that supports prescribe, are taken out: what remains is
/// symmetric, and factorised as L D L^T, unless supports stand at an angle, joints take part, or loads have no
/// potential; then as L U. The order of elimination and the structure of the factors are kept as long as the same
/// unknowns are taken out. Where a factorisation costs as much as many solves, the factors of an earlier matrix without
/// negative eigenvalues serve conjugate gradients as preconditioner, until they take too many iterations,
/// reset_factors() is called or eigenvalues are asked for.
class NetworkFactors : public LinearSolver {
 public:
  NetworkFactors(const Teuchos::RCP<DofMatrix>& matrix, PhaseTimes& times);

  void factorize() override;
  /// Checks nothing, and returns zero.
  double solve(const DofVector& b, DofVector& x, double enough = 0.0) override;
  /// Where the matrix is symmetric and what is taken out has a positive diagonal.
  std::optional<long> negative_eigenvalues() override;
  void reset_factors() override { serves_next_ = false; }
  /// Where matrices have the same structure: factors of `other` serve as those of an earlier one would.
  void adopt_factors_of(Solver& other) override;
  /// Of the matrix factorised last: unknowns that are not taken out, and whether their matrix is symmetric.
  int unknowns() const { return share_.rows.total(); }
  int factorizations() const { return factors_ == nullptr ? 0 : factors_->factorizations(); }
  bool is_symmetric() const { return kind_ == InertiaSolver::Kind::symmetric; }
  /// Of the last solve by conjugate gradients.
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
  std::vector<unsigned char> alone_;  ///< (row): 1 where it is taken out
  std::vector<int> column_;  ///< (remaining row here, then remaining column of others): its column in the matrix
  SparseMatrix remaining_;
  SharedRows share_;
  std::vector<size_t> entry_;  ///< (entry of remaining_): where it stands in the matrix
  std::vector<int> mirror_;    ///< (entry of remaining_): that of its transpose, -1 where there is none; behind the
                               ///< entries here those of all ranks in rows of one and columns of another one
  std::vector<int> border_;    ///< entries of remaining_ in columns of others
  GatherPlan borders_;
  InertiaSolver::Kind kind_ = InertiaSolver::Kind::symmetric;
  std::shared_ptr<InertiaSolver> factors_;  ///< as preconditioner shared with whoever has taken them over
  std::optional<long> negative_;
  bool serves_next_ = false;  ///< factors_ may be the preconditioner of the next matrix
  bool is_earlier_ = false;   ///< factors_ are those of an earlier matrix
  int left_ = 0;              ///< iterations that are still cheaper than factors of the present matrix
  int iterations_ = 0;
};

}  // namespace mixbeam
