/// The numbers that a run gives, quantities, section forces, stresses, in the present state of a simulation, and their
/// estimated errors.
#pragma once

#include "discretization/quantities/quantity_set.hpp"
#include "nonlinear/run/accurate_run.hpp"
#include "nonlinear/run/simulation.hpp"

#include <optional>
#include <string>
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

/// A state in a richer space.
struct RicherStates {
  RicherStates(const Simulation& simulation, const ErrorEstimate& estimate);

  std::vector<Simulation> states{};             ///< with the layers that no space sees, then without, if there are any
  std::vector<std::vector<EndLayer>> layers{};  ///< that count in each of them
  std::string not_estimated{};                  ///< why there are no states
};

/// `values`: of all columns of the set (NaN: not known); `richer`: what the set is to be evaluated in, one for each of
/// RicherStates::states, none: `not_estimated` tells why. Of the columns that are values, not places. Collective.
std::vector<EstimatedValue> with_errors(const QuantitySet& set, const std::vector<double>& values,
                                        const std::vector<QuantityState>& richer, const std::string& not_estimated);

/// The same of a simulation, to whose scene the set belongs.
std::vector<EstimatedValue> with_errors(const QuantitySet& set, const std::vector<double>& values,
                                        const Simulation& simulation, const RicherStates& richer);

/// Adds to the estimate of a step what it tells of `quantities` (null: none are asked for), whose values the record
/// has, and of stresses, if the record has them: their values less those in the richer space, theory (70). Collective.
void add_value_errors(const QuantitySet* quantities, const Simulation& simulation, const ErrorEstimate& estimate,
                      StepRecord& record);

/// Whether Scene::accuracy_of names motions of points, forces of supports, or what is made of the former: numbers of
/// vertices, see start_mesh().
bool wants_vertices(const Scene& scene, const QuantitySet& quantities);

/// Lets what Scene::accuracy_of names, a quantity or "stress", count in place of displacements: its relative error, NaN
/// where it is not estimated, and the shares of members in it. Nothing where the scene names nothing. Scene and
/// quantities must outlive the observer, whose functions are collective.
void judge_wanted(const Scene& scene, const QuantitySet& quantities, AccurateRunObserver& observer);

}  // namespace mixbeam
