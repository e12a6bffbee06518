/// The layout of a result file: every group, attribute and small dataset, written and read side by side. The large
/// datasets are in result_tables.hpp. Meaning of the names: apps/docs/results.md.
#pragma once

#include "discretization/results/hdf5_writer.hpp"
#include "discretization/results/stored_run.hpp"
#include "discretization/state/member_samples.hpp"
#include "discretization/text/errors.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// 2: first with states to resume from; 3: sealed (seal.hpp); 4: one table of all members, not a group for each.
inline constexpr int kFirstFormatWithStates = 2, kFirstSealedFormat = 3, kFormatVersion = 4;

/// Writes lines as one text; nothing if there are none.
void write_lines(hid_t group, const std::string& name, const std::vector<std::string>& lines);

/// Begins an empty file.
void write_header(hid_t file, const ResultHeader& header);
/// Throws InputError unless there is a file of this name that may hold results.
void require_result_file(const std::filesystem::path& path);
/// Runs an action that reads a result file; failures become an InputError that names the file, with the `suspected`
/// cause if the library refuses.
template <class Action>
auto naming_file(const std::filesystem::path& path, const Action& action, const std::string& suspected = "") {
  const auto named = [&](const std::string& problem) { return InputError(path.string() + ": " + problem); };
  try {
    return action();
  } catch (const DiskError& error) {
    throw named(error.what());
  } catch (const DamageError& error) {
    throw named(std::string("damaged: ") + error.what());
  } catch (const hdf5::Error& error) {
    throw named(suspected + error.what());
  }
}
/// Whether a file holds the results of a run, and not a table.
bool holds_run(hid_t file);
/// Throws InputError with `name`, that of the file, unless it is a result file of a format that this program knows,
/// with a seal if its format has one.
void require_known_format(hid_t file, const std::string& name, bool is_sealed);
ResultHeader read_header(hid_t file);

void write_members(hid_t file, const SampledMembers& members);
/// Names and numbers of samples, of files of all formats; order and elements from format 4 on.
std::vector<SampledMember> read_members(hid_t file);

void write_supports(hid_t file, const std::vector<RecordedReaction>& reactions);
void write_acting(hid_t file, const Acting& acting);

/// Table of natural frequencies over the path, a column for each motion.
inline constexpr const char* kFrequencies = "frequencies";
/// Adds a row to it, of a step that has modes.
void append_frequencies(hid_t file, int step, double load_factor, const std::vector<RecordedVibrationMode>& modes);

/// Writes all of a step except its tables.
void write_step(hid_t file, const StepRecord& record);
/// Names of the groups of all steps, in their order.
std::vector<std::string> step_groups(hid_t file);
/// Reads the group of that name.
PathPoint read_point(hid_t step, const std::string& name);
RecordedStability read_stability(hid_t step);
std::optional<RecordedJump> read_jump(hid_t step);
/// Reads natural modes without fields at samples.
std::vector<RecordedVibrationMode> read_vibration(hid_t step);
/// Reads the state of a step or a critical point.
StateSnapshot read_state(hid_t group);
/// Reads critical points without fields at samples and monitored quantities.
std::vector<RecordedCriticalPoint> read_critical_points(hid_t step);

std::vector<MonitoredSeries> read_monitor(hid_t file);
/// The time series that every run has, from these steps.
std::vector<MonitoredSeries> own_time_series(hid_t file, const std::vector<std::string>& groups);

/// Copies everything except steps after the first `steps` from one file to an empty one, in the current format.
/// `monitor`: the time series of at least so many steps.
void copy_steps(hid_t source, hid_t target, std::size_t steps, const std::vector<MonitoredSeries>& monitor);

}  // namespace mixbeam
