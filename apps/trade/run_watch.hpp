/// Times of one run, and those of several.
#pragma once

#include "apps/trade/cell.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

namespace mixbeam {

/// A median of fewer is none.
inline constexpr int kLeastRounds = 3;

class RunWatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  double processor_seconds() const { return static_cast<double>(std::clock() - processor_start_) / CLOCKS_PER_SEC; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  std::clock_t processor_start_ = std::clock();
};

inline double median(std::vector<CellTimes> runs, double CellTimes::*what) {
  std::sort(runs.begin(), runs.end(), [&](const CellTimes& a, const CellTimes& b) { return a.*what < b.*what; });
  const size_t middle = runs.size() / 2;
  return runs.size() % 2 == 1 ? runs[middle].*what : 0.5 * (runs[middle - 1].*what + runs[middle].*what);
}

inline CellTimes medians(const std::vector<CellTimes>& runs) {
  return {median(runs, &CellTimes::seconds), median(runs, &CellTimes::setup_seconds),
          median(runs, &CellTimes::processor_seconds)};
}

}  // namespace mixbeam
