/// The subcommands of `mixbeam`. Each takes the command line from its name on and returns the exit code.
#pragma once

#include "apps/common/run/application.hpp"

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// The command line from the subcommand on: arguments.values[0] is its name.
struct Arguments {
  std::vector<const char*> values;
  int count() const { return static_cast<int>(values.size()); }
};

int run_command(const Arguments& arguments);
int check_command(const Arguments& arguments);
int parameters_command(const Arguments& arguments);
int schema_command(const Arguments& arguments);
int convert_command(const Arguments& arguments);
int batch_command(const Arguments& arguments);
int resume_command(const Arguments& arguments);
int plot_command(const Arguments& arguments);
int report_command(const Arguments& arguments);
int view_command(const Arguments& arguments);
int verify_command(const Arguments& arguments);

/// Throws InputError if the command cannot draw the file: the table of a batch, a scene.
void require_run(const std::string& command, const std::filesystem::path& file);

/// Runs `mixbeam verify` on a result file, or on its steps up to `last_step`, in another process, since the HDF5
/// library may crash on damaged files. Throws InputError with the damage. Call it before MPI and threads start; only
/// the first rank acts.
void require_whole(const std::filesystem::path& results, std::optional<int> last_step = {});

/// Whether this is the only process or the first rank, also before MPI starts.
bool is_first_process();

/// Working folder and output files of a process; empty: those of this one.
struct ProcessPlaces {
  std::string folder{}, out{}, err{};
};
/// Runs a program. Returns its exit code, -1 if it cannot be started or is killed.
int exit_code_of(std::vector<std::string> words, const ProcessPlaces& places = {});

/// Folder of the scripts and page parts: beside the program in a build folder, in the Python package if installed.
std::filesystem::path plots_folder();

/// Help on the program or a subcommand; empty if there is no such subcommand.
std::string help_text(const std::string& command = "");

/// Prints the output of `check` for a scene, one load case or all. Throws InputError.
void check_scene(Application& app, const std::optional<std::string>& load_case);

/// Writes the undeformed structure of each load case, or of one, as result files <folder>/<name>[-<case>].h5 for
/// pictures. Draws what it can of a scene that a run refuses. `read`: returns the parsed scene, called repeatedly.
/// Throws InputError if nothing can be drawn.
void write_undeformed(const std::function<XmlParameters()>& read, const Communicator& communicator,
                      const std::filesystem::path& folder, const std::string& name,
                      const std::optional<std::string>& load_case);

/// Defines the lists that mixbeam accepts in a scene file: those of the benchmark programs included.
const ApplicationDefinition& mixbeam_definition();
/// Declaration of its scene files; created once.
const ListSpec& mixbeam_root_spec();

}  // namespace mixbeam
