/// The page of the documentation, as a run writes it.
#pragma once

#include "apps/extremes/extremes_study.hpp"

#include <iosfwd>

namespace mixbeam {

/// "1e-09", "0.5", "1000", "inf": a value of a sweep, two numbers next to each other with the digits that differ.
std::string value_text(double value);

/// Markdown: what was measured with what, a summary of all sweeps, where runs end, a table for each
/// sweep. It shows extremes.png beside it.
void write_page(std::ostream& page, const std::vector<SweepResult>& results);

}  // namespace mixbeam
