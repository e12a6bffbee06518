/// Inverse statics: the stress-free shape that its loads deform into the drawn one, theory (77) to (79).
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

/// Forces of a structure with loops, which equilibrium alone does not determine.
enum class LoopForces {
  refused,
  closed,       ///< those that leave no stress in the structure without its loads
  least_energy  ///< those of least strain energy among all that balance the loads
};

/// The list "Inverse".
struct RestShapeParameters {
  LoopForces loops = LoopForces::refused;
  bool turns_triads = true;  ///< where shear is soft; else there is a natural shear strain, which nobody can make
  std::string load_case{};   ///< whose loads deform the rest shape into the drawn one
};

ListSpec rest_shape_spec();
/// Reads the list, which is validated.
RestShapeParameters read_rest_shape_parameters(const Teuchos::ParameterList& list);

/// Natural strains of one member, beside those of its drawn shape.
struct NaturalMember {
  std::string name;
  std::array<FieldTable, 2> tables;    ///< strains at the force points, curvatures at the moment points, material
  std::array<Vector3, 2> end_turns{};  ///< as of Eigenstrain
  double cut_length = 0.0;
};

/// A section of a member that is cut out of the structure and carries nothing.
struct NaturalStation {
  double arc_length = 0.0, natural_length = 0.0;  ///< from the start: as drawn, and of the stress-free member
  Vector3 position{};
  std::array<Vector3, 3> triad{};  ///< its axes
};

struct RestShape {
  std::vector<NaturalMember> members;  ///< as of the scene
  int stage = 1;                       ///< in which all loads grow, and the natural strains with them
  int redundancy = 0;                  ///< independent states of forces in balance without loads
  double stress_left = 0.0;            ///< forces without loads, relative to those under loads; NaN: not found
  double residual = 0.0;  ///< of the drawn state with the natural strains and all loads: largest scaled row
  double largest_curvature = 0.0, largest_strain = 0.0, largest_turn = 0.0;  ///< components
  int negative = 0;    ///< negative eigenvalues of the tangent of the drawn state
  std::string stable;  ///< of the drawn state, in the words of result files
};

/// Natural strains for which the structure under all its loads has the drawn shape. Throws InputError for what is not
/// offered, MemberError, LinearSolverError, and ConvergenceError where equilibrium of the drawn shape is not found.
RestShape find_rest_shape(const Scene& scene, const RestShapeParameters& wanted, const SolverParameters& parameters,
                          const Communicator& comm, const InputPlace& place);

/// The scene with these natural strains: its loads deform it into the shape that is drawn.
Scene with_rest_shape(Scene scene, const RestShape& shape);

/// Sections of a stress-free member from the drawn place of its start, `pieces` in each element.
std::vector<NaturalStation> natural_curve(const MeshMember& drawn, const NaturalMember& member, int pieces);

}  // namespace mixbeam
