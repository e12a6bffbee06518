/// Reading a scene file into an application, and the places where it writes.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/common/session/command_line.hpp"
#include "discretization/text/errors.hpp"

namespace mixbeam {

/// Declaration of everything below the root of an application's scene file.
ListSpec root_spec(const ApplicationDefinition& definition);

/// Fills in scene, solver parameters and expected values from the parsed file, and the texts of the files that it names
/// unless its source has them already. Warns of parameters that no longer exist. Throws InputError with file, line and
/// XML path. `root`: root_spec() of the definition, which a host of thousands of scenes makes once.
void read_scene_file(Application& app, XmlParameters xml, const ApplicationDefinition& definition,
                     const ListSpec& root);

/// The same for a file, in XML or YAML.
void read_scene_file(Application& app, const std::string& file, const ApplicationDefinition& definition);

/// Prints what is unusual in the scene, and counts it in the summary.
void warn_of_scene(Application& app);

/// The error with file, line and XML path of the member.
InputError placed(const Application& app, const MemberError& error);

/// Name, version, compiler, ranks, threads. `threads`: of the command line, overrides the scene.
void describe_run(Application& app, const std::string& name, const std::optional<int>& threads);

/// Makes the folder; throws InputError when that fails or nothing can be written there.
void prepare_output_folder(const std::filesystem::path& folder);

/// Finds out before the run, not after it, whether the summary can be written; removes the one of an earlier run, which
/// a script might otherwise take for that of a run that failed. Keeps its lock as long as the application lives. Throws
/// InputError, also when another run writes there. Collective.
void prepare_summary(Application& app, const std::filesystem::path& file);

/// What a program does first with its command line: prepare_summary(), the scene, describe_run().
void set_up_run(Application& app, const CommandLine& line, const std::string& file,
                const ApplicationDefinition& definition);

/// After it: `compute`, then the summary with the total time and its file, also where no equilibrium was found
/// (ConvergenceError, which is passed on); prints the checks. Returns "0.123 s".
std::string compute_with_summary(Application& app, const CommandLine& line, const std::function<void()>& compute);

/// Before a run: throws InputError for an expected value of these load cases ("": of a scene without any) at whose load
/// factor no step will end.
void require_reachable(const Application& app, const std::vector<std::string>& cases = {""});

/// After a run that arrived: what it did not compare, such as a value at a critical point that did not come, is a
/// failed check.
void fail_what_was_missed(Application& app, const std::vector<std::string>& cases = {""});

}  // namespace mixbeam
