/// The files of a batch: one row for each case.
#pragma once

#include "apps/mixbeam/batch_solver.hpp"

namespace mixbeam {

/// Writes <stem>.csv and <stem>.h5: the cases that were tried. `scene_xml` goes to the latter.
void write_batch(const std::filesystem::path& stem, const Batch& batch, const CaseQuantities& quantities,
                 const std::vector<CaseResult>& results, const std::string& scene_xml);

}  // namespace mixbeam
