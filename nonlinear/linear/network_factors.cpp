#include "nonlinear/linear/network_factors.hpp"

#include "discretization/mesh/mixed_vector.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace mixbeam {

namespace {

/// Rounding of the condensation leaves asymmetry of 1e-15; what this much leaves of an error one refinement removes.
constexpr double kSymmetryOfRounding = 1e-12;

/// Iterations with the factors of an earlier matrix may cost this share of a factorisation: the rest pays for attempts
/// that end in one.
constexpr double kShareOfFactorization = 0.5;
/// Fewer are not worth an attempt: cubes of 14^3 junctions and sheets of 200^2 have that many.
constexpr int kLeastIterations = 7;
/// What is left of the error, in energy: Newton's method converges as with factors.
constexpr double kReduction = 1e-9;
/// So many iterations tell how many it will take.
constexpr int kForecast = 2;

double inner_product(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

bool is_moment(int row) { return row % kVertexDofs >= 3; }

}  // namespace

/// 1 where a row has no other entry than that on the diagonal.
std::vector<unsigned char> NetworkFactors::rows_alone() const {
  const auto local = matrix_->getLocalMatrixHost();
  std::vector<unsigned char> alone(local.numRows(), 1);
  for (int i = 0; i < local.numRows(); ++i)
    for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1) && alone[i] != 0; ++k)
      if ((local.graph.entries(k) == i) == (local.values(k) == 0.0)) alone[i] = 0;
  return alone;
}

void NetworkFactors::take_out(std::vector<unsigned char> alone) {
  const auto graph = matrix_->getLocalMatrixHost().graph;
  const int rows = static_cast<int>(alone.size());
  factors_.reset();
  alone_ = std::move(alone);
  row_.clear();
  entry_.clear();
  remaining_ = SparseMatrix();
  std::vector<int> number(rows, -1);
  for (int i = 0; i < rows; ++i)
    if (alone_[i] == 0) {
      number[i] = static_cast<int>(row_.size());
      row_.push_back(i);
    }
  remaining_.row_start = {0};
  std::vector<std::pair<int, size_t>> of_row;  // columns ascend, also in what several ranks have gathered
  for (int i : row_) {
    of_row.clear();
    for (size_t k = graph.row_map(i); k < graph.row_map(i + 1); ++k)
      if (number[graph.entries(k)] >= 0) of_row.push_back({number[graph.entries(k)], k});
    std::sort(of_row.begin(), of_row.end());
    for (const auto& [column, entry] : of_row) {
      remaining_.column.push_back(column);
      entry_.push_back(entry);
    }
    remaining_.row_start.push_back(static_cast<int>(entry_.size()));
  }
  remaining_.value.resize(entry_.size());
  rhs_.resize(row_.size());
  find_mirrors();
}

void NetworkFactors::find_mirrors() {
  mirror_.assign(entry_.size(), -1);
  const auto at = [this](int row) { return remaining_.column.begin() + remaining_.row_start[row]; };
  for (int i = 0; i < remaining_.rows(); ++i)
    for (int k = remaining_.row_start[i]; k < remaining_.row_start[i + 1]; ++k) {
      const int j = remaining_.column[k];
      const auto found = std::lower_bound(at(j), at(j + 1), i);
      if (found != at(j + 1) && *found == i) mirror_[k] = static_cast<int>(found - remaining_.column.begin());
    }
}

/// In units of the largest entries of the rows, forces by displacements and moments by rotations.
bool NetworkFactors::has_symmetry() const {
  std::vector<double> size(remaining_.rows(), 0.0);
  const auto each_entry = [this](const auto& action) {
    for (int i = 0; i < remaining_.rows(); ++i)
      for (int k = remaining_.row_start[i]; k < remaining_.row_start[i + 1]; ++k)
        if (!action(i, k)) return false;
    return true;
  };
  each_entry([&](int i, int k) {
    if (is_moment(row_[i]) == is_moment(row_[remaining_.column[k]]))
      size[i] = std::max(size[i], std::abs(remaining_.value[k]));
    return true;
  });
  return each_entry([&](int i, int k) {
    const double transposed = mirror_[k] < 0 ? 0.0 : remaining_.value[mirror_[k]];
    const double difference = std::abs(remaining_.value[k] - transposed);
    return difference <= kSymmetryOfRounding * std::sqrt(size[i] * size[remaining_.column[k]]);
  });
}

/// Of the rows that are taken out.
bool NetworkFactors::diagonal_is_positive() const {
  const auto local = matrix_->getLocalMatrixHost();
  for (size_t i = 0; i < alone_.size(); ++i)
    for (size_t k = local.graph.row_map(i); alone_[i] != 0 && k < local.graph.row_map(i + 1); ++k)
      if (local.graph.entries(k) == static_cast<int>(i) && !(local.values(k) > 0.0)) return false;
  return true;
}

void NetworkFactors::factorize() {
  std::vector<unsigned char> alone = rows_alone();
  if (alone != alone_) take_out(std::move(alone));
  const auto values = matrix_->getLocalMatrixHost().values;
  for (size_t k = 0; k < entry_.size(); ++k) remaining_.value[k] = values(entry_[k]);
  negative_.reset();
  is_earlier_ = false;
  if (row_.empty()) return;
  const auto kind = has_symmetry() ? InertiaSolver::Kind::symmetric : InertiaSolver::Kind::general;
  if (kind != kind_) factors_.reset();
  kind_ = kind;
  left_ = factors_ == nullptr || !serves_next_ || !is_symmetric()
              ? 0
              : static_cast<int>(kShareOfFactorization * factors_->solves_for_factors());
  is_earlier_ = left_ >= kLeastIterations;
  if (!is_earlier_) factorize_now();
}

void NetworkFactors::factorize_now() {
  is_earlier_ = serves_next_ = false;
  if (factors_ == nullptr || factors_.use_count() > 1) {
    PhaseTimer timer(times_, "symbolic factorisation");
    factors_.reset();
    factors_ = std::make_shared<InertiaSolver>(kind_, remaining_);
  }
  PhaseTimer timer(times_, "numeric factorisation");
  const InertiaSolver::Signs signs = factors_->factorize(remaining_);
  if (signs.null > 0) throw LinearSolverError("the matrix is singular");
  if (is_symmetric() && diagonal_is_positive()) negative_ = signs.negative;
  serves_next_ = is_symmetric() && signs.negative == 0;
}

void NetworkFactors::take_over(const NetworkFactors& other) {
  const auto here = matrix_->getLocalMatrixHost().graph, there = other.matrix_->getLocalMatrixHost().graph;
  const auto same = [](const auto& a, const auto& b) {
    return a.extent(0) == b.extent(0) && std::equal(a.data(), a.data() + a.extent(0), b.data());
  };
  if (!other.serves_next_ || !same(here.row_map, there.row_map) || !same(here.entries, there.entries)) return;
  take_out(other.alone_);
  kind_ = other.kind_;
  factors_ = other.factors_;
  serves_next_ = true;
}

std::optional<long> NetworkFactors::negative_eigenvalues() {
  if (is_earlier_) try {
      factorize_now();
    } catch (const LinearSolverError&) {  // a singular matrix tells no signs
    }
  return negative_;
}

/// Conjugate gradients, preconditioned by the factors; false where they would need more iterations than are left.
bool NetworkFactors::iterate(std::vector<double>& b) {
  PhaseTimer timer(times_, "iterations with earlier factors");
  std::vector<double> r = b, z = r, p(b.size(), 0.0), q(b.size()), x(b.size(), 0.0);
  factors_->solve(z.data(), 1);
  const double first = inner_product(r, z), aim = kReduction * kReduction * first;
  double energy = first, last = first;
  for (iterations_ = 0; energy > aim; ++iterations_) {
    const bool is_hopeless = iterations_ >= kForecast &&
                             iterations_ * std::log(aim / first) < (iterations_ + left_) * std::log(energy / first);
    if (left_ <= 0 || is_hopeless) return false;
    const double beta = iterations_ == 0 ? 0.0 : energy / last;
    for (size_t i = 0; i < p.size(); ++i) p[i] = z[i] + beta * p[i];
    remaining_.multiply(p.data(), q.data());
    const double curvature = inner_product(p, q);
    if (!(curvature > 0.0)) return false;
    for (size_t i = 0; i < p.size(); ++i) x[i] += energy / curvature * p[i];
    for (size_t i = 0; i < p.size(); ++i) r[i] -= energy / curvature * q[i];
    z = r;
    factors_->solve(z.data(), 1);
    --left_;
    last = energy;
    energy = inner_product(r, z);
  }
  if (!(energy >= 0.0)) return false;
  b = std::move(x);
  return true;
}

void NetworkFactors::solve(const DofVector& b, DofVector& x) {
  const auto local = matrix_->getLocalMatrixHost();
  const KernelView<const double*> given = MixedVector::view_of(b);
  const KernelView<double*> found = MixedVector::view_of(x);
  for (size_t i = 0; i < alone_.size(); ++i) {
    found(i) = 0.0;
    for (size_t k = local.graph.row_map(i); alone_[i] != 0 && k < local.graph.row_map(i + 1); ++k)
      if (local.graph.entries(k) == static_cast<int>(i)) found(i) = given(i) / local.values(k);
  }
  for (size_t r = 0; r < row_.size(); ++r) {
    rhs_[r] = given(row_[r]);
    for (size_t k = local.graph.row_map(row_[r]); k < local.graph.row_map(row_[r] + 1); ++k)
      rhs_[r] -= local.values(k) * found(local.graph.entries(k));  // zero where the unknown is not known yet
  }
  if (is_earlier_ && !iterate(rhs_)) factorize_now();
  if (!row_.empty() && !is_earlier_) factors_->solve(rhs_.data(), 1);
  for (size_t r = 0; r < row_.size(); ++r) found(row_[r]) = rhs_[r];
}

}  // namespace mixbeam
