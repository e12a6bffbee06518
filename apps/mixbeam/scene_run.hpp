/// Common parts of `run` and `resume`: solving one case of a scene, its result file, report and checks.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/common/session/command_line.hpp"

namespace mixbeam {

/// Whether the run was completed.
enum class RunEnd { arrived, interrupted };

/// Reason why runs with this scene cannot be resumed; empty if they can.
std::string obstacle_to_resuming(const Application& app);

/// Warns if the file system of a result file has no locks.
void warn_without_lock(Application& app, const SharedResultLock& lock);

/// Takes the lock of a result file, and warns where its file system has none. Throws ResultFileError when another run
/// holds it. Collective.
SharedResultLock lock_or_warn(Application& app, const std::filesystem::path& file);

/// Load cases and combinations of a scene, [""] if it has none, or only the one of option --case. Throws InputError.
std::vector<std::string> chosen_cases(const Scene& scene, const std::optional<std::string>& wanted);

/// Properties of a result file that identify the load case.
std::map<std::string, std::string> properties_of_case(const std::string& load_case);

/// Solves one case (empty name: what acts in all cases) into `file` (empty: none), or continues `resume`, and prints
/// the results.
RunEnd run_case(Application& app, const std::string& load_case, const std::filesystem::path& file,
                const WritingOptions& writing, const StoredRun* resume = nullptr);

/// `results/scene.h5` for `results`, "scene" and no case; `results/scene-wind.h5` for the case "wind".
std::filesystem::path result_file_of(const std::filesystem::path& folder, const std::string& name,
                                     const std::string& load_case);

/// Writes largest and smallest values of the quantities at the ends of several runs: to the summary, the terminal, a
/// CSV file and the HDF5 file `file`, which also holds the values of each run. Does nothing if fewer than two runs have
/// any. Throws as CsvTable and write_table_file.
void write_envelope(Application& app, const std::filesystem::path& file);

/// Likewise after one run of several, with the others read from their files. If a file is missing, of another scene or
/// incomplete, an existing envelope stays, with a warning. Not for displacement control, since a file does not record
/// whether such a path is complete.
void renew_envelope(Application& app, const std::filesystem::path& file);

/// Runs `cases`, then prints the closing line, writes the summary file and returns the exit code.
int finish_runs(Application& app, const CommandLine& line, const std::function<RunEnd()>& cases);

/// Tolerance of the balance of loads and reactions. Newton's method ends at a scaled residual of 1e-11 per row. In the
/// sums over all elements these residuals add up like a random walk, rounding errors in proportion to their number.
/// Along a member in tension the residuals have one direction and add up to the `residual` of the step times its number
/// of elements. `levers`: rounding_of_levers().
double balance_tolerance(double elements, double of_longest_member, double residual, double levers);
/// Rounding of the coordinates of a scene relative to its size: the uncertainty of moments about its centre.
double rounding_of_levers(const Scene& scene);

/// Explanation of an unstable end.
inline constexpr const char* kDoesNotStay = "a real structure does not stay there";

}  // namespace mixbeam
