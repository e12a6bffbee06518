#include "nonlinear/run/imperfect_scene.hpp"

#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/state/sampling.hpp"
#include "kernels/math/constants.hpp"
#include "nonlinear/stability/linear_buckling.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

using namespace vector_algebra;

/// Both are asked for beside the positive ones.
constexpr int kNegativeModes = 2;

double largest_displacement(const Model& model, const State& state) {
  double largest = 0.0;
  for (int vertex = 0; vertex < model.mesh().vertices(); ++vertex) {
    const std::array<double, 6> motion = vertex_motion(model, state, vertex);
    largest = std::max(largest, std::hypot(motion[0], motion[1], motion[2]));
  }
  return largest;
}

/// Undeformed structure, moved by the modes that are asked for.
State moved_by_modes(BeamProblem& problem, const Scene& scene, const InputPlace& place) {
  int most = 0;
  for (const ModeImperfection& wanted : scene.imperfection_modes) most = std::max(most, wanted.mode);
  std::vector<EigenMode> modes;
  for (EigenMode& mode : linear_buckling(problem, most + kNegativeModes))
    if (mode.eigenvalue > 0.0) modes.push_back(std::move(mode));
  std::stable_sort(modes.begin(), modes.end(),
                   [](const EigenMode& a, const EigenMode& b) { return a.eigenvalue < b.eigenvalue; });
  const State reference = problem.model.reference_state();
  State moved = reference;
  for (const ModeImperfection& wanted : scene.imperfection_modes) {
    const InputPlace here = place[wanted.name]["Mode"];
    if (static_cast<std::size_t>(wanted.mode) > modes.size())
      throw here.error("value " + std::to_string(wanted.mode) + "; allowed: " +
                       (modes.empty() ? "none, for no load factor above zero is critical by linear buckling"
                                      : "1 to " + std::to_string(modes.size()) +
                                            ", the modes of linear buckling with a load factor above zero"));
    const MixedVector& mode = modes[static_cast<std::size_t>(wanted.mode) - 1].mode;
    const double unit_size = largest_displacement(problem.model, problem.model.apply(reference, mode, 1.0));
    if (!(unit_size > 0.0))
      throw here.error("value " + std::to_string(wanted.mode) + ": this mode moves no vertex; allowed: one that does");
    moved = problem.model.apply(moved, mode, wanted.amplitude / unit_size);
  }
  return moved;
}

/// Angle by which `triad` is turned about its first axis against `carried`, nearest to `last`.
double turned(const Quaternion<double>& carried, const Quaternion<double>& triad, double last) {
  const Quaternion<double> q = conjugate(carried) * triad;
  const double angle = 2.0 * std::atan2(q.x, q.w);
  return angle - 2.0 * kPi * std::round((angle - last) / (2.0 * kPi));
}

/// Arc length over length of the place of a curve that is nearest to `point`, not far from `position`.
double nearest_position(const ReferenceCurve& curve, const Vec3<double>& point, double position) {
  constexpr int kSteps = 20;  // Newton's method from a place that is right to a small share of an element
  double s = position * curve.length;
  for (int step = 0; step < kSteps; ++step)
    s = std::clamp(s + dot(curve.tangent(s), point - curve.position(s)), 0.0, curve.length);
  return s / curve.length;
}

class ModeShape {
 public:
  ModeShape(const Model& model, const State& state, const Scene& scene) : model_(model), state_(state), scene_(scene) {}

  Scene scene() {
    move_points();
    for (std::size_t m = 0; m < scene_.members.size(); ++m) bend(static_cast<int>(m), scene_.members[m]);
    scene_.imperfection_modes.clear();
    return std::move(scene_);
  }

 private:
  Vector3 displaced(int vertex) const {
    const std::array<double, 6> motion = vertex_motion(model_, state_, vertex);
    return sum(model_.mesh().vertex_position[vertex], {motion[0], motion[1], motion[2]});
  }

  /// Points that followed from curves become points of their own.
  void move_points() {
    std::map<std::string, Vector3> positions;
    for (const auto& [point, vertex] : model_.mesh().vertex_of_point) positions[point] = displaced(vertex);
    for (Point& point : scene_.points) {
      const auto moved = positions.find(point.name);
      if (moved == positions.end()) continue;
      point.position = moved->second;
      positions.erase(moved);
    }
    for (const auto& [point, position] : positions) scene_.points.push_back({point, position});
  }

  void bend(int index, Member& member) {
    const MeshMember& mesh = model_.mesh().members[index];
    std::vector<PointSample> samples;
    for (int e = 0; e < mesh.elements; ++e)
      for (const double xi : {-1.0, 0.0}) samples.push_back(sample(index, mesh.arc_length(e, xi)));
    samples.push_back(sample(index, mesh.curve.length));
    Curve curve;
    curve.shape = CurveShape::spline;
    for (std::size_t i = 1; i + 1 < samples.size(); ++i) curve.through.push_back(to_array(samples[i].position));
    const auto axis = [](const PointSample& at, int i) {
      const auto axes = rotation_matrix(at.triad);
      return Vector3{axes(0, i), axes(1, i), axes(2, i)};
    };
    curve.end_tangents = {axis(samples.front(), 0), axis(samples.back(), 0)};
    member.curve = curve;
    member.second_axis = axis(samples.front(), 1);
    member.twist = 0.0;
    const Vector3 start = to_array(samples.front().position), end = to_array(samples.back().position);
    const ReferenceCurve carried = make_reference_curve(member, start, end);
    double angle = 0.0;
    for (const PointSample& at : samples)
      angle = turned(carried.triad(at.arc_length / mesh.curve.length * carried.length), at.triad, angle);
    member.twist = angle;
    for (InnerPoint& inner : member.inner_points) {
      const Vector3 position = displaced(vertex_of(model_.mesh(), inner.point));
      inner.position = nearest_position(carried, to_vec3(position), inner.position);
    }
  }

  PointSample sample(int member, double s) const {
    return sample_member(model_, state_, member, s / model_.mesh().members[member].curve.length);
  }

  const Model& model_;
  const State& state_;
  Scene scene_;
};

}  // namespace

Scene with_mode_shapes(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                       const InputPlace& place) {
  if (scene.imperfection_modes.empty()) return scene;
  const InputPlace modes = place["Imperfection"]["Modes"];
  BeamProblem problem(scene_of_case(scene, scene.imperfection_case), comm, parameters);
  try {
    return ModeShape(problem.model, moved_by_modes(problem, scene, modes), scene).scene();
  } catch (const LinearSolverError& error) {
    throw modes.error(std::string("no linear buckling: ") + error.what());
  }
}

}  // namespace mixbeam
