/// Queries of a scene, and variants of a scene or of the solver's parameters, for studies; a variant is a changed copy.
#pragma once

#include "discretization/checks/expected_values.hpp"
#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

// Position of a point, which must exist.
const Vector3& position_of(const Scene& scene, const std::string& point);

const Section& section_of(const Scene& scene, const Member& member);

/// A straight member, named after its ends; a support that fixes these components.
Member straight_member(const std::string& start, const std::string& end, const std::string& section, int order,
                       int elements);
Support support_of(const std::string& point, const std::array<bool, 3>& displacement,
                   const std::array<bool, 3>& rotation);

/// Whether the scene is one straight member from the origin along x, clamped at its start, with one dead load at its
/// end, and nothing else.
bool is_straight_cantilever(const Scene& scene);

/// Whether the solver's parameters or the expected values of this load case ("": a scene without load cases) need
/// states before the end of the path. `scene`: of the case.
bool asks_for_path(const SolverParameters& parameters, const std::vector<ExpectedValue>& expected,
                   const std::string& load_case, const Scene& scene);

/// Sets order and number of elements of every member.
Scene with_mesh(Scene scene, int order, int elements_per_member);

/// Multiplies all point loads and line loads by a factor.
Scene with_loads(Scene scene, double factor);

/// Makes sections `side` times as wide, of the same material (EA, GA ~ side^2, GIt, EI ~ side^4), and scales loads ~
/// side^4 for the same bending.
Scene with_side(Scene scene, double side);

/// Sets `steps` equal load steps per stage.
SolverParameters with_fixed_steps(SolverParameters parameters, int steps);

}  // namespace mixbeam
