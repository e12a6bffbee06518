/// Refuses runs that do not fit into memory or disk, before anything large is allocated or written.
#pragma once

#include "apps/common/run/application.hpp"
#include "nonlinear/run/needs.hpp"

namespace mixbeam {

/// Memory and disk that a run of the scene needs, with its quantities.
Needs needs_of_run(const Application& app, const Scene& scene, const SolverParameters& parameters);

/// Throws InputError with the needed and the available memory if a run does not fit, unless Application::force. If
/// `file` is given, checks the disk too, for two copies of the result file, which exist while it is written. Costs
/// nothing for small scenes. Collective.
void require_room(const Application& app, const Scene& scene, const SolverParameters& parameters,
                  const std::filesystem::path& file = {});

/// Likewise for memory only, with known needs.
void require_memory(const Application& app, const Scene& scene, const Needs& needs);

/// Likewise for `bytes` of anything else, of all `ranks` together (null: those of the application); `what`: "the scenes
/// of 5000000 cases".
void require_memory(const Application& app, double bytes, const std::string& what, Communicator ranks = {});

}  // namespace mixbeam
