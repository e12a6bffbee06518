/// Harmonic parts of Saint-Venant's shear stresses in a rectangle: series that converge slowly at the edge, summed in
/// closed form (dilogarithm) but for a rest that falls like exp(-pi n).
#pragma once

#include <array>
#include <complex>
#include <vector>

namespace mixbeam {

using Complex = std::complex<double>;

/// An analytic function and its derivatives.
struct AnalyticJet {
  Complex value{}, first{}, second{};
};

/// f(z) = amplitude (S(p (-l + d z)) + sign S(p (-l - d z))) of z = x2 + i x3, where S(w) is
///   alternating: sum over m = 1, 2, 3, ... of (-1)^m / m^2 exp(m w) / (1 + q^m)
///   odd:         sum over n = 1, 3, 5, ... of (-1)^((n-1)/2) / n^2 exp(n w) / (1 + q^n), or 1 - q^n.
/// Then tau_13 + i tau_12 = f(z): equilibrium and compatibility are the equations of Cauchy and Riemann.
class RectangleSeries {
 public:
  enum class Kind { alternating, odd_plus, odd_minus };
  struct Form {
    Kind kind = Kind::alternating;
    double scale = 1.0;     ///< p > 0
    double reach = 1.0;     ///< l: |Re(d z)| is at most this
    Complex direction = 1;  ///< d: 1 or i
    double sign = 1.0;
    double ratio = 0.0;  ///< q, at most 0.05
    Complex amplitude = 0.0;
  };

  RectangleSeries() = default;
  explicit RectangleSeries(const Form& form);

  Complex value(Complex z) const;
  AnalyticJet jet(Complex z) const;

  /// Of a unit torque in a rectangle of half sizes b along axis 2 and a along axis 3 with torsion constant J.
  /// Timoshenko and Goodier, art. 109; across the narrow side, where it converges.
  static RectangleSeries of_torque(double b, double a, double j);
  /// Of a unit force along axis 3; nu Poisson's ratio, i2 the second moment about axis 2. Timoshenko and Goodier,
  /// ch. 11. For flat ones by the series across the other side.
  static RectangleSeries of_force3(double b, double a, double i2, double nu);
  /// The same with axes exchanged.
  static RectangleSeries of_force2(double b, double a, double i3, double nu);

  /// Whether the series of a force runs along it: what `of_force3` expects of the polynomial beside it.
  static bool runs_along_force(double along, double across) { return along >= 0.5 * across; }

 private:
  AnalyticJet sum(Complex w, bool derivatives) const;

  Form form_{};
  std::vector<double> coefficients_{};  ///< of exp(m w) with all of the denominator, up to where |exp(w)| = kSmall ends
  std::vector<double> rest_{};          ///< of exp(m w): what the closed form without q leaves
};

}  // namespace mixbeam
