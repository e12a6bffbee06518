#include "apps/common/session/progress.hpp"

#include "apps/common/tables/formatted.hpp"

#include <cmath>
#include <ostream>

namespace mixbeam {

namespace {

constexpr double kSecondsOfADay = 86400.0;
constexpr std::chrono::seconds kBetweenLines{1};

/// Range of load factors that "%8.5f" shows with at least three digits and without widening the line.
constexpr double kSmallestWritten = 1e-3, kLargestWritten = 1e5;

}  // namespace

std::string load_factor_text(double load_factor) {
  if (!std::isfinite(load_factor)) return " unknown";
  const double size = std::abs(load_factor);
  const bool written = size == 0.0 || (size >= kSmallestWritten && size < kLargestWritten);
  return formatted(written ? "%8.5f" : "%8.2e", load_factor);
}

Progress::Progress(std::ostream& out, std::string label, int stages, double from)
    : out_(out),
      label_(std::move(label)),
      stages_(stages),
      from_(from),
      start_(std::chrono::steady_clock::now()),
      last_search_(start_) {}

std::string Progress::time_to_go(double elapsed, double share_done) const {
  const double covered = share_done - from_, seconds = elapsed * (1.0 - share_done) / covered;
  if (!(covered > 0.0) || !(seconds >= 0.0) || seconds > kSecondsOfADay) return "";
  return formatted("  to go %7.3f s", seconds);
}

void Progress::report(const StepReport& report, double share_done) {
  if (report.step == 0 || !out_) return;  // a stream that discards everything
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  for (const CriticalPoint& point : report.critical_points) report_critical(point);
  if (report.jump) out_ << label_ << ": " << jump_text(*report.jump) << "\n";
  out_ << label_ << formatted(": step %3d  load factor ", report.step) << load_factor_text(report.load_factor)
       << formatted(" of %d  iterations %3d  residual %8.1e  elapsed %7.3f s", stages_, report.newton_iterations,
                    report.residual, elapsed)
       << time_to_go(elapsed, share_done) << "\n"
       << std::flush;
}

void Progress::report_critical(const CriticalPoint& point) {
  out_ << label_ << ": "
       << critical_text(name_of(point.kind), point.load_factor, point.error, point.negative_before,
                        point.negative_after, point.omega)
       << "\n";
}

std::string critical_text(const std::string& kind, double load_factor, double error, int before, int after,
                          double omega) {
  const std::string place = kind + " at load factor " + in_known_digits(load_factor, error);
  if (!std::isnan(omega))
    return place + formatted(", omega %.10g: %d motions grow before, %d after", omega, before, after);
  return place + formatted(": negative eigenvalues %d before, %d after", before, after);
}

std::string jump_text(const RecordedJump& jump) {
  return formatted(
      "jump between load factors %.6g and %.6g: energy released %.6g, mean motion %.3g, largest displacement %.6g (%s)",
      jump.from, jump.to, jump.released, jump.motion, jump.largest, jump.place.c_str());
}

bool Progress::is_due() {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_search_ < kBetweenLines) return false;
  last_search_ = now;
  return true;
}

void Progress::report(const ModeSearch& search) {
  if (!is_due()) return;
  out_ << label_ << ": search for modes at load factor " << load_factor_text(search.load_factor)
       << formatted(": %d of %d found", search.found, search.wanted) << "\n"
       << std::flush;
}

void Progress::report(const DescentProgress& descent) {
  if (!is_due()) return;
  out_ << label_ << ": search for a stable state at load factor " << load_factor_text(descent.load_factor)
       << formatted(": potential %.6g, %d factorisations", descent.potential, descent.factorizations) << "\n"
       << std::flush;
}

void Progress::report(const StepFailure& failure) {
  out_ << label_ << formatted(": step %3d  load factor ", failure.step) << load_factor_text(failure.load_factor)
       << formatted(" of %d  iterations %3d  FAILED: ", stages_, failure.iterations) << failure.cause << "\n"
       << std::flush;
}

}  // namespace mixbeam
