#include "nonlinear/linear/linear_solver.hpp"

#include "discretization/mesh/mixed_vector.hpp"
#include "discretization/mesh/vertex_partition.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/linear/network_factors.hpp"

#include <Amesos2.hpp>
#include <Teuchos_CommHelpers.hpp>

#include <mpi.h>

#include <cmath>

namespace mixbeam {

namespace {

using DofMultiVector = Tpetra::MultiVector<double, LocalOrdinal, GlobalOrdinal, TpetraNode>;
using Amesos2Solver = Amesos2::Solver<DofMatrix, DofMultiVector>;

/// Solves by a solver of Amesos2, without checks.
class Amesos2Factors : public LinearSolver {
 public:
  Amesos2Factors(const Teuchos::RCP<DofMatrix>& matrix, const std::string& method, PhaseTimes& times) : times_(times) {
    const auto map = matrix->getRowMap();
    PhaseTimer timer(times, "symbolic factorisation");
    solver_ = Amesos2::create<DofMatrix, DofMultiVector>(method, matrix, Teuchos::rcp(new DofVector(map)),
                                                         Teuchos::rcp(new DofVector(map)));
    solver_->symbolicFactorization();
  }
  void factorize() override {
    PhaseTimer timer(times_, "numeric factorisation");
    solver_->numericFactorization();
  }
  double solve(const DofVector& b, DofVector& x, double /*energy_reduction*/) override {
    solver_->solve(&x, &b);
    return 0.0;
  }

 private:
  PhaseTimes& times_;
  Teuchos::RCP<Amesos2Solver> solver_;
};

/// Rows below which factorising on rank 0 alone is as fast. Time of whole runs on two ranks, relative to factorisation
/// on rank 0: cubic lattices of 10^3 and 15^3 vertices 0.95, 0.7; square ones of 40^2, 60^2, 100^2 0.97, 0.9, 0.87.
constexpr Tpetra::global_size_t kLeastSharedRows = 5000;

/// Rows up to which LAPACK factorises (see InertiaSolver), at a negligible cost beside a tangent.
constexpr size_t kMostCountedRows = 60;

/// Lower bound of the number of independent loops in the graph of vertices; exact if the graph is connected.
double independent_loops(const DofMatrix& matrix) {
  const double vertices = static_cast<double>(matrix.getGlobalNumRows()) / kVertexDofs;
  const double blocks = static_cast<double>(matrix.getGlobalNumEntries()) / (kVertexDofs * kVertexDofs);
  return 0.5 * (blocks - vertices) - vertices + 1.0;
}

class DirectSolver : public LinearSolver {
 public:
  DirectSolver(const Teuchos::RCP<DofMatrix>& matrix, const std::string& method, double tolerance, PhaseTimes& times)
      : matrix_(matrix),
        method_(method),
        tolerance_(tolerance),
        times_(times),
        correction_(Teuchos::rcp(new DofVector(matrix->getDomainMap()))),
        residual_(Teuchos::rcp(new DofVector(matrix->getRangeMap()))) {
    if (method == kAutomatic) method_ = independent_loops(*matrix) < kLeastLoopsOfNetwork ? kKlu : kMumps;
    if (method_ != kMumps && !Amesos2::query(method_))
      throw LinearSolverError("Amesos2 of this Trilinos has no solver \"" + method + "\"");
    const bool is_shared = method_ == kMumps && matrix->getGlobalNumRows() >= kLeastSharedRows;
    if (matrix->getRowMap()->getComm()->getSize() > 1 && !is_shared) root_ = std::make_unique<RootCopy>(matrix);
  }

  void reset_factors() override {
    if (factors_ != nullptr) factors_->reset_factors();
  }

  void adopt_factors_of(Solver& other) override {
    const auto* from = dynamic_cast<const DirectSolver*>(&other);
    if (from == nullptr || from->factors_ == nullptr || from->root_ != nullptr || root_ != nullptr || method_ != kMumps)
      return;
    factors_ = std::make_unique<NetworkFactors>(matrix_, times_);
    factors_->adopt_factors_of(*from->factors_);
  }

  void factorize() override {
    has_failed_ = true;
    if (root_ != nullptr) {
      reset_factors();  // rank 0 must not factorise in solve(): the others would wait for ever if it threw there
      PhaseTimer timer(times_, "gather matrix");
      root_->gather_values();
    }
    std::string problem;
    if (root_ == nullptr || root_->is_root()) problem = factorize_here();
    int failed = problem.empty() ? 0 : 1;
    if (matrix_->getRowMap()->getComm()->getSize() > 1)
      MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, communicator_of(*matrix_));
    if (failed != 0) throw LinearSolverError("factorisation failed: " + (problem.empty() ? "see rank 0" : problem));
    has_failed_ = false;
  }

  double solve(const DofVector& b, DofVector& x, double /*energy_reduction*/) override {
    if (has_failed_) throw LinearSolverError("the matrix has no factors");  // Amesos2 would factorise it again
    solve_once(b, x);
    double error = backward_error(*matrix_, x, b);
    if (!(error <= tolerance_)) {
      refine(b, x);
      error = backward_error(*matrix_, x, b);
    }
    if (!(error <= tolerance_))
      throw LinearSolverError("the linear solver returned a vector that does not solve the equations: backward error " +
                              shortest(error) + ", allowed " + shortest(tolerance_));
    return error;
  }

  std::optional<long> negative_eigenvalues() override {
    long known[2] = {0, 0};  // {whether it is known, count}
    if (root_ == nullptr || root_->is_root())
      if (const std::optional<long> here = negative_here()) known[0] = 1, known[1] = *here;
    if (root_ != nullptr) root_->share(known, 2, MPI_LONG);
    return known[0] == 1 ? std::optional<long>(known[1]) : std::nullopt;
  }

 private:
  /// Counts by MUMPS, or for small matrices by additional factors: those of KLU do not provide the count.
  std::optional<long> negative_here() {
    if (method_ == kMumps) return factors_->negative_eigenvalues();
    const Teuchos::RCP<DofMatrix>& matrix = root_ == nullptr ? matrix_ : root_->matrix();
    if (matrix->getNodeNumRows() > kMostCountedRows) return std::nullopt;
    if (signs_ == nullptr) signs_ = std::make_unique<NetworkFactors>(matrix, times_);
    try {
      signs_->reset_factors();
      signs_->factorize();
      return signs_->negative_eigenvalues();
    } catch (const LinearSolverError&) {  // a singular matrix
      return std::nullopt;
    }
  }

  std::string factorize_here() {
    try {
      if (factors_ == nullptr) {
        const Teuchos::RCP<DofMatrix>& matrix = root_ == nullptr ? matrix_ : root_->matrix();
        if (method_ == kMumps)
          factors_ = std::make_unique<NetworkFactors>(matrix, times_);
        else
          factors_ = std::make_unique<Amesos2Factors>(matrix, method_, times_);
        if (root_ != nullptr) {
          x_ = Teuchos::rcp(new DofVector(matrix->getRowMap()));
          b_ = Teuchos::rcp(new DofVector(matrix->getRowMap()));
        }
      }
      factors_->factorize();
    } catch (const std::exception& error) {
      if (is_out_of_memory(error)) throw;  // another factorisation would need as much
      return error.what();
    }
    return "";
  }

  void solve_once(const DofVector& b, DofVector& x) {
    PhaseTimer timer(times_, "solve");
    if (root_ == nullptr) {
      factors_->solve(b, x);
      return;
    }
    double* rhs = root_->is_root() ? b_->getLocalViewHost(Tpetra::Access::OverwriteAll).data() : nullptr;
    root_->gather(b, rhs);
    const double* solution = nullptr;
    if (root_->is_root()) {
      factors_->solve(*b_, *x_);
      solution = x_->getLocalViewHost(Tpetra::Access::ReadOnly).data();
    }
    root_->scatter(solution, x);
  }

  void refine(const DofVector& b, DofVector& x) {
    matrix_->apply(x, *residual_);
    residual_->update(1.0, b, -1.0);
    solve_once(*residual_, *correction_);
    x.update(1.0, *correction_, 1.0);
  }

  Teuchos::RCP<DofMatrix> matrix_;
  std::string method_;
  double tolerance_;
  bool has_failed_ = false;  ///< whether the last factorisation failed
  PhaseTimes& times_;
  std::unique_ptr<RootCopy> root_;  ///< several ranks only
  std::unique_ptr<LinearSolver> factors_, signs_;
  Teuchos::RCP<DofVector> x_, b_;  ///< of rank 0; several ranks only
  Teuchos::RCP<DofVector> correction_, residual_;
};

}  // namespace

DofVector in_columns(const DofMatrix& matrix, const DofVector& x) {
  const auto importer = matrix.getGraph()->getImporter();
  if (importer.is_null()) return x;
  DofVector all(matrix.getColMap());
  all.doImport(x, *importer, Tpetra::REPLACE);
  return all;
}

double backward_error(const DofMatrix& matrix, const DofVector& x, const DofVector& b) {
  const DofVector columns = in_columns(matrix, x);
  const auto xv = columns.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto bv = b.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto local = matrix.getLocalMatrixHost();
  const KernelView<const double*> xs(xv.data(), xv.extent(0)), bs(bv.data(), bv.extent(0));
  const Teuchos::Comm<int>& comm = *matrix.getRowMap()->getComm();
  const LargestParts sizes = largest_parts(comm, xs);
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::backward_error", Kokkos::RangePolicy<ExecutionSpace>(0, local.numRows()),
      KOKKOS_LAMBDA(int i, double& m) {
        double residual = bs(i), size = bs(i) < 0.0 ? -bs(i) : bs(i);
        for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1); ++k) {
          const int j = local.graph.entries(k);
          const double a = local.values(k);
          residual -= a * xs(j);
          size += (a < 0.0 ? -a : a) * (j % kVertexDofs < 3 ? sizes.moved : sizes.turned);
        }
        raise(m, residual == 0.0 ? 0.0 : residual / size);
      },
      Kokkos::Max<double>(largest));
  return maximum_over_ranks(comm, largest);
}

double form_of_sizes(const DofMatrix& matrix, const DofVector& x) {
  const DofVector ghosted = in_columns(matrix, x);
  const KernelView<const double*> rows = MixedVector::view_of(x), columns = MixedVector::view_of(ghosted);
  const auto local = matrix.getLocalMatrixHost();
  double sum = 0.0, all = 0.0;
  for (int i = 0; i < local.numRows(); ++i)
    for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1); ++k)
      sum += std::abs(rows(i) * local.values(k) * columns(local.graph.entries(k)));
  Teuchos::reduceAll(*matrix.getRowMap()->getComm(), Teuchos::REDUCE_SUM, 1, &sum, &all);
  return all;
}

std::unique_ptr<LinearSolver> make_direct_solver(const Teuchos::RCP<DofMatrix>& matrix, const std::string& method,
                                                 double residual_tolerance, PhaseTimes& times) {
  return std::make_unique<DirectSolver>(matrix, method, residual_tolerance, times);
}

}  // namespace mixbeam
