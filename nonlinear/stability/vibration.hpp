/// Natural vibrations about a state in equilibrium.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"
#include "nonlinear/stability/independent_unknowns.hpp"

#include <array>
#include <complex>
#include <functional>
#include <vector>

namespace mixbeam {

/// Mode phi exp(s t) of (K + s C + s^2 M) phi = 0, C of damping and of Coriolis forces in a frame that turns. Where s
/// is complex phi is a part of its mode, of unit length.
struct VibrationMode {
  EigenMode pair;  ///< eigenvalue: real part of -s^2, omega^2; the mode with N and M; error: residual of the pair
  /// s: i omega; where omega^2 is below zero or complex, that of the motion that grows, and with the conjugate of
  /// omega^2 that of the one that decays; with C one for each conjugate pair.
  std::complex<double> rate{};
  double modal_mass = 0.0;                       ///< phi . M phi
  std::array<double, 3> participation{};         ///< phi . M e / modal_mass, e a unit translation along x, y, z
  std::array<std::vector<double>, 2> momenta{};  ///< G phi, theory (71): real and imaginary part; where asked for
};

/// Where a search for modes is.
struct ModeSearch {
  int found = 0, wanted = 0;  ///< modes whose residual is small enough; two more than asked for are wanted
  double load_factor = 0.0;
};
using ModeSearchObserver = std::function<void(const ModeSearch&)>;

/// The `count` lowest modes about a state, or fewer where not as many unknowns carry mass: largest eigenvalues 1 /
/// (omega^2 + shift) of (K + shift M)^-1 M, of which no mass is condensed, theory (72). The stiffness is the true one,
/// rigid sections included, theory (38). Modes that share a frequency are orthogonal in M. EigenMode::converged: the
/// inertia of K - omega^2 M above the modes found tells that none is missing below, theory (47); where loads have no
/// potential, and with C, nothing counts, and it tells that the equation of the mode holds. Those with C are the
/// eigenvalues 1 / s of largest size of T = ((-K^-1 C, -K^-1 M), (1, 0)), theory (73), about a state that supports
/// hold.
///
/// `in_plane`: of a scene in a plane, without motions that leave it. `observer`: called on every rank after each block
/// of solutions. `with_momenta`: VibrationMode::momenta are kept. Collective. Throws LinearSolverError where nothing
/// has a mass.
std::vector<VibrationMode> vibration_modes(BeamProblem& problem, const State& state, double load_factor, int count,
                                           bool in_plane = false, const ModeSearchObserver& observer = {},
                                           bool with_momenta = false);

}  // namespace mixbeam
