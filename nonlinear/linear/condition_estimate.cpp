#include "nonlinear/linear/condition_estimate.hpp"

#include "discretization/mesh/mixed_vector.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_RowMatrixTransposer.hpp>

#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Limit of rounds: more than five hardly ever improve the estimate (Higham, ACM TOMS 14).
constexpr int kMostRounds = 5;

/// Backward error above which a solution says nothing about the size of the inverse.
constexpr double kUsableSolution = 1e-2;

/// Applies B = R A^-T C^-1 and its transpose, to estimate ||B||_1; R: row sums of |A| C.
class ScaledInverse {
 public:
  ScaledInverse(const Teuchos::RCP<const DofMatrix>& matrix, const std::string& method, double length)
      : matrix_(Teuchos::rcp(new DofMatrix(*matrix, Teuchos::Copy))),
        transposed_(
            Tpetra::RowMatrixTransposer<double, LocalOrdinal, GlobalOrdinal, TpetraNode>(matrix_).createTranspose()),
        inverse_(make_direct_solver(matrix_, method, kUsableSolution, times_)),
        transposed_inverse_(make_direct_solver(transposed_, method, kUsableSolution, times_)),
        row_sum_(matrix->getRangeMap()),
        column_scale_(matrix->getDomainMap()) {
    inverse_->factorize();
    transposed_inverse_->factorize();
    fill_scales(length);
  }

  DofVector create_vector() const { return DofVector(matrix_->getDomainMap()); }

  void apply(const DofVector& x, DofVector& y) const { solve(*transposed_inverse_, column_scale_, row_sum_, x, y); }
  void apply_transposed(const DofVector& x, DofVector& y) const { solve(*inverse_, row_sum_, column_scale_, x, y); }

 private:
  void solve(LinearSolver& inverse, const DofVector& before, const DofVector& behind, const DofVector& x,
             DofVector& y) const {
    DofVector scaled(x, Teuchos::Copy), solution = create_vector();
    scaled.elementWiseMultiply(1.0, before, x, 0.0);
    inverse.solve(scaled, solution);
    y.elementWiseMultiply(1.0, behind, solution, 0.0);
  }
  void fill_scales(double length) {
    const auto local = matrix_->getLocalMatrixHost();
    const auto columns = matrix_->getColMap();
    const auto sum = MixedVector::view_of(row_sum_), inverse_scale = MixedVector::view_of(column_scale_);
    for (int i = 0; i < local.numRows(); ++i) {
      inverse_scale(i) = i % kVertexDofs < 3 ? 1.0 / length : 1.0;
      sum(i) = 0.0;
      for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1); ++k) {
        const bool is_displacement = columns->getGlobalElement(local.graph.entries(k)) % kVertexDofs < 3;
        sum(i) += std::abs(local.values(k)) * (is_displacement ? length : 1.0);
      }
    }
  }

  PhaseTimes times_;
  Teuchos::RCP<DofMatrix> matrix_, transposed_;
  std::unique_ptr<LinearSolver> inverse_, transposed_inverse_;
  DofVector row_sum_, column_scale_;
};

template <class Function>
void for_each_entry(DofVector& v, const Function& value) {
  const auto entries = MixedVector::view_of(v);
  for (size_t i = 0; i < entries.extent(0); ++i)
    entries(i) = value(v.getMap()->getGlobalElement(static_cast<LocalOrdinal>(i)), entries(i));
}

/// Global number of the first entry of largest magnitude.
GlobalOrdinal largest_entry(DofVector& v) {
  const double largest = v.normInf();
  GlobalOrdinal mine = v.getMap()->getMaxAllGlobalIndex(), first = mine;
  for_each_entry(v, [&](GlobalOrdinal i, double x) {
    if (std::abs(x) == largest) mine = std::min(mine, i);
    return x;
  });
  Teuchos::reduceAll(*v.getMap()->getComm(), Teuchos::REDUCE_MIN, 1, &mine, &first);
  return first;
}

/// Hager's ascent: goes to the unit vector along which the gradient of ||B x||_1 is largest.
double hager_estimate(const ScaledInverse& b) {
  DofVector x = b.create_vector(), y = b.create_vector(), gradient = b.create_vector();
  x.putScalar(1.0 / static_cast<double>(x.getGlobalLength()));
  double estimate = 0.0;
  for (int round = 0; round < kMostRounds; ++round) {
    b.apply(x, y);
    const double size = y.norm1();
    if (!(size > estimate)) return estimate;
    estimate = size;
    for_each_entry(y, [](GlobalOrdinal, double value) { return value < 0.0 ? -1.0 : 1.0; });
    b.apply_transposed(y, gradient);
    if (gradient.normInf() <= gradient.dot(x)) return estimate;
    const GlobalOrdinal best = largest_entry(gradient);
    for_each_entry(x, [best](GlobalOrdinal i, double) { return i == best ? 1.0 : 0.0; });
  }
  return estimate;
}

/// Higham's estimate from a vector of alternating signs: catches most matrices that mislead the ascent.
double alternating_estimate(const ScaledInverse& b) {
  DofVector x = b.create_vector(), y = b.create_vector();
  const auto n = static_cast<double>(x.getGlobalLength());
  for_each_entry(x, [n](GlobalOrdinal i, double) { return (i % 2 == 0 ? 1.0 : -1.0) * (1.0 + i / (n - 1.0)); });
  b.apply(x, y);
  return 2.0 * y.norm1() / (3.0 * n);
}

}  // namespace

double condition_estimate(const Teuchos::RCP<const DofMatrix>& matrix, const std::string& method, double length) {
  try {
    const ScaledInverse inverse(matrix, method, length);
    return std::max(hager_estimate(inverse), alternating_estimate(inverse));
  } catch (const LinearSolverError&) {
    return std::numeric_limits<double>::infinity();
  }
}

double condition_of_tangent(const Model& model, const State& state, double load_factor, const std::string& method) {
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, state, load_factor, residual);
  const VertexMatrix matrix = whole_matrix(model);
  Tangent(model, point, cap_for(model, point.scales), {true, false}).gather(matrix);
  return condition_estimate(matrix.matrix(), method, model.structure().length);
}

}  // namespace mixbeam
