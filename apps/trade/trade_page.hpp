/// The page of the documentation, as a run writes it.
#pragma once

#include "apps/trade/matrix.hpp"

#include <iosfwd>
#include <vector>

namespace mixbeam {

/// Markdown: what was measured with what, the order to take, what each digit costs, the cheapest cell of every
/// benchmark, what the program makes of a wanted accuracy on them and on the scenes of the gallery, references,
/// integration of force strains, what was not reached. It shows the pictures beside it.
void write_page(std::ostream& page, const std::vector<BenchmarkResult>& results,
                const std::vector<BenchmarkResult>& gallery, const MatrixPlan& plan);

}  // namespace mixbeam
