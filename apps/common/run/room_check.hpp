/// Refuses what does not fit before anything large is allocated or written.
#pragma once

#include "apps/common/run/application.hpp"
#include "nonlinear/run/needs.hpp"

namespace mixbeam {

/// What a run of the scene takes with the quantities that are asked of it.
Needs needs_of_run(const Application& app, const Scene& scene, const SolverParameters& parameters);

/// Throws InputError with what a run of the scene needs and what is there, unless Application::force. Costs nothing
/// for small scenes. Collective.
void require_memory(const Application& app, const Scene& scene, const SolverParameters& parameters);

/// Likewise for `bytes` that something else needs; `what`: "the scenes of 5000000 cases".
void require_memory(const Application& app, double bytes, const std::string& what);

/// The same for the disk of a result file, of which there are two copies while it is written. Collective.
void require_disk(const Application& app, const Scene& scene, const SolverParameters& parameters,
                  const std::filesystem::path& file);

}  // namespace mixbeam
