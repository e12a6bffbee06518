/// What a run of a scene will take, from the scene alone: nothing here costs more than a walk along its members. Within
/// a factor of two; chains within a third.
#pragma once

#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

/// Memory in bytes, on top of what the program takes when it has nothing to do. Without the
/// points, members and loads of the scene, which are there already when this is asked.
struct Needs {
  long long members = 0, elements = 0, vertices = 0;
  long long interior = 0;      ///< unknowns inside the elements, eliminated there
  double memory = 0.0;         ///< most that a run holds at a time, on one rank
  double everywhere = 0.0;     ///< thereof what each of several ranks holds too
  double factors = 0.0;        ///< thereof the factors of the chains and of what they leave
  double file = 0.0;           ///< result file without steps [byte]
  double file_per_step = 0.0;  ///< what a step adds [byte]
  int steps = 0;               ///< that a path takes at least, the state at its start included
  /// Floating-point operations, and bytes that move, of a Newton iteration for what chains leave.
  double network_operations = 0.0, network_bytes = 0.0;

  long long unknowns() const { return 6 * vertices + interior; }
  double memory_of_rank(int ranks) const { return everywhere + (memory - everywhere) / ranks; }
};

/// Orders and elements are those of the members. Throws InputError for scenes of which no mesh can be made.
Needs needs_of(const Scene& scene, const SolverParameters& parameters);

/// Memory that a scene itself takes. [byte]
double bytes_of(const Scene& scene);

/// The same structure with fewer elements, where there are more than `most`: enough to see its shape, its plane and
/// its loads.
Scene coarse_scene(const Scene& scene, long long most);

}  // namespace mixbeam
