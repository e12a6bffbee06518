#pragma once
#include "nonlinear/corrector.hpp"
#include <functional>
namespace mixbeam {
struct StageCallbacks { std::function<void(const Correction&)> converged; };
bool follow_automatically(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                          SolveRecord& record, const StageCallbacks& callbacks, State& state, double from, double to);
}
