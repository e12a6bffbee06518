/// Points whose motion and reactions a run records as time series.
#pragma once

#include "discretization/quantities/quantity_set.hpp"
#include "discretization/results/stored_run.hpp"
#include "nonlinear/run/simulation.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Returns the loaded and the supported points, at most a hundred, sorted by name.
std::vector<std::string> followed_points(const Scene& scene);

/// Adds forces and moments of the supports among the followed points to the time series of a step and its critical
/// points.
void follow_reactions(const std::vector<std::string>& points, StepRecord& record);

/// Returns a stored run with damaged time series recomputed from its states, bit for bit. `quantities`: of the scene,
/// null if it has none; `simulation`: of the scene, ends in the state of the last step. Collective.
StoredRun with_all_series(const StoredRun& run, const Scene& scene, const QuantitySet* quantities,
                          Simulation& simulation);

}  // namespace mixbeam
