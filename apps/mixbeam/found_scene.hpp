/// Scenes with the lists "Identification", "Design" or "Inverse": their results as files, and the scene with them.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// If the scene has "Identification" or "Design", finds and reports its numbers and replaces the scene by one with
/// them, whose run is compared with the found equilibrium. `stem`: of the files beside the results,
/// "results/scene/scene"; empty: writes none. False: interrupted. Throws InputError, and ConvergenceError after writing
/// the best numbers.
bool take_found_numbers(Application& app, const std::filesystem::path& stem);

/// Throws InputError if the scene has a search; for programs that solve scenes as they stand.
void refuse_search(const Application& app);

/// If the scene has the list "Inverse", finds the rest shape, writes its tables, natural curves and the scene with them
/// to the result folder, under names that begin with `name`, and replaces the scene by it. `jobs`: processes that read
/// the scene; only one may write. Throws InputError and ConvergenceError.
void take_rest_shape(Application& app, const std::string& name, int jobs);

/// Copies imported tables beside a scene derived from the first, under the same names. `list`: the list that needs
/// them, for messages. Throws InputError.
void copy_imported(const ParameterSource& source, const std::filesystem::path& folder, const std::string& list);

/// Throws InputError if the scene has the list "Inverse"; for programs that solve scenes as they stand.
void refuse_rest_shape(const Application& app);

}  // namespace mixbeam
