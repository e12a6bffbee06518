#include "apps/extremes/sweeps.hpp"

#include "apps/common/studies/variants.hpp"
#include "apps/common/studies/vertex_places.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/gauss.hpp"

#include <gsl/gsl_sf_ellint.h>

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Up to this load the series of short_rod is exact to rounding; beyond it the elliptic form loses two digits at most.
constexpr double kSmallLoad = 0.03;

/// Beyond this load tip and force differ in direction by less than exp(-40), and the rod is infinitely long for its
/// curve at the clamp.
constexpr double kLongRod = 1600.0;

/// Halvings of an interval; 60 exhaust the digits, more cost nothing.
constexpr int kHalvings = 200;

/// Power series in the load of theta'' = -load cos(theta), theta(0) = theta'(1) = 0, by exact fractions; the terms left
/// out are below 1e-3 load^8 of the first ones.
ElasticaTip short_rod(double load) {
  const double x = load * load;
  const auto series = [x](double a, double b, double c, double d) { return a + x * (b + x * (c + x * d)); };
  return {x * series(1.0 / 15, -4.0 / 315, 2126.0 / 675675, -356164.0 / 402026625),
          load * series(1.0 / 3, -4.0 / 105, 47.0 / 5775, -21584.0 / 10135125),
          load * series(0.5, -11.0 / 240, 3601.0 / 403200, -3086639.0 / 1383782400)};
}

/// With phi the angle to the load R, phi'' = -R sin(phi), phi'(1) = 0, is a pendulum's: from `load_angle` at the clamp
/// to the tip's, k = sin(phi_tip / 2); by u = log(k / k'), which resolves both ends. sin(phi / 2) = k sin(psi), sqrt(R)
/// = K(k) - F(psi_0, k) = F(chi, k) with tan(chi) = 1 / (k' tan(psi_0)).
struct PendulumRod {
  double k, cos_psi;
  double first;   ///< F(chi, k)
  double second;  ///< E(k) - E(psi_0, k)

  PendulumRod(double load_angle, double u) : k(1.0 / std::sqrt(1.0 + std::exp(-2.0 * u))) {
    const double k_prime = 1.0 / std::sqrt(1.0 + std::exp(2.0 * u));
    const double sin_psi = std::min(1.0, std::sin(0.5 * load_angle) / k);
    cos_psi = std::sqrt((1.0 - sin_psi) * (1.0 + sin_psi));
    const double product = std::pow(k_prime * sin_psi, 2), sum = product + cos_psi * cos_psi;
    const double sin_chi = cos_psi / std::sqrt(sum), cos2_chi = product / sum, delta2 = k_prime * k_prime / sum;
    first = sin_chi * gsl_sf_ellint_RF(cos2_chi, delta2, 1.0, GSL_PREC_DOUBLE);
    second = first - k * k / 3.0 * std::pow(sin_chi, 3) * gsl_sf_ellint_RD(cos2_chi, delta2, 1.0, GSL_PREC_DOUBLE) -
             k * k * sin_chi * sin_psi;
  }
};

/// `load_angle`: of the load to the axis of the clamp.
ElasticaTip pendulum_tip(double load, double load_angle) {
  const double root = std::sqrt(load);
  const double nearest = std::log(std::tan(0.5 * load_angle));  // the tip still points along the clamp
  double low = nearest * (1.0 - 1e-15), high = root + 3.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (PendulumRod(load_angle, middle).first < root ? low : high) = middle;
  }
  const double u = 0.5 * (low + high);
  const PendulumRod rod(load_angle, u);
  const double along = 2.0 / root * rod.second - 1.0, across = 2.0 * rod.k / root * rod.cos_psi;
  const double cosine = std::cos(load_angle), sine = std::sin(load_angle);
  return {1.0 - (cosine * along + sine * across), cosine * across - sine * along,
          2.0 * std::atan(std::exp(u)) - load_angle};
}

/// Below this angle the series of theta - sin(theta) is used: the difference would lose three digits and more.
constexpr double kSeriesAngle = 0.5;

const Vec3<double> kTangent{{1.0, 0.0, 0.0}};

/// Zero motion has no size: it is measured against the structure.
double or_one(double size) { return size > 0.0 ? size : 1.0; }

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

/// Ends of elements over the length of the member.
std::vector<double> graded_stations(int elements, double ratio) {
  const double growth = elements > 1 ? std::pow(ratio, 1.0 / (elements - 1)) : 1.0;
  std::vector<double> ends = {0.0};
  double length = 1.0;
  for (int e = 0; e < elements; ++e, length *= growth) ends.push_back(ends.back() + length);
  const double total = ends.back();
  for (double& end : ends) end /= total;
  return ends;
}

void set_exact(Cantilever& rod, const ElasticaTip& tip, double shift) {
  rod.exact_displacement = {{-rod.length * tip.back, rod.length * tip.across + shift, 0.0}};
  rod.exact_rotation = rotation_about({{0.0, 0.0, 1.0}}, tip.angle);
  rod.displacement_scale = length_of(rod.exact_displacement);
  rod.rotation_scale = std::min(1.0, tip.angle);
}

}  // namespace

ElasticaTip elastica_tip(double load) {
  if (load <= kSmallLoad) return short_rod(load);
  if (load <= kLongRod) return pendulum_tip(load, 0.5 * kPi);
  return {1.0 - std::sqrt(2.0 / load), 1.0 - (2.0 - M_SQRT2) / std::sqrt(load), 0.5 * kPi};  // k = 1
}

ElasticaTip thrust_tip(double thrust, double eccentricity) {
  return pendulum_tip(thrust * std::hypot(1.0, eccentricity), std::atan(eccentricity));
}

Cantilever::Cantilever(const Scene& scene) {
  const Section section = scene.sections.size() == 1 ? scene.sections.front() : Section{};
  if (!is_straight_cantilever(scene) || scene.sections.size() != 1 || section.matrix ||
      section.bending_stiffness[0] != section.bending_stiffness[1] || !std::isfinite(section.bending_stiffness[0]))
    throw InputError(
        "the study needs a scene of one straight member from the origin along x, of one section with EI2 = EI3, "
        "clamped at its start, with one dead load at its end and nothing else; other scenes: --single");
  const Member& rod = scene.members.front();
  length = position_of(scene, rod.end_point)[0];
  bending = section.bending_stiffness[0];
  torsion = section.torsional_stiffness;
  order = rod.order;
  elements = rod.elements;
}

void Cantilever::pull_in_units(double of_length, double of_force, double load) {
  length *= of_length;
  bending *= of_force * of_length * of_length;
  torsion *= of_force * of_length * of_length;
  set_slenderness(100.0);
  pull(load);
}

void Cantilever::pull(double load) {
  force = {0.0, load * bending / (length * length), 0.0};
  set_exact(*this, elastica_tip(load), length * force[1] / force_stiffness);
}

void Cantilever::push(double load, double eccentricity) {
  const double thrust = 0.25 * kPi * kPi * load, size = thrust * bending / (length * length);
  force = {-size, eccentricity * size, 0.0};
  set_exact(*this, thrust_tip(thrust, eccentricity), 0.0);
}

void Cantilever::turn(const Vec3<double>& bending_turn, double twist) {
  const double along = torsion * twist / length;                                            // M1
  const Vec3<double> turned{{length * along / bending, bending_turn[1], bending_turn[2]}};  // m L / EI
  for (int i = 0; i < 3; ++i) moment[i] = turned[i] * bending / length;
  const double angle = length_of(turned), half_sine = std::sin(0.5 * angle);
  const Vec3<double> axis = (1.0 / or_one(angle)) * turned, binormal = cross(axis, kTangent);
  // integral of exp(s m / EI) e1: Rodrigues' formula, term by term
  exact_displacement = length * ((2.0 * half_sine * half_sine / or_one(angle)) * binormal +
                                 one_minus_sinc(angle) * cross(axis, binormal));
  exact_rotation = rotation_about(axis, angle) * rotation_about(kTangent, twist - turned[0]);
  displacement_scale = or_one(length_of(exact_displacement) / length) * length;
  rotation_scale = std::min(1.0, or_one(std::max(angle, std::abs(twist))));
}

void Cantilever::turn_by_gauss_rule(double angle) {
  turn({{0.0, 0.0, angle}}, 0.0);
  std::vector<double> points(order), weights(order);
  gauss_rule(order, points.data(), weights.data());
  exact_displacement = {};
  for (int e = 0; e < elements; ++e)
    for (int q = 0; q < order; ++q) {
      const double half = 0.5 * angle * (e + 0.5 * (1.0 + points[q])) / elements, sine = std::sin(half);
      // cos - 1, sin; no cancellation
      exact_displacement += length / elements * weights[q] * Vec3<double>{{-sine * sine, sine * std::cos(half), 0.0}};
    }
  displacement_scale = or_one(length_of(exact_displacement) / length) * length;
}

Scene Cantilever::in(Scene scene) const {
  scene = with_mesh(scene, order, elements);
  if (ratio > 0.0) scene.members.front().stations = graded_stations(elements, ratio);
  const double scale = length / position_of(scene, scene.members.front().end_point)[0];
  for (Point& point : scene.points) point.position[0] *= scale;
  Section& section = scene.sections.front();
  section.axial_stiffness = force_stiffness;
  section.shear_stiffness = {force_stiffness, force_stiffness};
  section.torsional_stiffness = torsion;
  section.bending_stiffness = {bending, bending};
  scene.point_loads.front().force = force;
  scene.point_loads.front().moment = moment;
  return scene;
}

double Cantilever::error(const Simulation& simulation) const {
  const std::string& tip = simulation.scene().members.front().end_point;
  const Vec3<double> distance = to_vec(simulation.displacement(tip)) - exact_displacement;
  const Quaternion<double> rotation = exp_quaternion(to_vec(simulation.rotation(tip)));
  const double position_error = length_of(distance) / displacement_scale;
  const double rotation_error = angle_of(rotation * conjugate(exact_rotation)) / rotation_scale;
  return std::isfinite(rotation_error) ? std::max(position_error, rotation_error) : rotation_error;
}

}  // namespace mixbeam
