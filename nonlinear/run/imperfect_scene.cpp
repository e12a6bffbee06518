#include "nonlinear/run/imperfect_scene.hpp"

#include "discretization/scene/load_cases.hpp"
#include "discretization/state/sampling.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"
#include "nonlinear/path/load_path.hpp"
#include "nonlinear/stability/linear_buckling.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

using namespace vector_algebra;

/// Number of additional buckling modes requested, since some may have negative factors.
constexpr int kNegativeModes = 2;

/// Amplitude of a mode with largest entry one for a central difference, whose error is about 1e-10, both from the third
/// derivative and from rounding.
constexpr double kStepAlongMode = 1e-5;

/// Largest displacement of a vertex between two states.
double largest_displacement(const Model& model, const State& from, const State& to) {
  double largest = 0.0;
  const auto &a = from.views.vertex_displacement, &b = to.views.vertex_displacement;
  for (int v = 0; v < model.structure().owned_vertices; ++v)
    largest = std::max(largest, std::hypot(b(v, 0) - a(v, 0), b(v, 1) - a(v, 1), b(v, 2) - a(v, 2)));
  return maximum_over_ranks(*model.map()->getComm(), largest);
}

/// A mode of a deformed state to apply to the undeformed structure: `factor` times the motion between two states.
struct LaidMode {
  State back{}, forth{};
  double factor = 0.0;
};

/// Finds the first critical points on the path of the structure as drawn, at least `most` if there are that many.
std::vector<CriticalPoint> critical_points(const Teuchos::RCP<BeamProblem>& problem, SolverParameters parameters,
                                           std::size_t most) {
  parameters.analysis.branch = Branch::primary;
  parameters.analysis.snap = Snap::follow;
  parameters.analysis.stability = true;
  std::vector<CriticalPoint> found;
  PathControl control;
  control.stop = [&] { return found.size() >= most; };
  State state = problem->model.reference_state();
  follow_load_path(
      problem, parameters, state,
      [&](const StepReport& report, const State&) {
        found.insert(found.end(), report.critical_points.begin(), report.critical_points.end());
      },
      control);
  return found;
}

/// Modes of the requested critical points.
std::vector<LaidMode> modes_of_path(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                    const Scene& scene, const InputPlace& place) {
  int most = 0;
  for (const ModeImperfection& wanted : scene.imperfection_modes)
    most = std::max(most, wanted.critical_point.value_or(0));
  if (most == 0) return {};
  const std::vector<CriticalPoint> points = critical_points(problem, parameters, static_cast<std::size_t>(most));
  std::vector<LaidMode> laid;
  for (const ModeImperfection& wanted : scene.imperfection_modes) {
    if (!wanted.critical_point) continue;
    const InputPlace here = place[wanted.name]["Critical Point"];
    const std::string value = "value " + std::to_string(*wanted.critical_point);
    if (static_cast<std::size_t>(*wanted.critical_point) > points.size())
      throw here.error(value + "; allowed: " +
                       (points.empty() ? "none, for the path of the structure as it was drawn meets none"
                                       : "1 to " + std::to_string(points.size()) +
                                             ", those on the path of the structure as it was drawn"));
    const CriticalPoint& point = points[static_cast<std::size_t>(*wanted.critical_point) - 1];
    LaidMode mode{problem->model.apply(point.state, point.mode, -kStepAlongMode),
                  problem->model.apply(point.state, point.mode, kStepAlongMode), wanted.amplitude};
    const double largest = largest_displacement(problem->model, mode.back, mode.forth);
    if (!(largest > 0.0)) throw here.error(value + ": this mode moves no vertex; allowed: one that does");
    mode.factor /= largest;
    laid.push_back(std::move(mode));
  }
  return laid;
}

/// Undeformed structure, displaced by the requested modes of linear buckling.
State moved_by_modes(BeamProblem& problem, const Scene& scene, const InputPlace& place) {
  int most = 0;
  for (const ModeImperfection& wanted : scene.imperfection_modes) most = std::max(most, wanted.mode.value_or(0));
  if (most == 0) return problem.model.reference_state();
  std::vector<EigenMode> modes;
  for (EigenMode& mode : linear_buckling(problem, most + kNegativeModes))
    if (mode.eigenvalue > 0.0) modes.push_back(std::move(mode));
  std::stable_sort(modes.begin(), modes.end(),
                   [](const EigenMode& a, const EigenMode& b) { return a.eigenvalue < b.eigenvalue; });
  const State reference = problem.model.reference_state();
  State moved = reference;
  for (const ModeImperfection& wanted : scene.imperfection_modes) {
    if (!wanted.mode) continue;
    const InputPlace here = place[wanted.name]["Mode"];
    if (static_cast<std::size_t>(*wanted.mode) > modes.size())
      throw here.error("value " + std::to_string(*wanted.mode) + "; allowed: " +
                       (modes.empty() ? "none, for no load factor above zero is critical by linear buckling"
                                      : "1 to " + std::to_string(modes.size()) +
                                            ", the modes of linear buckling with a load factor above zero"));
    const MixedVector& mode = modes[static_cast<std::size_t>(*wanted.mode) - 1].mode;
    const double unit_size = largest_displacement(problem.model, reference, problem.model.apply(reference, mode, 1.0));
    if (!(unit_size > 0.0))
      throw here.error("value " + std::to_string(*wanted.mode) + ": this mode moves no vertex; allowed: one that does");
    moved = problem.model.apply(moved, mode, wanted.amplitude / unit_size);
  }
  return moved;
}

/// Angle by which `triad` is rotated about its first axis relative to `carried`, nearest to `last`.
double turned(const Quaternion<double>& carried, const Quaternion<double>& triad, double last) {
  const Quaternion<double> q = conjugate(carried) * triad;
  const double angle = 2.0 * std::atan2(q.x, q.w);
  return angle - 2.0 * kPi * std::round((angle - last) / (2.0 * kPi));
}

/// Relative arc length of the point of a curve that is nearest to `point`, close to `position`.
double nearest_position(const ReferenceCurve& curve, const Vec3<double>& point, double position) {
  constexpr int kSteps = 20;  // of a fixed-point iteration from a start within a small share of an element
  double s = position * curve.length;
  for (int step = 0; step < kSteps; ++step)
    s = std::clamp(s + dot(curve.tangent(s), point - curve.position(s)), 0.0, curve.length);
  return s / curve.length;
}

/// Section of the imperfect structure.
struct PlacedSection {
  double arc_length = 0.0;
  Vec3<double> position, tangent;
  Quaternion<double> triad;
};

class ModeShape {
 public:
  ModeShape(const Model& model, const State& state, const std::vector<LaidMode>& laid, const Scene& scene)
      : model_(model), mesh_(model.whole_mesh()), state_(state), laid_(laid), scene_(scene) {}

  Scene scene() {
    move_points();
    for (std::size_t m = 0; m < scene_.members.size(); ++m) bend(static_cast<int>(m), scene_.members[m]);
    scene_.imperfection_modes.clear();
    return std::move(scene_);
  }

 private:
  Vector3 displaced(int vertex) const {
    const auto moved = [&](const State& state) {
      const std::array<double, 6> motion = vertex_motion(model_, state, vertex);
      return Vector3{motion[0], motion[1], motion[2]};
    };
    Vector3 position = sum(mesh_->vertex_position[vertex], moved(state_));
    for (const LaidMode& mode : laid_)
      position = sum(position, scaled(mode.factor, difference(moved(mode.forth), moved(mode.back))));
    return position;
  }

  /// Moves points; points that followed from curves become explicit ones.
  void move_points() {
    std::map<std::string, Vector3> positions;
    for (const auto& [point, vertex] : mesh_->vertex_of_point) positions[point] = displaced(vertex);
    for (Point& point : scene_.points) {
      const auto moved = positions.find(point.name);
      if (moved == positions.end()) continue;
      point.position = moved->second;
      positions.erase(moved);
    }
    for (const auto& [point, position] : positions) scene_.points.push_back({point, position});
  }

  void bend(int index, Member& member) {
    const MeshMember& mesh = mesh_->members[index];
    std::vector<PlacedSection> samples;
    for (int e = 0; e < mesh.elements; ++e)
      for (const double xi : {-1.0, 0.0}) samples.push_back(sample(index, mesh.arc_length(e, xi)));
    samples.push_back(sample(index, mesh.curve.length));
    Curve curve;
    curve.shape = CurveShape::spline;
    for (std::size_t i = 1; i + 1 < samples.size(); ++i) curve.through.push_back(to_array(samples[i].position));
    curve.end_tangents = {to_array(samples.front().tangent), to_array(samples.back().tangent)};
    member.curve = curve;
    member.second_axis = to_array(axis(samples.front().triad, 1));
    member.twist = 0.0;
    const Vector3 start = to_array(samples.front().position), end = to_array(samples.back().position);
    const ReferenceCurve carried = make_reference_curve(member, start, end);
    double angle = 0.0;
    for (const PlacedSection& at : samples)
      angle = turned(carried.triad(at.arc_length / mesh.curve.length * carried.length), at.triad, angle);
    member.twist = angle;
    for (InnerPoint& inner : member.inner_points) {
      const Vector3 position = displaced(vertex_of(*mesh_, inner.point));
      inner.position = nearest_position(carried, to_vec3(position), inner.position);
    }
  }

  static Vec3<double> axis(const Quaternion<double>& triad, int i) {
    const auto axes = rotation_matrix(triad);
    return {{axes(0, i), axes(1, i), axes(2, i)}};
  }

  /// Derivative of the position with respect to the undeformed arc length.
  static Vec3<double> slope(const PointSample& at) {
    const Vec3<double>& strain = at.force_strain;
    return (1.0 + strain[0]) * axis(at.triad, 0) + strain[1] * axis(at.triad, 1) + strain[2] * axis(at.triad, 2);
  }

  PlacedSection sample(int member, double s) const {
    const double position = s / mesh_->member_length[member];
    const PointSample at = sample_member(model_, state_, member, position);
    PlacedSection placed{at.arc_length, at.position, axis(at.triad, 0), at.triad};
    for (const LaidMode& mode : laid_) {
      const PointSample back = sample_member(model_, mode.back, member, position);
      const PointSample forth = sample_member(model_, mode.forth, member, position);
      placed.position = placed.position + mode.factor * (forth.position - back.position);
      placed.tangent = placed.tangent + mode.factor * (slope(forth) - slope(back));
      placed.triad = exp_quaternion(mode.factor * log_quaternion(forth.triad * conjugate(back.triad))) * placed.triad;
    }
    return placed;
  }

  const Model& model_;
  std::shared_ptr<const Mesh> mesh_;
  const State& state_;
  const std::vector<LaidMode>& laid_;
  Scene scene_;
};

}  // namespace

Scene with_mode_shapes(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                       const InputPlace& place) {
  if (scene.imperfection_modes.empty()) return scene;
  const InputPlace modes = place["Imperfection"]["Modes"];
  if (!scene_of_case(scene, scene.imperfection_case).rotating_frames.empty())
    throw modes.error(
        "given, but in \"Rotating Frame\" loads grow with the square of the load factor; allowed: a \"Case\" "
        "without it, or \"Bows\", \"Sway\" and \"Points\"");
  const auto problem = Teuchos::rcp(new BeamProblem(scene_of_case(scene, scene.imperfection_case), comm, parameters));
  try {
    const State moved = moved_by_modes(*problem, scene, modes);
    const std::vector<LaidMode> laid = modes_of_path(problem, parameters, scene, modes);
    return ModeShape(problem->model, moved, laid, scene).scene();
  } catch (const LinearSolverError& error) {
    throw modes.error(std::string("no linear buckling: ") + error.what());
  }
}

}  // namespace mixbeam
