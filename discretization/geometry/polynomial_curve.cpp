#include "discretization/geometry/polynomial_curve.hpp"

#include "kernels/math/vector_algebra.hpp"

#include <gsl/gsl_linalg.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace mixbeam {
namespace {

using namespace vector_algebra;

/// Chebyshev coefficients of the derivative with respect to t: c'_{k-1} = c'_{k+1} + 2 k c_k, the first one halved
/// (Mason, Handscomb, Chebyshev Polynomials, 2.4.5).
std::vector<Vec3<double>> derivative(const std::vector<Vec3<double>>& c, double length) {
  std::vector<Vec3<double>> d(c.size() + 1, Vec3<double>{{0.0, 0.0, 0.0}});
  for (std::size_t k = c.size() - 1; k > 0; --k)
    d[k - 1] = d[k + 1] + (2.0 * static_cast<double>(k) * 2.0 / length) * c[k];
  d[0] = 0.5 * d[0];
  d.resize(c.size() > 1 ? c.size() - 1 : 1);
  return d;
}

// Neighbouring points closer than this share of the coordinates differ only by rounding errors.
constexpr double kShortestRelativeChord = 1e-12;

/// Second derivatives M at the knots of a spline through points with chords h, from
///   h_{i-1} M_{i-1} + 2 (h_{i-1} + h_i) M_i + h_i M_{i+1} = 6 (d_i - d_{i-1}),   d_i = (P_{i+1} - P_i) / h_i
/// (de Boor, A Practical Guide to Splines, IV): a symmetric matrix with a dominant diagonal.
class KnotEquations {
 public:
  KnotEquations(const std::vector<Vector3>& points, const std::vector<double>& chords)
      : h_(chords), diagonal_(points.size(), 0.0), above_(points.size(), 0.0), right_side_(points.size()) {
    for (std::size_t i = 0; i < h_.size(); ++i) {
      slope_.push_back(scaled(1.0 / h_[i], difference(points[i + 1], points[i])));
      above_[i] = h_[i];
    }
    for (std::size_t i = 1; i < h_.size(); ++i) set_row(i, i - 1, i);
  }

  /// Open spline: each end has a tangent direction, or none.
  std::vector<Vector3> solve_open(const std::array<Vector3, 2>& tangents) {
    const std::size_t last = h_.size();
    diagonal_[0] = 2.0 * h_[0];
    diagonal_[last] = 2.0 * h_[last - 1];
    if (is_zero(tangents[0]))
      above_[0] = 0.0;
    else
      right_side_[0] = scaled(6.0, difference(slope_[0], unit(tangents[0])));
    if (is_zero(tangents[1]))
      above_[last - 1] = 0.0;
    else
      right_side_[last] = scaled(6.0, difference(unit(tangents[1]), slope_[last - 1]));
    above_.resize(last);
    return solve(gsl_linalg_solve_symm_tridiag);
  }

  /// Closed spline: the last point is the first one.
  std::vector<Vector3> solve_closed() {
    set_row(0, h_.size() - 1, 0);
    for (auto* numbers : {&diagonal_, &above_}) numbers->resize(h_.size());
    right_side_.resize(h_.size());
    std::vector<Vector3> result = solve(gsl_linalg_solve_symm_cyc_tridiag);
    result.push_back(result.front());
    return result;
  }

 private:
  using Solver = int (*)(const gsl_vector*, const gsl_vector*, const gsl_vector*, gsl_vector*);

  void set_row(std::size_t row, std::size_t before, std::size_t after) {
    diagonal_[row] = 2.0 * (h_[before] + h_[after]);
    right_side_[row] = scaled(6.0, difference(slope_[after], slope_[before]));
  }

  std::vector<Vector3> solve(Solver solver) const {
    const std::size_t n = diagonal_.size();
    std::vector<Vector3> result(n);
    std::vector<double> right_side(n), unknown(n);
    const auto diagonal = gsl_vector_const_view_array(diagonal_.data(), n);
    const auto above = gsl_vector_const_view_array(above_.data(), above_.size());
    const auto known = gsl_vector_const_view_array(right_side.data(), n);
    auto x = gsl_vector_view_array(unknown.data(), n);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t row = 0; row < n; ++row) right_side[row] = right_side_[row][i];
      if (solver(&diagonal.vector, &above.vector, &known.vector, &x.vector) != 0)
        throw std::invalid_argument("The equations of the spline have no solution.");
      for (std::size_t row = 0; row < n; ++row) result[row][i] = unknown[row];
    }
    return result;
  }

  std::vector<double> h_, diagonal_, above_;
  std::vector<Vector3> slope_, right_side_;
};

/// Chebyshev coefficients of a + b w + c w^2 + d w^3, w = (1 + x) / 2.
std::vector<Vec3<double>> chebyshev(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                                    const Vec3<double>& d) {
  return {a + 0.5 * b + 0.375 * c + 0.3125 * d, 0.5 * b + 0.5 * c + 0.46875 * d, 0.125 * c + 0.1875 * d, 0.03125 * d};
}

/// Start, inner points and end relative to the start.
std::vector<Vector3> spline_points(const Curve& curve, const Vector3& start, const Vector3& end) {
  std::vector<Vector3> points = {start};
  points.insert(points.end(), curve.through.begin(), curve.through.end());
  points.push_back(end);
  for (Vector3& point : points) {
    if (!std::isfinite(norm(point))) throw std::invalid_argument("A point of the spline is not finite.");
    point = difference(point, start);
  }
  return points;
}

std::vector<double> chord_lengths(const std::vector<Vector3>& points, const Vector3& start) {
  std::vector<double> chords;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    chords.push_back(norm(difference(points[i + 1], points[i])));
    const double coordinates = std::max({norm(start), norm(points[i]), norm(points[i + 1])});
    if (chords.back() <= std::max(kShortestLength, kShortestRelativeChord * coordinates))
      throw std::invalid_argument("Points " + std::to_string(i + 1) + " and " + std::to_string(i + 2) +
                                  " of the spline coincide.");
  }
  return chords;
}

}  // namespace

PolynomialPiece::PolynomialPiece(double first, double last, std::vector<Vec3<double>> coefficients)
    : first_(first),
      last_(last),
      position_(std::move(coefficients)),
      velocity_(derivative(position_, last - first)),
      acceleration_(derivative(velocity_, last - first)) {}

/// Uses Clenshaw's recurrence.
Vec3<double> PolynomialPiece::evaluate(const std::vector<Vec3<double>>& c, double t) const {
  const double x = ((t - first_) - (last_ - t)) / (last_ - first_);
  Vec3<double> here{{0.0, 0.0, 0.0}}, after{{0.0, 0.0, 0.0}};
  for (std::size_t k = c.size() - 1; k > 0; --k) {
    const Vec3<double> before = c[k] + (2.0 * x) * here - after;
    after = here;
    here = before;
  }
  return c[0] + x * here - after;
}

PolynomialCurve make_spline(const Curve& curve, const Vector3& start, const Vector3& end) {
  const std::vector<Vector3> points = spline_points(curve, start, end);
  for (const Vector3& tangent : curve.end_tangents)
    if (!std::isfinite(norm(tangent))) throw std::invalid_argument("An end tangent of the spline is not finite.");
  const std::vector<double> h = chord_lengths(points, start);
  const bool is_periodic = start == end && is_zero(curve.end_tangents[0]) && is_zero(curve.end_tangents[1]);
  if (is_periodic && h.size() < 3)
    throw std::invalid_argument("A closed spline without end tangents needs at least two points between its ends.");
  KnotEquations equations(points, h);
  const std::vector<Vector3> bend = is_periodic ? equations.solve_closed() : equations.solve_open(curve.end_tangents);
  PolynomialCurve result;
  result.origin = to_vec3(start);
  double t = 0.0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const Vec3<double> a = to_vec3(points[i]);
    const Vec3<double> c = (0.5 * h[i] * h[i]) * to_vec3(bend[i]);
    const Vec3<double> d = (h[i] * h[i] / 6.0) * to_vec3(difference(bend[i + 1], bend[i]));
    const Vec3<double> b = to_vec3(difference(points[i + 1], points[i])) - c - d;
    result.pieces.emplace_back(t, t + h[i], chebyshev(a, b, c, d));
    t += h[i];
  }
  return result;
}

}  // namespace mixbeam
