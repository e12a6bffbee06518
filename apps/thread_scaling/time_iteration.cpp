#include "apps/thread_scaling/time_iteration.hpp"

#include <algorithm>
#include <array>
#include <chrono>

namespace mixbeam {

namespace {

class StopWatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

constexpr std::array<const char*, 4> kPhasesOfElements = {"residual", "element tangent", "recover", "update"};
/// Small against one, so that every iteration starts from the same state and still moves it.
constexpr double kStep = 1e-3;

}  // namespace

IterationTimer::IterationTimer(const Scene& scene, const SolverParameters& parameters, const Communicator& communicator)
    : problem_(scene, communicator, parameters),
      state_(problem_.assembler.reference_state()),
      residual_(problem_.assembler.create_vector()),
      increment_(problem_.assembler.create_vector()),
      sparse_method_(sparse_solver_of(parameters.linear.method)),
      tolerance_(parameters.linear.residual_tolerance) {}

PhaseSeconds IterationTimer::time() {
  Assembler& assembler = problem_.assembler;
  const PhaseTimes before = assembler.times();
  PhaseSeconds phases;
  const StopWatch whole;
  assembler.residual(state_, 1.0, residual_);
  assembler.newton_tangent(state_, 1.0);
  const StopWatch linear;
  problem_.linear_solver->factorize();
  assembler.condensed_residual().scale(-1.0);
  problem_.linear_solver->solve(assembler.condensed_residual(), increment_.vertex_dofs());
  phases[kLinearSolver] = linear.seconds();
  assembler.recover(state_, increment_);
  const State moved = assembler.apply(state_, increment_, kStep);
  phases[kWholeIteration] = whole.seconds();
  double other = phases[kWholeIteration];
  for (const auto& [phase, total] : assembler.times()) {
    const auto earlier = before.find(phase);
    const double seconds = total - (earlier == before.end() ? 0.0 : earlier->second);
    if (seconds > 0.0) phases[phase] = seconds;
    other -= seconds;
  }
  phases[kOther] = other;
  for (const char* phase : kPhasesOfElements) phases[kElementWork] += phases[phase];
  return phases;
}

double IterationTimer::time_sparse_solver() {
  if (sparse_solver_ == nullptr) sparse_solver_ = make_linear_solver(problem_.assembler, sparse_method_, tolerance_);
  DofVector x(problem_.assembler.map());
  const StopWatch watch;
  sparse_solver_->factorize();
  sparse_solver_->solve(problem_.assembler.condensed_residual(), x);
  return watch.seconds();
}

}  // namespace mixbeam
