/// The potential of a structure under its loads: what stable equilibria are minima of.
#pragma once

#include "discretization/assembly/model.hpp"

namespace mixbeam {

/// Theory (65): stored energy of elements and springs less the work of dead forces, all of them as at a load factor.
/// Moments and follower loads have no potential and are left out. Where the interiors of elements are not in
/// equilibrium, the value of the mixed functional, which their equilibrium changes to second order alone. A force times
/// a length; collective.
double potential_energy(const Model& model, const State& state, double load_factor);

/// Energy released between two equilibria, theory (66): the work that loads, supports and eigenstrains do on a straight
/// way from one to the other, less what the structure stores of it. Zero to third order in a step along a path.
/// Collective.
double released_energy(const Model& model, const State& first, double first_load_factor, const State& second,
                       double second_load_factor);

}  // namespace mixbeam
