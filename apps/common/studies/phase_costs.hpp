/// Costs of the phases of an iteration per element of a chain: floating-point operations and bytes moved.
#pragma once

#include <array>
#include <map>
#include <string>

namespace mixbeam {

// Sums of phases.
inline constexpr const char* kWholeIteration = "whole iteration";
inline constexpr const char* kElementWork = "element work";    ///< residual, element tangent, recover, update
inline constexpr const char* kLinearSolver = "linear solver";  ///< factorise, solve and check

/// Counted phases, in the order of the table phase_costs.inc.
inline constexpr std::array<const char*, 8> kCountedPhases = {
    "residual", "element tangent", "recover", "update", "condense chains", "solve", "check of the solve", "assemble"};

struct PhaseCost {
  double flops = 0.0;  ///< counted by running the kernel with a counting number type
  /// Between memory and processor if every array of the phase passes once, in the layouts of StateViews, ElementBlock,
  /// ElementEquations and ChainLevel. Caching between phases is not subtracted, the read before a write not added.
  /// Vertex data count once per element: a chain has as many vertices as elements.
  double bytes = 0.0;
};

/// Costs by phase for "spatial" or "planar" chains: the phases of Model::times() if chains are condensed, and their
/// sums. From a table written by tests/benchmarks/operation_counts; a test counts again.
std::map<std::string, PhaseCost> phase_costs(const std::string& kind, int order);

}  // namespace mixbeam
