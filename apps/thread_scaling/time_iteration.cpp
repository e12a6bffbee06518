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
      state_(problem_.model.reference_state()),
      residual_(problem_.model.create_vector()),
      increment_(problem_.model.create_vector()),
      sparse_method_(sparse_solver_of(parameters.linear.method)),
      tolerance_(parameters.linear.residual_tolerance) {}

PhaseSeconds IterationTimer::time() {
  const Model& model = problem_.model;
  const PhaseTimes before = model.times();
  const auto solver = problem_.take_solver();
  tangent_.reset();
  PhaseSeconds phases;
  const StopWatch whole;
  const EvaluationPoint point = mixed_residual(model, state_, 1.0, residual_);
  tangent_.emplace(model, point, cap_for(model, point.scales));
  const StopWatch linear;
  solver->factorize(*tangent_);
  tangent_->condensed_rows().scale(-1.0);
  solver->solve(tangent_->condensed_rows(), increment_.vertex_dofs());
  phases[kLinearSolver] = linear.seconds();
  tangent_->recover(increment_);
  const State moved = model.apply(state_, increment_, kStep);
  phases[kWholeIteration] = whole.seconds();
  double other = phases[kWholeIteration];
  for (const auto& [phase, total] : model.times()) {
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
  if (sparse_solver_ == nullptr) sparse_solver_ = make_tangent_solver(problem_.model, sparse_method_, tolerance_);
  DofVector x(problem_.model.map());
  const StopWatch watch;
  sparse_solver_->factorize(*tangent_);
  sparse_solver_->solve(tangent_->condensed_rows(), x);
  return watch.seconds();
}

}  // namespace mixbeam
