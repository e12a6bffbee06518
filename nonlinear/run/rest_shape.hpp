/// Inverse statics: the stress-free shape that the loads deform into the drawn one, theory (77) to (79).
#pragma once

#include "discretization/mesh/communicator.hpp"
#include "discretization/mesh/mesh.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

#include <array>
#include <string>
#include <vector>

namespace mixbeam {

/// Choice of the forces that equilibrium does not determine in a structure with loops.
enum class LoopForces {
  refused,
  closed,       ///< such that the structure is free of stress without its loads
  least_energy  ///< least strain energy among all that balance the loads
};

/// The list "Inverse".
struct RestShapeParameters {
  LoopForces loops = LoopForces::refused;
  bool turns_triads = true;  ///< if sections are not shear rigid; else a natural shear strain, which cannot be made
  std::string load_case{};   ///< case whose loads deform the rest shape into the drawn one
};

ListSpec rest_shape_spec();
/// Reads the list, which is validated.
RestShapeParameters read_rest_shape_parameters(const Teuchos::ParameterList& list);

/// Natural strains of one member, in addition to those of its drawn shape.
struct NaturalMember {
  std::string name;
  std::array<FieldTable, 2> tables;    ///< strains at the force points, curvatures at the moment points, material
  std::array<Vector3, 2> end_turns{};  ///< see Eigenstrain
  double cut_length = 0.0;
};

/// A section of a member that is cut out of the structure and unloaded.
struct NaturalStation {
  double arc_length = 0.0, natural_length = 0.0;  ///< from the start: drawn, and of the stress-free member
  Vector3 position{};
  std::array<Vector3, 3> triad{};  ///< its axes
};

struct RestShape {
  std::vector<NaturalMember> members;  ///< (member of the scene)
  int stage = 1;                       ///< in which all loads grow, and the natural strains with them
  int redundancy = 0;                  ///< number of independent self-stress states
  double stress_left = 0.0;            ///< forces without loads, relative to those under loads; NaN: not found
  double residual = 0.0;               ///< largest scaled row of the drawn state with the natural strains and all loads
  double largest_curvature = 0.0, largest_strain = 0.0, largest_turn = 0.0;  ///< of components; turn: of angles
  int negative = 0;    ///< negative eigenvalues of the tangent of the drawn state
  std::string stable;  ///< stability of the drawn state, in the words of result files
};

/// Finds natural strains for which the structure under all its loads has the drawn shape. Throws InputError if that is
/// not offered, MemberError, LinearSolverError, and ConvergenceError if the drawn shape has no equilibrium.
RestShape find_rest_shape(const Scene& scene, const RestShapeParameters& wanted, const SolverParameters& parameters,
                          const Communicator& comm, const InputPlace& place);

/// Adds these natural strains to the scene, whose loads then deform it into the drawn shape.
Scene with_rest_shape(Scene scene, const RestShape& shape);

/// Integrates the axis of a stress-free member from its drawn start; `pieces`: sections per element.
std::vector<NaturalStation> natural_curve(const MeshMember& drawn, const NaturalMember& member, int pieces);

}  // namespace mixbeam
