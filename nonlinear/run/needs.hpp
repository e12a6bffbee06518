/// Forecast of the resources for a run, from the scene alone, at the cost of one loop over its members. Accurate within
/// a factor of two; for chains within a third.
#pragma once

#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

/// Resources of a run. Memory in bytes, in addition to that of an idle program, without the points, members and loads
/// of the scene, which exist already.
struct Needs {
  long long members = 0, elements = 0, vertices = 0;
  long long interior = 0;      ///< unknowns inside the elements, eliminated there
  double memory = 0.0;         ///< peak of a run on one rank
  double everywhere = 0.0;     ///< share of it that each of several ranks holds
  double factors = 0.0;        ///< share of it for factors of chains and of the remaining system
  double file = 0.0;           ///< result file without steps [byte]
  double file_per_step = 0.0;  ///< growth of the file per step [byte]
  int steps = 0;               ///< least number of steps of a path, including the state at its start
  /// Floating-point operations and memory traffic of a Newton iteration for the remaining system of chains.
  double network_operations = 0.0, network_bytes = 0.0;

  long long unknowns() const { return 6 * vertices + interior; }
  double memory_of_rank(int ranks) const { return everywhere + (memory - everywhere) / ranks; }
};

/// Forecasts for the orders and elements of the members. Throws InputError for scenes that cannot be meshed.
Needs needs_of(const Scene& scene, const SolverParameters& parameters);

/// Memory of a scene itself. [byte]
double bytes_of(const Scene& scene);

/// Returns the structure with fewer elements if there are more than `most`: enough to show its shape, its plane and its
/// loads.
Scene coarse_scene(const Scene& scene, long long most);

}  // namespace mixbeam
