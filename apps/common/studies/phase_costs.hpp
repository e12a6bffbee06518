/// Costs of the phases of an iteration for each element of a chain, in floating-point operations and in bytes that have
/// to move.
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
  double flops = 0.0;  ///< counted by running the kernel on numbers that count
  /// Between memory and processor when every array that the phase reads or writes passes once, in the layouts of
  /// StateViews, ElementBlock, ElementEquations and ChainLevel; what caches keep between phases is not subtracted, the
  /// read before a write not added. Vertex data once for each element: a chain has as many vertices as elements.
  double bytes = 0.0;
};

/// By the name of the phase, for "spatial" or "planar" chains: those of Model::times() when chains are condensed,
/// and their sums. From a table that tests/benchmarks/operation_counts writes; a test counts again.
std::map<std::string, PhaseCost> phase_costs(const std::string& kind, int order);

}  // namespace mixbeam
