#include "nonlinear/stability/nearest_eigenvalue.hpp"

#include "nonlinear/stability/block_krylov.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <limits>

namespace mixbeam {

namespace {

/// Inverse iterations from an arbitrary vector: next to zero each gains many digits.
constexpr int kInverseIterations = 3;

}  // namespace

double rounding_level(const SparseMatrix& a, const std::vector<double>& y) {
  double sum = 0.0;
  for (int i = 0; i < a.rows(); ++i)
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k)
      sum += std::abs(y[i]) * std::abs(a.value[k]) * std::abs(y[a.column[k]]);
  return std::numeric_limits<double>::epsilon() * sum;
}

NearestEigenvalue nearest_eigenvalue(const SparseMatrix& a, InertiaSolver& solver) {
  std::vector<double> y(a.rows());
  for (int i = 0; i < a.rows(); ++i) y[i] = 1.0 + 0.5 * std::sin(1.0 + i);  // parallel to no mode
  double length = std::sqrt(dot_product(y, y)), size = HUGE_VAL;
  for (int i = 0; i < kInverseIterations; ++i) {
    for (double& x : y) x /= length;
    solver.solve(y.data(), 1);
    length = std::sqrt(dot_product(y, y));
    size = 1.0 / length;
  }
  for (double& x : y) x /= length;
  return {size, rounding_level(a, y)};
}

NearestEigenvalue nearest_eigenvalue(const Tangent& tangent, const SolveVertices& solve,
                                     const std::function<double(const DofVector&)>& rounding_of_form) {
  const Model& model = tangent.model();
  const Structure& structure = model.structure();
  DofVector x(model.map()), b(model.map());
  const size_t rows = MixedVector::view_of(x).extent(0);
  const double L = structure.length, share = structure.bending_reference / (L * model.mesh().vertices());
  const auto weight = [&](size_t i) { return i % kVertexDofs < 3 ? share / (L * L) : share; };
  const auto length_of = [&](const DofVector& v, bool is_force) {
    const KernelView<const double*> values = MixedVector::view_of(v);
    double sum = 0.0, all = 0.0;
    for (size_t i = 0; i < rows; ++i) sum += values(i) * values(i) * (is_force ? 1.0 / weight(i) : weight(i));
    Teuchos::reduceAll(*model.map()->getComm(), Teuchos::REDUCE_SUM, 1, &sum, &all);
    return std::sqrt(all);
  };
  for (size_t i = 0; i < rows; ++i) {
    const double number = kVertexDofs * structure.local_vertex_to_global[i / kVertexDofs] + i % kVertexDofs;
    MixedVector::view_of(x)(i) = 1.0 + 0.5 * std::sin(1.0 + number);
  }
  NearestEigenvalue nearest;
  double length = length_of(x, false);
  for (int step = 0; step < kInverseIterations; ++step) {
    for (size_t i = 0; i < rows; ++i) MixedVector::view_of(b)(i) = weight(i) / length * MixedVector::view_of(x)(i);
    tangent.project_on_free_motions(MixedVector::view_of(b));
    const double force = length_of(b, true);
    solve(b, x);
    length = length_of(x, false);
    nearest.size = force / length;
  }
  if (rounding_of_form) nearest.rounding = rounding_of_form(x) / (length * length);
  return nearest;
}

}  // namespace mixbeam
