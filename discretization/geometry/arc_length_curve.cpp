#include "discretization/geometry/arc_length_curve.hpp"

#include "discretization/text/number_text.hpp"
#include "kernels/math/gauss.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace mixbeam {
namespace {

constexpr int kGaussPoints = 16;
// The Gauss rule over a panel must agree with that over its halves to this accuracy; that of the halves, which are
// kept, is then better by 2^-32, far below rounding. [share of the length], [radian]
constexpr double kPanelTolerance = 1e-13;
constexpr double kSmallestCosine = 0.87;     // half a radian
constexpr int kMostHalvings = 40;            // a curve still not smooth then reverses
constexpr std::size_t kMostPanels = 100000;  // more are a mistake
constexpr double kSmallestSpeed = 1e-6;      // relative to the speed nearby: slower is a stop
// Arc length is inverted until a correction is below this share of the panel, which leaves its square, or this share of
// t: rounding, within which Newton's method would alternate.
constexpr double kInversionTolerance = 1e-14, kRoundingOfParameter = 1e-15;
constexpr int kMostIterations = 60;  // bisection alone needs fewer

struct GaussRule {
  std::array<double, kGaussPoints> points{}, weights{};
  GaussRule() { gauss_rule(kGaussPoints, points.data(), weights.data()); }
};

const GaussRule& rule() {
  static const GaussRule gauss;
  return gauss;
}

Vec3<double> unit(const Vec3<double>& v) { return (1.0 / std::hypot(v[0], v[1], v[2])) * v; }

Vec3<double> first_axis(const Quaternion<double>& triad) {
  const Mat3<double> m = rotation_matrix(triad);
  return unit({{m(0, 0), m(1, 0), m(2, 0)}});
}

std::invalid_argument no_tangent(double t) {
  return std::invalid_argument("The curve has no tangent near t = " + shortest(t) + ": it stops or turns back there.");
}

}  // namespace

Quaternion<double> smallest_rotation(const Vec3<double>& from, const Vec3<double>& to) {
  const Vec3<double> axis = cross(from, to);
  return normalized(Quaternion<double>{1.0 + dot(from, to), axis[0], axis[1], axis[2]});
}

Quaternion<double> turn_about_first_axis(double angle) {
  return {std::cos(0.5 * angle), std::sin(0.5 * angle), 0.0, 0.0};
}

Vec3<double> start_tangent(const PolynomialCurve& curve) {
  const PolynomialPiece& piece = curve.pieces.front();
  const Vec3<double> velocity = piece.velocity(piece.first());
  const double speed = norm(velocity);
  if (!(speed > kSmallestSpeed * norm(piece.velocity(0.5 * (piece.first() + piece.last())))))
    throw no_tangent(piece.first());
  // sign of a range that runs backwards
  return (piece.last() > piece.first() ? 1.0 : -1.0) * unit(velocity);
}

ArcLengthCurve::ArcLengthCurve(PolynomialCurve curve, const Quaternion<double>& start_triad)
    : curve_(std::make_shared<PolynomialCurve>(std::move(curve))), start_triad_(start_triad) {
  for (const PolynomialPiece& piece : curve_->pieces) add_panels(piece, piece.first(), piece.last(), 0);
}

ArcLengthCurve::Panel::Panel(const PolynomialPiece& of, double from, double to, double at,
                             const Quaternion<double>& triad_before)
    : piece(&of), first(from), last(to), start(at), tangent(forward() * unit(of.velocity(from))) {
  triad = normalized(smallest_rotation(first_axis(triad_before), tangent) * triad_before);
  whole = integrate(last);
  end_triad = carried_triad(last, whole.angle);
}

ArcLengthCurve::Integrals ArcLengthCurve::Panel::integrate(double t) const {
  Integrals sum;
  const double half = 0.5 * (t - first);
  for (int q = 0; q < kGaussPoints; ++q) {
    const double here = first + half * (1.0 + rule().points[q]), weight = std::abs(half) * rule().weights[q];
    const Vec3<double> velocity = piece->velocity(here);
    const double speed = norm(velocity);
    const Vec3<double> g1 = (forward() / speed) * velocity;
    const double cosine = dot(tangent, g1);
    const Vec3<double> turning = (1.0 / speed) * cross(g1, piece->acceleration(here));  // g1 x dg1/dt
    sum.length += weight * speed;
    sum.angle += weight * dot(tangent, turning) / (1.0 + cosine);
    sum.smallest_cosine = std::min(sum.smallest_cosine, cosine);
    sum.largest_speed = std::max(sum.largest_speed, speed);
  }
  return sum;
}

Quaternion<double> ArcLengthCurve::Panel::carried_triad(double t, double angle) const {
  const Vec3<double> g1 = forward() * unit(piece->velocity(t));
  return normalized(smallest_rotation(tangent, g1) * triad * turn_about_first_axis(angle));
}

void ArcLengthCurve::add_panels(const PolynomialPiece& piece, double first, double last, int halvings) {
  const double start = panels_.empty() ? 0.0 : panels_.back().end(), middle = 0.5 * (first + last);
  const Quaternion<double> triad = panels_.empty() ? start_triad_ : panels_.back().end_triad;
  const Panel whole(piece, first, last, start, triad), half(piece, first, middle, start, triad);
  for (const double t : {first, last})
    if (!(norm(piece.velocity(t)) > kSmallestSpeed * whole.whole.largest_speed)) throw no_tangent(t);
  const Panel other_half(piece, middle, last, half.end(), half.end_triad);
  // agreement of the panel and its halves; false if anything is NaN
  const double length = other_half.end() - half.start;
  if (half.whole.smallest_cosine >= kSmallestCosine && other_half.whole.smallest_cosine >= kSmallestCosine &&
      std::abs(whole.end() - whole.start - length) <= kPanelTolerance * length &&
      norm(log_quaternion(conjugate(whole.end_triad) * other_half.end_triad)) <= kPanelTolerance) {
    panels_.insert(panels_.end(), {half, other_half});
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

/// Uses Newton's method, and bisection if it leaves the bracket.
double ArcLengthCurve::Panel::parameter(double s) const {
  const double size = whole.length, wanted = std::clamp(s - start, 0.0, size);
  const double enough = std::max(kInversionTolerance * std::abs(last - first),
                                 kRoundingOfParameter * std::max(std::abs(first), std::abs(last)));
  double low = first, high = last;  // in the direction of growing s
  double t = low + (high - low) * (wanted / size);
  for (int i = 0; i < kMostIterations; ++i) {
    const double error = integrate(t).length - wanted;
    const double correction = -forward() * error / norm(piece->velocity(t));
    const double next = t + correction;
    if (std::abs(correction) <= enough) return next;
    (error > 0.0 ? high : low) = t;
    const bool is_inside = (next - low) * (next - high) < 0.0;
    t = is_inside ? next : 0.5 * (low + high);
  }
  return t;
}

Vec3<double> ArcLengthCurve::position(double s) const {
  const Panel& panel = panel_at(s);
  return curve_->origin + panel.piece->position(panel.parameter(s));
}

Vec3<double> ArcLengthCurve::tangent(double s) const {
  const Panel& panel = panel_at(s);
  return panel.forward() * unit(panel.piece->velocity(panel.parameter(s)));
}

Vec3<double> ArcLengthCurve::tangent_slope(double s) const {
  const Panel& panel = panel_at(s);
  const double t = panel.parameter(s);
  const Vec3<double> velocity = panel.piece->velocity(t), acceleration = panel.piece->acceleration(t);
  const double square = dot(velocity, velocity);
  return (1.0 / square) * (acceleration - (dot(velocity, acceleration) / square) * velocity);
}

Quaternion<double> ArcLengthCurve::triad(double s) const {
  const Panel& panel = panel_at(s);
  const double t = panel.parameter(s);
  return panel.carried_triad(t, panel.integrate(t).angle);
}

}  // namespace mixbeam
