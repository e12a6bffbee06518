// The failure report as a page in plain words.
#include "discretization/text/message_text.hpp"
#include "nonlinear/diagnosis/failure_report.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace mixbeam {

namespace {

/// Attempts shown: the first ones say no more than the last.
constexpr std::size_t kAttemptsShown = 5;

std::string rounded_direction(const Vector3& v) {
  std::ostringstream text;
  text.precision(3);
  const auto rounded = [](double x) { return std::round(x * 1e3) / 1e3 + 0.0; };
  text << "(" << rounded(v[0]) << ", " << rounded(v[1]) << ", " << rounded(v[2]) << ")";
  return text.str();
}

void write_attempts(std::ostream& out, const FailureReport& report) {
  if (report.attempts.empty()) {
    out << "No step failed: all steps that are permitted were used up.\n";
    return;
  }
  const std::size_t shown = std::min(kAttemptsShown, report.attempts.size());
  out << "Failed attempts since then: " << report.failures
      << (static_cast<std::size_t>(report.failures) > shown ? ", of which the last are" : "") << "\n";
  for (std::size_t i = report.attempts.size() - shown; i < report.attempts.size(); ++i) {
    const FailedAttempt& attempt = report.attempts[i];
    out << "  at ";
    if (std::isfinite(attempt.load_factor))
      out << "load factor " << attempt.load_factor;
    else
      out << "an unknown load factor";
    out << ": " << cause_text(attempt) << "\n";
  }
  if (report.step_at_minimum) out << "  The step was reduced to its minimum of " << report.minimum_step << ".\n";
  if (report.steps_used_up) out << "  Then all steps that are permitted were used up.\n";
  if (!report.attempts.back().linear_solver.empty())
    out << "Last linear solve: " << report.attempts.back().linear_solver << ".\n";
}

void write_peak(std::ostream& out, const FailureReport& report) {
  if (report.attempts.empty() || !report.attempts.back().peak) return;
  const ResidualPeak& peak = *report.attempts.back().peak;
  out << "Farthest from equilibrium in the last attempt: " << equation_text(peak.place) << ", " << text_of(peak.place);
  if (peak.place.element < 0 && !peak.place.point.empty())
    out << " (member \"" << excerpt(peak.place.member) << "\" at " << peak.place.along << " of its length)";
  out << ", by " << peak.value << " in the units of the scene, " << peak.scaled
      << " of what is at work in the structure.\n";
}

void write_angles(std::ostream& out, const FailureReport& report) {
  for (const WideAngle& wide : report.wide_angles)
    out << "Rotation between an element and its vertices (must stay below pi): " << wide.angle << " rad in element "
        << wide.element << " of member \"" << excerpt(wide.member) << "\", "
        << (wide.converged ? "in the last equilibrium" : "in a failed attempt") << "; the member has " << wide.elements
        << (wide.elements == 1 ? " element, " : " elements, ") << wide.suggested_elements << " would do.\n";
}

void write_mode(std::ostream& out, const CriticalMode& mode) {
  out << "  Eigenvalue " << mode.eigenvalue << " (" << mode.relative << " of the lowest of the undeformed structure):";
  for (const MovingVertex& vertex : mode.vertices)
    out << (&vertex == &mode.vertices.front() ? " " : "; ") << text_of(vertex.place)
        << (vertex.turns ? " turns about " : " moves along ") << rounded_direction(vertex.direction);
  out << ".\n";
}

void write_tangent(std::ostream& out, const FailureReport& report) {
  const TangentReport& tangent = report.tangent;
  if (!tangent.known) {
    out << "Tangent at the last equilibrium: unknown (" << tangent.unknown_because << ").\n";
    return;
  }
  out << "Tangent at the last equilibrium: ";
  if (tangent.null > 0)
    out << "singular";
  else
    out << (tangent.nearly_singular ? "nearly singular" : "regular");
  out << ", " << tangent.negative << " negative " << (tangent.negative == 1 ? "eigenvalue" : "eigenvalues")
      << (tangent.negative > 0 ? ": the equilibrium is unstable" : "");
  if (tangent.condition) out << "; condition number about " << *tangent.condition;
  out << ".\n";
  for (const CriticalMode& mode : tangent.modes)
    if (tangent.nearly_singular || tangent.mechanism || mode.eigenvalue < 0.0) write_mode(out, mode);
}

const char* words_of(FailureCause cause) {
  switch (cause) {
    case FailureCause::load_not_finite:
      return "a load or prescribed motion has no value there";
    case FailureCause::steps_used_up:
      return "more steps are needed than are permitted";
    case FailureCause::mechanism:
      return "the structure is a mechanism: it can move without strain";
    case FailureCause::end_angle:
      return "elements are too long for the rotations in them";
    case FailureCause::critical_point:
      return "a critical point: the load cannot grow from here (limit point), or the structure buckles (bifurcation)";
    case FailureCause::overflow:
      return "numbers beyond the range of double precision";
    case FailureCause::linear_solver:
      return "the linear equations are too ill-conditioned to be solved";
    case FailureCause::path_lost:
      return "equilibria go on from here, but not to the end of the stage";
    case FailureCause::incompatible:
      return "strains or motions are imposed that members which cannot stretch or shear, or hardly, do not take on";
    case FailureCause::slow:
      return "Newton's method was on its way, but had too few iterations";
    case FailureCause::wandering:
      return "Newton's method found no way from the last equilibrium to the next";
  }
  return "";
}

}  // namespace

std::string text_of(const FailureReport& report) {
  std::ostringstream out;
  out << "no equilibrium was found beyond load factor " << report.last_load_factor << " of " << report.stages
      << " (step " << report.last_step << ").\n";
  write_attempts(out, report);
  write_peak(out, report);
  write_angles(out, report);
  write_tangent(out, report);
  out << "Most likely: " << words_of(report.cause) << ".\n";
  out << "What to try, in this order:\n";
  for (std::size_t i = 0; i < report.next.size(); ++i) out << "  " << i + 1 << ". " << report.next[i].text << "\n";
  return out.str();
}

}  // namespace mixbeam
