#include "apps/common/studies/asked_path.hpp"

#include <algorithm>

namespace mixbeam {

bool asks_for_path(const SolverParameters& parameters, const std::vector<ExpectedValue>& expected,
                   const std::string& load_case, const Scene& scene) {
  const AnalysisParameters& analysis = parameters.analysis;
  const LoadPathParameters& path = parameters.load_path;
  const bool by_analysis =
      analysis.trace || analysis.control || analysis.branch != Branch::primary || analysis.buckling_modes > 0;
  const bool by_steps = path.method == LoadPathMethod::fixed && path.steps > 1;
  const bool by_values = std::any_of(expected.begin(), expected.end(), [&](const ExpectedValue& value) {
    return value.load_case == load_case &&
           (value.critical_point || value.load_factor.value_or(scene.stages) != scene.stages);
  });
  return by_analysis || by_steps || by_values || scene.stages > 1;
}

}  // namespace mixbeam
