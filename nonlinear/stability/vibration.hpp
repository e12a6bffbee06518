/// Natural vibrations about a state in equilibrium.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"
#include "nonlinear/stability/eigen_mode.hpp"

#include <array>
#include <vector>

namespace mixbeam {

/// Mode phi of K phi = omega^2 M phi. Where loads have no potential omega^2 may be complex; then phi is the real part
/// of its mode, and with the conjugate the imaginary one.
struct VibrationMode {
  EigenMode pair;                         ///< eigenvalue omega^2; the mode with N and M; error: residual of the pair
  double imaginary = 0.0;                 ///< of omega^2
  double modal_mass = 0.0;                ///< phi . M phi
  std::array<double, 3> participation{};  ///< phi . M e / modal_mass, e a unit translation along x, y, z
};

/// The `count` lowest modes about a state, or fewer where not as many unknowns carry mass: largest eigenvalues 1 /
/// (omega^2 + shift) of (K + shift M)^-1 M, of which no mass is condensed, theory (72). The stiffness is the true one,
/// rigid sections included, theory (38). Modes that share a frequency are orthogonal in M. EigenMode::converged: the
/// inertia of K - omega^2 M above the modes found tells that none is missing below, theory (47); where loads have no
/// potential nothing counts, and it tells that the equation of the mode holds.
///
/// `in_plane`: of a scene in a plane, without motions that leave it. Collective. Throws LinearSolverError where nothing
/// has a mass.
std::vector<VibrationMode> vibration_modes(BeamProblem& problem, const State& state, double load_factor, int count,
                                           bool in_plane = false);

}  // namespace mixbeam
