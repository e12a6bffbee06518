#include "discretization/geometry/polynomial_curve.hpp"

#include <utility>

namespace mixbeam {
namespace {

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

}  // namespace

PolynomialPiece::PolynomialPiece(double first, double last, std::vector<Vec3<double>> coefficients)
    : first_(first),
      last_(last),
      position_(std::move(coefficients)),
      velocity_(derivative(position_, last - first)),
      acceleration_(derivative(velocity_, last - first)) {}

/// Clenshaw's recurrence.
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

}  // namespace mixbeam
