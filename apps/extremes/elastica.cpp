#include "apps/extremes/elastica.hpp"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_sf_ellint.h>

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Up to this load the tip turns by less than half a radian, where integrands of elementary functions are smooth and
/// nothing cancels; beyond it the elliptic form loses less than a digit.
constexpr double kSmallLoad = 1.0;

/// Beyond this load tip and force differ in direction by less than exp(-40), and the rod is infinitely long for its
/// curve at the clamp.
constexpr double kLongRod = 1600.0;

/// Halvings of an interval; 60 exhaust the digits, more cost nothing.
constexpr int kHalvings = 200;

template <class Increasing>
double root_of(const Increasing& f, double low, double high) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Integral over [0, 1] of a function that is analytic well around it: 32 Gauss points reach rounding.
template <class Function>
double smooth_integral(const Function& f) {
  constexpr int kPoints = 32;
  gsl_integration_glfixed_table* table = gsl_integration_glfixed_table_alloc(kPoints);
  double sum = 0.0, x = 0.0, weight = 0.0;
  for (size_t i = 0; i < kPoints; ++i) {
    gsl_integration_glfixed_point(0.0, 1.0, i, &x, &weight, table);
    sum += weight * f(x);
  }
  gsl_integration_glfixed_table_free(table);
  return sum;
}

/// sin(theta) = sine (1 - t^2) makes ds = sqrt(2 sine / load) dt / cos(theta), without a singularity at the tip.
double cosine_at(double sine, double t) {
  const double s = sine * (1.0 - t * t);
  return std::sqrt(1.0 - s * s);
}

ElasticaTip short_rod(double load) {
  const auto root_of_load = [](double angle) {
    const double sine = std::sin(angle);
    return std::sqrt(2.0 * sine) * smooth_integral([sine](double t) { return 1.0 / cosine_at(sine, t); });
  };
  // The linear angle is load / 2, and the rod only becomes stiffer.
  const double angle = root_of([&](double a) { return root_of_load(a) - std::sqrt(load); }, 0.0, 0.5 * load);
  const double sine = std::sin(angle);
  ElasticaTip tip;
  tip.angle = angle;
  tip.across = std::sqrt(2.0 * sine / load) * sine *
               smooth_integral([sine](double t) { return (1.0 - t * t) / cosine_at(sine, t); });
  // int (1 - cos(theta)) ds, with 1/cos - 1 = sin^2 / (cos (1 + cos)), which does not cancel
  tip.back = std::sqrt(2.0 * sine / load) * smooth_integral([sine](double t) {
               const double s = sine * (1.0 - t * t), c = cosine_at(sine, t);
               return s * s / (c * (1.0 + c));
             });
  return tip;
}

/// By the complementary modulus k' = sqrt((1 - sin(angle)) / 2), which stays exact where k approaches 1:
/// sqrt(load) = K(k) - F(phi, k) = F(psi, k) with sin(phi) = 1 / (k sqrt 2), tan(psi) = sqrt(sin(angle)) / k'.
struct EllipticRod {
  double k2, sine, sin_psi, cos2_psi, delta2;

  explicit EllipticRod(double k_prime) {
    const double square = k_prime * k_prime;
    sine = 1.0 - 2.0 * square;
    k2 = 1.0 - square;
    cos2_psi = square / (square + sine);
    sin_psi = std::sqrt(sine / (square + sine));
    delta2 = square * (1.0 + sine) / (square + sine);
  }
  double first() const { return sin_psi * gsl_sf_ellint_RF(cos2_psi, delta2, 1.0, GSL_PREC_DOUBLE); }
  double second() const {
    return first() - k2 / 3.0 * sin_psi * sin_psi * sin_psi * gsl_sf_ellint_RD(cos2_psi, delta2, 1.0, GSL_PREC_DOUBLE);
  }
};

ElasticaTip bent_rod(double load) {
  const double root = std::sqrt(load);
  // F(psi, k) grows with y = -log(k'); F < log(4 / k') + 1 bounds y from above
  const double y = root_of([root](double x) { return EllipticRod(std::exp(-x)).first() - root; },
                           0.5 * std::log(2.0) + 1e-12, root + 3.0);
  const double k_prime = std::exp(-y);
  const EllipticRod rod(k_prime);
  // E(k) - E(phi, k) = E(psi, k) - k^2 sin(psi) sin(phi)
  const double second = rod.second() - rod.k2 * rod.sin_psi / std::sqrt(2.0 * rod.k2);
  return {1.0 - std::sqrt(2.0 * rod.sine / load), 1.0 - 2.0 / root * second, M_PI_2 - 2.0 * std::asin(k_prime)};
}

/// phi from `load_angle` at the clamp to the tip's, k = sin(phi_tip / 2); by u = log(k / k'), which resolves both ends.
/// sin(phi / 2) = k sin(psi), sqrt(R) = K(k) - F(psi_0, k) = F(chi, k) with tan(chi) = 1 / (k' tan(psi_0)).
struct PendulumRod {
  double k, k_prime, sin_psi, cos_psi, sin_chi, cos2_chi, delta2;

  PendulumRod(double load_angle, double u) {
    k = 1.0 / std::sqrt(1.0 + std::exp(-2.0 * u));
    k_prime = 1.0 / std::sqrt(1.0 + std::exp(2.0 * u));
    sin_psi = std::min(1.0, std::sin(0.5 * load_angle) / k);
    cos_psi = std::sqrt((1.0 - sin_psi) * (1.0 + sin_psi));
    const double product = std::pow(k_prime * sin_psi, 2), sum = product + cos_psi * cos_psi;
    sin_chi = cos_psi / std::sqrt(sum);
    cos2_chi = product / sum;
    delta2 = k_prime * k_prime / sum;
  }
  double first() const { return sin_chi * gsl_sf_ellint_RF(cos2_chi, delta2, 1.0, GSL_PREC_DOUBLE); }
  /// E(k) - E(psi_0, k)
  double second() const {
    const double e =
        first() - k * k / 3.0 * std::pow(sin_chi, 3) * gsl_sf_ellint_RD(cos2_chi, delta2, 1.0, GSL_PREC_DOUBLE);
    return e - k * k * sin_chi * sin_psi;
  }
};

}  // namespace

ElasticaTip elastica_tip(double load) {
  if (load <= kSmallLoad) return short_rod(load);
  if (load <= kLongRod) return bent_rod(load);
  return {1.0 - std::sqrt(2.0 / load), 1.0 - (2.0 - M_SQRT2) / std::sqrt(load), M_PI_2};  // k = 1
}

ElasticaTip thrust_tip(double thrust, double eccentricity) {
  const double load_angle = std::atan(eccentricity), root = std::sqrt(thrust * std::hypot(1.0, eccentricity));
  const double nearest = std::log(std::tan(0.5 * load_angle));  // the tip still points along the clamp
  const double u =
      root_of([&](double x) { return PendulumRod(load_angle, x).first() - root; }, nearest * (1.0 - 1e-15), root + 3.0);
  const PendulumRod rod(load_angle, u);
  const double along = 2.0 / root * rod.second() - 1.0, across = 2.0 * rod.k / root * rod.cos_psi;
  const double cosine = std::cos(load_angle), sine = std::sin(load_angle);
  return {1.0 - (cosine * along + sine * across), cosine * across - sine * along,
          2.0 * std::atan(std::exp(u)) - load_angle};
}

}  // namespace mixbeam
