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
  for (const CriticalPoint& point : report.critical_points) report_critical(point);
  out_ << line << std::flush;
}

void Progress::report_critical(const CriticalPoint& point) {
  char line[200];
  std::snprintf(line, sizeof line, "%s: %s at load factor %.10g: negative eigenvalues %d before, %d after\n",
                label_.c_str(), name_of(point.kind), point.load_factor, point.negative_before, point.negative_after);
  out_ << line;
}

void Progress::report(const StepFailure& failure) {
  char line[100];
  std::snprintf(line, sizeof line, ": step %3d  load factor %8.5f of %d  iterations %3d  FAILED: ", failure.step,
                failure.load_factor, stages_, failure.iterations);
  out_ << label_ << line << failure.cause << "\n" << std::flush;
}

}  // namespace mixbeam
