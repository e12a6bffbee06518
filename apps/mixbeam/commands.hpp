/// The subcommands of `mixbeam`. Each takes what follows its own name on the command line and returns the exit code.
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

/// Throws InputError where a command is given another file than it draws: the table of a batch, a scene.
void require_run(const std::string& command, const std::filesystem::path& file);

/// Runs `mixbeam verify` on a result file, up to a step where one is given, so that a file on which the HDF5 library
/// crashes ends that process and not this one. Throws InputError, which says what is damaged. For programs that have
/// not started MPI or threads yet; of several ranks the first does it.
void require_whole(const std::filesystem::path& results, std::optional<int> last_step = {});

/// Whether this is the only process or the first rank, also before MPI starts.
bool is_first_process();

/// Where a process works and writes; empty: as this one does.
struct ProcessPlaces {
  std::string folder{}, out{}, err{};
};
/// Exit code of a program, -1 when it cannot be started or is killed.
int exit_code_of(std::vector<std::string> words, const ProcessPlaces& places = {});

/// Folder of the scripts and of the parts of pages: beside the program in a build folder, in the package for Python
/// where it is installed.
std::filesystem::path plots_folder();

/// Help on the whole program, or on one subcommand; empty when there is none of that name.
std::string help_text(const std::string& command = "");

/// What `check` prints of a scene that was read, of one load case or all. Throws InputError.
void check_scene(Application& app, const std::optional<std::string>& load_case);

/// Writes the undeformed structure of each load case, or of one, as <folder>/<name>[-<case>].h5 for pictures: results
/// of no step. Also of a scene that a run refuses, as far as it can be drawn. `read`: gives the parsed scene, more than
/// once. Throws InputError where nothing can be drawn.
void write_undeformed(const std::function<XmlParameters()>& read, const Communicator& communicator,
                      const std::filesystem::path& folder, const std::string& name,
                      const std::optional<std::string>& load_case);

/// Defines the lists that mixbeam accepts in a scene file: those of the benchmark programs included.
const ApplicationDefinition& mixbeam_definition();
/// Declaration of its scene files; made once.
const ListSpec& mixbeam_root_spec();

}  // namespace mixbeam
