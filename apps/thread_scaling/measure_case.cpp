#include "apps/thread_scaling/measurement.hpp"

#include "apps/common/studies/study.hpp"
#include "apps/thread_scaling/chain_unit.hpp"
#include "apps/thread_scaling/separate_process.hpp"
#include "kernels/execution/execution_space.hpp"
#include "nonlinear/newton/beam_problem.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace mixbeam {

namespace {

/// Least number of rounds for a median.
constexpr int kLeastRounds = 3;

constexpr std::array<const char*, 4> kPhasesOfElements = {"residual", "element tangent", "recover", "update"};
/// Length of an increment, alternating in sign. Small compared with one, so that all iterations do the same work; not
/// zero, since an unchanged matrix is not factorised again.
constexpr double kStep = 1e-3;

/// Times one Newton iteration of the nonlinear solver, phase by phase.
class IterationTimer {
 public:
  /// Uses the linear solver of `parameters`.
  IterationTimer(const Scene& scene, const SolverParameters& parameters, const Communicator& communicator)
      : problem_(scene, communicator, parameters),
        state_(problem_.model.reference_state()),
        residual_(problem_.model.create_vector()),
        increment_(problem_.model.create_vector()),
        tolerance_(parameters.linear.residual_tolerance) {}

  /// Times residual, tangent, factorisation, solve, recovery of the interior and update at the undeformed state, or the
  /// one next to it, under the full load, with the current number of threads.
  PhaseSeconds time() {
    const Model& model = problem_.model;
    const PhaseTimes before = model.times();
    const auto solver = problem_.take_solver();
    tangent_.reset();
    problem_.forget_tangents();
    PhaseSeconds phases;
    const RunWatch whole;
    const EvaluationPoint point = mixed_residual(model, state_, 1.0, residual_);
    tangent_.emplace(model, point, cap_for(model, point.scales));
    const RunWatch linear;
    DofVector &rows = tangent_->condensed_rows(), &solution = increment_.writable_dofs(false);
    rows.scale(-1.0);
    solver->factorize(*tangent_, {&rows, &solution});
    solver->solve(rows, solution);
    phases[kLinearSolver] = linear.seconds();
    tangent_->recover_last(increment_);
    State moved = model.apply(state_, increment_, is_beside_ ? -kStep : kStep);
    phases[kWholeIteration] = whole.seconds();
    state_ = std::move(moved);
    is_beside_ = !is_beside_;
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

  /// Times KLU2 alone, which gathers, factorises, solves and checks the matrix of the same iteration; created at the
  /// first call, to save memory.
  double time_sparse_solver() {
    if (sparse_solver_ == nullptr) sparse_solver_ = make_direct_tangent_solver(problem_.model, kKlu, tolerance_);
    DofVector x(problem_.model.map());
    sparse_solver_->reset_factors();
    const RunWatch watch;
    sparse_solver_->factorize(*tangent_);
    sparse_solver_->solve(tangent_->condensed_rows(), x);
    return watch.seconds();
  }

 private:
  BeamProblem problem_;
  State state_;
  bool is_beside_ = false;  ///< the state is next to the undeformed one
  MixedVector residual_, increment_;
  std::optional<Tangent> tangent_;  ///< of the last time()
  double tolerance_;
  std::unique_ptr<TangentSolver> sparse_solver_;
};

/// Takes one sample for each number of threads; `phases` runs the measured work.
template <class Phases>
Round take_round(const std::vector<int>& threads, ChainUnit& unit, const Phases& phases) {
  Round round;
  for (int n : threads) {
    set_number_of_threads(n);
    Sample& sample = round[n];
    sample.phases = phases(n);
    const ChainUnit::Seconds seconds = unit.time();
    sample.unit_factorize = seconds.factorize;
    sample.unit_solve = seconds.solve;
    sample.unit_processor_seconds = seconds.processor;
  }
  return round;
}

template <class Phases>
void take_rounds(const MeasuringPlan& plan, int least, int most, ChainUnit& unit, const Phases& phases,
                 std::vector<Round>& rounds) {
  const RunWatch watch;
  for (int taken = 0; taken < most && (taken < least || watch.seconds() < plan.seconds); ++taken)
    rounds.push_back(take_round(plan.threads, unit, phases));
}

/// Times the Newton iterations of a user's run, including NOX and LOCA, from the straight rod to equilibrium.
PhaseSeconds time_run(const Scene& scene, SolverParameters parameters, const Communicator& communicator, int threads) {
  parameters.threads = threads;
  Simulation simulation(scene, parameters, communicator);
  const RunWatch watch;
  const LoadPathResult& result = simulation.run();
  const double seconds = watch.seconds();
  if (result.newton_iterations == 0) return {};
  return {{kWholeRun, seconds / result.newton_iterations}};
}

int vertices_of(const Scene& scene) {
  int vertices = static_cast<int>(scene.points.size());
  for (const Member& member : scene.members) vertices += member.elements - 1;
  return vertices;
}

/// Builds the problem, takes all rounds of iterations and releases its memory.
void measure_iterations(const Scene& scene, const SolverParameters& parameters, const Communicator& communicator,
                        const MeasuringPlan& plan, Measurement& measurement) {
  const double at_start = resident_memory();
  IterationTimer timer(scene, parameters, communicator);
  for (int n : plan.threads) {
    set_number_of_threads(n);
    timer.time();
  }
  measurement.memory =
      communicator->getSize() == 1 ? peak_resident_memory() - at_start : std::numeric_limits<double>::quiet_NaN();
  ChainUnit unit(vertices_of(scene));
  if (plan.compare_sparse_solver) timer.time_sparse_solver();
  take_rounds(
      plan, kLeastRounds, std::max(kLeastRounds, plan.repetitions), unit,
      [&](int) {
        PhaseSeconds phases = timer.time();
        if (plan.compare_sparse_solver) phases[kLinearSolverSparse] = timer.time_sparse_solver();
        return phases;
      },
      measurement.rounds);
}

}  // namespace

Measurement measure_case(const Scene& scene, const SolverParameters& parameters, const Communicator& communicator,
                         const MeasuringPlan& plan) {
  Measurement measurement;
  measure_iterations(scene, parameters, communicator, plan, measurement);
  ChainUnit unit(vertices_of(scene));
  take_rounds(
      plan, 1, plan.run_repetitions, unit, [&](int n) { return time_run(scene, parameters, communicator, n); },
      measurement.rounds);
  return measurement;
}

}  // namespace mixbeam
