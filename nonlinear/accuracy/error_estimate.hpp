/// Error of a converged state against the solution of the continuous equations.
#pragma once

#include "discretization/quantities/end_layers.hpp"
#include "discretization/quantities/quantity_derivative.hpp"
#include "discretization/state/member_samples.hpp"
#include "nonlinear/newton/beam_problem.hpp"

#include <vector>

namespace mixbeam {

/// Estimated errors, the same on every rank. Differences are exact solution less present state:
///   vertex_displacement         of the displacement of each vertex, spatial; largest_displacement: the largest |.| of
///                               them, with the largest |u| of any point as its size
///   element_displacement, _moment  sqrt(1/L int |error|^2 ds) over each element, L the length of all members (theory
///                               (52)), so that the squares of all elements sum to that of the whole structure; of the
///                               displacement, that of vertices included, and of M, material components
///   displacement, moment        the same over all elements
///   energy                      strain energy, the error with its sign
struct ErrorEstimate : RecordedErrorEstimate {
  int corrections = 0;  ///< number of linear systems solved
  /// The richer space with its state, from which any other number can be estimated; null without an estimate.
  Teuchos::RCP<BeamProblem> richer{};
  State richer_state{};

  bool exists() const { return not_estimated.empty(); }
};

/// Estimates errors by correcting the state by Newton's method in a richer space, theory (52): one order higher, two on
/// meshes of a few elements if Newton's method converges there, or two elements instead of one if the order is the
/// highest available. A first correction starts from the present fields, with relative rotations recovered from the
/// vertices (recovered_rotation.hpp). If its residual shows that quadratic terms might affect the estimate, a second
/// one follows with the same tangent, or with a new one if the first was inaccurate. The error of the richer space
/// itself is not included; it is much smaller wherever more elements or a higher order pay at all.
/// Costs two Newton iterations for orders 2 to 7, and three to four for order 1, whose iterations are cheap compared to
/// those of order 2, and for order 8. The load factor stays fixed, also under displacement control: next to a limit
/// point errors of the path count as errors of the state.
///
/// Reasons that prevent an estimate are stated in `not_estimated`, not thrown. Collective.
///
/// `problem`: of the state. The solver of the richer space adopts its factors.
ErrorEstimate estimate_error(BeamProblem& problem, const SolverParameters& parameters, const State& state,
                             double load_factor);

/// Returns (member): its contribution to the error of a quantity, with sign: t_+ . R_+ of theory (52), (80) in the
/// richer space of an existing estimate; the sum is the change of the quantity there. `quantity`: of the richer state.
/// Elements that meet at a vertex share its part. Throws LinearSolverError; one process only.
std::vector<double> shares_of_members(const Model& model, const State& state, double load_factor,
                                      const ErrorEstimate& estimate, const StateDerivative& quantity);

/// Returns `state` after one more Newton iteration, whatever its residual: next to a critical load a small residual
/// does not mean a small error, which is the residual over the smallest eigenvalue. Returns `state` itself if the
/// residual grows beyond the tolerance, or the tangent is singular. Collective.
State polished(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& state,
               double load_factor);

/// Makes the problem of the same scene in the richer space. Throws InputError.
Teuchos::RCP<BeamProblem> richer_problem(const BeamProblem& problem, const SolverParameters& parameters);

/// Returns `state` after one Newton step in which closed forms of end layers (end_layers.hpp) rotate the vertices
/// instead of the elements' approximation of them. Throws LinearSolverError. Collective.
State with_layers(const Teuchos::RCP<BeamProblem>& problem, const State& state, double load_factor,
                  const std::vector<EndLayer>& layers);

}  // namespace mixbeam
