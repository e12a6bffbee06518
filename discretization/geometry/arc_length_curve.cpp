#include "discretization/geometry/arc_length_curve.hpp"

#include "discretization/text/number_text.hpp"
#include "kernels/math/gauss.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace mixbeam {
namespace {

constexpr int kGaussPoints = 16;
// The Gauss rule over a panel agrees with that over its halves to this accuracy; then that of the halves, which are
// kept, is better by 2^-32, far below rounding. [share of the length], [radian]
constexpr double kPanelTolerance = 1e-13;
constexpr double kSmallestCosine = 0.87;     // half a radian
constexpr int kMostHalvings = 40;            // a curve that is still not smooth there turns back
constexpr std::size_t kMostPanels = 100000;  // a curve that turns more often is a mistake
constexpr double kSmallestSpeed = 1e-6;      // share of the speed near by: slower is a stop
// Arc length is inverted to this share of the panel's length: a few roundings.
constexpr double kInversionTolerance = 1e-15;
constexpr int kMostIterations = 60;  // bisection alone ends with fewer

struct GaussRule {
  std::array<double, kGaussPoints> points{}, weights{};
  GaussRule() { gauss_rule(kGaussPoints, points.data(), weights.data()); }
};

const GaussRule& rule() {
  static const GaussRule gauss;
  return gauss;
}

Vec3<double> unit(const Vec3<double>& v) { return (1.0 / std::hypot(v[0], v[1], v[2])) * v; }

/// Smallest rotation between two unit vectors that are not opposite.
Quaternion<double> smallest_rotation(const Vec3<double>& from, const Vec3<double>& to) {
  const Vec3<double> axis = cross(from, to);
  return normalized(Quaternion<double>{1.0 + dot(from, to), axis[0], axis[1], axis[2]});
}

Quaternion<double> turn_about_tangent(double angle) { return {std::cos(0.5 * angle), std::sin(0.5 * angle), 0.0, 0.0}; }

Vec3<double> first_axis(const Quaternion<double>& triad) {
  const Mat3<double> m = rotation_matrix(triad);
  return unit({{m(0, 0), m(1, 0), m(2, 0)}});
}

std::invalid_argument no_tangent(double t) {
  return std::invalid_argument("The curve has no tangent near t = " + shortest(t) + ": it stops or turns back there.");
}

}  // namespace

Vec3<double> start_tangent(const PolynomialCurve& curve) {
  const PolynomialPiece& piece = curve.pieces.front();
  const Vec3<double> velocity = piece.velocity(piece.first());
  const double speed = norm(velocity);
  if (!(speed > kSmallestSpeed * norm(piece.velocity(0.5 * (piece.first() + piece.last())))))
    throw no_tangent(piece.first());
  // a range that runs backwards
  return (piece.last() > piece.first() ? 1.0 : -1.0) * unit(velocity);
}

ArcLengthCurve::ArcLengthCurve(PolynomialCurve curve, const Quaternion<double>& start_triad)
    : curve_(std::make_shared<PolynomialCurve>(std::move(curve))), next_triad_(start_triad) {
  for (const PolynomialPiece& piece : curve_->pieces) add_panels(piece, piece.first(), piece.last(), 0);
}

ArcLengthCurve::Panel ArcLengthCurve::panel_from(const PolynomialPiece& piece, double first, double last, double start,
                                                 const Quaternion<double>& triad) {
  const double forward = last > first ? 1.0 : -1.0;
  Panel panel{&piece, first, last, start, start, forward * unit(piece.velocity(first)), triad};
  panel.triad = normalized(smallest_rotation(first_axis(triad), panel.tangent) * triad);
  panel.end = start + integrate(panel, last).length;
  return panel;
}

ArcLengthCurve::Integrals ArcLengthCurve::integrate(const Panel& panel, double t) {
  Integrals sum;
  const double half = 0.5 * (t - panel.first), forward = panel.forward();
  for (int q = 0; q < kGaussPoints; ++q) {
    const double here = panel.first + half * (1.0 + rule().points[q]), weight = std::abs(half) * rule().weights[q];
    const Vec3<double> velocity = panel.piece->velocity(here);
    const double speed = norm(velocity);
    const Vec3<double> g1 = (forward / speed) * velocity;
    const double cosine = dot(panel.tangent, g1);
    const Vec3<double> turning = (1.0 / speed) * cross(g1, panel.piece->acceleration(here));  // g1 x dg1/dt
    sum.length += weight * speed;
    sum.angle += weight * dot(panel.tangent, turning) / (1.0 + cosine);
    sum.smallest_cosine = std::min(sum.smallest_cosine, cosine);
    sum.largest_speed = std::max(sum.largest_speed, speed);
  }
  return sum;
}

Quaternion<double> ArcLengthCurve::carried_triad(const Panel& panel, double t) {
  const Vec3<double> g1 = panel.forward() * unit(panel.piece->velocity(t));
  return normalized(smallest_rotation(panel.tangent, g1) * panel.triad * turn_about_tangent(integrate(panel, t).angle));
}

/// Whether a panel and its halves agree in length and triad; false when anything is not a number.
bool ArcLengthCurve::is_resolved(const Panel& whole, const Panel& half, const Panel& other_half) {
  for (const Panel* panel : {&half, &other_half})
    if (!(integrate(*panel, panel->last).smallest_cosine >= kSmallestCosine)) return false;
  const double length = other_half.end - half.start;
  if (!(std::abs(whole.end - whole.start - length) <= kPanelTolerance * length)) return false;
  const Quaternion<double> once = carried_triad(whole, whole.last), twice = carried_triad(other_half, other_half.last);
  return norm(log_quaternion(conjugate(once) * twice)) <= kPanelTolerance;
}

void ArcLengthCurve::add_panels(const PolynomialPiece& piece, double first, double last, int halvings) {
  const double start = panels_.empty() ? 0.0 : panels_.back().end, middle = 0.5 * (first + last);
  const Panel whole = panel_from(piece, first, last, start, next_triad_);
  const double speed = integrate(whole, last).largest_speed;
  for (const double t : {first, last})
    if (!(norm(piece.velocity(t)) > kSmallestSpeed * speed)) throw no_tangent(t);
  const Panel half = panel_from(piece, first, middle, start, next_triad_);
  const Panel other_half = panel_from(piece, middle, last, half.end, carried_triad(half, middle));
  if (is_resolved(whole, half, other_half)) {
    panels_.push_back(half);
    panels_.push_back(other_half);
    next_triad_ = carried_triad(other_half, last);
    return;
  }
  if (halvings == kMostHalvings) throw no_tangent(middle);
  if (panels_.size() >= kMostPanels) throw std::invalid_argument("The curve turns too often for a member.");
  add_panels(piece, first, middle, halvings + 1);
  add_panels(piece, middle, last, halvings + 1);
}

const ArcLengthCurve::Panel& ArcLengthCurve::panel_at(double s) const {
  const auto after = std::upper_bound(panels_.begin() + 1, panels_.end(), s,
                                      [](double value, const Panel& panel) { return value < panel.start; });
  return *(after - 1);
}

/// t of an arc length: Newton's method, and bisection where it leaves the bracket.
double ArcLengthCurve::parameter(const Panel& panel, double s) {
  const double wanted = std::clamp(s - panel.start, 0.0, panel.end - panel.start);
  const double tolerance = kInversionTolerance * (panel.end - panel.start);
  double low = panel.first, high = panel.last;  // in the direction of growing s
  double t = low + (high - low) * (wanted / (panel.end - panel.start));
  for (int i = 0; i < kMostIterations; ++i) {
    const double error = integrate(panel, t).length - wanted;
    if (std::abs(error) <= tolerance) break;
    (error > 0.0 ? high : low) = t;
    const double next = t - panel.forward() * error / norm(panel.piece->velocity(t));
    const bool is_inside = (next - low) * (next - high) < 0.0;
    const double before = std::exchange(t, is_inside ? next : 0.5 * (low + high));
    if (t == before) break;
  }
  return t;
}

Vec3<double> ArcLengthCurve::position(double s) const {
  const Panel& panel = panel_at(s);
  return curve_->origin + panel.piece->position(parameter(panel, s));
}

Vec3<double> ArcLengthCurve::tangent(double s) const {
  const Panel& panel = panel_at(s);
  return panel.forward() * unit(panel.piece->velocity(parameter(panel, s)));
}

Vec3<double> ArcLengthCurve::tangent_slope(double s) const {
  const Panel& panel = panel_at(s);
  const double t = parameter(panel, s);
  const Vec3<double> velocity = panel.piece->velocity(t), acceleration = panel.piece->acceleration(t);
  const double square = dot(velocity, velocity);
  return (1.0 / square) * (acceleration - (dot(velocity, acceleration) / square) * velocity);
}

Quaternion<double> ArcLengthCurve::triad(double s) const {
  const Panel& panel = panel_at(s);
  return carried_triad(panel, parameter(panel, s));
}

}  // namespace mixbeam
