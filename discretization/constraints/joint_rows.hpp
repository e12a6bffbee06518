/// Joints as equations of two vertices, theory (43): the master, which the rest of the point shares, and the slave, the
/// end of one member with displacement and triad of its own.
///
/// The frame (b1, b2, a) of a joint turns with the master, a = Lambda_m a_0; p = x_s - x_m. In virtual motions that the
/// joint permits, du_s = du_m + dtheta_m x p (+ dq a for a slider) and dtheta_s = dtheta_m (+ dq a for a hinge), so
///   master:  f_m + f_s,   m_m + m_s + p x f_s;
///   hinge:   u_s - u_m;   swings of Lambda_m^T Lambda_s against a_0 (swing.hpp),  a . m_s + k angle;
///   ball:    u_s - u_m;   m_s (which the master then does without);
///   slider:  b1 . p, b2 . p, a . f_s + k a . p;   rotation vector of Lambda_s Lambda_m^T.
#pragma once

#include "discretization/constraints/conditions.hpp"
#include "discretization/constraints/vertex_rows.hpp"

namespace mixbeam {

void mark_fixed_rows(const VertexJoint& joint, const KernelView<unsigned char*>& fixed);

/// Gives the slave's forces and moments to the master and leaves the free component to the slave; its constraint rows
/// become zero.
void join_rows(const VertexJoint& joint, const State& state, const KernelView<double*>& rows);

/// What the master's moment row takes of the slave's spatial rows.
Vec moment_on_master(const VertexJoint& joint, const State& state, const Vec& force, const Vec& moment);

/// Adds the spring and writes the constraint rows, after join_rows.
void set_joint_rows(const VertexJoint& joint, const State& state, const KernelView<double*>& rows);

/// Derivative of the rows above; the matrix holds the derivative of the spatial rows, and `force`, `moment` are the
/// spatial rows of the slave themselves.
void join_matrix_rows(const VertexJoint& joint, const State& state, const Vec& force, const Vec& moment,
                      const MatrixRows& matrix);

/// Angle of a hinge or distance of a slider in its free motion; zero for a ball joint. The angle goes on beyond pi, up
/// to 2 pi.
double joint_motion(const VertexJoint& joint, const State& state);

}  // namespace mixbeam
