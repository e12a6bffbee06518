/// Inertia of sections and of bodies at points.
#pragma once

#include "discretization/scene/scene.hpp"

namespace mixbeam {

/// Whether three moments of inertia are those of a body: none exceeds the sum of the others.
bool is_inertia(const std::array<double, 3>& inertia);

/// Lower factor of the matrix of 6 x 6 whose form is twice the kinetic energy per length of a section, of its velocity
/// and its spin along its axes; row by row, the lower triangle.
std::array<double, 21> mass_factor(const Section& section);

}  // namespace mixbeam
