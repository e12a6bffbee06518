/// Parameters of the solution: load path, Newton's method, linear solver.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "nonlinear/parameters/analysis_parameters.hpp"

#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>

#include <string>

namespace mixbeam {

enum class LoadPathMethod {
  automatic,  ///< load steps as large as possible; where they fail, arc-length steps
  fixed,      ///< equal steps
  adaptive    ///< steps grow after easy steps and shrink after failed ones
};

/// All step sizes are fractions of a stage.
struct LoadPathParameters {
  LoadPathMethod method = LoadPathMethod::automatic;
  int steps = 1;  ///< fixed: per stage
  double initial_step = 1.0;
  double minimum_step = 1e-4;
  double maximum_step = 1.0;
  int maximum_steps = 1000;  ///< of all stages together; fixed: on top of the requested ones
  double aggressiveness = 0.5;

  /// Limit of attempts for a path of so many stages.
  int most_steps(int stages) const;
};

struct NewtonParameters {
  double residual_tolerance = 1e-11;  ///< of the scaled, dimensionless residual
  int maximum_iterations = 50;
  double maximum_rotation = 0.4;  ///< of any vertex in one iteration
};

struct LinearSolverParameters {
  std::string method = "automatic";
  double residual_tolerance = 1e-8;  ///< |b - A x| / (|A| |x| + |b|), checked after every solve
  double force_stiffness_cap =
      1e5;  ///< times max(EI/L^2, largest force): limits the force stiffness of the tangent only
};

struct SolverParameters {
  AnalysisParameters analysis;
  LoadPathParameters load_path;
  NewtonParameters newton;
  LinearSolverParameters linear;
  int threads = 0;     ///< 0: from OMP_NUM_THREADS
  bool planar = true;  ///< solve planar scenes with three unknowns per vertex; see Model::plane()
  // Lists as the user gave them, without defaults; else null.
  Teuchos::RCP<Teuchos::ParameterList> nox;
  Teuchos::RCP<Teuchos::ParameterList> status_tests;
  Teuchos::RCP<Teuchos::ParameterList> loca;
};

/// Name of this program's own line search.
inline constexpr const char* kRotationLimited = "Rotation Limited";

/// Declaration of the list "Solver".
ListSpec solver_spec();

/// Validates and reads the list. `path`: its location below the root of `source`.
SolverParameters read_solver_parameters(Teuchos::ParameterList& list, const ParameterSource& source,
                                        const ParameterPath& path = {"Solver"});

}  // namespace mixbeam
