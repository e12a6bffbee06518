/// The page of the documentation, as a run writes it.
#pragma once

#include "apps/trade/matrix.hpp"

#include <iosfwd>
#include <vector>

namespace mixbeam {

/// Markdown: what was measured with what, the order to take, what each digit costs, the cheapest cell of every
/// benchmark, references, integration of force strains, what was not reached. It shows the pictures beside it.
void write_page(std::ostream& page, const std::vector<BenchmarkResult>& results, const MatrixPlan& plan);

}  // namespace mixbeam
