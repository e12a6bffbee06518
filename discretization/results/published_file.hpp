/// A file that readers find complete at all times while the ranks of a run extend it: a kill loses no published step.
///
/// Two hidden copies are written in turn, and the name is moved to a copy only after every rank has closed that copy. A
/// copy is first brought to the bytes of the published one, block by block, each of which is checked; each step is
/// therefore written twice, and the disk holds two copies until the run ends.
#pragma once

#include "discretization/results/guarded_file.hpp"
#include "discretization/results/result_tables.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace mixbeam {

/// Decides which steps wait for the disk: those that took so long that waiting costs at most 3 %.
class SyncBudget {
 public:
  explicit SyncBudget(bool every_step) : every_step_(every_step) {}
  /// Whether a step that is complete now, and has written so many bytes, can afford to wait.
  bool affords(std::uint64_t bytes) const;
  /// Runs `sync` and measures its cost.
  void spend(const std::function<void()>& sync);
  /// Starts the time of the next step, when one is published.
  void start_step() { since_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;

  bool every_step_;
  Clock::time_point since_ = Clock::now();
  std::optional<double> cost_{};  ///< seconds of the last one
};

/// Throws ResultFileError. Functions are collective, except those of rank 0.
class PublishedFile {
 public:
  using Write = std::function<void(GuardedFile& content)>;

  /// `ranks` must outlive this. `durable`: every step waits until it is on the disk before it is published; otherwise
  /// those that can afford it (SyncBudget) do, and the last one.
  PublishedFile(const std::filesystem::path& path, const FileRanks& ranks, bool durable);

  /// Rank 0: makes the first copy with `write`; the file of that name stays until that is published.
  void begin(std::uint64_t block, const Write& write);

  /// A step: makes the next copy equal to the published one; rank 0 changes it and shares the places of the tables'
  /// numbers; every rank writes those of its rows; rank 0 seals the copy.
  void catch_up();
  /// Rank 0: changes to large blocks, before the first large step.
  void use_large_blocks();
  /// Rank 0: changes the next copy.
  void change(const Write& write);
  void write_tables(const std::vector<ResultTable>& tables, std::vector<std::uint64_t> places);

  /// Moves the name to the next copy, atomically.
  void publish();

  /// Rank 0: removes hidden files, ignoring errors.
  void remove_copies() const noexcept;
  /// Rank 0: waits until the published copy is on the disk.
  void sync();

 private:
  struct Copy {
    std::filesystem::path path{};
    bool exists = false;
    std::uint64_t bytes = 0;  ///< without its seal
  };

  const Copy& published() const { return copies_[1 - next_]; }
  Copy& next() { return copies_[next_]; }
  void give_name();
  void seal_next(const std::vector<BlockSum>& sums, const std::vector<std::uint64_t>& blocks);

  std::filesystem::path path_, new_name_;  ///< the second is hidden, and renamed to the first
  const FileRanks& ranks_;
  SyncBudget budget_;
  std::array<Copy, 2> copies_;
  std::size_t next_ = 0;  ///< the copy that is not published
  // Known to rank 0:
  Seal seal_;                      ///< of the latest copy; the other one lacks changed_
  std::vector<BlockSum> changed_;  ///< by the last step
  std::uint64_t written_ = 0;      ///< bytes of the next copy, since it was published last
  FileNumber named_;               ///< the file that was published last
  bool is_synced_ = false;
};

}  // namespace mixbeam
