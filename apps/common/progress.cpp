#include "apps/common/progress.hpp"

#include <cstdio>
#include <ostream>

namespace mixbeam {

Progress::Progress(std::ostream& out, std::string label, int stages, double from)
    : out_(out), label_(std::move(label)), stages_(stages), from_(from), start_(std::chrono::steady_clock::now()) {}

void Progress::report(const StepReport& report) {
  if (report.step == 0) return;
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double covered = report.load_factor - from_;
  const double to_go = covered > 0.0 ? elapsed * (stages_ - report.load_factor) / covered : 0.0;
  char line[200];
  std::snprintf(
      line, sizeof line,
      "%s: step %3d  load factor %8.5f of %d  iterations %3d  residual %8.1e  elapsed %7.3f s  to go %7.3f s\n",
      label_.c_str(), report.step, report.load_factor, stages_, report.newton_iterations, report.residual, elapsed,
      to_go);
  out_ << line << std::flush;
}

}  // namespace mixbeam
