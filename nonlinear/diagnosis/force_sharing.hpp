/// Detection of forces that are spoilt by rounding errors. Stiff redundant members distribute forces by their strains,
/// which are differences of numbers of order one: the rounding of these differences, times the stiffness, is added to
/// the correct forces without showing in any residual. Exactly rigid members distribute them arbitrarily.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"

#include <optional>
#include <string>

namespace mixbeam {

struct UncertainForce {
  std::string member{};
  int element = 0;      ///< index in the member
  bool rigid = false;   ///< inextensible or shear rigid there: any self-stress is in equilibrium
  double change = 0.0;  ///< change of the force by strains of the size of rounding errors, over the largest force
};

/// Finds the least certain force at an equilibrium, if it is uncertain by more than kUncertain. Solves one linear
/// system, or none if no section is that stiff or equilibrium alone determines the forces. None if the linear solver
/// fails. Collective.
std::optional<UncertainForce> uncertain_force(BeamProblem& problem, const State& state, double load_factor);

/// Share of the largest force beyond which a force is uncertain: half of the digits of a report.
inline constexpr double kUncertain = 1e-5;

/// `member "tie": ...`, one sentence for people.
std::string text_of(const UncertainForce& force);

}  // namespace mixbeam
