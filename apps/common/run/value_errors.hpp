/// Estimated errors of the numbers that a run gives: quantities, section forces, stresses.
#pragma once

#include "discretization/quantities/quantity_set.hpp"
#include "nonlinear/run/accurate_run.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Adds to the estimate of a step what it tells of `quantities` (null: none are asked for), whose values the record
/// has, and of stresses, if the record has them: their values less those in the richer space, theory (70). Collective.
void add_value_errors(const QuantitySet* quantities, const Simulation& simulation, const ErrorEstimate& estimate,
                      StepRecord& record);

/// Relative error of what Scene::accuracy_of names, a quantity or "stress", NaN where it is not estimated; empty where
/// the scene names nothing. Scene and quantities must outlive it. Collective.
AccurateRunObserver::ErrorOf error_of_wanted(const Scene& scene, const QuantitySet& quantities);

}  // namespace mixbeam
