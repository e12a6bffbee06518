/// Forces and moments of the supports, and whether they balance the loads.
#pragma once

#include "discretization/assembly/residual.hpp"
#include "discretization/state/member_samples.hpp"

#include <vector>

namespace mixbeam {

using Reaction = RecordedReaction;

/// Sums over everything that acts from outside; all moments about `center`. Spatial.
struct Balance {
  Vector3 center{};  ///< middle of the box around the undeformed structure
  Vector3 applied_force{}, applied_moment{};
  Vector3 reaction_force{}, reaction_moment{};
  /// |applied + reaction|, over the largest force and the largest moment at work inside or outside. Zero up to the
  /// tolerance of Newton's method.
  double force_error = 0.0, moment_error = 0.0;
  /// Moment (over the largest moment at work) which `moment_error` leaves out: the quadrature of an element sees the
  /// integral of the tangent at its Gauss points in place of the chord of a curved member. A discretisation error: zero
  /// for straight members, and vanishing as h^2k.
  double curve_moment = 0.0;
};

/// Reactions in the order of Scene::supports, complete on every rank. Collective.
std::vector<Reaction> reactions(const Model& model, const State& state, double load_factor);

/// Sums of loads and reactions. The total of the line loads is what the equations of the elements take of them: their
/// virtual work in the six rigid motions. `reactions`: what reactions() gives, for the same sweep. Collective.
Balance balance(const Model& model, const State& state, double load_factor, std::vector<Reaction>* reactions = nullptr);

}  // namespace mixbeam
