/// Scenes with the lists "Identification" or "Design": their numbers as files, and the scene that has them.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Where the scene has one of the lists: finds its numbers, reports them, and reads the scene with them in place of the
/// first one, whose runs are compared with what was found. `stem`: of the files beside the results,
/// "results/scene/scene"; empty: none are written. False: interrupted. Throws InputError and, after the files with the
/// best numbers were written, ConvergenceError.
bool take_found_numbers(Application& app, const std::filesystem::path& stem);

/// Of programs that solve a scene as it stands. Throws InputError.
void refuse_search(const Application& app);

}  // namespace mixbeam
