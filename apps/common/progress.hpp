/// One line for each load step: where the path is, what the step cost, how long the rest may take.
#pragma once

#include "nonlinear/load_path.hpp"

#include <chrono>
#include <iosfwd>
#include <string>

namespace mixbeam {

class Progress {
 public:
  Progress(std::ostream& out, std::string label, int stages);
  void report(const StepReport& report);

 private:
  std::ostream& out_;
  std::string label_;
  int stages_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace mixbeam
