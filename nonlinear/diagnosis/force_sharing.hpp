/// Finds forces that rounding errors share out. Members that are stiff and redundant share forces by their strains,
/// which are differences of numbers of size one: the rounding of these differences, times the stiffness, is added to
/// the right forces without any residual to tell. Exactly rigid ones share them in any way at all.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"

#include <optional>
#include <string>

namespace mixbeam {

struct UncertainForce {
  std::string member{};
  int element = 0;      ///< of the member
  bool rigid = false;   ///< inextensible or shear rigid there: any self-stress is in equilibrium
  double change = 0.0;  ///< of the force, from strains of the size of rounding errors, over the largest force at work
};

/// The force that is least certain at an equilibrium, if any is by more than kUncertain. Solves one linear system, and
/// nothing where no section is that stiff or equilibrium alone determines the forces. Where the linear solver fails
/// nothing is said. Collective.
std::optional<UncertainForce> uncertain_force(BeamProblem& problem, const State& state, double load_factor);

/// Share of the largest force at work: half of the digits of a report.
inline constexpr double kUncertain = 1e-5;

/// `member "tie": ...`, one sentence for people.
std::string text_of(const UncertainForce& force);

}  // namespace mixbeam
