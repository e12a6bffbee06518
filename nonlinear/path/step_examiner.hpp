/// Examines a converged step of a path, by whatever method it was found: does it follow the path, and which critical
/// points does it pass?
#pragma once

#include "nonlinear/path/critical_point_finder.hpp"

#include <string>
#include <vector>

namespace mixbeam {

struct StepFindings {
  std::string objection{};              ///< empty: the step may be taken
  std::vector<CriticalPoint> passed{};  ///< in the order of the path
};

class StepExaminer {
 public:
  /// `stability` may be null: then counts are not compared. It must outlive this object. `stage_end`: load factor.
  StepExaminer(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, Stability* stability,
               double stage_end);

  const PathMeasure& measure() const { return measure_; }

  /// See LoadHistory.
  bool loads_are_straight(double from, double to) const { return judge_.loads().is_straight(from, to); }

  /// See StepJudge::station. Collective.
  Station station(const State& state, double load_factor, const PathDirection* along) const {
    return judge_.station(state, load_factor, along);
  }

  /// Collective.
  StepFindings examine(const PathPiece& piece, const StepTest& test);

 private:
  Teuchos::RCP<BeamProblem> problem_;
  Stability* stability_;
  SolveRecord checks_;
  Corrector corrector_;
  PathMeasure measure_;
  StepJudge judge_;
};

}  // namespace mixbeam
