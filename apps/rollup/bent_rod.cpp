#include "apps/rollup/bent_rod.hpp"

#include "apps/common/studies/variants.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/gauss.hpp"
#include "kernels/math/rotation.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// More points than the k + 1 that a polynomial of degree k needs: the exact circle is none.
constexpr int kMoreGaussPoints = 3;

const Vector3& position_of(const Scene& scene, const std::string& name) {
  const auto found =
      std::find_if(scene.points.begin(), scene.points.end(), [&](const Point& p) { return p.name == name; });
  return found->position;
}

bool is_clamp(const Support& support, const std::string& point) {
  const auto all = [](const std::array<bool, 3>& fixed) { return fixed[0] && fixed[1] && fixed[2]; };
  return support.point == point && all(support.displacement_fixed) && all(support.rotation_fixed) &&
         support.prescribed_displacement == Vector3{} && support.prescribed_rotation == Vector3{};
}

bool is_moment_about_z(const PointLoad& load, const std::string& point) {
  return load.point == point && load.frame == LoadFrame::dead && load.force == Vector3{} && load.moment[0] == 0.0 &&
         load.moment[1] == 0.0 && load.moment[2] != 0.0;
}

bool is_pure_bending(const Scene& scene) {
  if (scene.members.size() != 1 || scene.supports.size() != 1 || scene.point_loads.size() != 1) return false;
  if (!scene.distributed_loads.empty() || scene.stages != 1) return false;
  const Member& rod = scene.members.front();
  if (rod.curve.shape != CurveShape::line || position_of(scene, rod.start_point) != Vector3{}) return false;
  const Vector3& end = position_of(scene, rod.end_point);
  return end[0] > 0.0 && end[1] == 0.0 && end[2] == 0.0 && is_clamp(scene.supports.front(), rod.start_point) &&
         is_moment_about_z(scene.point_loads.front(), rod.end_point);
}

double norm(const Vec3<double>& v) { return std::hypot(v[0], v[1], v[2]); }

}  // namespace

PureBending::PureBending(const Scene& scene) : scene_(scene) {
  if (!is_pure_bending(scene))
    throw InputError(
        "the study needs a scene of one straight member from the origin along x, clamped at its start, with a dead "
        "moment about z at its end and nothing else; other scenes: --single");
  const auto section = std::find_if(scene.sections.begin(), scene.sections.end(),
                                    [&](const Section& s) { return s.name == scene.members.front().section; });
  length_ = position_of(scene, scene.members.front().end_point)[0];
  bending_stiffness_ = section->bending_stiffness[1];
  curvature_ = scene.point_loads.front().moment[2] / bending_stiffness_;
}

Scene PureBending::variant(const BentRod& rod) const {
  Scene scene = with_mesh(scene_, rod.order, rod.elements);
  scene.members.front().force_integration = rod.integration;
  const double axial = 12.0 * std::pow(rod.slenderness / length_, 2) * bending_stiffness_;
  for (Section& section : scene.sections) {
    section.axial_stiffness = axial;
    section.shear_stiffness = {0.5 * axial, 0.5 * axial};
  }
  return scene;
}

Vec3<double> PureBending::exact_position(double arc_length) const {
  const double angle = curvature_ * arc_length, half_sine = std::sin(0.5 * angle);
  return {{std::sin(angle) / curvature_, 2.0 * half_sine * half_sine / curvature_, 0.0}};  // 1 - cos, no cancellation
}

std::vector<Vec3<double>> PureBending::quadrature_positions(int order, int elements) const {
  std::vector<double> points(order), weights(order);
  gauss_rule(order, points.data(), weights.data());
  const double h = length_ / elements;
  std::vector<Vec3<double>> positions = {{{0.0, 0.0, 0.0}}};
  for (int e = 0; e < elements; ++e) {
    Vec3<double> end = positions.back();
    for (int q = 0; q < order; ++q) {
      const double angle = curvature_ * h * (e + 0.5 * (1.0 + points[q]));
      end += 0.5 * h * weights[q] * Vec3<double>{{std::cos(angle), std::sin(angle), 0.0}};
    }
    positions.push_back(end);
  }
  return positions;
}

double PureBending::centerline_error(const Simulation& simulation) const {
  const int points = simulation.scene().members.front().order + kMoreGaussPoints;
  return simulation.l2_norm(points, [this](const PointSample& sample, int) {
    return sample.position - exact_position(sample.arc_length);
  }) / length_;
}

VertexErrors PureBending::vertex_errors(const Simulation& simulation) const {
  const Mesh& mesh = simulation.model().mesh();
  const auto quadrature = quadrature_positions(simulation.scene().members.front().order, mesh.members.front().elements);
  VertexErrors errors;
  for (const MeshElement& element : mesh.elements) {
    const int vertex = element.vertex[1];
    const auto motion = vertex_motion(simulation.model(), simulation.state(), vertex);
    const Vector3& start = mesh.vertex_position[vertex];
    const Vec3<double> position{{start[0] + motion[0], start[1] + motion[1], start[2] + motion[2]}};
    const Vec3<double> angle = log_quaternion(exp_quaternion(Vec3<double>{{0.0, 0.0, -curvature_ * start[0]}}) *
                                              exp_quaternion(Vec3<double>{{motion[3], motion[4], motion[5]}}));
    errors.tip = norm(position - exact_position(start[0])) / length_;
    errors.circle = std::max(errors.circle, errors.tip);
    errors.quadrature = std::max(errors.quadrature, norm(position - quadrature[element.index + 1]) / length_);
    errors.rotation = std::max(errors.rotation, norm(angle));
  }
  return errors;
}

}  // namespace mixbeam
