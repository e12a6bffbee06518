/// How far a converged state is from the solution of the continuous equations.
#pragma once

#include "discretization/quantities/end_layers.hpp"
#include "discretization/quantities/quantity_derivative.hpp"
#include "discretization/state/member_samples.hpp"
#include "nonlinear/newton/beam_problem.hpp"

#include <vector>

namespace mixbeam {

/// Estimated errors, the same on every rank. Differences are exact solution less present state:
///   vertex_displacement         of the displacement of each vertex, spatial; largest_displacement the largest |.| of
///                               them, beside the largest |u| of any point
///   element_displacement, _moment  sqrt(1/L int |error|^2 ds) over each element, L the length of all members (theory
///                               (52)), so that the squares of all elements add up to that of the whole structure; of
///                               the displacement, vertices or not, and of M, material components
///   displacement, moment        the same over all elements
///   energy                      strain energy, the error with its sign
struct ErrorEstimate : RecordedErrorEstimate {
  int corrections = 0;  ///< linear systems solved
  /// The richer space with its state, from which any other number can be estimated; null where there is no estimate.
  Teuchos::RCP<BeamProblem> richer{};
  State richer_state{};

  bool exists() const { return not_estimated.empty(); }
};

/// Estimates by what Newton's method makes of the state in a richer space, theory (52): one order more, two on
/// meshes of a few elements if Newton's method converges there, or two elements in place of one where the order is
/// the highest there is. A first correction starts from the present fields, with relative rotations recovered from
/// the vertices (recovered_rotation.hpp). Where its residual tells that the squares it leaves might be seen in the
/// estimate, a second one follows with the same tangent, or with a new one where the first was far off. The error
/// of the richer space itself stays unseen; it is much smaller wherever more elements or a higher order pay at all.
/// Costs two Newton iterations for orders 2 to 7, and three to four for order 1, whose iterations are cheap beside
/// those of order 2, and for order 8. The load factor stays what it is, also where a displacement is controlled:
/// next to a limit point errors of the path count as errors of the state.
///
/// What makes an estimate impossible is stated in `not_estimated`, not thrown. Collective.
///
/// `problem`: of the state. What it keeps of its last tangent serves that of the richer space.
ErrorEstimate estimate_error(BeamProblem& problem, const SolverParameters& parameters, const State& state,
                             double load_factor);

/// (member): what it adds to the error of a quantity, with its sign: t_+ . R_+ of theory (52), (80) in the richer space
/// of an estimate that exists, which adds up to the change of the quantity there. `quantity`: of the richer state. The
/// elements that meet at a vertex share its part. Throws LinearSolverError; one process only.
std::vector<double> shares_of_members(const Model& model, const State& state, double load_factor,
                                      const ErrorEstimate& estimate, const StateDerivative& quantity);

/// `state` after one Newton iteration more, whatever its residual: next to a critical load a small residual is not a
/// small error, which is that over the smallest eigenvalue. The same state where the residual grows, beyond the
/// tolerance, or the tangent is singular. Collective.
State polished(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& state,
               double load_factor);

/// The same scene in the richer space. Throws InputError.
Teuchos::RCP<BeamProblem> richer_problem(const BeamProblem& problem, const SolverParameters& parameters);

/// `state` after one Newton step in which the closed forms of layers (end_layers.hpp) turn the vertices in place of
/// what the elements there make of them. Throws LinearSolverError. Collective.
State with_layers(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& state,
                  double load_factor, const std::vector<EndLayer>& layers);

}  // namespace mixbeam
