#include "apps/extremes/sweeps.hpp"

#include "kernels/math/constants.hpp"
#include "kernels/math/gauss.hpp"

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

/// Points that reach rounding for a function that is analytic well around [0, 1].
struct SmoothRule {
  static constexpr int kPoints = 32;
  double x[kPoints], weights[kPoints];
  SmoothRule() { gauss_rule(kPoints, x, weights); }
};

template <class Function>
double smooth_integral(const Function& f) {
  static const SmoothRule rule;
  double sum = 0.0;
  for (int i = 0; i < SmoothRule::kPoints; ++i) sum += 0.5 * rule.weights[i] * f(0.5 * (1.0 + rule.x[i]));
  return sum;
}

/// theta'' = -load cos(theta), theta(0) = theta'(1) = 0, hence theta' = sqrt(2 load (sin(angle) - sin(theta))), and
/// sin(theta) = s = sin(angle) (1 - t^2) makes ds = sqrt(2 sin(angle) / load) dt / c, c = cos(theta), without a
/// singularity at the tip.
template <class Function>
double along_rod(double sine, const Function& of_sine_cosine) {
  return smooth_integral([&](double t) {
    const double s = sine * (1.0 - t * t), c = std::sqrt(1.0 - s * s);
    return of_sine_cosine(s, c) / c;
  });
}

ElasticaTip short_rod(double load) {
  const auto root_of_load = [](double angle) {
    const double sine = std::sin(angle);
    return std::sqrt(2.0 * sine) * along_rod(sine, [](double, double) { return 1.0; });
  };
  // The linear angle is load / 2, and the rod only becomes stiffer.
  const double angle = root_of([&](double a) { return root_of_load(a) - std::sqrt(load); }, 0.0, 0.5 * load);
  const double sine = std::sin(angle), scale = std::sqrt(2.0 * sine / load);
  // 1 - cos(theta) = sin^2 / (1 + cos), which does not cancel
  return {scale * along_rod(sine, [](double s, double c) { return s * s / (1.0 + c); }),
          scale * along_rod(sine, [](double s, double) { return s; }), angle};
}

/// With phi the angle to the load R, phi'' = -R sin(phi), phi'(1) = 0, is a pendulum's: from `load_angle` at the clamp
/// to the tip's, k = sin(phi_tip / 2); by u = log(k / k'), which resolves both ends. sin(phi / 2) = k sin(psi), sqrt(R)
/// = K(k) - F(psi_0, k) = F(chi, k) with tan(chi) = 1 / (k' tan(psi_0)).
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

/// `load_angle`: of the load to the axis of the clamp.
ElasticaTip pendulum_tip(double load, double load_angle) {
  const double root = std::sqrt(load);
  const double nearest = std::log(std::tan(0.5 * load_angle));  // the tip still points along the clamp
  const double u =
      root_of([&](double x) { return PendulumRod(load_angle, x).first() - root; }, nearest * (1.0 - 1e-15), root + 3.0);
  const PendulumRod rod(load_angle, u);
  const double along = 2.0 / root * rod.second() - 1.0, across = 2.0 * rod.k / root * rod.cos_psi;
  const double cosine = std::cos(load_angle), sine = std::sin(load_angle);
  return {1.0 - (cosine * along + sine * across), cosine * across - sine * along,
          2.0 * std::atan(std::exp(u)) - load_angle};
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

}  // namespace mixbeam
