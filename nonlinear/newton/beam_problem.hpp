/// Data shared by all groups of one run: the model, its linear solvers and the record of the work done.
#pragma once

#include "discretization/assembly/tangent.hpp"
#include "nonlinear/multilevel/network_solver.hpp"
#include "nonlinear/newton/attempt_log.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

#include <LOCA_GlobalData.H>

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace mixbeam {

struct WorkCount {
  int residuals = 0, tangents = 0, newton_iterations = 0;
  int factorizations = 0;  ///< of tangents, by Newton's method
  // Cost of checking that steps follow the path:
  int check_iterations = 0;  ///< of Newton's method, not in newton_iterations
  int looks = 0;             ///< tangents probed inside steps
};

/// Every group of LOCA has these: where messages go, and who makes its parts.
struct LocaData {
  explicit LocaData(const SolverParameters& parameters);
  ~LocaData() { LOCA::destroyGlobalData(global); }  // its parts point at each other
  LocaData(const LocaData&) = delete;
  LocaData& operator=(const LocaData&) = delete;

  Teuchos::RCP<LOCA::GlobalData> global;
};

class BeamProblem {
 public:
  /// See Model. `shared`: of another problem with these parameters; null: its own.
  BeamProblem(std::shared_ptr<const Scene> scene, const Communicator& comm, const SolverParameters& parameters,
              std::shared_ptr<const LocaData> shared = nullptr)
      : model(std::move(scene), comm, options_of(parameters)),
        loca(shared != nullptr ? std::move(shared) : std::make_shared<const LocaData>(parameters)),
        linear_(parameters.linear) {
    take_solver();
  }
  BeamProblem(const Scene& scene, const Communicator& comm, const SolverParameters& parameters)
      : BeamProblem(std::make_shared<const Scene>(scene), comm, parameters) {}

  /// A solver that is not in use elsewhere, usually the same one each time.
  std::shared_ptr<TangentSolver> take_solver() {
    for (const auto& solver : solvers_)
      if (solver.use_count() == 1) return solver;
    solvers_.push_back(make_tangent_solver(model, linear_.method, linear_.residual_tolerance));
    return solvers_.back();
  }

  /// Whether tangents are too large for factors, so that eigenvalues are not counted.
  bool iterates() const { return solvers_.front()->iterates(); }
  /// Whether stable states may be solved for, and confirmed as stable, by iteration.
  bool tries_iteration() const { return solvers_.front()->tries_iteration(); }

  /// Whether the last residual was taken at this state. States are never written to and the last one is held, so that
  /// addresses identify them, even of empty views. Never with formulas of loads, which depend on the running piece too.
  bool is_last_point(const State& state, double load_factor) const {
    if (!last_point || model.clock().have_formulas()) return false;
    const State& last = last_point->state;
    return last.views.interior.data() == state.views.interior.data() && last.in_plane == state.in_plane &&
           last.turns == state.turns && last_point->load_factor == load_factor;
  }

  /// Drops cached factors, so that the next solve depends on its tangent alone. A resumed path starts in this state.
  void forget_tangents() {
    for (const auto& solver : solvers_) solver->reset_factors();
  }

  /// Frees arrays that the next residual and tangent allocate again.
  void release_idle() {
    last_rows.reset();
    for (const auto& solver : solvers_)
      if (solver.use_count() == 1 && solver->chains() != nullptr) solver->chains()->release();
    model.release_idle_arrays(true);
  }

  /// Seeds the solver with the factors of a problem on the same structure and another discretization.
  void take_over(BeamProblem& other) { take_solver()->adopt_factors_of(*other.take_solver()); }

  const Model model;
  const std::shared_ptr<const LocaData> loca;
  WorkCount work;
  // Point and rows of the last residual: a converged state is judged, counted and reported without a new evaluation.
  std::optional<EvaluationPoint> last_point;
  std::optional<MixedVector> last_rows;
  AttemptLog attempts;
  /// Called before each iteration and each evaluation inside a step; throws to leave it, on every rank or on none.
  std::function<void()> leave_if_asked{};
  std::string last_failure;  ///< why the last linear solve failed; empty when it did not
  std::string objection;     ///< why the path rejected the last converged state

 private:
  static ModelOptions options_of(const SolverParameters& parameters) {
    ModelOptions options;
    options.force_stiffness_cap = parameters.linear.force_stiffness_cap;
    options.residual_tolerance = parameters.newton.residual_tolerance;
    options.planar = parameters.planar;
    return options;
  }

  LinearSolverParameters linear_;
  std::vector<std::shared_ptr<TangentSolver>> solvers_;
};

}  // namespace mixbeam
