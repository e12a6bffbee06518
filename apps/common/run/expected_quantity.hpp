/// Evaluation of quantities in the present state of a simulation.
#pragma once

#include "discretization/quantities/quantity_set.hpp"
#include "nonlinear/run/simulation.hpp"

#include <optional>
#include <vector>

namespace mixbeam {

/// Every number of a set that was made for the scene of the simulation. Collective.
std::vector<double> values_of(const QuantitySet& quantities, const Simulation& simulation);
/// Where extremes over places are, see QuantitySet::places().
std::vector<std::string> places_of(const QuantitySet& quantities, const Simulation& simulation);

/// The same in a state that is being recorded: what the record knows is not computed again. Collective.
std::vector<double> values_of(const QuantitySet& quantities, const Simulation& simulation, const StepRecord& record);

/// What the checks compare; none for a quantity of the application's own. `asked`: the list "Quantities" of the scene.
/// Collective.
std::vector<std::optional<double>> present_values(const Simulation& simulation,
                                                  const std::vector<ExpectedValue>& wanted,
                                                  const QuantitySet& asked = {});
std::optional<double> present_value(const Simulation& simulation, const ExpectedValue& wanted);

}  // namespace mixbeam
