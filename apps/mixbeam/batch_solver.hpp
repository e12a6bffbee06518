/// Solves the cases of a batch: in groups, and alone where a group does not do.
#pragma once

#include "apps/common/session/command_line.hpp"
#include "apps/mixbeam/case_quantities.hpp"
#include "apps/mixbeam/case_scenes.hpp"

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>

namespace mixbeam {

/// The scenes of all cases of a batch, and which of them are solved side by side.
struct GroupedCases {
  std::vector<Scene> scenes{};
  std::vector<std::vector<std::size_t>> groups{};
};
/// Throws as CaseScenes.
GroupedCases grouped_cases(CaseScenes& scenes, std::size_t cases);

/// Adds the time between its beginning and its end to an entry of the summary.
class Stopwatch {
 public:
  Stopwatch(Application& app, std::string name)
      : app_(app), name_(std::move(name)), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { app_.summary.seconds[name_] += seconds(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  Application& app_;
  std::string name_;
  std::chrono::steady_clock::time_point start_;
};

/// How one case ended.
struct CaseResult {
  bool solved = false;  ///< tried at all; false after an interruption
  bool converged = false;
  bool alone = false;              ///< solved on its own
  CaseValues values{};             ///< empty where Newton's method failed
  int iterations = 0;              ///< of the Newton iteration that it was part of
  double residual = 0.0;           ///< over its own scales
  std::string cause{};             ///< why it did not converge
  std::string stable = "unknown";  ///< whether the end is: "true", "false", "neutral", "unknown"
};

/// Gives what the ranks have solved to rank 0, in the order of the cases. False: one of them was stopped. Collective.
bool gather_results(const Teuchos::Comm<int>& ranks, Summary& summary, std::vector<CaseResult>& results,
                    bool all_solved);

class BatchSolver {
 public:
  /// `stop`: asked between iterations; cases that are not solved by then stay so.
  BatchSolver(Application& app, const CaseQuantities& quantities, std::size_t cases, std::function<bool()> stop);

  /// Solves these cases, which are alike; `scenes` are theirs, in the same order.
  void solve(const std::vector<std::size_t>& cases, const std::vector<Scene>& scenes);

  /// Solves all groups, or the share of a rank among several, whose scenes are freed then, and reports the number of
  /// each. False: stopped before the last case.
  bool solve_all(GroupedCases& cases, const std::function<void(std::size_t group)>& solved, int rank = 0,
                 int ranks = 1);
  /// See gather_results().
  bool gather(const Teuchos::Comm<int>& ranks, bool all_solved) {
    return gather_results(ranks, app_.summary, results_, all_solved);
  }

  const std::vector<CaseResult>& results() const { return results_; }
  /// Copies the results as they are now, for other threads than the one that solves: final as far as they are solved.
  std::vector<CaseResult> results_so_far() const {
    const std::lock_guard<std::mutex> lock(*results_mutex_);
    return results_;
  }

 private:
  using Range = std::pair<std::size_t, std::size_t>;  ///< of the cases of the present group
  void solve_range(const Range& range);
  bool solve_together(const Range& range);
  void solve_alone(std::size_t place);
  CaseResult solved_alone(const Scene& scene);
  CaseResult solved_accurately(const Scene& scene);
  std::vector<CaseResult> checked(const Simulation& simulation, const Scene* scenes, std::size_t count,
                                  const std::vector<int>& part_of_member, bool merged, const References& references);
  CaseResult checked_alone(const Simulation& simulation, const Scene& scene, const References& references);
  RunObserver taking(References& references, const Scene* scenes, std::size_t count, bool merged) const;
  void keep(std::size_t place, CaseResult result);

  Application& app_;
  const CaseQuantities& quantities_;
  std::function<bool()> stop_;
  bool may_merge_;
  std::vector<CaseResult> results_;
  std::unique_ptr<std::mutex> results_mutex_ = std::make_unique<std::mutex>();
  const std::vector<std::size_t>* cases_ = nullptr;
  const std::vector<Scene>* scenes_ = nullptr;
};

/// "sag; drift": the quantities of a case that are beyond their limits.
std::string beyond_limits(const CaseResult& result, const CaseQuantities& quantities, std::size_t index);

/// 1 for "true", 0 for "false", 0.5 for "neutral", NaN for "unknown": a column of an HDF5 file holds numbers.
double number_of_stable(const std::string& stable);

/// "-3-7" of --rows 3:7, for names of files; empty without it.
std::string rows_text(const CommandLine& line);
/// Throws InputError where --rows begins behind the last case.
void require_row(int first, std::size_t cases);

/// Each rank solves by itself from here on; the first one speaks.
void part_ranks(Application& app);

/// A batch at its end.
struct SolvedBatch {
  const std::vector<CaseResult>& results;
  std::function<std::string(std::size_t)> name_of_case;
  bool interrupted = false;
};

/// Counts how the cases end, writes the summary, prints what failed and the last lines. Returns the exit code. Throws
/// ConvergenceError where cases failed.
int conclude_batch(Application& app, const CommandLine& line, const SolvedBatch& batch);

/// The files of a batch, <stem>.csv and <stem>.h5, with one row for each case that was tried. `scene_xml` goes to the
/// latter.
void write_batch(const std::filesystem::path& stem, const Batch& batch, const CaseQuantities& quantities,
                 const std::vector<CaseResult>& results, const std::string& scene_xml);

}  // namespace mixbeam
