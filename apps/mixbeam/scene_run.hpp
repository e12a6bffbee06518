/// What `run` and `resume` share: solving one case of a scene with its record, report and checks.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/common/session/command_line.hpp"

namespace mixbeam {

/// Whether the run came to its end.
enum class RunEnd { arrived, interrupted };

/// Why the runs of a program with this scene cannot be resumed, empty if they can.
std::string obstacle_to_resuming(const Application& app);

/// Where the file system of a result file has no locks.
void warn_without_lock(Application& app, const SharedResultLock& lock);

/// Takes the lock of a result file, and warns where its file system has none. Throws ResultFileError when another run
/// holds it. Collective.
SharedResultLock lock_or_warn(Application& app, const std::filesystem::path& file);

/// Load cases and combinations of a scene, [""] where it has none, or the one of the option --case. Throws InputError.
std::vector<std::string> chosen_cases(const Scene& scene, const std::optional<std::string>& wanted);

/// What a result file records of the case of its scene.
std::map<std::string, std::string> properties_of_case(const std::string& load_case);

/// Solves the scene of one case (an empty name: what acts in all cases) into `file` (none where that is empty), or goes
/// on with `resume`, and prints what came out.
RunEnd run_case(Application& app, const std::string& load_case, const std::filesystem::path& file,
                const WritingOptions& writing, const StoredRun* resume = nullptr);

/// `results/scene.h5` of `results`, "scene" and no case; `results/scene-wind.h5` with the case "wind".
std::filesystem::path result_file_of(const std::filesystem::path& folder, const std::string& name,
                                     const std::string& load_case);

/// Largest and smallest values of the quantities in the summary at the ends of several runs: one row for each quantity
/// in `file`, an HDF5 file with the value of every run, and in a CSV file beside it, a table on the terminal, and in
/// the summary. Nothing where fewer than two runs have any. Throws as CsvTable and write_table_file.
void write_envelope(Application& app, const std::filesystem::path& file);

/// The same after one run of several: those of the others come from their files. Where a file is missing, of another
/// scene or of a run that has not ended, an envelope that is there stays, with a warning. Not of paths with a
/// controlled displacement, of which a file does not record whether they are complete.
void renew_envelope(Application& app, const std::filesystem::path& file);

/// Closing line, summary file and exit code of a program that ran `cases` and returns whether all of them arrived.
int finish_runs(Application& app, const CommandLine& line, const std::function<RunEnd()>& cases);

/// Reactions must balance the loads in every run. Newton's method ends at a scaled residual of 1e-11 in each row, and
/// the sums run over the rows of all elements: what is left there adds up like a random walk, the rounding errors of
/// the sums with their number. Along a member in tension what is left points to one side, and adds up to as many times
/// the `residual` of the step as it has elements. `levers`: rounding_of_levers().
double balance_tolerance(double elements, double of_longest_member, double residual, double levers);
/// Rounding of the coordinates of a scene over its size: what moments about its middle are uncertain by.
double rounding_of_levers(const Scene& scene);

/// What an unstable end is.
inline constexpr const char* kDoesNotStay = "a real structure does not stay there";

}  // namespace mixbeam
