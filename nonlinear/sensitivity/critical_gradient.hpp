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

/// "load factor at NAME". Of a bifurcation, "imperfection sensitivity at NAME" beside it: of numbers that have one the
/// derivative is NaN. Of several modes together the derivative is NaN, and there is one for each direction, "load
/// factor at NAME, direction 1", the smallest first. `transposed` false: the mode in place of the left null vector, of
/// which loads that follow make something else. One process only. Throws as gradients_of() does.
std::vector<RecordedGradient> critical_gradients_of(BeamProblem& problem, const CriticalPoint& point,
                                                    const CriticalGradientRequest& request, bool transposed = true);

}  // namespace mixbeam
