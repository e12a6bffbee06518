/// A benchmark solved to a wanted accuracy, on meshes that the program chooses: judged and timed like a cell.
#pragma once

#include "apps/trade/cell.hpp"
#include "nonlinear/accurate_run.hpp"

#include <string>
#include <vector>

namespace mixbeam {

struct AccurateCell {
  double wanted = 0.0;  ///< relative error of displacements
  AccuracyEnd end = AccuracyEnd::reached;
  std::vector<MeshRound> rounds;
  double estimated = 0.0;
  Errors errors = kNoErrors;
  CellTimes times;  ///< medians, of the first number of threads; reading left out
};

/// "5 x 4, 7 x 6": order and elements of the members, those of the finest member where they differ; mesh after mesh.
std::string meshes_text(const AccurateCell& cell);

/// Scenes that ask for a path, or for a branch, have their path followed on the last mesh too.
AccurateCell measure_accurate_cell(const BenchmarkProblem& problem, const Reference& reference, double wanted,
                                   const TimingPlan& plan, const Communicator& communicator);

}  // namespace mixbeam
