/// The page of the documentation, as a run writes it.
#pragma once

#include "apps/economies/economies_study.hpp"

#include <iosfwd>

namespace mixbeam {

/// Markdown: the table, with what was measured where.
void write_economies_page(std::ostream& page, const Scene& rod, const std::vector<EconomyResult>& unused);

}  // namespace mixbeam
