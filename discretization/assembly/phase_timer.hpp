/// Adds the wall time of a scope to a named total.
#pragma once

#include <chrono>
#include <map>
#include <string>

namespace mixbeam {

/// Wall time spent in each phase, in seconds.
using PhaseTimes = std::map<std::string, double>;

class PhaseTimer {
 public:
  PhaseTimer(PhaseTimes& times, const char* phase) : total_(times[phase]), start_(Clock::now()) {}
  ~PhaseTimer() { total_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  PhaseTimer(const PhaseTimer&) = delete;
  PhaseTimer& operator=(const PhaseTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& total_;
  Clock::time_point start_;
};

}  // namespace mixbeam
