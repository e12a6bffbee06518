/// Solves the cases of a batch in groups; cases that fail in a group are solved alone.
#pragma once

#include "apps/mixbeam/batch_cases.hpp"

#include <chrono>
#include <functional>
#include <mutex>

namespace mixbeam {

/// Largest ratio within a group of lengths, loads, and critical loads EI / L^2: its cases share one Newton iteration,
/// one limit of rotations, and residual scales taken from the largest. With 2 a decade of loads makes four groups.
inline constexpr double kLikeness = 2.0;

/// Elements of a group: enough for all threads and vector lanes; more would increase memory and the cost of a failing
/// case.
inline constexpr int kElementsPerGroup = 40'000;

/// Indices of the cases of each group.
using CaseGroups = std::vector<std::vector<std::size_t>>;

/// Divides the cases into groups of similar cases, independent of the number of threads. Keeps no scene. Throws as
/// CaseScenes.
CaseGroups grouped_cases(CaseScenes& scenes, std::size_t cases);

/// Checks the memory of a batch whose cases `ranks` share, each rank with the scenes of a group or those that
/// CaseScenes keeps. `scene`: of the first case. Throws as require_memory(). Collective over `ranks`.
void require_memory_of_cases(const Application& app, const Scene& scene, std::size_t cases, const Communicator& ranks);

/// Adds its lifetime to an entry of the summary.
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
  bool solved = false;  ///< attempted; false after an interruption
  bool converged = false;
  bool alone = false;              ///< solved on its own
  CaseValues values{};             ///< empty if Newton's method failed
  int iterations = 0;              ///< of the run that solved it
  double residual = 0.0;           ///< relative to its own scales
  std::string cause{};             ///< why it did not converge
  std::string stable = "unknown";  ///< stability of the end: "true", "false", "neutral", "unknown"
};

/// Results of all cases, which another thread may read during the solution.
class CaseResults {
 public:
  void resize(std::size_t cases) { all_.resize(cases); }
  const std::vector<CaseResult>& all() const { return all_; }
  /// Copies the present results; those of solved cases are final.
  std::vector<CaseResult> so_far() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return all_;
  }
  void keep(std::size_t index, CaseResult result) {
    const std::lock_guard<std::mutex> lock(mutex_);
    all_[index] = std::move(result);
  }
  /// Gathers the results on rank 0, in the order of the cases. False: a rank was stopped. Collective.
  bool gather(const Teuchos::Comm<int>& ranks, Summary& summary, bool all_solved);

 private:
  std::vector<CaseResult> all_;
  mutable std::mutex mutex_;
};

class BatchSolver {
 public:
  /// `stop`: polled between iterations; the remaining cases stay unsolved.
  BatchSolver(Application& app, const CaseQuantities& quantities, CaseResults& results, std::function<bool()> stop);

  /// Solves similar cases; `scenes`: in the same order.
  void solve(const std::vector<std::size_t>& cases, const std::vector<Scene>& scenes);

  /// Solves all groups, or the share of a rank, and calls `solved` after each; reads its scenes again. False: stopped
  /// before the last case.
  bool solve_all(const CaseGroups& groups, CaseScenes& scenes, const std::function<void(std::size_t group)>& solved,
                 int rank = 0, int ranks = 1);

 private:
  using Range = std::pair<std::size_t, std::size_t>;  ///< cases of the current group
  void solve_range(const Range& range);
  bool solve_together(const Range& range);
  CaseResult solved_alone(const Scene& scene);
  CaseResult solved_accurately(const Scene& scene);
  std::vector<CaseResult> checked(const Simulation& simulation, const Scene* scenes, std::size_t count,
                                  const std::vector<int>& part_of_member, bool merged, const References& references);
  CaseResult checked_alone(const Simulation& simulation, const Scene& scene, const References& references);
  void keep(std::size_t place, CaseResult result) { results_.keep((*cases_)[place], std::move(result)); }
  RunObserver taking(References& references, const Scene* scenes, std::size_t count, bool merged) const;

  Application& app_;
  const CaseQuantities& quantities_;
  std::function<bool()> stop_;
  CaseResults& results_;
  bool may_merge_;
  const std::vector<std::size_t>* cases_ = nullptr;
  const std::vector<Scene>* scenes_ = nullptr;
};

}  // namespace mixbeam
