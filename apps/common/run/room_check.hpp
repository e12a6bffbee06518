/// Refuses what does not fit before anything large is allocated or written.
#pragma once

#include "apps/common/run/application.hpp"
#include "nonlinear/run/needs.hpp"

namespace mixbeam {

/// What a run of the scene takes with the quantities that are asked of it.
Needs needs_of_run(const Application& app, const Scene& scene, const SolverParameters& parameters);

/// Throws InputError with what a run of the scene needs and what is there, unless Application::force: memory, and where
/// `file` is given the disk of a result file, of which there are two copies while it is written. Costs nothing for
/// small scenes. Collective.
void require_room(const Application& app, const Scene& scene, const SolverParameters& parameters,
                  const std::filesystem::path& file = {});

/// Likewise for memory alone, where the needs are known.
void require_memory(const Application& app, const Scene& scene, const Needs& needs);

/// Likewise for `bytes` that something else needs; `what`: "the scenes of 5000000 cases".
void require_memory(const Application& app, double bytes, const std::string& what);

}  // namespace mixbeam
