/// Values of quantities, section forces and stresses in the current state of a simulation, and their estimated errors.
#pragma once

#include "discretization/quantities/quantity_set.hpp"
#include "nonlinear/run/accurate_run.hpp"
#include "nonlinear/run/simulation.hpp"

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// Values of all columns of a set that belongs to the scene of the simulation. Collective.
std::vector<double> values_of(const QuantitySet& quantities, const Simulation& simulation);
/// Places of extremes, see QuantitySet::places().
std::vector<std::string> places_of(const QuantitySet& quantities, const Simulation& simulation);

/// Values in a state that is being recorded; values in the record are not computed again. Collective.
std::vector<double> values_of(const QuantitySet& quantities, const Simulation& simulation, const StepRecord& record);

/// Values to compare with the expected ones; none for a quantity of the application's own. `asked`: the list
/// "Quantities" of the scene. Collective.
std::vector<std::optional<double>> present_values(const Simulation& simulation,
                                                  const std::vector<ExpectedValue>& wanted,
                                                  const QuantitySet& asked = {});
std::optional<double> present_value(const Simulation& simulation, const ExpectedValue& wanted);

/// The current state, improved in richer spaces for error estimates.
struct RicherStates {
  RicherStates(const Simulation& simulation, const ErrorEstimate& estimate);

  std::vector<Simulation> states{};             ///< with the end layers that no space resolves; then without
  std::vector<std::vector<EndLayer>> layers{};  ///< end layers included in each state
  std::string not_estimated{};                  ///< why there are no states
};

/// Estimates errors of columns that are values, not places. `values`: all columns (NaN: unknown); `richer`: where to
/// evaluate the set, one for each of RicherStates::states; empty: `not_estimated` says why. Collective.
std::vector<EstimatedValue> with_errors(const QuantitySet& set, const std::vector<double>& values,
                                        const std::vector<QuantityState>& richer, const std::string& not_estimated);

/// Likewise for a simulation to whose scene the set belongs.
std::vector<EstimatedValue> with_errors(const QuantitySet& set, const std::vector<double>& values,
                                        const Simulation& simulation, const RicherStates& richer);

/// Adds the errors of `quantities` (null: none), whose values are in the record, and of recorded stresses to the
/// estimate of a step: their values minus those in the richer space, theory (70). Collective.
void add_value_errors(const QuantitySet* quantities, const Simulation& simulation, const ErrorEstimate& estimate,
                      StepRecord& record);

/// Whether Scene::accuracy_of names motions of points, functions of these, or support forces: values at vertices, see
/// start_mesh().
bool wants_vertices(const Scene& scene, const QuantitySet& quantities);

/// Makes the quantity (or "stress") named by Scene::accuracy_of replace displacements as the criterion: its relative
/// error, NaN if not estimated, and the shares of members in it. No effect if the scene names nothing. Scene and
/// quantities must outlive the observer, whose functions are collective.
void judge_wanted(const Scene& scene, const QuantitySet& quantities, AccurateRunObserver& observer);

}  // namespace mixbeam
