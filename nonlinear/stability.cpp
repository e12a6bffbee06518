#include "nonlinear/stability.hpp"

#include "discretization/added_compliance.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace mixbeam {

namespace {

/// Rounding leaves 1e-13 in refined meshes, an unfinished Newton iteration 1e-11; asymmetry this small changes
/// eigenvalues by its square.
constexpr double kSymmetric = 1e-9;
/// A Ritz value is real when its imaginary part is rounding.
constexpr double kReal = 1e-8;
/// Eigenvalues asked for when negative ones of an unsymmetric tangent are counted: at first, and at most.
constexpr int kFirstCount = 4, kLastCount = 8;
/// Where a pivot is zero the inverse is taken beside it; eigenvalues of structures are far larger.
constexpr double kShift = 1e-7;
bool is_real(const RitzPair& pair) { return std::abs(pair.imaginary) <= kReal * std::abs(pair.value); }

SparseMatrix shifted(SparseMatrix matrix, double shift) {
  for (int i = 0; i < matrix.rows(); ++i)
    for (int k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k)
      if (matrix.column[k] == i) matrix.value[k] += shift;
  return matrix;
}

/// (A + A^T) / 2, for matrices whose structure is symmetric.
SparseMatrix symmetric_part(const SparseMatrix& a) {
  SparseMatrix result = a;
  for (int i = 0; i < a.rows(); ++i)
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
      const int j = a.column[k];
      for (int other = a.row_start[j]; other < a.row_start[j + 1]; ++other)
        if (a.column[other] == i) result.value[k] = 0.5 * (a.value[k] + a.value[other]);
    }
  return result;
}

}  // namespace

Stability::Stability(BeamProblem& problem) : problem_(problem) {}

void Stability::evaluate_tangent(const State& state, double load_factor) {
  Assembler& assembler = problem_.assembler;
  MixedVector residual = assembler.create_vector();
  assembler.residual(state, load_factor, residual);
  assembler.tangent(state, load_factor);
}

/// The tangent of evaluate_tangent(), all of it.
void Stability::assemble(const State& state, double load_factor) {
  evaluate_tangent(state, load_factor);
  if (unknowns_ == nullptr) unknowns_ = std::make_unique<IndependentUnknowns>(problem_.assembler);
  unknowns_->reduce(problem_.assembler, state);
}

/// None where the signs of pivots cannot be relied on, next to a critical point, and where they are not enough: without
/// symmetry, unless the symmetric part is positive (is_positive_in_its_symmetric_part).
std::optional<StabilityResult> Stability::inertia_with_chains(const State& state) {
  if (chains_ == nullptr) {
    chains_ = std::make_unique<CondensedSystem>(problem_.assembler);
    unknowns_beside_chains_ = std::make_unique<IndependentUnknowns>(problem_.assembler, chains_->remaining());
  }
  const bool reliable = chains_->condense();
  const SparseMatrix& matrix = unknowns_beside_chains_->reduce(problem_.assembler, state);
  const RootCopy& root = unknowns_beside_chains_->root();
  StabilityResult result;
  on_root(root, [&] {
    result.asymmetry = asymmetry(matrix);
    result.symmetric = result.asymmetry <= kSymmetric;
    if (matrix.rows() == 0) return;
    // Chains are symmetric, so what they leave of the symmetric part is the symmetric part of what they leave.
    const SparseMatrix part = result.symmetric ? matrix : symmetric_part(matrix);
    if (symmetric_beside_chains_ == nullptr)
      symmetric_beside_chains_ = std::make_unique<InertiaSolver>(InertiaSolver::Kind::symmetric, part);
    const InertiaSolver::Signs signs = symmetric_beside_chains_->factorize(part);
    result.null = signs.null;
    result.negative = signs.negative;
  });
  double on_all[4] = {static_cast<double>(result.negative), static_cast<double>(result.null),
                      result.symmetric ? 1.0 : 0.0, result.asymmetry};
  MPI_Bcast(on_all, 4, MPI_DOUBLE, 0, root.communicator());
  double of_chains[2] = {static_cast<double>(chains_->negative_pivots()), reliable ? 0.0 : 1.0};
  MPI_Allreduce(MPI_IN_PLACE, of_chains, 2, MPI_DOUBLE, MPI_SUM, root.communicator());
  const int negative = static_cast<int>(on_all[0] + of_chains[0]);
  const bool symmetric = on_all[2] == 1.0;
  if (of_chains[1] > 0.0 || on_all[1] > 0.0 || (!symmetric && negative > 0)) return std::nullopt;
  return StabilityResult{negative, 0, symmetric, on_all[3]};
}

/// No real eigenvalue lies below the smallest one of the symmetric part (Bendixson), and that is quickly looked at.
bool Stability::is_positive_in_its_symmetric_part() {
  const SparseMatrix part = symmetric_part(unknowns_->matrix());
  if (symmetric_ == nullptr) symmetric_ = std::make_unique<InertiaSolver>(InertiaSolver::Kind::symmetric, part);
  const InertiaSolver::Signs signs = symmetric_->factorize(part);
  return signs.negative == 0 && signs.null == 0;
}

StabilityResult Stability::inertia(bool keeps_factors) {
  StabilityResult result;
  on_root(unknowns_->root(), [&] {
    result.asymmetry = asymmetry(unknowns_->matrix());
    result.symmetric = result.asymmetry <= kSymmetric;
    if (!result.symmetric && !keeps_factors && is_positive_in_its_symmetric_part()) return;
    const auto kind = result.symmetric ? InertiaSolver::Kind::symmetric : InertiaSolver::Kind::general;
    std::unique_ptr<InertiaSolver>& solver = result.symmetric ? symmetric_ : general_;
    if (solver == nullptr) solver = std::make_unique<InertiaSolver>(kind, unknowns_->matrix());
    const InertiaSolver::Signs signs = solver->factorize(unknowns_->matrix());
    result.null = signs.null;
    result.negative = signs.negative;
    if (signs.null > 0) solver->factorize(shifted(unknowns_->matrix(), kShift));
    if (!result.symmetric) result.negative = signs.determinant_sign < 0 ? 1 : 0;
    if (!result.symmetric) count_real_negative(result);
  });
  double numbers[4] = {static_cast<double>(result.negative), static_cast<double>(result.null),
                       result.symmetric ? 1.0 : 0.0, result.asymmetry};
  MPI_Bcast(numbers, 4, MPI_DOUBLE, 0, unknowns_->root().communicator());
  return {static_cast<int>(numbers[0]), static_cast<int>(numbers[1]), numbers[2] == 1.0, numbers[3]};
}

/// On entry `negative` is the parity. The eigenvalues nearest to zero are looked through, more of them while their
/// signs contradict the determinant or the last of them is still negative.
void Stability::count_real_negative(StabilityResult& result) {
  const int parity = result.negative;
  KrylovProblem problem;
  problem.unknowns = unknowns_->count();
  problem.symmetric = false;
  problem.apply = [&](double* block, int columns) { general_->solve(block, columns); };
  for (int wanted = kFirstCount;; wanted *= 2) {
    const std::vector<RitzPair> pairs = largest_eigenpairs(problem, wanted);
    const auto negative = [](const RitzPair& p) { return is_real(p) && p.value < 0.0; };
    result.negative = static_cast<int>(std::count_if(pairs.begin(), pairs.end(), negative));
    const bool agrees = result.negative % 2 == parity || result.null > 0;
    if (agrees && !(negative(pairs.back()) && static_cast<int>(pairs.size()) < problem.unknowns)) return;
    if (wanted >= std::min(kLastCount, problem.unknowns)) {
      if (!agrees) ++result.negative;  // one that is far from zero
      return;
    }
  }
}

StabilityResult Stability::count(const State& state, double load_factor) {
  evaluate_tangent(state, load_factor);
  if (const auto result = inertia_with_chains(state)) return *result;
  assemble(state, load_factor);
  return inertia(false);
}

/// Uses the factors that inertia() left.
Stability::Reduced Stability::nearest(const StabilityResult& stability, int count) {
  Reduced reduced;
  on_root(unknowns_->root(), [&] {
    InertiaSolver& solver = stability.symmetric ? *symmetric_ : *general_;
    const double shift = stability.null > 0 ? kShift : 0.0;
    KrylovProblem problem;
    problem.unknowns = unknowns_->count();
    problem.symmetric = stability.symmetric;
    problem.apply = [&](double* block, int columns) { solver.solve(block, columns); };
    std::vector<RitzPair> right = largest_eigenpairs(problem, count);
    right.erase(std::remove_if(right.begin(), right.end(), [](const RitzPair& p) { return !is_real(p); }), right.end());
    for (const RitzPair& pair : right) {
      reduced.eigenvalue.push_back(1.0 / pair.value - shift);
      reduced.vector.push_back(pair.vector);
    }
    if (stability.symmetric) return;
    problem.apply = [&](double* block, int columns) { solver.solve(block, columns, true); };
    const std::vector<RitzPair> left = largest_eigenpairs(problem, count);
    for (const RitzPair& pair : right)
      reduced.left.push_back(std::min_element(left.begin(), left.end(), [&](const RitzPair& a, const RitzPair& b) {
                               return std::abs(a.value - pair.value) < std::abs(b.value - pair.value);
                             })->vector);
  });
  int found = static_cast<int>(reduced.eigenvalue.size());
  MPI_Bcast(&found, 1, MPI_INT, 0, unknowns_->root().communicator());
  reduced.eigenvalue.resize(found);
  reduced.vector.resize(found);
  if (!stability.symmetric) reduced.left.resize(found);
  MPI_Bcast(reduced.eigenvalue.data(), found, MPI_DOUBLE, 0, unknowns_->root().communicator());
  return reduced;
}

Spectrum Stability::spectrum(const State& state, double load_factor, int count) {
  assemble(state, load_factor);
  Spectrum result{inertia(true), {}};
  const Reduced reduced = nearest(result.stability, count);
  result.modes = corrected_modes(state, result.stability, reduced);
  for (double before : reduced.eigenvalue) result.stability.negative -= before < 0.0 ? 1 : 0;
  for (const EigenMode& mode : result.modes) result.stability.negative += mode.eigenvalue < 0.0 ? 1 : 0;
  return result;
}

namespace {

/// Eigenvalues (into `values`) and eigenvectors (columns of the result) of diag(values) + correction.
std::vector<double> small_eigenproblem(std::vector<double>& values, std::vector<double> correction) {
  const int m = static_cast<int>(values.size());
  for (int i = 0; i < m; ++i) correction[i * (m + 1)] += values[i];
  std::vector<double> work(4 * m + 1);
  int info = 0;
  Teuchos::LAPACK<int, double>().SYEV('V', 'L', m, correction.data(), m, values.data(), work.data(), 4 * m + 1, &info);
  if (info != 0) throw LinearSolverError("the small eigenvalue problem failed: dsyev " + std::to_string(info));
  return correction;
}

}  // namespace

/// Rayleigh-Ritz in the modes found, with the true compliance: degenerate modes separate as they should.
std::vector<EigenMode> Stability::corrected_modes(const State& state, const StabilityResult& stability,
                                                  const Reduced& reduced) {
  Assembler& assembler = problem_.assembler;
  const int m = static_cast<int>(reduced.eigenvalue.size());
  std::vector<MixedVector> found;
  for (const std::vector<double>& y : reduced.vector) found.push_back(complete_motion(assembler, *unknowns_, state, y));
  std::vector<double> values = reduced.eigenvalue, weights(static_cast<size_t>(m) * m, 0.0);
  if (stability.symmetric) {
    for (int i = 0; i < m; ++i)
      for (int j = 0; j <= i; ++j)
        weights[i + static_cast<size_t>(j) * m] = weights[j + static_cast<size_t>(i) * m] =
            added_compliance(assembler, found[i], found[j]);
    weights = small_eigenproblem(values, weights);
  } else {
    for (int i = 0; i < m; ++i) {
      weights[i * (m + 1)] = 1.0;
      double overlap = 0.0;
      if (unknowns_->is_root())
        overlap = std::inner_product(reduced.left[i].begin(), reduced.left[i].end(), reduced.vector[i].begin(), 0.0);
      MPI_Bcast(&overlap, 1, MPI_DOUBLE, 0, unknowns_->root().communicator());
      values[i] +=
          added_compliance(assembler, complete_motion(assembler, *unknowns_, state, reduced.left[i]), found[i]) /
          overlap;
    }
  }
  std::vector<int> order(m);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(values[a]) < std::abs(values[b]); });
  std::vector<EigenMode> modes;
  for (int k : order) {
    MixedVector mode = combination(found, &weights[static_cast<size_t>(k) * m]);
    normalize_mode(assembler, mode);
    modes.push_back({values[k], std::move(mode)});
  }
  return modes;
}

}  // namespace mixbeam
