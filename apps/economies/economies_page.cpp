#include "apps/economies/economies_page.hpp"

#include "apps/common/session/machine_facts.hpp"

#include <cstdio>
#include <ostream>

namespace mixbeam {

namespace {

void write_rows(std::ostream& page, const std::vector<EconomyResult>& results) {
  for (const EconomyResult& r : results) {
    char numbers[160];
    std::snprintf(numbers, sizeof numbers, "%.3f | %.3f | %.2f | %d / %d | %.0e", r.plain.seconds, r.other.seconds,
                  r.ratio(), r.plain.iterations, r.other.iterations, r.difference());
    page << "| " << r.economy.plain.description << " | " << r.economy.other.description << " | " << numbers << " |\n";
  }
  page << '\n';
  for (const EconomyResult& r : results)
    if (!r.economy.remark.empty()) page << "- " << r.economy.plain.description << ": " << r.economy.remark << '\n';
}

}  // namespace

void write_economies_page(std::ostream& page, const Scene& rod, const std::vector<EconomyResult>& unused) {
  page << "# Only what the scene requires\n\n"
          "A rod of "
       << rod.members.at(0).elements << " elements of order " << rod.members.at(0).order
       << ", clamped, bent and twisted at its tip, solved from the straight rod: seconds from the scene to the answer "
          "(median, one thread), Newton iterations, and how far the two displacements of the tip are apart, relative. "
          "Written by the program; to renew it:\n\n"
          "```sh\n./run.sh economies && cp results/economies/economies.md apps/docs/\n```\n\n";
  for (const auto& [name, value] : machine_facts())
    if (name != "flags") page << name << " " << value << ", ";
  page << today() << ".\n\n"
       << "## Features that a scene does not use\n\n"
          "Left: the scene as it is. Right: the same scene with the feature in it, at rest.\n\n"
          "| as it is | with the feature | s | s | ratio | iterations | difference "
          "|\n|---|---|---:|---:|---:|---:|---:|\n";
  write_rows(page, unused);
}

}  // namespace mixbeam
