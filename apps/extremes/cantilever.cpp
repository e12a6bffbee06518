#include "apps/extremes/cantilever.hpp"

#include "apps/common/studies/variants.hpp"
#include "apps/extremes/elastica.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/gauss.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Below this angle the series of theta - sin(theta) is used: the difference would lose three digits and more.
constexpr double kSeriesAngle = 0.5;

/// Zero motion has no size: it is measured against the structure.
double or_one(double size) { return size > 0.0 ? size : 1.0; }

double norm(const Vec3<double>& v) { return std::hypot(v[0], v[1], v[2]); }

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

bool is_plain_cantilever(const Scene& scene) {
  if (scene.members.size() != 1 || scene.supports.size() != 1 || scene.point_loads.size() != 1) return false;
  if (scene.sections.size() != 1 || scene.sections.front().matrix || scene.stages != 1) return false;
  if (!scene.distributed_loads.empty() || !scene.eigenstrains.empty() || !scene.joints.empty()) return false;
  const Member& rod = scene.members.front();
  const PointLoad& load = scene.point_loads.front();
  const std::array<double, 2>& bending = scene.sections.front().bending_stiffness;
  if (rod.curve.shape != CurveShape::line || position_of(scene, rod.start_point) != Vector3{}) return false;
  const Vector3& end = position_of(scene, rod.end_point);
  return end[0] > 0.0 && end[1] == 0.0 && end[2] == 0.0 && bending[0] == bending[1] && std::isfinite(bending[0]) &&
         is_clamp(scene.supports.front(), rod.start_point) && load.point == rod.end_point &&
         load.frame == LoadFrame::dead;
}

/// 1 - sin(x) / x
double one_minus_sinc(double x) {
  if (std::abs(x) > kSeriesAngle) return 1.0 - std::sin(x) / x;
  double term = 1.0, sum = 0.0;
  for (int j = 1; j <= 9; ++j) {  // truncation x^20 / 21!
    term *= -x * x / ((2.0 * j) * (2.0 * j + 1.0));
    sum -= term;
  }
  return sum;
}

Quaternion<double> rotation_about(const Vec3<double>& axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return {std::cos(0.5 * angle), s * axis[0], s * axis[1], s * axis[2]};
}

const Vec3<double> kTangent{{1.0, 0.0, 0.0}};

}  // namespace

Cantilever::Cantilever(const Scene& scene) : scene_(scene) {
  if (!is_plain_cantilever(scene))
    throw InputError(
        "the study needs a scene of one straight member from the origin along x, of one section with EI2 = EI3, "
        "clamped at its start, with one dead load at its end and nothing else; other scenes: --single");
  const Section& section = scene.sections.front();
  length_ = position_of(scene, scene.members.front().end_point)[0];
  bending_ = section.bending_stiffness[0];
  torsion_ = section.torsional_stiffness;
  *this = with_force_stiffness(std::numeric_limits<double>::infinity());
}

Cantilever Cantilever::with_mesh(int order, int elements) const {
  Cantilever copy = *this;
  copy.scene_ = mixbeam::with_mesh(scene_, order, elements);
  return copy;
}

Cantilever Cantilever::with_graded_mesh(int elements, double ratio) const {
  Cantilever copy = *this;
  Member& rod = copy.scene_.members.front();
  const double growth = elements > 1 ? std::pow(ratio, 1.0 / (elements - 1)) : 1.0;
  std::vector<double> ends = {0.0};
  double length = 1.0;
  for (int e = 0; e < elements; ++e, length *= growth) ends.push_back(ends.back() + length);
  const double total = ends.back();
  for (double& end : ends) end /= total;
  rod.elements = elements;
  rod.stations = ends;
  return copy;
}

Cantilever Cantilever::with_force_stiffness(double stiffness) const {
  Cantilever copy = *this;
  copy.force_stiffness_ = stiffness;
  copy.scene_.sections.front().axial_stiffness = stiffness;
  copy.scene_.sections.front().shear_stiffness = {stiffness, stiffness};
  return copy;
}

Cantilever Cantilever::with_torsional_stiffness(double stiffness) const {
  Cantilever copy = *this;
  copy.torsion_ = stiffness;
  copy.scene_.sections.front().torsional_stiffness = stiffness;
  return copy;
}

Cantilever Cantilever::in_units(double length, double force) const {
  Cantilever copy = with_force_stiffness(force_stiffness_ * force);
  Section& section = copy.scene_.sections.front();
  copy.length_ *= length;
  copy.bending_ *= force * length * length;
  copy.torsion_ *= force * length * length;
  section.torsional_stiffness = copy.torsion_;
  section.bending_stiffness = {copy.bending_, copy.bending_};
  for (Point& point : copy.scene_.points) point.position[0] *= length;
  return copy;
}

Cantilever Cantilever::with_tip_force(double load) const {
  Cantilever copy = *this;
  const double force = load * bending_ / (length_ * length_), shift = length_ * force / force_stiffness_;
  copy.load().force = {0.0, force, 0.0};
  copy.load().moment = {};
  const ElasticaTip tip = elastica_tip(load);
  copy.exact_.displacement = {{-length_ * tip.back, length_ * tip.across + shift, 0.0}};
  copy.exact_.rotation = rotation_about({{0.0, 0.0, 1.0}}, tip.angle);
  copy.exact_.displacement_scale = norm(copy.exact_.displacement);
  copy.exact_.rotation_scale = std::min(1.0, tip.angle);
  return copy;
}

Cantilever Cantilever::with_thrust(double load, double eccentricity) const {
  Cantilever copy = *this;
  const double thrust = 0.25 * M_PI * M_PI * load, force = thrust * bending_ / (length_ * length_);
  copy.load().force = {-force, eccentricity * force, 0.0};
  copy.load().moment = {};
  const ElasticaTip tip = thrust_tip(thrust, eccentricity);
  copy.exact_.displacement = {{-length_ * tip.back, length_ * tip.across, 0.0}};
  copy.exact_.rotation = rotation_about({{0.0, 0.0, 1.0}}, tip.angle);
  copy.exact_.displacement_scale = norm(copy.exact_.displacement);
  copy.exact_.rotation_scale = std::min(1.0, tip.angle);
  return copy;
}

Cantilever Cantilever::with_tip_moment(const Vec3<double>& bending_turn, double twist) const {
  Cantilever copy = *this;
  const double along = torsion_ * twist / length_;                                          // M1
  const Vec3<double> turn{{length_ * along / bending_, bending_turn[1], bending_turn[2]}};  // m L / EI
  for (int i = 0; i < 3; ++i) copy.load().moment[i] = turn[i] * bending_ / length_;
  copy.load().force = {};
  const double angle = norm(turn);
  const Vec3<double> axis = (1.0 / or_one(angle)) * turn, binormal = cross(axis, kTangent);
  const double half_sine = std::sin(0.5 * angle);
  // integral of exp(s m / EI) e1: Rodrigues' formula, term by term
  copy.exact_.displacement = length_ * ((2.0 * half_sine * half_sine / or_one(angle)) * binormal +
                                        one_minus_sinc(angle) * cross(axis, binormal));
  copy.exact_.rotation = rotation_about(axis, angle) * rotation_about(kTangent, twist - turn[0]);
  copy.exact_.displacement_scale = or_one(norm(copy.exact_.displacement) / length_) * length_;
  copy.exact_.rotation_scale = std::min(1.0, or_one(std::max(angle, std::abs(twist))));
  return copy;
}

Cantilever Cantilever::against_gauss_rule() const {
  Cantilever copy = *this;
  const Member& rod = scene_.members.front();
  const double angle = scene_.point_loads.front().moment[2] * length_ / bending_, h = length_ / rod.elements;
  std::vector<double> points(rod.order), weights(rod.order);
  gauss_rule(rod.order, points.data(), weights.data());
  Vec3<double>& u = copy.exact_.displacement = {};
  for (int e = 0; e < rod.elements; ++e)
    for (int q = 0; q < rod.order; ++q) {
      const double half = 0.5 * angle * (e + 0.5 * (1.0 + points[q])) / rod.elements, sine = std::sin(half);
      u += h * weights[q] * Vec3<double>{{-sine * sine, sine * std::cos(half), 0.0}};  // cos - 1, sin; no cancellation
    }
  copy.exact_.displacement_scale = or_one(norm(u) / length_) * length_;
  return copy;
}

double Cantilever::error(const Simulation& simulation) const {
  const std::string& tip = scene_.members.front().end_point;
  const Vector3 u = simulation.displacement(tip), angle = simulation.rotation(tip);
  const Vec3<double> distance = Vec3<double>{{u[0], u[1], u[2]}} - exact_.displacement;
  const Quaternion<double> rotation = exp_quaternion(Vec3<double>{{angle[0], angle[1], angle[2]}});
  const Vec3<double> turn = log_quaternion(rotation * conjugate(exact_.rotation));
  const double position_error = norm(distance) / exact_.displacement_scale;
  const double rotation_error = norm(turn) / exact_.rotation_scale;
  return std::isfinite(rotation_error) ? std::max(position_error, rotation_error) : rotation_error;
}

}  // namespace mixbeam
