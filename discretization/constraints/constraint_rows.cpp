#include "discretization/constraints/constraint_rows.hpp"

#include "discretization/constraints/swing.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace mixbeam {

namespace {

using namespace vector_algebra;

bool has_rotation_spring(const Support& support) {
  for (int i = 0; i < 3; ++i)
    if (!support.rotation_fixed[i] && support.rotation_stiffness[i] != 0.0) return true;
  return false;
}

SupportRotation rotation_kind(const Support& support) {
  const int fixed = support.rotation_fixed[0] + support.rotation_fixed[1] + support.rotation_fixed[2];
  if (fixed == 3) return SupportRotation::fixed;
  if (fixed == 2) return SupportRotation::hinge;
  return fixed == 1 || has_rotation_spring(support) ? SupportRotation::vector : SupportRotation::free;
}

bool is_counted(const Support& support) {
  return rotation_kind(support) == SupportRotation::hinge && has_rotation_spring(support);
}
bool is_counted(const Joint& joint) { return joint.kind == JointKind::hinge && joint.stiffness != 0.0; }

VertexSupport vertex_support(const Support& support, int stages, int index, int local) {
  VertexSupport result;
  result.vertex = local;
  result.index = index;
  result.amplitude = Amplitude(support.stage, stages, support.amplitude);
  result.axes = matrix_of(support.axes);
  result.turns_forces = support.axes != kGlobalAxes;
  result.displacement = to_vec3(support.prescribed_displacement);
  result.rotation = transpose_times(result.axes, to_vec3(support.prescribed_rotation));
  result.rotation_kind = rotation_kind(support);
  if (is_counted(support)) result.angle.place = index;
  for (int i = 0; i < 3; ++i) {
    result.fixed[i] = support.displacement_fixed[i];
    result.fixed[3 + i] = support.rotation_fixed[i];
    result.displacement_stiffness[i] = support.displacement_fixed[i] ? 0.0 : support.displacement_stiffness[i];
    result.rotation_stiffness[i] = support.rotation_fixed[i] ? 0.0 : support.rotation_stiffness[i];
  }
  return result;
}

}  // namespace

Mat matrix_of(const Axes& axes) {
  Mat rows;
  for (int i = 0; i < 3; ++i)
    for (int c = 0; c < 3; ++c) rows(i, c) = axes[i][c];
  return rows;
}

double CountedAngle::operator()(double angle, const State& state) const {
  return place < 0 ? angle : angle + 4.0 * kPi * state.turns[place];
}

void CountedAngle::follow(double angle_before, const State& from, double angle, State& to) const {
  if (place < 0) return;
  to.turns[place] = from.turns[place] + static_cast<int>(std::lround((angle_before - angle) / (4.0 * kPi)));
}

Conditions build_conditions(const Scene& scene, const Mesh& mesh, const Structure& structure) {
  Conditions conditions;
  const VertexPartition& partition = structure.partition;
  for (size_t i = 0; i < scene.supports.size(); ++i) {
    const int local = partition.place(vertex_of(mesh, scene.supports[i].point));
    if (local >= 0)
      conditions.supports.push_back(vertex_support(scene.supports[i], scene.stages, static_cast<int>(i), local));
  }
  bool counts =
      std::any_of(scene.supports.begin(), scene.supports.end(), [](const Support& s) { return is_counted(s); });
  for (size_t i = 0; i < mesh.joints.size(); ++i) {
    const MeshJoint& joint = mesh.joints[i];
    const Joint& described = scene.joints[joint.joint];
    counts = counts || is_counted(described);
    const int master = partition.place(joint.master);
    if (master < 0) continue;
    conditions.joints.push_back(
        {master, partition.place(joint.slave), described.kind, matrix_of(joint_frame(described)), described.stiffness});
    if (is_counted(described)) conditions.joints.back().angle.place = static_cast<int>(scene.supports.size() + i);
  }
  if (counts) conditions.counted_angles = static_cast<int>(scene.supports.size() + mesh.joints.size());
  return conditions;
}

namespace {

// Samples per stage: a formula that rotates a support faster than found here only costs load steps.
constexpr int kSlopeSamples = 64;

double steepest_slope(const Support& support, int stages, const LoadClock& clock) {
  if (clock.piece()) return clock.largest_rate(support.stage, support.amplitude);
  if (support.amplitude.empty()) return 1.0;
  const Amplitude amplitude(support.stage, stages, support.amplitude);
  double steepest = 0.0;
  for (int i = 0; i <= stages * kSlopeSamples; ++i) {
    const double slope = std::abs(amplitude.slope(static_cast<double>(i) / kSlopeSamples));
    if (std::isfinite(slope)) steepest = std::max(steepest, slope);
  }
  return steepest;
}

}  // namespace

double largest_prescribed_rotation(const Scene& scene, const LoadClock& clock) {
  double largest = 0.0;
  for (const Support& s : scene.supports)
    if (!is_zero(s.prescribed_rotation))
      largest = std::max(largest, steepest_slope(s, scene.stages, clock) * norm(to_vec3(s.prescribed_rotation)));
  return largest;
}

double* MatrixRows::entries(size_t row, int column_place) const {
  const int wanted = kVertexDofs * column_place;
  size_t low = matrix_.graph.row_map(row) / kVertexDofs, high = matrix_.graph.row_map(row + 1) / kVertexDofs;
  while (low < high) {  // the blocks of six ascend
    const size_t middle = (low + high) / 2;
    if (matrix_.graph.entries(kVertexDofs * middle) < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  if (kVertexDofs * low >= matrix_.graph.row_map(row + 1) || matrix_.graph.entries(kVertexDofs * low) != wanted)
    throw std::logic_error("the matrix has no entry where a joint couples two vertices");
  return &matrix_.values(kVertexDofs * low);
}

void MatrixRows::clear(int vertex, int component) const {
  const size_t cleared = row(vertex, component);
  for (size_t k = matrix_.graph.row_map(cleared); k < matrix_.graph.row_map(cleared + 1); ++k) matrix_.values(k) = 0.0;
}

void MatrixRows::add(int vertex, int component, int column_vertex, VertexPart column_part, const Vec& value) const {
  double* to = entries(row(vertex, component), place_(column_vertex)) + column_part;
  for (int j = 0; j < 3; ++j) to[j] += value[j];
}

void MatrixRows::add(int vertex, VertexPart part, int column_vertex, VertexPart column_part, const Mat& block) const {
  for (int i = 0; i < 3; ++i)
    add(vertex, part + i, column_vertex, column_part, Vec{{block(i, 0), block(i, 1), block(i, 2)}});
}

void MatrixRows::add_rows(int vertex, VertexPart part, const Mat& factor, int other, VertexPart other_part) const {
  const size_t first = matrix_.graph.row_map(row(other, other_part));
  const size_t width = matrix_.graph.row_map(row(other, other_part) + 1) - first;
  for (size_t block = 0; block < width; block += kVertexDofs) {
    const int column_place = matrix_.graph.entries(first + block) / kVertexDofs;
    for (int i = 0; i < 3; ++i) {
      double* to = entries(row(vertex, part + i), column_place);
      for (int c = 0; c < kVertexDofs; ++c)
        for (int j = 0; j < 3; ++j) to[c] += factor(i, j) * matrix_.values(first + j * width + block + c);
    }
  }
}

void MatrixRows::combine(int vertex, VertexPart part, const Mat& factor) const {
  const size_t first = matrix_.graph.row_map(row(vertex, part));
  const size_t width = matrix_.graph.row_map(row(vertex, part) + 1) - first;
  for (size_t k = 0; k < width; ++k) {
    const Vec column{
        {matrix_.values(first + k), matrix_.values(first + width + k), matrix_.values(first + 2 * width + k)}};
    const Vec combined = factor * column;
    for (int i = 0; i < 3; ++i) matrix_.values(first + i * width + k) = combined[i];
  }
}

namespace {

// Supports as equations of a vertex: theory (41).
//
// The force rows are projected on the axes e_i of the support; a fixed one becomes e_i . (u - prescribed), a free one
// keeps e_i . f, to which external_energy.hpp has added the spring k_i e_i . u. Rotations have four cases:
//   - free: the moment rows are unchanged;
//   - all fixed: the rotation vector from the prescribed to the current triad;
//   - two fixed (a hinge about the third axis, any number of turns): the swings of Lambda_V (swing.hpp), and the moment
//     about the third axis, with a spring there + k angle (State::turns);
//   - one fixed, or springs and fewer than two: with theta the rotation vector of Lambda_V in the axes, a fixed one
//     becomes theta_i, a free one (T(theta) e_i) . m + k_i theta_i, the derivative of the energy with respect to
//     theta_i; |theta| < 2 pi.

Vec axis(const VertexSupport& support, int i) { return {{support.axes(i, 0), support.axes(i, 1), support.axes(i, 2)}}; }

Quat triad_of(const VertexSupport& support, const State& state) {
  return load_quaternion(&state.views.vertex_rotation(support.vertex, 0));
}

Vec displacement_of(const VertexSupport& support, const State& state) {
  return load_vector(&state.views.vertex_displacement(support.vertex, 0));
}

int hinge_axis(const VertexSupport& support) {
  for (int i = 0; i < 3; ++i)
    if (!support.fixed[3 + i]) return i;
  return 2;
}

/// Swing of Lambda_V relative to the hinge axis; the frame is the axes in cyclic order, that of the hinge last.
SwingTwist hinge_swing(const VertexSupport& support, const State& state, Mat& frame) {
  const int last = hinge_axis(support);
  for (int row = 0; row < 3; ++row)
    for (int c = 0; c < 3; ++c) frame(row, c) = support.axes((last + 1 + row) % 3, c);
  return SwingTwist(triad_of(support, state), frame);
}

/// Angles about the axes: zero except for the counted one about the free axis.
Vec hinge_angles(const VertexSupport& support, const State& state) {
  Mat frame;
  Vec angles{{0.0, 0.0, 0.0}};
  angles[hinge_axis(support)] = support.angle(hinge_swing(support, state, frame).angle, state);
  return angles;
}

/// Directions onto which the moment rows are projected: row i is e_i, or T(theta) e_i.
Mat moment_directions(const VertexSupport& support, const State& state) {
  if (support.rotation_kind == SupportRotation::hinge) return support.axes;
  return support.axes * transpose(tangent_map(continued_log(triad_of(support, state))));
}

/// Projects the spatial rows of the vertex to the form described above; those of fixed components become zero.
void project_rows(const VertexSupport& support, const State& state, const KernelView<double*>& rows) {
  const int v = support.vertex;
  if (support.turns_forces) set_rows_of(rows, v, kForcePart, support.axes * rows_of(rows, v, kForcePart));
  if (turns_moment_rows(support))
    set_rows_of(rows, v, kMomentPart, moment_directions(support, state) * rows_of(rows, v, kMomentPart));
  for (int c = 0; c < kVertexDofs; ++c)
    if (support.fixed[c]) rows(vertex_row(v, c)) = 0.0;
}

/// Adds springs against rotation and writes the fixed rows, after project_rows.
void set_support_rows(const VertexSupport& support, const State& state, double load_factor,
                      const KernelView<double*>& rows) {
  const double amplitude = support.amplitude(load_factor);
  const int v = support.vertex;
  const Vec u = support.axes * displacement_of(support, state);
  for (int i = 0; i < 3; ++i) {
    double& row = rows(vertex_row(v, i));
    if (support.fixed[i]) row = u[i] - amplitude * support.displacement[i];
  }
  switch (support.rotation_kind) {
    case SupportRotation::free:
      break;
    case SupportRotation::fixed:  // rotation from the prescribed triad to the current one
      set_rows_of(rows, v, kMomentPart,
                  log_quaternion(triad_of(support, state) * conjugate(exp_quaternion(amplitude * support.rotation))));
      break;
    case SupportRotation::hinge: {
      Mat frame;
      const SwingTwist swing = hinge_swing(support, state, frame);
      const int last = hinge_axis(support);
      for (int i = 0; i < 2; ++i) rows(vertex_row(v, 3 + (last + 1 + i) % 3)) = swing.swing[i];
      if (support.angle.place >= 0)
        rows(vertex_row(v, 3 + last)) += support.rotation_stiffness[last] * support.angle(swing.angle, state);
      break;
    }
    case SupportRotation::vector: {
      const Vec theta = support.axes * continued_log(triad_of(support, state));
      for (int i = 0; i < 3; ++i) {
        double& row = rows(vertex_row(v, 3 + i));
        row = support.fixed[3 + i] ? theta[i] : row + support.rotation_stiffness[i] * theta[i];
      }
      break;
    }
  }
}

/// Derivative of the fixed rows with respect to the load factor.
void set_support_slopes(const VertexSupport& support, double load_factor, const KernelView<double*>& rows) {
  const double slope = support.amplitude.slope(load_factor);
  for (int i = 0; i < 3; ++i) {
    if (support.fixed[i]) rows(vertex_row(support.vertex, i)) = -slope * support.displacement[i];
    if (support.fixed[3 + i])
      rows(vertex_row(support.vertex, 3 + i)) =
          support.rotation_kind == SupportRotation::fixed ? -slope * support.rotation[i] : 0.0;
  }
}

void turn_force_rows(const VertexSupport& support, const MatrixRows& matrix) {
  const int v = support.vertex;
  if (support.turns_forces) matrix.combine(v, kForcePart, support.axes);
  for (int i = 0; i < 3; ++i) {
    if (!support.fixed[i]) continue;
    matrix.clear(v, i);
    matrix.add(v, i, v, kForcePart, axis(support, i));
  }
}

/// Sets the two swings in the rows of the fixed axes and the spring in that of the free one.
void set_hinge_rows(const VertexSupport& support, const State& state, const MatrixRows& matrix) {
  Mat frame;
  const SwingTwist swing = hinge_swing(support, state, frame);
  for (int i = 0; i < 2; ++i) {
    const int row = 3 + (hinge_axis(support) + 1 + i) % 3;
    matrix.clear(support.vertex, row);
    matrix.add(support.vertex, row, support.vertex, kMomentPart, transpose_times(frame, swing.swing_slope[i]));
  }
  const int last = hinge_axis(support);
  if (support.angle.place >= 0)
    matrix.add(support.vertex, 3 + last, support.vertex, kMomentPart,
               support.rotation_stiffness[last] * transpose_times(frame, swing.angle_slope));
}

/// d theta = T^-1 dtheta_V; the free rows (T e_i) . m also change with T.
void set_rotation_vector_rows(const VertexSupport& support, const State& state, const Vec& moment,
                              const MatrixRows& matrix) {
  const int v = support.vertex;
  const Vec theta = continued_log(triad_of(support, state));
  const StumpffValues<double> c = stumpff(dot(theta, theta));
  const Mat inverse = inverse_tangent_map(theta);
  for (int i = 0; i < 3; ++i) {
    Vec by_theta = axis(support, i);
    if (support.fixed[3 + i])
      matrix.clear(v, 3 + i);
    else
      by_theta = support.rotation_stiffness[i] * by_theta +
                 transpose_times(tangent_map_derivative(theta, axis(support, i), c), moment);
    matrix.add(v, 3 + i, v, kMomentPart, transpose_times(inverse, by_theta));
  }
}

/// Derivative of the rows above. The matrix holds the derivative of the spatial rows; `moment` is the spatial moment
/// row.
void project_matrix_rows(const VertexSupport& support, const State& state, const Vec& moment,
                         const MatrixRows& matrix) {
  turn_force_rows(support, matrix);
  const int v = support.vertex;
  if (turns_moment_rows(support)) matrix.combine(v, kMomentPart, moment_directions(support, state));
  switch (support.rotation_kind) {
    case SupportRotation::free:
      break;
    case SupportRotation::fixed:
      for (int i = 3; i < kVertexDofs; ++i) matrix.clear(v, i);
      matrix.add(v, kMomentPart, v, kMomentPart, identity_matrix<double>());
      break;
    case SupportRotation::hinge:
      set_hinge_rows(support, state, matrix);
      break;
    case SupportRotation::vector:
      set_rotation_vector_rows(support, state, moment, matrix);
      break;
  }
}

/// Largest distance from a whole number of turns; farther away the state is no equilibrium and cannot be counted.
constexpr double kWholeTurn = 1e-3;

// Joints as equations of two vertices, theory (43): the master, which the rest of the point shares, and the slave, the
// end of one member with its own displacement and triad.
//
// The frame (b1, b2, a) of a joint rotates with the master, a = Lambda_m a_0; p = x_s - x_m. Virtual motions admitted
// by the joint are du_s = du_m + dtheta_m x p (+ dq a for a slider) and dtheta_s = dtheta_m (+ dq a for a hinge), so
//   master:  f_m + f_s,   m_m + m_s + p x f_s;
//   hinge:   u_s - u_m;   swings of Lambda_m^T Lambda_s against a_0 (swing.hpp),  a . m_s + k angle;
//   ball:    u_s - u_m;   m_s (which the master's row then omits);
//   slider:  b1 . p, b2 . p, a . f_s + k a . p;   rotation vector of Lambda_s Lambda_m^T.

/// Current configuration of a joint.
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

/// Contribution of the slave's spatial rows to the master's moment row.
Vec moment_on_master(const VertexJoint& joint, const JointState& at, const Vec& force, const Vec& moment) {
  const Vec by_force = cross(at.offset, force);
  return joint.kind == JointKind::ball ? by_force : by_force + moment;
}

void clear_constraint_rows(const VertexJoint& joint, const KernelView<double*>& rows) {
  for (int c = 0; c < kVertexDofs; ++c)
    if (joint.holds(c)) rows(vertex_row(joint.slave, c)) = 0.0;
}

/// Adds the spring and writes the constraint rows, after join_rows.
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

/// Adds the slave's forces and moments to the rows of the master: p x f_s also changes with p.
void add_to_master(const VertexJoint& joint, const JointState& at, const Vec& force, const MatrixRows& matrix) {
  const int m = joint.master, s = joint.slave;
  const Mat identity = identity_matrix<double>();
  matrix.add_rows(m, kForcePart, identity, s, kForcePart);
  matrix.add_rows(m, kMomentPart, hat(at.offset), s, kForcePart);
  if (joint.kind != JointKind::ball) matrix.add_rows(m, kMomentPart, identity, s, kMomentPart);
  matrix.add(m, kMomentPart, s, kForcePart, -1.0 * hat(force));
  matrix.add(m, kMomentPart, m, kForcePart, hat(force));
}

/// Adds value . (u_s - u_m) to a row.
void add_relative(const VertexJoint& joint, int row, VertexPart part, const Vec& value, const MatrixRows& matrix) {
  matrix.add(joint.slave, row, joint.slave, part, value);
  matrix.add(joint.slave, row, joint.master, part, -value);
}

void set_hinge_rows(const VertexJoint& joint, const JointState& at, const Vec& moment, const MatrixRows& matrix) {
  const int s = joint.slave;
  const SwingTwist swing = at.swing(joint);
  for (int i = 0; i < 2; ++i)
    add_relative(joint, 3 + i, kMomentPart, transpose_times(at.frame, swing.swing_slope[i]), matrix);
  // a rotates with the master: (dtheta_m x a) . m = dtheta_m . (a x m)
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
  // Lambda_s Lambda_m^T rotates by -(Lambda_s Lambda_m^T) dtheta_m with the master
  const Mat turn = rotation_matrix(at.slave * conjugate(at.master));
  matrix.add(s, kMomentPart, joint.master, kMomentPart, -1.0 * (inverse * turn));
}

/// Derivative of the rows above. The matrix holds the derivative of the spatial rows; `force`, `moment` are the spatial
/// rows of the slave.
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

}  // namespace

SpatialLoad support_reaction(const VertexSupport& support, const State& state, const Vec& force, const Vec& moment) {
  const Vec u = support.axes * displacement_of(support, state), f = support.axes * force;
  Vec reaction, turning{};
  for (int i = 0; i < 3; ++i) reaction[i] = support.fixed[i] ? f[i] : -support.displacement_stiffness[i] * u[i];
  SpatialLoad result{transpose_times(support.axes, reaction), moment};
  if (support.rotation_kind == SupportRotation::free) result.moment = Vec{{0.0, 0.0, 0.0}};
  if (!turns_moment_rows(support)) return result;
  const Vec m = moment_directions(support, state) * moment;
  const Vec theta = continued_log(triad_of(support, state));
  const Vec components =
      support.rotation_kind == SupportRotation::hinge ? hinge_angles(support, state) : support.axes * theta;
  for (int i = 0; i < 3; ++i) turning[i] = support.fixed[3 + i] ? m[i] : -support.rotation_stiffness[i] * components[i];
  result.moment = transpose_times(support.axes, turning);
  if (support.rotation_kind == SupportRotation::vector)
    result.moment = transpose_times(inverse_tangent_map(theta), result.moment);
  return result;
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

double stored_energy(const VertexSupport& support, const State& state) {
  double energy = 0.0;
  if (support.rotation_kind != SupportRotation::vector && support.angle.place < 0) return energy;
  const Vec theta = support.rotation_kind == SupportRotation::hinge
                        ? hinge_angles(support, state)
                        : support.axes * continued_log(triad_of(support, state));
  for (int i = 0; i < 3; ++i) energy += 0.5 * support.rotation_stiffness[i] * theta[i] * theta[i];
  return energy;
}

double stored_energy(const VertexJoint& joint, const State& state) {
  if (joint.kind == JointKind::ball || joint.stiffness == 0.0) return 0.0;
  const JointState at(joint, state);
  const double moved =
      joint.kind == JointKind::hinge ? joint.angle(at.swing(joint).angle, state) : dot(at.direction(2), at.offset);
  return 0.5 * joint.stiffness * moved * moved;
}

void ConstraintRows::follow(const State& from, State& to) const {
  to.turns.assign(counted_angles_, 0);
  if (counted_angles_ == 0) return;
  for (const VertexSupport& support : supports_) {
    Mat frame;
    if (support.angle.place >= 0)
      support.angle.follow(hinge_swing(support, from, frame).angle, from, hinge_swing(support, to, frame).angle, to);
  }
  for (const VertexJoint& joint : joints_)
    if (joint.angle.place >= 0)
      joint.angle.follow(JointState(joint, from).swing(joint).angle, from, JointState(joint, to).swing(joint).angle,
                         to);
}

void ConstraintRows::count(const KernelView<double*>& rows, State& state) const {
  const auto add = [&](const CountedAngle& angle, double row, double stiffness) {
    if (angle.place < 0) return;
    const double turns = row / (4.0 * kPi * stiffness);
    if (std::abs(turns - std::round(turns)) < kWholeTurn)
      state.turns[angle.place] -= static_cast<int>(std::lround(turns));
  };
  for (const VertexSupport& support : supports_) {
    const int last = hinge_axis(support);
    add(support.angle, rows(vertex_row(support.vertex, 3 + last)), support.rotation_stiffness[last]);
  }
  for (const VertexJoint& joint : joints_) add(joint.angle, rows(vertex_row(joint.slave, 5)), joint.stiffness);
}

void ConstraintRows::keep_turns(const State& from, State& to) const {
  to.turns.assign(counted_angles_, 0);
  const auto keep = [&](const CountedAngle& angle) {
    if (angle.place >= 0) to.turns[angle.place] = from.turns[angle.place];
  };
  for (const VertexSupport& support : supports_) keep(support.angle);
  for (const VertexJoint& joint : joints_) keep(joint.angle);
}

ConstraintRows::ConstraintRows(const Conditions& conditions)
    : supports_(conditions.supports), joints_(conditions.joints), counted_angles_(conditions.counted_angles) {
  std::set<int> vertices;
  for (const VertexSupport& support : supports_)
    if (turns_moment_rows(support)) vertices.insert(support.vertex);
  for (const VertexJoint& joint : joints_) vertices.insert({joint.master, joint.slave});
  for (int vertex : vertices) unloaded_.push_back({vertex});
}

int ConstraintRows::index_of(int vertex) const {
  const auto found = std::lower_bound(unloaded_.begin(), unloaded_.end(), vertex,
                                      [](const CarriedForce& f, int v) { return f.vertex < v; });
  return static_cast<int>(found - unloaded_.begin());
}

void ConstraintRows::mark_fixed(const KernelView<unsigned char*>& fixed) const {
  for (int c = 0; c < kVertexDofs; ++c) {
    for (const VertexSupport& support : supports_)
      if (support.fixed[c]) fixed(vertex_row(support.vertex, c)) = 1;
    for (const VertexJoint& joint : joints_)
      if (joint.holds(c)) fixed(vertex_row(joint.slave, c)) = 1;
  }
}

void ConstraintRows::project(const State& state, const KernelView<double*>& rows) const {
  for (const VertexJoint& joint : joints_) join_rows(joint, state, rows);
  for (const VertexSupport& support : supports_) project_rows(support, state, rows);
}

void ConstraintRows::set(const State& state, double load_factor, const KernelView<double*>& rows) const {
  for (const VertexJoint& joint : joints_) set_joint_rows(joint, state, rows);
  for (const VertexSupport& support : supports_) set_support_rows(support, state, load_factor, rows);
}

void ConstraintRows::scale_springs(const ResidualScales& scales, bool inverse, const KernelView<double*>& rows) const {
  for (const VertexJoint& joint : joints_) {
    if (joint.kind == JointKind::ball) continue;
    const bool turns = joint.kind == JointKind::hinge;
    const double noise = joint.stiffness * (turns ? scales.rotation_noise : scales.displacement_noise);
    const double factor = std::max(1.0, noise / (turns ? scales.moment : scales.force));
    rows(vertex_row(joint.slave, turns ? 5 : 2)) *= inverse ? factor : 1.0 / factor;
  }
}

void ConstraintRows::set_slopes(double load_factor, const KernelView<double*>& rows) const {
  for (const VertexSupport& support : supports_) set_support_slopes(support, load_factor, rows);
}

CarriedForces ConstraintRows::carried(const State& state, const KernelView<double*>& rows) const {
  CarriedForces carried = unloaded_;
  for (CarriedForce& f : carried) {
    f.force = rows_of(rows, f.vertex, kForcePart);
    f.moment = f.joined_moment = rows_of(rows, f.vertex, kMomentPart);
  }
  for (const VertexJoint& joint : joints_) {
    const CarriedForce& slave = carried[index_of(joint.slave)];
    carried[index_of(joint.master)].joined_moment +=
        moment_on_master(joint, JointState(joint, state), slave.force, slave.moment);
  }
  return carried;
}

void ConstraintRows::project(const State& state, const CarriedForces& carried, const MatrixRows& rows) const {
  // theory (44), beside second variations; loads have added their part
  for (const CarriedForce& f : carried) rows.add(f.vertex, kMomentPart, f.vertex, kMomentPart, -0.5 * hat(f.moment));
  for (const VertexJoint& joint : joints_) {
    const CarriedForce& slave = carried[index_of(joint.slave)];
    join_matrix_rows(joint, state, slave.force, slave.moment, rows);
  }
  for (const VertexSupport& support : supports_) {
    const Vec moment =
        turns_moment_rows(support) ? carried[index_of(support.vertex)].joined_moment : Vec{{0.0, 0.0, 0.0}};
    project_matrix_rows(support, state, moment, rows);
  }
}

}  // namespace mixbeam
