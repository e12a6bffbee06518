#include "apps/rollup/bent_rod.hpp"

#include "apps/common/studies/variants.hpp"
#include "apps/common/studies/vertex_places.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/gauss.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// More points than the k + 1 that a polynomial of degree k needs: the exact circle is none.
constexpr int kMoreGaussPoints = 3;

}  // namespace

PureBending::PureBending(const Scene& scene) : scene_(scene) {
  const PointLoad load = is_straight_cantilever(scene) ? scene.point_loads.front() : PointLoad{};
  if (load.force != Vector3{} || load.moment[0] != 0.0 || load.moment[1] != 0.0 || load.moment[2] == 0.0)
    throw InputError(
        "the study needs a scene of one straight member from the origin along x, clamped at its start, with a dead "
        "moment about z at its end and nothing else; other scenes: --single");
  length_ = position_of(scene, scene.members.front().end_point)[0];
  bending_stiffness_ = section_of(scene, scene.members.front()).bending_stiffness[1];
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
  const auto whole = simulation.model().whole_mesh();
  const Mesh& mesh = *whole;
  const auto quadrature = quadrature_positions(simulation.scene().members.front().order, mesh.elements_of(0));
  VertexErrors errors;
  for (const MeshElement& element : mesh.elements) {
    const int vertex = element.vertex[1];
    const VertexPlace place = place_of(simulation, vertex);
    const double s = mesh.vertex_position[vertex][0];
    const Quaternion<double> back = exp_quaternion(Vec3<double>{{0.0, 0.0, -curvature_ * s}});
    errors.tip = length_of(place.position - exact_position(s)) / length_;
    errors.circle = std::max(errors.circle, errors.tip);
    errors.quadrature =
        std::max(errors.quadrature, length_of(place.position - quadrature[element.index + 1]) / length_);
    errors.rotation = std::max(errors.rotation, angle_of(back * place.rotation));
  }
  return errors;
}

}  // namespace mixbeam
