#include "discretization/constraints/conditions.hpp"

#include "kernels/element/layout.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
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

// Samples for each stage: a formula that turns a support at a rate above the one found here only costs load steps.
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

}  // namespace mixbeam
