/// Reading a scene file into an application; output folder and summary file.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/common/session/command_line.hpp"
#include "discretization/text/errors.hpp"

namespace mixbeam {

/// Declaration of everything below the root of an application's scene file.
ListSpec root_spec(const ApplicationDefinition& definition);

/// Fills in scene, solver parameters and expected values from the parsed file, and the texts of the files that it names
/// unless its source has them already. Warns of parameters that no longer exist. Throws InputError with file, line and
/// XML path. `root`: root_spec() of the definition, made once for many scenes.
void read_scene_file(Application& app, XmlParameters xml, const ApplicationDefinition& definition,
                     const ListSpec& root);

/// Likewise from a file in XML or YAML.
void read_scene_file(Application& app, const std::string& file, const ApplicationDefinition& definition);

/// Prints warnings about the scene and adds them to the summary.
void warn_of_scene(Application& app);

/// Returns the error with file, line and XML path of the member.
InputError placed(const Application& app, const MemberError& error);

/// Sets name, version, compiler, ranks, threads in the summary. `threads`: of the command line, overrides the scene.
void describe_run(Application& app, const std::string& name, const std::optional<int>& threads);

/// Creates the folder; throws InputError if that fails or the folder is not writable.
void prepare_output_folder(const std::filesystem::path& folder);

/// Checks before the run that the summary can be written; removes that of an earlier run, which a script might take for
/// the one of a failed run. Holds its lock for the lifetime of the application. Throws InputError, also when another
/// run writes there. Collective.
void prepare_summary(Application& app, const std::filesystem::path& file);

/// Begins a program: prepare_summary(), reads the scene, describe_run().
void set_up_run(Application& app, const CommandLine& line, const std::string& file,
                const ApplicationDefinition& definition);

/// Calls `compute`, then adds the total time and writes the summary, also after ConvergenceError, which is rethrown;
/// prints the checks. Returns "0.123 s".
std::string compute_with_summary(Application& app, const CommandLine& line, const std::function<void()>& compute);

/// Throws InputError if no step will end at the load factor of an expected value of these load cases ("": a scene
/// without load cases).
void require_reachable(const Application& app, const std::vector<std::string>& cases = {""});

/// After a completed run, counts expected values that were not compared as failed, such as those at a missing critical
/// point.
void fail_what_was_missed(Application& app, const std::vector<std::string>& cases = {""});

}  // namespace mixbeam
