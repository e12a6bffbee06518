#include "nonlinear/linear/network_factors.hpp"

#include "discretization/mesh/mixed_vector.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

/// Rounding of the condensation leaves asymmetry of 1e-15; what this much leaves of an error one refinement removes.
constexpr double kSymmetryOfRounding = 1e-12;

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
  if (row_.empty()) return;
  const auto kind = has_symmetry() ? InertiaSolver::Kind::symmetric : InertiaSolver::Kind::general;
  if (factors_ == nullptr || kind != kind_) {
    PhaseTimer timer(times_, "symbolic factorisation");
    kind_ = kind;
    factors_.reset();
    factors_ = std::make_unique<InertiaSolver>(kind_, remaining_);
  }
  PhaseTimer timer(times_, "numeric factorisation");
  const InertiaSolver::Signs signs = factors_->factorize(remaining_);
  if (signs.null > 0) throw LinearSolverError("the matrix is singular");
  if (is_symmetric() && diagonal_is_positive()) negative_ = signs.negative;
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
  if (!row_.empty()) factors_->solve(rhs_.data(), 1);
  for (size_t r = 0; r < row_.size(); ++r) found(row_[r]) = rhs_[r];
}

}  // namespace mixbeam
