/// The matrix of one benchmark: all orders on all meshes.
#pragma once

#include "apps/trade/choice.hpp"

namespace mixbeam {

/// Which cells, against which reference.
struct MatrixPlan {
  std::vector<int> orders, elements;  ///< ascending
  Discretization reference, confirmation;
  TimingPlan timing;
  std::vector<double> accuracies{};  ///< that the program is asked for
};

/// Fills the cells of one benchmark. Cells that are not computed are among them, with the reason; see CellStatus.
BenchmarkResult measure_matrix(const BenchmarkProblem& problem, const Reference& reference, const MatrixPlan& plan,
                               const Communicator& communicator);

/// A scene of the gallery: only cells that may be the cheapest for one of the accuracies, from the highest order down.
/// Elements are those of the file, halved and doubled.
BenchmarkResult measure_front(const BenchmarkProblem& problem, const Reference& reference, const MatrixPlan& plan,
                              const Communicator& communicator);

}  // namespace mixbeam
