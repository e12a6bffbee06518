#include "apps/extremes/extremes_page.hpp"

#include "apps/common/session/machine_facts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace mixbeam {

namespace {

template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

bool is_promised(const Sweep& sweep, double value) { return value >= sweep.from && value <= sweep.to; }

/// "1e-12 to 1e+08"
std::string range_of(const std::vector<SweepRow>& rows) {
  return rows.size() == 1 ? value_text(rows[0].value)
                          : value_text(rows.front().value) + " to " + value_text(rows.back().value);
}

const SweepRow* worst_promised(const SweepResult& result) {
  const SweepRow* worst = nullptr;
  for (const SweepRow& row : result.rows)
    if (row.converged && is_promised(result.sweep, row.value) && (worst == nullptr || row.error > worst->error))
      worst = &row;
  return worst;
}

void write_head(std::ostream& page, int values) {
  page << "# Extremes\n\n"
          "One quantity of a straight cantilever at a time, swept to its limits and held against a closed form.\n"
          "Written by the program; to renew it:\n\n"
          "```sh\n./run.sh extremes && cp results/extremes/extremes.md results/extremes/extremes.png "
          "apps/docs/\n```\n\n";
  for (const auto& [name, value] : machine_facts())
    if (name != "flags") page << name << " " << value << ", ";
  page << today() << "; " << values << " runs.\n\n";
  page << "![Errors, iterations and condition numbers over each quantity](extremes.png)\n\n";
}

void write_overview(std::ostream& page, const std::vector<SweepResult>& results) {
  page
      << "The error is the distance of the tip from the closed form over its displacement, or the angle between the "
         "two\n"
         "rotations over the angle turned (at most 1 rad), whichever is larger. `allowed` is what every run checks.\n\n"
         "| sweep | values | converged | iterations | largest error | at | allowed |\n"
         "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const SweepResult& result : results) {
    int converged = 0, fewest = 1 << 30, most = 0;
    for (const SweepRow& row : result.rows) {
      if (!row.converged) continue;
      ++converged;
      fewest = std::min(fewest, row.iterations);
      most = std::max(most, row.iterations);
    }
    const SweepRow* worst = worst_promised(result);
    page << "| [" << result.sweep.name << "](#" << result.sweep.name << ") | " << range_of(result.rows) << " | "
         << converged << " of " << result.rows.size() << " | "
         << (converged == 0 ? std::string("-") : format(fewest == most ? "%d" : "%d to %d", fewest, most)) << " | "
         << (worst == nullptr ? std::string("-") : format("%.1e", worst->error)) << " | "
         << (worst == nullptr ? std::string("-") : value_text(worst->value)) << " | "
         << format("%.0e", result.sweep.allowed) << " |\n";
  }
}

/// The first sentence of a report, without findings and advice.
std::string cause_of(const std::string& failure) {
  return failure.substr(0, std::min(failure.find('\n'), failure.find(" What to try:")));
}

/// Runs that end early, and errors above what is allowed, each with the reason of its sweep.
void write_ends(std::ostream& page, const std::vector<SweepResult>& results) {
  page << "\n## Where it ends\n\n";
  bool any = false;
  for (const SweepResult& result : results) {
    std::string ends;
    for (const SweepRow& row : result.rows) {
      if (row.converged && row.error <= result.sweep.allowed) continue;
      const char* promise = is_promised(result.sweep, row.value) ? "allowed" : "allowed elsewhere in this sweep";
      ends += "  - " + value_text(row.value) + ": " +
              (row.converged ? format("error %.1e, %.0e is %s", row.error, result.sweep.allowed, promise)
                             : cause_of(row.failure)) +
              "\n";
    }
    if (ends.empty()) continue;
    any = true;
    page << "- " << result.sweep.name << ": " << result.sweep.limit << "\n" << ends;
  }
  if (!any) page << "Every run converges, with an error below the allowed one.\n";
}

void write_table(std::ostream& page, const SweepResult& result) {
  const Sweep& sweep = result.sweep;
  page << "\n## " << sweep.name << "\n\n"
       << sweep.what << " Swept: " << sweep.parameter << ". Closed form: " << sweep.source << ". " << sweep.limit
       << "\n\n| value | converged | load steps | failed steps | iterations | error | residual | condition | processor "
          "s |\n"
          "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const SweepRow& row : result.rows)
    page << "| " << value_text(row.value) << " | " << (row.converged ? "yes" : "**no**") << " | " << row.load_steps
         << " | " << row.failed_steps << " | " << row.iterations << " | "
         << (row.converged ? format("%.1e", row.error) : std::string("-")) << " | "
         << format("%.1e | %.1e | %.3f", row.residual, row.condition, row.processor_seconds) << " |\n";
}

}  // namespace

std::string value_text(double value) {
  const std::string brief = format("%.6g", value);
  // 6.28 (1 - 1e-12) and pi (1 - 1e-6) are not what six digits say
  return std::stod(brief) == value || std::abs(std::stod(brief) - value) < 1e-15 * std::abs(value)
             ? brief
             : format("%.13g", value);
}

void write_page(std::ostream& page, const std::vector<SweepResult>& results) {
  int values = 0;
  for (const SweepResult& result : results) values += static_cast<int>(result.rows.size());
  write_head(page, values);
  write_overview(page, results);
  write_ends(page, results);
  for (const SweepResult& result : results) write_table(page, result);
}

}  // namespace mixbeam
