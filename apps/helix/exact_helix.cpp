#include "apps/helix/exact_helix.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

constexpr double kPi = 3.14159265358979323846;

/// A third of two coils, the longest element of the study, has sines and cosines of 4 pi / 3: 16 points integrate the
/// square of the error to round-off.
constexpr int kGaussPoints = 16;

double distance(const Vec3<double>& a, const Vec3<double>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Angle between two rotations.
double angle_between(const Quaternion<double>& a, const Quaternion<double>& b) {
  const Vec3<double> difference = log_quaternion(conjugate(a) * b);
  return std::hypot(difference[0], difference[1], difference[2]);
}

}  // namespace

double ExactHelix::length() const { return std::hypot(2.0 * kPi * coils * radius, height); }

double ExactHelix::slope() const { return height / (2.0 * kPi * coils * radius); }

double ExactHelix::angle(double s) const { return 2.0 * kPi * coils * s / length(); }

Vec3<double> ExactHelix::position(double s) const {
  return {{radius * std::sin(angle(s)), -radius * std::cos(angle(s)), height * s / length()}};
}

Quaternion<double> ExactHelix::triad(double s) const {
  return exp_quaternion(Vec3<double>{{0.0, 0.0, angle(s)}}) *
         exp_quaternion(Vec3<double>{{0.0, -std::atan(slope()), 0.0}});
}

HelixErrors compare(const Simulation& simulation, const ExactHelix& exact) {
  const Mesh& mesh = simulation.model().mesh();
  const double length = exact.length();
  HelixErrors errors;
  for (const MeshElement& element : mesh.elements) {
    const int vertex = element.vertex[1];
    const double s = length * (element.index + 1) / static_cast<double>(mesh.elements.size());
    const auto motion = vertex_motion(simulation.model(), simulation.state(), vertex);
    const Vector3& start = mesh.vertex_position[vertex];
    const Vec3<double> position{{start[0] + motion[0], start[1] + motion[1], start[2] + motion[2]}};
    const Quaternion<double> triad =
        exp_quaternion(Vec3<double>{{motion[3], motion[4], motion[5]}}) * mesh.members[element.member].curve.triad(s);
    errors.tip_position = distance(position, exact.position(s)) / length;
    errors.tip_rotation = angle_between(exact.triad(s), triad);
    errors.vertex_position = std::max(errors.vertex_position, errors.tip_position);
    errors.vertex_rotation = std::max(errors.vertex_rotation, errors.tip_rotation);
  }
  errors.centerline = simulation.l2_norm(kGaussPoints, [&exact](const PointSample& sample, int) {
    return sample.position - exact.position(sample.arc_length);
  }) / length;
  return errors;
}

}  // namespace mixbeam
