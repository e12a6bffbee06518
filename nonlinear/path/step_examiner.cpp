#include "nonlinear/path/step_examiner.hpp"

#include <array>
#include <cstdio>

namespace mixbeam {

StepExaminer::StepExaminer(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                           Stability* stability, double stage_end)
    : problem_(problem),
      stability_(stability),
      corrector_(problem, parameters, checks_, NewtonPurpose::check),
      measure_(problem->model),
      judge_(problem, corrector_, measure_, stability, stage_end) {}

StepFindings StepExaminer::examine(const PathPiece& piece, const StepTest& test) {
  StepFindings findings;
  findings.objection = judge_.objection(piece, test);
  const std::optional<StabilityResult>&before = piece.start.stability, &after = piece.end.stability;
  const bool changes = before && after && before->negative != after->negative;
  if (findings.objection.empty() && changes) {
    try {
      findings.passed = CriticalPointFinder(problem_, corrector_, *stability_, measure_, judge_).find(piece);
    } catch (const NotLocated& error) {
      findings.objection = error.what();
    }
  }
  if (findings.objection.empty()) return findings;
  std::array<char, 80> interval{};
  std::snprintf(interval.data(), interval.size(), " (load factor %.6g to %.6g)", piece.start.load_factor,
                piece.end.load_factor);
  findings.objection += interval.data();
  return findings;
}

}  // namespace mixbeam
