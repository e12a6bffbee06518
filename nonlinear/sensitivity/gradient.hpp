/// Gradients of quantities of a state with respect to numbers of its scene, and to compliances and natural strains of
/// single elements, by one adjoint solution for each quantity, theory (80).
#pragma once

#include "discretization/quantities/quantity_set.hpp"
#include "discretization/state/member_samples.hpp"
#include "nonlinear/parameters/analysis_parameters.hpp"
#include "nonlinear/sensitivity/number_derivatives.hpp"

#include <optional>
#include <vector>

namespace mixbeam {

/// Gradients to compute for an equilibrium at a fixed load factor.
struct GradientRequest {
  const QuantitySet& quantities;
  std::vector<std::size_t> columns{};  ///< columns of the quantities
  std::vector<SceneNumber> numbers{};
  bool by_element = false;
  /// Solve once for each number instead of each quantity; unset: if there are fewer numbers, and no derivatives by
  /// elements. Always for frequencies, whose modes are those of `modes`.
  std::optional<bool> direct{};
  ModesParameters modes{};
  std::vector<std::size_t> of_patterns{};  ///< columns omitted, with a note, if they have no derivative
};

/// Appends a derivative to each gradient, which `take` sets; NaN if it rejects a number that comes from a pattern.
void add_number(const SceneNumber& number, std::vector<RecordedGradient>& gradients, const std::function<void()>& take);

/// Throws InputError if gradients are not available.
void require_differentiable(const BeamProblem& problem);

/// Computes gradients. For several modes with one frequency the derivative is NaN, and there is one for each direction,
/// "NAME, direction 1", the smallest first. One process only. Throws InputError if the equations are not a smooth
/// function of a number or a quantity has no derivative, LinearSolverError if the adjoint equations cannot be solved.
std::vector<RecordedGradient> gradients_of(BeamProblem& problem, const State& state, double load_factor,
                                           const GradientRequest& request);

/// Computes derivatives of one quantity of a state by stiffnesses (NaN for tapered and coupled sections), compliances
/// and natural strains of elements. `stresses`: increments whose N and M replace those of the state. Throws
/// std::invalid_argument for a quantity that consists of strains.
void find_by_element(const State& state, const StateDerivative& quantity, const Adjoint& adjoint,
                     RecordedGradient& gradient, const MixedVector* stresses = nullptr);

}  // namespace mixbeam
