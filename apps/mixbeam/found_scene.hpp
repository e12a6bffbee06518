/// Scenes with the lists "Identification", "Design" or "Inverse": what these find, as files, and the scene that has it.
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

/// Where the scene has the list "Inverse": finds the rest shape, writes its tables, the natural curves and the scene
/// with them to the folder of the results, under names that begin with `name`, and reads that scene in place of the
/// first one. `jobs`: processes that read the scene, of which one alone may write. Throws InputError and
/// ConvergenceError.
void take_rest_shape(Application& app, const std::string& name, int jobs);

/// Tables that a scene imports, beside a scene that is made of it, under the same names. `list`: why they are needed,
/// for messages. Throws InputError.
void copy_imported(const ParameterSource& source, const std::filesystem::path& folder, const std::string& list);

/// Of programs that solve a scene as it stands. Throws InputError where it has the list "Inverse".
void refuse_rest_shape(const Application& app);

}  // namespace mixbeam
