/// Points whose motion and reactions a run follows as time series.
#pragma once

#include "discretization/quantities/quantity_set.hpp"
#include "discretization/results/stored_run.hpp"
#include "nonlinear/run/simulation.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Those that are held or loaded, the first hundred, in alphabetical order.
std::vector<std::string> followed_points(const Scene& scene);

/// Adds forces and moments of the supports among the followed points to what is monitored in a step and at its critical
/// points.
void follow_reactions(const std::vector<std::string>& points, StepRecord& record);

/// A stored run whose time series are damaged, with those computed from its states, bit for bit. `quantities`: of its
/// scene, null where none were asked for; `simulation`: of its scene; left at the last step. Collective.
StoredRun with_all_series(const StoredRun& run, const Scene& scene, const QuantitySet* quantities,
                          Simulation& simulation);

}  // namespace mixbeam
