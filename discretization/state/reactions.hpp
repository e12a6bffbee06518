/// Forces and moments of the supports, and their balance with the loads.
#pragma once

#include "discretization/assembly/residual.hpp"
#include "discretization/state/member_samples.hpp"

#include <vector>

namespace mixbeam {

using Reaction = RecordedReaction;

/// Sums over all external forces and reactions; all moments about `center`. Spatial.
struct Balance {
  Vector3 center{};  ///< middle of the box around the undeformed structure
  Vector3 applied_force{}, applied_moment{};
  Vector3 reaction_force{}, reaction_moment{};
  /// |applied + reaction| over the largest force or moment, inside or outside. Zero up to the tolerance of Newton's
  /// method.
  double force_error = 0.0, moment_error = 0.0;
  /// Moment (over the largest moment) that `moment_error` leaves out: the quadrature of an element integrates the
  /// tangent at its Gauss points, which differs from the chord of a curved member. A discretisation error: zero for
  /// straight members, and vanishing as h^2k.
  double curve_moment = 0.0;
};

/// Reactions in the order of Scene::supports, complete on every rank. Collective.
std::vector<Reaction> reactions(const Model& model, const State& state, double load_factor);

/// Sums of loads and reactions. The total of the line loads is their virtual work in the six rigid motions, as in the
/// equations of the elements. `reactions`: receives reactions(), from the same sweep. Collective.
Balance balance(const Model& model, const State& state, double load_factor, std::vector<Reaction>* reactions = nullptr);

}  // namespace mixbeam
