#include "nonlinear/stability/eigen_mode.hpp"

#include "discretization/text/memory_error.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace mixbeam {

MixedVector complete_motion(const Tangent& tangent, const IndependentUnknowns& unknowns, const std::vector<double>& y) {
  MixedVector by_residual = tangent.model().create_vector(), motion = by_residual.clone(false);
  tangent.recover(by_residual);
  unknowns.expand(y.data(), motion.vertex_dofs());
  tangent.recover(motion);
  motion.update(-1.0, by_residual, 1.0);
  return motion;
}

MixedVector combination(const std::vector<MixedVector>& vectors, const double* weights) {
  MixedVector sum = vectors.front().clone(false);
  sum.fill(0.0);
  for (size_t i = 0; i < vectors.size(); ++i) sum.update(weights[i], vectors[i], 1.0);
  return sum;
}

double normalize_mode(const Model& model, MixedVector& mode) {
  const KernelView<double*> rows = mode.vertex();
  const double length = model.structure().length;
  const auto size = [&](size_t i) { return rows(i) / (i % kVertexDofs < 3 ? length : 1.0); };
  double largest = 0.0;
  for (size_t i = 0; i < rows.extent(0); ++i) largest = std::max(largest, std::abs(size(i)));
  const Teuchos::Comm<int>& comm = *model.map()->getComm();
  largest = maximum_over_ranks(comm, largest);
  // rank and sign of the first of the largest components as one number, of which the lowest rank has the largest
  double first = -2.0 * comm.getSize();
  for (size_t i = 0; i < rows.extent(0); ++i)
    if (std::abs(size(i)) >= stability_limit.almost_largest * largest) {
      first = -2.0 * comm.getRank() - (size(i) < 0.0 ? 1.0 : 0.0);
      break;
    }
  first = maximum_over_ranks(comm, first);
  const bool turned = std::fmod(-first, 2.0) == 1.0;
  const double factor = largest > 0.0 ? (turned ? -1.0 : 1.0) / largest : 1.0;
  if (largest > 0.0) mode.scale(factor);
  return factor;
}

void on_root(const RootCopy& root, const std::function<void()>& action) {
  std::string problem;
  if (root.is_root()) {
    try {
      action();
    } catch (const std::exception& error) {
      if (is_out_of_memory(error)) throw;  // no fault of the step, which would be repeated smaller
      problem = error.what();
    }
  }
  int failed = problem.empty() ? 0 : 1;
  root.share(&failed, 1, MPI_INT);
  if (failed != 0) throw LinearSolverError("stability: " + (problem.empty() ? "see rank 0" : problem));
}

double number_of_root(const RootCopy& root, const std::function<double()>& number) {
  double found = 0.0;
  on_root(root, [&] { found = number(); });
  root.share(&found, 1, MPI_DOUBLE);
  return found;
}

}  // namespace mixbeam
