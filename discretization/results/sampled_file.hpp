/// A result file for pictures: fields at the samples of all members, read on demand. Also for a structure that is not
/// solved, whose file has no state to resume from.
#pragma once

#include "discretization/results/stored_run.hpp"
#include "discretization/state/acting.hpp"

#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

/// A step of the path.
struct SampledStep {
  std::string group{};  ///< its path in the file
  int number = 0;
  double load_factor = 0.0;
  std::string stable{};
};

/// Holds the file open. All members throw InputError, which names the file, for content that no run writes.
class SampledFile {
 public:
  explicit SampledFile(const std::filesystem::path& path);
  ~SampledFile();
  SampledFile(const SampledFile&) = delete;
  SampledFile& operator=(const SampledFile&) = delete;

  const ResultHeader& header() const { return header_; }
  const std::vector<SampledMember>& members() const { return members_; }
  const Acting& acting() const { return acting_; }
  const std::vector<SampledStep>& steps() const { return steps_; }
  const std::vector<MonitoredSeries>& monitor() const { return monitor_; }
  std::size_t samples() const { return samples_; }

  /// Arc lengths of all samples.
  std::vector<double> arc_lengths() const;
  bool has(const std::string& group, const std::string& name) const;
  /// Number of groups 0, 1, ... in a group of that name; 0 if it is missing.
  std::size_t count(const std::string& group, const std::string& name) const;
  /// A field: rows of numbers, one for each sample.
  std::vector<double> field(const std::string& group, const std::string& name) const;
  /// Numbers of a dataset of rows.
  std::vector<double> numbers(const std::string& group, const std::string& name, std::size_t columns = 1) const;
  double number(const std::string& group, const std::string& attribute) const;
  std::string word(const std::string& group, const std::string& attribute) const;

 private:
  struct Held;
  /// Calls read(group) with the group of that path.
  template <class Read>
  auto reading(const std::string& group, const Read& read) const;

  std::filesystem::path path_;
  std::unique_ptr<Held> held_;
  ResultHeader header_{};
  std::vector<SampledMember> members_{};
  Acting acting_{};
  std::vector<SampledStep> steps_{};
  std::vector<MonitoredSeries> monitor_{};
  std::size_t samples_ = 0;
};

/// Runs over which a file holds the largest and smallest quantities (such a file is not of one run); else empty. Throws
/// like SampledFile.
std::vector<std::filesystem::path> runs_of_envelope(const std::filesystem::path& path);

}  // namespace mixbeam
