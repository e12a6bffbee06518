/// Bounds of time that hold on a busy machine: the processor's own, not the clock on the wall.
#pragma once

#include <ctime>

namespace mixbeam {

/// Processor time that an action takes in this process [s].
template <class Action>
double processor_seconds(const Action& action) {
  const std::clock_t begin = std::clock();
  action();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

}  // namespace mixbeam
