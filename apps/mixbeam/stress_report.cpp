// What a run says of stresses and strains when it has ended.
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/run_report.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace mixbeam {

namespace {

/// Share of the von Mises stress of an open section that its torque makes, above which warping deserves a note.
constexpr double kTorsionNote = 0.1;

/// Strains below this are differences of larger numbers: a structure that only eigenstrains deform has no stresses.
constexpr double kNoStrain = 1e-12;

/// Place over the length of the member.
std::string share_text(const StressedMember& m) {
  return formatted("%.4g", m.length > 0.0 ? m.arc_length / m.length : 0.0);
}

/// "0.05, -0.1"; a coordinate that is rounding beside the other is zero.
std::string point_text(const SectionPoint& p) {
  constexpr double kRounding = 1e-9;
  const double size = kRounding * std::max(std::abs(p[0]), std::abs(p[1]));
  return formatted("%.4g, %.4g", std::abs(p[0]) < size ? 0.0 : p[0], std::abs(p[1]) < size ? 0.0 : p[1]);
}

bool any_utilisation(const StressSummary& stresses) {
  return std::any_of(stresses.members.begin(), stresses.members.end(),
                     [](const StressedMember& m) { return m.utilisation.has_value(); });
}

std::string percent(double value) { return formatted("%.3g %%", 100.0 * value); }

}  // namespace

std::string error_text(const EstimatedValue* value) {
  if (value != nullptr && value->is_estimated()) return formatted("%.1e", value->error);
  return value == nullptr || value->not_estimated.empty() ? "-" : "unknown";
}

void print_stresses(std::ostream& out, const StressSummary& stresses) {
  if (stresses.members.empty() || (stresses.strain.value > 0.0 && stresses.strain.value < kNoStrain)) return;
  out << formatted("  %-24s %14s %9s %14s %9s   %-24s%s\n", "largest stress in", "von Mises", "error", "at s", "s / L",
                   "point of section x2, x3", any_utilisation(stresses) ? " utilisation" : "");
  for (const StressedMember& m : stresses.members) {
    const LargestStress& s = m.stresses.von_mises;
    out << formatted("  %-24.60s %14.6g %9s %14.6g %9s   %-24s", m.member.c_str(), s.value,
                     error_text(&m.estimated).c_str(), m.arc_length, share_text(m).c_str(),
                     point_text(s.point).c_str());
    out << (m.utilisation ? formatted(" %11.3g", *m.utilisation) : "") << "\n";
  }
  for (const StressedMember& m : stresses.members)
    if (m.torsion_share > kTorsionNote) {
      out << "  note: of the stress in \"" << m.member << "\" torsion makes " << percent(m.torsion_share)
          << "; with restrained warping an open section has other stresses than these (Saint-Venant's)\n";
      break;
    }
}

std::vector<std::string> stress_warnings(const StressSummary& stresses) {
  std::vector<std::string> warnings;
  const LargestAlong &strain = stresses.strain, &curved = stresses.curvature, &used = stresses.utilisation;
  if (used.value + used.error > used.limit)
    warnings.push_back("member \"" + used.member +
                       "\" is stressed beyond the \"Strength\" of its material: utilisation " +
                       formatted("%.3g at s = %.6g", used.value, used.arc_length) +
                       (used.value > used.limit ? "" : formatted(", and an estimated error of %.2g", used.error)));
  if (!strain.member.empty() && strain.value > strain.limit)
    warnings.push_back(
        "member \"" + strain.member + "\" is strained by " + percent(strain.value) +
        " at s = " + formatted("%.6g", strain.arc_length) + ", more than " + percent(strain.limit) +
        ": hardly any material is linear up to there (\"Largest Strain\" of its section changes the limit)");
  if (!curved.member.empty() && curved.value > curved.limit)
    warnings.push_back("member \"" + curved.member +
                       "\" is curved so much that the bending stress at its inner fibre is "
                       "too low by about " +
                       percent(curved.value) + " (Winkler and Bach), for its section is thick against its radius");
  return warnings;
}

}  // namespace mixbeam
