/// Potential of a structure under its loads; stable equilibria are its minima.
#pragma once

#include "discretization/assembly/model.hpp"

namespace mixbeam {

/// Theory (65): stored energy of elements and springs minus the work of dead forces, all at one load factor. Moments
/// and follower loads have no potential and are omitted. If element interiors are not in equilibrium, this is the value
/// of the mixed functional, which their equilibrium changes only to second order. A force times a length; collective.
double potential_energy(const Model& model, const State& state, double load_factor);

/// Energy released between two equilibria, theory (66): work of loads, supports and eigenstrains along the straight
/// line between them, minus the change of the stored energy. Zero to third order in a step along a path. Collective.
double released_energy(const Model& model, const State& first, double first_load_factor, const State& second,
                       double second_load_factor);

}  // namespace mixbeam
