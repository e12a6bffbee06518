/// The result file of a run: HDF5 for programs, with an XDMF description beside it for ParaView and VisIt.
///
/// Layout: apps/docs/results.md. Contents and names of a record: state/record_fields.hpp.
///
/// A run may be killed at any moment: see published_file.hpp.
///
/// Rank 0 alone calls the HDF5 library. It reserves room for the large datasets, closes the file and shares the places
/// of their numbers; then each rank writes its rows there by plain system calls, so that neither samples nor states are
/// sent. Finally rank 0 seals the file (seal.hpp): the bytes are the same for any number of ranks.
#pragma once

#include "discretization/results/disk_file.hpp"
#include "discretization/results/published_file.hpp"
#include "discretization/results/rank_agreement.hpp"
#include "discretization/results/result_lock.hpp"
#include "discretization/results/result_tables.hpp"
#include "discretization/results/stored_run.hpp"
#include "discretization/state/member_samples.hpp"

#include <filesystem>
#include <functional>
#include <vector>

namespace mixbeam {

/// How a result file is written.
struct WritingOptions {
  SharedResultLock lock{};  ///< of the file, where the caller holds it already
  /// Each step waits until it is on the disk before it is published, so that a power cut loses none. Otherwise only
  /// steps that take long enough do (SyncBudget), and the last one.
  bool durable = false;
};

/// Writes the steps of one run. Every rank owns one: each writes the rows that it holds of the large datasets, rank 0
/// everything else, and all of them see the same folder. An error on one rank throws the same ResultFileError on every
/// rank. Not for concurrent threads.
class ResultFile {
 public:
  /// Starts an empty file, replacing one of that name. `path` must lie in an existing folder; its extension is free,
  /// and the XDMF file takes the same name with extension `.xdmf`. Throws ResultFileError. Collective.
  ResultFile(const std::filesystem::path& path, ResultHeader header, const Communicator& communicator = one_rank(),
             WritingOptions options = {});

  /// Continues after the last step of a stored run, in its own file. Throws ResultFileError. Collective.
  explicit ResultFile(const StoredRun& run, const Communicator& communicator = one_rank(), WritingOptions options = {});

  /// Removes the second copy and completes the XDMF file, ignoring errors; `close` reports them. Not collective: a rank
  /// may be alone in leaving by an exception.
  ~ResultFile();

  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  /// Appends a step and publishes it: once this returns, readers of the file see it. On an error (ResultFileError) the
  /// published file keeps the steps it had, and the file takes no more steps.
  /// Members, their samples and monitored names must be those of the first record, and `step` must grow. Collective.
  void append_step(const StepRecord& record);

  /// Brings the XDMF file up to date and removes the second copy; waits until the file is on the disk. Called once;
  /// later calls do nothing. Collective.
  void close();

  const std::filesystem::path& path() const { return path_; }

 private:
  void take_place();
  void or_give_up(const std::function<void()>& step);
  void check_consistent(const StepRecord& record) const;
  void write_step_of(const StepRecord& record);
  void write_xdmf();
  void finish();

  std::filesystem::path path_, xdmf_path_;
  FileRanks ranks_;
  SharedResultLock lock_;  ///< known to rank 0
  PublishedFile file_;
  std::vector<SampledMember> members_;  ///< of every step, those of this rank at least
  std::size_t member_count_ = 0, sample_count_ = 0;
  StepSummary previous_;           ///< for what is monitored
  std::vector<XdmfStep> labels_;   ///< of all published steps; names of stresses known to rank 0
  std::size_t steps_in_xdmf_ = 0;  ///< known to rank 0
  bool failed_ = false;
  bool closed_ = false;
};

/// Must be called before a program starts MPI. An HDF5 library built for MPI closes itself when MPI ends, and would
/// then try for ever to close a damaged file, with messages; begun earlier, it never does.
void begin_results_library();

}  // namespace mixbeam
