/// Gradients of quantities of a state with respect to numbers of its scene, and to compliances and natural strains of
/// single elements: one transposed solution for each quantity, theory (80).
#pragma once

#include "discretization/quantities/quantity_set.hpp"
#include "discretization/state/member_samples.hpp"
#include "nonlinear/parameters/analysis_parameters.hpp"
#include "nonlinear/sensitivity/number_derivatives.hpp"

#include <optional>
#include <vector>

namespace mixbeam {

/// A state in equilibrium at a fixed load factor, and quantities of it.
struct GradientRequest {
  const QuantitySet& quantities;
  std::vector<std::size_t> columns{};  ///< of the quantities
  std::vector<SceneNumber> numbers{};
  bool by_element = false;
  /// By one solution for each number in place of each quantity; not said: where there are fewer numbers, and none of
  /// elements. Frequencies always, whose modes `modes` asks for.
  std::optional<bool> direct{};
  ModesParameters modes{};
  std::vector<std::size_t> of_patterns{};  ///< columns that are left out, with a note, where they have no derivative
};

/// Adds a derivative to each: NaN where `take`, which finds them, refuses a number that a pattern means.
void add_number(const SceneNumber& number, std::vector<RecordedGradient>& gradients, const std::function<void()>& take);

/// Throws InputError where gradients are not offered.
void require_differentiable(const BeamProblem& problem);

/// Of several modes with one frequency the derivative is NaN, and there is one for each direction, "NAME, direction 1",
/// the smallest first. One process only. Throws InputError for a number of which the equations are no smooth function
/// and for a quantity that has no derivative, LinearSolverError where the adjoint equations cannot be solved.
std::vector<RecordedGradient> gradients_of(BeamProblem& problem, const State& state, double load_factor,
                                           const GradientRequest& request);

/// Finds derivatives of one quantity of a state by stiffnesses (NaN of tapered and coupled sections), compliances and
/// natural strains of elements. `stresses`: increments whose N and M take the place of those of the state. Throws
/// std::invalid_argument for one that is made of strains.
void find_by_element(const State& state, const StateDerivative& quantity, const Adjoint& adjoint,
                     RecordedGradient& gradient, const MixedVector* stresses = nullptr);

}  // namespace mixbeam
