#include "apps/common/studies/phase_costs.hpp"

namespace mixbeam {

namespace {

struct CostsOfOrder {
  const char* kind;
  int order;
  PhaseCost costs[kCountedPhases.size()];
};

constexpr CostsOfOrder kCosts[] = {
#include "apps/common/studies/phase_costs.inc"
};

}  // namespace

std::map<std::string, PhaseCost> phase_costs(const std::string& kind, int order) {
  std::map<std::string, PhaseCost> all;
  const auto add = [&all](const char* sum, const char* part) {
    all[sum].flops += all[part].flops;
    all[sum].bytes += all[part].bytes;
  };
  for (const CostsOfOrder& row : kCosts)
    for (std::size_t i = 0; row.kind == kind && row.order == order && i < kCountedPhases.size(); ++i)
      all[kCountedPhases[i]] = row.costs[i];
  for (const char* part : {"residual", "element tangent", "recover", "update"}) add(kElementWork, part);
  for (const char* part : {"condense chains", "solve", "check of the solve"}) add(kLinearSolver, part);
  for (const char* part : {kElementWork, kLinearSolver, "assemble"}) add(kWholeIteration, part);
  return all;
}

}  // namespace mixbeam
