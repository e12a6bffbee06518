/// Natural vibrations about a state in equilibrium.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"
#include "nonlinear/stability/independent_unknowns.hpp"

#include <array>
#include <complex>
#include <functional>
#include <vector>

namespace mixbeam {

/// Mode phi exp(s t) of (K + s C + s^2 M) phi = 0, C of damping and of Coriolis forces in a rotating frame. For complex
/// s, phi is a real vector of the span of its mode, of unit length.
struct VibrationMode {
  EigenMode pair;  ///< eigenvalue: real part of -s^2, omega^2; the mode with N and M; error: residual of the pair
  /// s = i omega. For negative or complex omega^2 that of the growing motion, and for the conjugate of omega^2 that of
  /// the decaying one; with C one for each conjugate pair.
  std::complex<double> rate{};
  double modal_mass = 0.0;                       ///< phi . M phi
  std::array<double, 3> participation{};         ///< phi . M e / modal_mass, e a unit translation along x, y, z
  std::array<std::vector<double>, 2> momenta{};  ///< G phi, theory (71): real and imaginary part; if requested
};

/// Progress of a search for modes.
struct ModeSearch {
  int found = 0, wanted = 0;  ///< modes with a small enough residual; wanted: two more than requested
  double load_factor = 0.0;
};
using ModeSearchObserver = std::function<void(const ModeSearch&)>;

/// Finds the `count` lowest modes about a state, or fewer if fewer unknowns carry mass: largest eigenvalues 1 /
/// (omega^2 + shift) of (K + shift M)^-1 M, with no mass condensed, theory (72). The stiffness is the true one, rigid
/// sections included, theory (38). Modes that share a frequency are orthogonal in M. EigenMode::converged: the inertia
/// of K - omega^2 M above the modes found confirms that none is missing below, theory (47); if loads have no potential,
/// and with C, there is no count, and it means that the equation of the mode holds. Modes with C belong to the
/// eigenvalues 1 / s of largest magnitude of T = ((-K^-1 C, -K^-1 M), (1, 0)), theory (73), and need a state without
/// free rigid motions.
///
/// `in_plane`: planar scenes, without out-of-plane motions. `observer`: called on every rank after each block of
/// solutions. `with_momenta`: keep VibrationMode::momenta. Collective. Throws InputError if nothing has a mass,
/// LinearSolverError.
std::vector<VibrationMode> vibration_modes(BeamProblem& problem, const State& state, double load_factor, int count,
                                           bool in_plane = false, const ModeSearchObserver& observer = {},
                                           bool with_momenta = false);

}  // namespace mixbeam
