#include "discretization/constraints/constraint_rows.hpp"

#include "discretization/constraints/swing.hpp"

namespace mixbeam {

namespace {

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

/// Swing of Lambda_V against the hinge's axis; its frame is the axes in cyclic order, that of the hinge last.
SwingTwist hinge_swing(const VertexSupport& support, const State& state, Mat& frame) {
  const int last = hinge_axis(support);
  for (int row = 0; row < 3; ++row)
    for (int c = 0; c < 3; ++c) frame(row, c) = support.axes((last + 1 + row) % 3, c);
  return SwingTwist(triad_of(support, state), frame);
}

/// What the moment rows are multiplied by: row i is e_i, or T(theta) e_i.
Mat moment_directions(const VertexSupport& support, const State& state) {
  if (support.rotation_kind == SupportRotation::hinge) return support.axes;
  return support.axes * transpose(tangent_map(continued_log(triad_of(support, state))));
}

}  // namespace

void mark_fixed_rows(const VertexSupport& support, const KernelView<unsigned char*>& fixed) {
  for (int c = 0; c < kVertexDofs; ++c)
    if (support.fixed[c]) fixed(vertex_row(support.vertex, c)) = 1;
}

void project_rows(const VertexSupport& support, const State& state, const KernelView<double*>& rows) {
  const int v = support.vertex;
  if (support.turns_forces) set_rows_of(rows, v, kForcePart, support.axes * rows_of(rows, v, kForcePart));
  if (turns_moment_rows(support))
    set_rows_of(rows, v, kMomentPart, moment_directions(support, state) * rows_of(rows, v, kMomentPart));
  for (int c = 0; c < kVertexDofs; ++c)
    if (support.fixed[c]) rows(vertex_row(v, c)) = 0.0;
}

void set_support_rows(const VertexSupport& support, const State& state, double load_factor,
                      const KernelView<double*>& rows) {
  const double amplitude = support.amplitude(load_factor);
  const int v = support.vertex;
  const Vec u = support.axes * displacement_of(support, state);
  for (int i = 0; i < 3; ++i) {
    double& row = rows(vertex_row(v, i));
    if (support.fixed[i])
      row = u[i] - amplitude * support.displacement[i];
    else
      row += support.displacement_stiffness[i] * u[i];
  }
  switch (support.rotation_kind) {
    case SupportRotation::free:
      break;
    case SupportRotation::fixed:  // the rotation from the prescribed triad to the present one
      set_rows_of(rows, v, kMomentPart,
                  log_quaternion(triad_of(support, state) * conjugate(exp_quaternion(amplitude * support.rotation))));
      break;
    case SupportRotation::hinge: {
      Mat frame;
      const SwingTwist swing = hinge_swing(support, state, frame);
      for (int i = 0; i < 2; ++i) rows(vertex_row(v, 3 + (hinge_axis(support) + 1 + i) % 3)) = swing.swing[i];
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

void set_support_slopes(const VertexSupport& support, double load_factor, const KernelView<double*>& rows) {
  const double slope = support.amplitude.slope(load_factor);
  for (int i = 0; i < 3; ++i) {
    if (support.fixed[i]) rows(vertex_row(support.vertex, i)) = -slope * support.displacement[i];
    if (support.fixed[3 + i])
      rows(vertex_row(support.vertex, 3 + i)) =
          support.rotation_kind == SupportRotation::fixed ? -slope * support.rotation[i] : 0.0;
  }
}

namespace {

void turn_force_rows(const VertexSupport& support, const MatrixRows& matrix) {
  const int v = support.vertex;
  if (support.turns_forces) matrix.combine(v, kForcePart, support.axes);
  for (int i = 0; i < 3; ++i) {
    if (support.fixed[i]) {
      matrix.clear(v, i);
      matrix.add(v, i, v, kForcePart, axis(support, i));
    } else if (support.displacement_stiffness[i] != 0.0) {
      matrix.add(v, i, v, kForcePart, support.displacement_stiffness[i] * axis(support, i));
    }
  }
}

/// The two swings in the rows of the fixed axes.
void set_hinge_rows(const VertexSupport& support, const State& state, const MatrixRows& matrix) {
  Mat frame;
  const SwingTwist swing = hinge_swing(support, state, frame);
  for (int i = 0; i < 2; ++i) {
    const int row = 3 + (hinge_axis(support) + 1 + i) % 3;
    matrix.clear(support.vertex, row);
    matrix.add(support.vertex, row, support.vertex, kMomentPart, transpose_times(frame, swing.swing_slope[i]));
  }
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

}  // namespace

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

SpatialLoad support_reaction(const VertexSupport& support, const State& state, const Vec& force, const Vec& moment) {
  const Vec u = support.axes * displacement_of(support, state), f = support.axes * force;
  Vec reaction, turning{};
  for (int i = 0; i < 3; ++i) reaction[i] = support.fixed[i] ? f[i] : -support.displacement_stiffness[i] * u[i];
  SpatialLoad result{transpose_times(support.axes, reaction), moment};
  if (support.rotation_kind == SupportRotation::free) result.moment = Vec{{0.0, 0.0, 0.0}};
  if (!turns_moment_rows(support)) return result;
  const Vec m = moment_directions(support, state) * moment;
  const Vec theta = continued_log(triad_of(support, state)), components = support.axes * theta;
  for (int i = 0; i < 3; ++i) turning[i] = support.fixed[3 + i] ? m[i] : -support.rotation_stiffness[i] * components[i];
  result.moment = transpose_times(support.axes, turning);
  if (support.rotation_kind == SupportRotation::vector)
    result.moment = transpose_times(inverse_tangent_map(theta), result.moment);
  return result;
}

double stored_energy(const VertexSupport& support, const State& state) {
  const Vec u = support.axes * displacement_of(support, state);
  double energy = 0.0;
  for (int i = 0; i < 3; ++i) energy += 0.5 * support.displacement_stiffness[i] * u[i] * u[i];
  if (support.rotation_kind != SupportRotation::vector) return energy;
  const Vec theta = support.axes * continued_log(triad_of(support, state));
  for (int i = 0; i < 3; ++i) energy += 0.5 * support.rotation_stiffness[i] * theta[i] * theta[i];
  return energy;
}

}  // namespace mixbeam
