#include "discretization/constraints/constraint_rows.hpp"

#include "discretization/constraints/swing.hpp"

namespace mixbeam {

namespace {

/// Present position of a joint.
struct JointState {
  Quat master, slave;
  Mat frame;   ///< rows b1, b2, a, spatial
  Vec offset;  ///< p = x_s - x_m

  JointState(const VertexJoint& joint, const State& state)
      : master(load_quaternion(&state.views.vertex_rotation(joint.master, 0))),
        slave(load_quaternion(&state.views.vertex_rotation(joint.slave, 0))),
        frame(joint.frame * transpose(rotation_matrix(master))),
        offset(load_vector(&state.views.vertex_displacement(joint.slave, 0)) -
               load_vector(&state.views.vertex_displacement(joint.master, 0))) {}

  Vec direction(int i) const { return {{frame(i, 0), frame(i, 1), frame(i, 2)}}; }
  SwingTwist swing(const VertexJoint& joint) const { return SwingTwist(conjugate(master) * slave, joint.frame); }
  Vec turn() const { return log_quaternion(slave * conjugate(master)); }
};

Vec moment_on_master(const VertexJoint& joint, const JointState& at, const Vec& force, const Vec& moment) {
  const Vec by_force = cross(at.offset, force);
  return joint.kind == JointKind::ball ? by_force : by_force + moment;
}

void clear_constraint_rows(const VertexJoint& joint, const KernelView<double*>& rows) {
  for (int c = 0; c < kVertexDofs; ++c)
    if (joint.holds(c)) rows(vertex_row(joint.slave, c)) = 0.0;
}

}  // namespace

void mark_fixed_rows(const VertexJoint& joint, const KernelView<unsigned char*>& fixed) {
  for (int c = 0; c < kVertexDofs; ++c)
    if (joint.holds(c)) fixed(vertex_row(joint.slave, c)) = 1;
}

Vec moment_on_master(const VertexJoint& joint, const State& state, const Vec& force, const Vec& moment) {
  return moment_on_master(joint, JointState(joint, state), force, moment);
}

void join_rows(const VertexJoint& joint, const State& state, const KernelView<double*>& rows) {
  const JointState at(joint, state);
  const Vec force = rows_of(rows, joint.slave, kForcePart), moment = rows_of(rows, joint.slave, kMomentPart);
  set_rows_of(rows, joint.master, kForcePart, rows_of(rows, joint.master, kForcePart) + force);
  set_rows_of(rows, joint.master, kMomentPart,
              rows_of(rows, joint.master, kMomentPart) + moment_on_master(joint, at, force, moment));
  clear_constraint_rows(joint, rows);
  if (joint.kind == JointKind::hinge) rows(vertex_row(joint.slave, 5)) = dot(at.direction(2), moment);
  if (joint.kind == JointKind::slider) rows(vertex_row(joint.slave, 2)) = dot(at.direction(2), force);
}

void set_joint_rows(const VertexJoint& joint, const State& state, const KernelView<double*>& rows) {
  const JointState at(joint, state);
  const int s = joint.slave;
  if (joint.kind != JointKind::slider) set_rows_of(rows, s, kForcePart, at.offset);
  if (joint.kind == JointKind::hinge) {
    const SwingTwist swing = at.swing(joint);
    for (int i = 0; i < 2; ++i) rows(vertex_row(s, 3 + i)) = swing.swing[i];
    rows(vertex_row(s, 5)) += joint.stiffness * joint.angle(swing.angle, state);
  }
  if (joint.kind == JointKind::slider) {
    for (int i = 0; i < 2; ++i) rows(vertex_row(s, i)) = dot(at.direction(i), at.offset);
    rows(vertex_row(s, 2)) += joint.stiffness * dot(at.direction(2), at.offset);
    set_rows_of(rows, s, kMomentPart, at.turn());
  }
}

namespace {

/// The slave's forces and moments on the master: p x f_s also changes with p.
void add_to_master(const VertexJoint& joint, const JointState& at, const Vec& force, const MatrixRows& matrix) {
  const int m = joint.master, s = joint.slave;
  const Mat identity = identity_matrix<double>();
  matrix.add_rows(m, kForcePart, identity, s, kForcePart);
  matrix.add_rows(m, kMomentPart, hat(at.offset), s, kForcePart);
  if (joint.kind != JointKind::ball) matrix.add_rows(m, kMomentPart, identity, s, kMomentPart);
  matrix.add(m, kMomentPart, s, kForcePart, -1.0 * hat(force));
  matrix.add(m, kMomentPart, m, kForcePart, hat(force));
}

/// A row value . (u_s - u_m).
void add_relative(const VertexJoint& joint, int row, VertexPart part, const Vec& value, const MatrixRows& matrix) {
  matrix.add(joint.slave, row, joint.slave, part, value);
  matrix.add(joint.slave, row, joint.master, part, -value);
}

void set_hinge_rows(const VertexJoint& joint, const JointState& at, const Vec& moment, const MatrixRows& matrix) {
  const int s = joint.slave;
  const SwingTwist swing = at.swing(joint);
  for (int i = 0; i < 2; ++i)
    add_relative(joint, 3 + i, kMomentPart, transpose_times(at.frame, swing.swing_slope[i]), matrix);
  // a turns with the master: (dtheta_m x a) . m = dtheta_m . (a x m)
  matrix.add(s, 5, joint.master, kMomentPart, cross(at.direction(2), moment));
  add_relative(joint, 5, kMomentPart, joint.stiffness * transpose_times(at.frame, swing.angle_slope), matrix);
}

void set_slider_rows(const VertexJoint& joint, const JointState& at, const Vec& force, const MatrixRows& matrix) {
  const int s = joint.slave;
  const Mat inverse = inverse_tangent_map(at.turn());
  for (int i = 0; i < 3; ++i) {
    const Vec b = at.direction(i);
    const double factor = i < 2 ? 1.0 : joint.stiffness;
    add_relative(joint, i, kForcePart, factor * b, matrix);
    matrix.add(s, i, joint.master, kMomentPart, cross(b, factor * at.offset + (i < 2 ? 0.0 : 1.0) * force));
  }
  matrix.add(s, kMomentPart, s, kMomentPart, inverse);
  // Lambda_s Lambda_m^T turns by -(Lambda_s Lambda_m^T) dtheta_m when the master does
  const Mat turn = rotation_matrix(at.slave * conjugate(at.master));
  matrix.add(s, kMomentPart, joint.master, kMomentPart, -1.0 * (inverse * turn));
}

}  // namespace

void join_matrix_rows(const VertexJoint& joint, const State& state, const Vec& force, const Vec& moment,
                      const MatrixRows& matrix) {
  const JointState at(joint, state);
  const int s = joint.slave;
  add_to_master(joint, at, force, matrix);
  if (joint.kind == JointKind::hinge) matrix.combine(s, kMomentPart, at.frame);
  if (joint.kind == JointKind::slider) matrix.combine(s, kForcePart, at.frame);
  for (int c = 0; c < kVertexDofs; ++c)
    if (joint.holds(c)) matrix.clear(s, c);
  if (joint.kind != JointKind::slider) {
    const Mat identity = identity_matrix<double>();
    matrix.add(s, kForcePart, s, kForcePart, identity);
    matrix.add(s, kForcePart, joint.master, kForcePart, -1.0 * identity);
  }
  if (joint.kind == JointKind::hinge) set_hinge_rows(joint, at, moment, matrix);
  if (joint.kind == JointKind::slider) set_slider_rows(joint, at, force, matrix);
}

double stored_energy(const VertexJoint& joint, const State& state) {
  if (joint.kind == JointKind::ball || joint.stiffness == 0.0) return 0.0;
  const JointState at(joint, state);
  const double moved =
      joint.kind == JointKind::hinge ? joint.angle(at.swing(joint).angle, state) : dot(at.direction(2), at.offset);
  return 0.5 * joint.stiffness * moved * moved;
}

void follow_turns(const VertexJoint& joint, const State& from, State& to) {
  if (joint.angle.place >= 0)
    joint.angle.follow(JointState(joint, from).swing(joint).angle, from, JointState(joint, to).swing(joint).angle, to);
}

}  // namespace mixbeam
