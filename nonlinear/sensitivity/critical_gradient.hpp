/// Gradients of the load factors of critical points with respect to numbers of their scene, theory (81), (82).
#pragma once

#include "nonlinear/sensitivity/gradient.hpp"
#include "nonlinear/stability/stability.hpp"

namespace mixbeam {

struct CriticalGradientRequest {
  std::string name{};  ///< "critical point 1"
  std::vector<SceneNumber> numbers{};
  bool by_element = false;
};

/// Computes the gradient "load factor at NAME" and, for a bifurcation, "imperfection sensitivity at NAME": where that
/// is not zero the derivative is NaN. For several modes together the derivative is NaN, and there is one for each
/// direction, "load factor at NAME, direction 1", the smallest first. `transposed` false: uses the mode instead of the
/// left null vector, from which it differs for follower loads. One process only. Throws like gradients_of().
std::vector<RecordedGradient> critical_gradients_of(BeamProblem& problem, const CriticalPoint& point,
                                                    const CriticalGradientRequest& request, bool transposed = true);

}  // namespace mixbeam
