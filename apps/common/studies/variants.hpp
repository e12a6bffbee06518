/// Questions of studies to a scene, and the changes of a scene or of the solver's parameters that they make; each
/// returns a changed copy.
#pragma once

#include "discretization/checks/expected_values.hpp"
#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

// Position of a point in a scene that was read, which names no others.
const Vector3& position_of(const Scene& scene, const std::string& point);

const Section& section_of(const Scene& scene, const Member& member);

/// A straight member, named after its ends; a support that holds these components.
Member straight_member(const std::string& start, const std::string& end, const std::string& section, int order,
                       int elements);
Support support_of(const std::string& point, const std::array<bool, 3>& displacement,
                   const std::array<bool, 3>& rotation);

/// Whether the scene is one straight member from the origin along x, clamped at its start, with one dead load at its
/// end, and nothing else.
bool is_straight_cantilever(const Scene& scene);

/// Whether the solver's parameters or the expected values of this load case ("": of a scene without any) ask for steps
/// on the way to the end. `scene`: of the case.
bool asks_for_path(const SolverParameters& parameters, const std::vector<ExpectedValue>& expected,
                   const std::string& load_case, const Scene& scene);

/// Every member with this order and this number of elements.
Scene with_mesh(Scene scene, int order, int elements_per_member);

/// All point loads and line loads times a factor.
Scene with_loads(Scene scene, double factor);

/// Sections `side` times as wide, of the same material (EA, GA ~ side^2, GIt, EI ~ side^4), under loads ~ side^4, which
/// bend them as much.
Scene with_side(Scene scene, double side);

/// Equal load steps, this many for each stage.
SolverParameters with_fixed_steps(SolverParameters parameters, int steps);

}  // namespace mixbeam
