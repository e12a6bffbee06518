/// Supports as equations of a vertex: theory (41).
///
/// The force rows are turned into the axes e_i of the support; a fixed one becomes e_i . (u - prescribed), a free one
/// keeps e_i . f and takes the spring k_i e_i . u. Rotations come in four ways:
///   - free: the moment rows stay as they are;
///   - all fixed: the rotation vector from the prescribed to the present triad;
///   - two fixed (a hinge about the third axis, any number of turns): the swings of Lambda_V (swing.hpp), and the
///   moment
///     about the third axis;
///   - one fixed, or springs: with theta the rotation vector of Lambda_V in the axes, a fixed one becomes theta_i, a
///   free
///     one (T(theta) e_i) . m + k_i theta_i, the derivative of the energy with respect to theta_i; |theta| < 2 pi.
#pragma once

#include "discretization/constraints/conditions.hpp"
#include "discretization/constraints/vertex_rows.hpp"

namespace mixbeam {

/// Marks the rows that hold a constraint in place of an equilibrium.
void mark_fixed_rows(const VertexSupport& support, const KernelView<unsigned char*>& fixed);

/// Rows of the vertex, spatial forces and moments, in the form described above; those of fixed components become zero.
void project_rows(const VertexSupport& support, const State& state, const KernelView<double*>& rows);

/// Adds springs and writes the fixed rows, after project_rows.
void set_support_rows(const VertexSupport& support, const State& state, double load_factor,
                      const KernelView<double*>& rows);

/// Derivative of the fixed rows with respect to the load factor.
void set_support_slopes(const VertexSupport& support, double load_factor, const KernelView<double*>& rows);

/// Whether the matrix rows need the moment on the vertex, because it is not balanced by loads alone.
inline bool turns_moment_rows(const VertexSupport& support) {
  return support.rotation_kind == SupportRotation::hinge || support.rotation_kind == SupportRotation::vector;
}

/// Derivative of the rows above; the matrix holds the derivative of the spatial rows, `moment` is the spatial moment
/// row itself.
void project_matrix_rows(const VertexSupport& support, const State& state, const Vec& moment, const MatrixRows& matrix);

/// Force and moment of a support and its springs on the vertex, from its spatial rows without it.
SpatialLoad support_reaction(const VertexSupport& support, const State& state, const Vec& force, const Vec& moment);

}  // namespace mixbeam
