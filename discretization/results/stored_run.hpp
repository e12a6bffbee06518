/// A result file read back, from which a run is resumed. Layout: apps/docs/results.md.
#pragma once

#include "discretization/state/member_samples.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// Data of a result file about the run as a whole.
struct ResultHeader {
  std::string scene_name;
  std::string scene_xml;                          ///< the input, word for word
  std::string version;                            ///< of the program
  std::map<std::string, std::string> properties;  ///< compiler, threads, ranks, ...
  std::vector<std::string> quantities{};          ///< names of the columns of the series of that name
  std::vector<std::string> quantity_units{};      ///< of these columns, where the scene names units
  std::map<std::string, std::string> imported{};  ///< text of every file that the input names, by that name

  /// Empty if there is none of this name.
  std::string property(const std::string& name) const {
    const auto found = properties.find(name);
    return found == properties.end() ? "" : found->second;
  }
};

/// A quantity followed over the completed steps.
struct MonitoredSeries {
  std::string name{};
  std::size_t columns = 1;
  std::vector<double> values{};  ///< step after step
};

/// Keeps no file open. Whatever is read has been checked against the seal of the file.
class StoredRun {
 public:
  /// `last_step`: ignores steps after it; if the time series cannot be read then, has_all_series() is false and those
  /// of every run come from the steps. Throws InputError if `path` is not a readable result file of this program, is of
  /// a version that kept no states, or has a format newer than this program.
  explicit StoredRun(const std::filesystem::path& path, std::optional<int> last_step = {});

  const std::filesystem::path& path() const { return path_; }
  const ResultHeader& header() const { return header_; }
  const std::vector<PathPoint>& steps() const { return steps_; }
  const std::vector<MonitoredSeries>& monitor() const { return monitor_; }
  /// Whether a last step was chosen: the rest of the file does not count, and may be damaged.
  bool drops_the_rest() const { return drops_the_rest_; }
  bool has_all_series() const { return has_all_series_; }
  /// Completes the series that are missing, one row for each of steps().
  void complete(const std::vector<MonitoredSeries>& series);
  const std::vector<SampledMember>& members() const { return members_; }
  /// Names and sizes of monitored quantities, and the number of the last step; no values.
  const StepSummary& layout() const { return layout_; }

  /// Stability of each of steps(); "unknown" in files of versions that did not record it.
  const std::vector<RecordedStability>& stability() const { return stability_; }
  /// Natural modes of each of steps(), without fields at samples.
  const std::vector<std::vector<RecordedVibrationMode>>& vibration() const { return vibration_; }
  /// State of the step at this position in steps().
  StateSnapshot state(std::size_t position) const;

  /// Critical points between the step before and the one at this position, with their states; without fields at samples
  /// and monitored quantities.
  std::vector<RecordedCriticalPoint> critical_points(std::size_t position) const;
  /// Jump that led to a step, if any.
  std::optional<RecordedJump> jump(std::size_t position) const;

 private:
  std::filesystem::path path_;
  ResultHeader header_;
  std::vector<std::string> groups_;
  std::vector<PathPoint> steps_;
  std::vector<RecordedStability> stability_;
  std::vector<std::vector<RecordedVibrationMode>> vibration_;
  std::vector<MonitoredSeries> monitor_;
  bool drops_the_rest_ = false, has_all_series_ = true;
  std::vector<SampledMember> members_;
  StepSummary layout_;
};

/// Integrity of a result file.
struct FileReport {
  bool is_sealed = false;  ///< false: of a version without checksums, known only to be readable
  std::vector<int> steps{};
  std::string damage{};  ///< empty: none; else the bytes, and the objects that lie in them
  std::optional<int> last_whole_step{};
};

/// Reads all of a result file. The HDF5 library sees no damaged bytes, except in files without a seal: with those it
/// may crash. Throws InputError, like StoredRun, if there is nothing to read.
FileReport verify_results(const std::filesystem::path& path);

}  // namespace mixbeam
