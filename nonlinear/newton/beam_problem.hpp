/// What all groups of one run share: the assembled equations, the linear solver and the record of the work done.
#pragma once

#include "discretization/assembly/assembler.hpp"
#include "nonlinear/linear/chain_solver.hpp"
#include "nonlinear/newton/attempt_log.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

#include <functional>
#include <memory>
#include <string>

namespace mixbeam {

struct WorkCount {
  int residuals = 0, tangents = 0, newton_iterations = 0;
  int factorizations = 0;  ///< of tangents, by Newton's method
  // What it costs to know that a step follows the path:
  int check_iterations = 0;  ///< of Newton's method, beside newton_iterations
  int looks = 0;             ///< tangents inside of steps
};

class BeamProblem {
 public:
  BeamProblem(const Scene& scene, const Communicator& comm, const SolverParameters& parameters)
      : assembler(scene, comm,
                  {parameters.linear.force_stiffness_cap, parameters.newton.residual_tolerance, parameters.planar}),
        linear_solver(make_linear_solver(assembler, parameters.linear.method, parameters.linear.residual_tolerance)) {}

  Assembler assembler;
  std::unique_ptr<LinearSolver> linear_solver;
  WorkCount work;
  AttemptLog attempts;
  /// Asked before each iteration and each look at a path; throws to leave it. Must answer the same on every rank.
  std::function<void()> leave_if_asked{};
  /// Increments are those of the capped tangent, all of them: bordered systems next to a critical point combine several
  /// solves with a nearly singular tangent, whose errors cancel only if it is one and the same.
  bool keeps_cap = false;
  bool leaves_plane = false;  ///< tangents of scenes in a plane are in space all the same
  std::string last_failure;   ///< why the last linear solve failed; empty when it did not
  std::string objection;      ///< why the path does not take what Newton's method has found
};

}  // namespace mixbeam
