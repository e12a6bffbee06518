/// Curves given by formulas: implements make_formula_curve of polynomial_curve.hpp.
#include "discretization/geometry/polynomial_curve.hpp"
#include "discretization/text/expression.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/constants.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam {
namespace {

constexpr std::size_t kSamples = 64;  // per piece: a full turn of a helix needs 30
// Coefficients have decayed if the last quarter of them is at rounding, relative to the coordinates.
constexpr double kRoundingLevel = 1e-15;
// Formulas with cancellation end in noise above it: accepted if flat from the middle on, and not larger than this.
constexpr double kNoiseLevel = 1e-12;
constexpr double kFlat = 4.0;
// Probes over the whole range, dense enough for a bump of 1e-4 of its width; deviation allowed [of the coordinates].
constexpr int kLooks = 16384;
constexpr double kPassedBy = 1e-10;
// Coefficients up to this multiple of the last ones are noise.
constexpr double kInsignificant = 3.0;
// A piece shorter than 2^-30 of the range hides a jump or kink; a jump of the curvature needs 2^-26.
constexpr int kMostHalvings = 30;
constexpr std::size_t kMostPieces = 1000;  // some ten oscillations each: more are a mistake
// Neighbouring pieces meet up to rounding; real jumps and kinks are larger than these. [length of the curve], [radian]
constexpr double kSmallestJump = 1e-9;
constexpr double kSmallestKink = 1e-5;

/// cos(pi m / (2 kSamples)), used by the discrete cosine transform.
class CosineTable {
 public:
  CosineTable() {
    for (std::size_t m = 0; m < values_.size(); ++m)
      values_[m] = std::cos(kPi * static_cast<double>(m) / (2 * kSamples));
  }
  double operator()(std::size_t m) const { return values_[m % values_.size()]; }

 private:
  std::array<double, 4 * kSamples> values_{};  // one period
};

class FormulaInterpolation {
 public:
  explicit FormulaInterpolation(const Curve& curve) : range_(curve.range) {
    for (std::size_t i = 0; i < 3; ++i) formula_[i] = read(curve.formula[i], i);
    if (!std::isfinite(curve.range[0]) || !std::isfinite(curve.range[1]) || curve.range[0] == curve.range[1])
      throw std::invalid_argument("The range of t must have two different, finite ends.");
    add_pieces(curve.range[0], curve.range[1], 0);
  }

  PolynomialCurve take() {
    check_joints();
    PolynomialCurve curve;
    curve.origin = origin_;
    curve.pieces = std::move(pieces_);
    return curve;
  }

 private:
  static Expression read(const std::string& text, std::size_t i) {
    try {
      return Expression(text, {"t"});
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("The formula of ") + "xyz"[i] + ", \"" + text + "\": " + error.what());
    }
  }

  Vec3<double> value(double t) const {
    const Vec3<double> r{{formula_[0](t), formula_[1](t), formula_[2](t)}};
    for (std::size_t i = 0; i < 3; ++i)
      if (!std::isfinite(r[static_cast<int>(i)]))
        throw std::invalid_argument("The formula \"" + formula_[i].text() + "\" of the curve is " +
                                    shortest(r[static_cast<int>(i)]) + " at t = " + shortest(t) + ".");
    return r;
  }

  /// Chebyshev coefficients of the interpolant; sets `size` to the largest coordinate.
  std::vector<Vec3<double>> interpolate(double first, double last, double& size) const {
    static const CosineTable cosine;
    std::vector<Vec3<double>> sample(kSamples), coefficient(kSamples, Vec3<double>{{0.0, 0.0, 0.0}});
    size = 0.0;
    for (std::size_t j = 0; j < kSamples; ++j) {
      const double x = cosine(2 * j + 1);
      sample[j] = value(0.5 * (1.0 - x) * first + 0.5 * (1.0 + x) * last);
      for (int i = 0; i < 3; ++i) size = std::max(size, std::abs(sample[j][i]));
      sample[j] = sample[j] - origin_;
    }
    for (std::size_t k = 0; k < kSamples; ++k)
      for (std::size_t j = 0; j < kSamples; ++j)
        coefficient[k] += ((k == 0 ? 1.0 : 2.0) / kSamples * cosine(k * (2 * j + 1))) * sample[j];
    return coefficient;
  }

  static double largest(const std::vector<Vec3<double>>& c, std::size_t first, std::size_t last) {
    double result = 0.0;
    for (std::size_t k = first; k < last; ++k)
      for (int i = 0; i < 3; ++i) result = std::max(result, std::abs(c[k][i]));
    return result;
  }

  /// True if the formulas deviate between the samples of a piece, at one of the probes of the whole range inside it.
  bool passes_by(const PolynomialPiece& piece, double size) const {
    const double share = (piece.last() - piece.first()) / (range_[1] - range_[0]);
    const int looks = std::max(1, static_cast<int>(std::ceil(share * kLooks)));
    for (int i = 0; i < looks; ++i) {
      const double t = piece.first() + (piece.last() - piece.first()) * (i + 0.5) / looks;
      const Vec3<double> difference = value(t) - origin_ - piece.position(t);
      if (norm(difference) > kPassedBy * size) return true;
    }
    return false;
  }

  void add_pieces(double first, double last, int halvings) {
    if (pieces_.empty()) origin_ = value(first);
    double size = 0.0;
    std::vector<Vec3<double>> c = interpolate(first, last, size);
    const double end = largest(c, 3 * kSamples / 4, kSamples), middle = largest(c, kSamples / 2, 3 * kSamples / 4);
    bool has_decayed = end <= kRoundingLevel * size || (end <= kNoiseLevel * size && middle <= kFlat * end);
    if (has_decayed && halvings < kMostHalvings && passes_by(PolynomialPiece(first, last, c), size))
      has_decayed = false;
    if (!has_decayed) {
      if (halvings == kMostHalvings || pieces_.size() == kMostPieces) throw not_smooth(first);
      const double half = 0.5 * (first + last);
      add_pieces(first, half, halvings + 1);
      add_pieces(half, last, halvings + 1);
      return;
    }
    while (c.size() > 2 && largest(c, c.size() - 1, c.size()) <= kInsignificant * end) c.pop_back();
    pieces_.emplace_back(first, last, std::move(c));
  }

  /// Halving may hit a jump or kink exactly and leave smooth pieces.
  void check_joints() const {
    double length = 0.0;
    for (const PolynomialPiece& piece : pieces_)
      length += norm(piece.position(piece.last()) - piece.position(piece.first()));
    for (std::size_t i = 1; i < pieces_.size(); ++i) {
      const double t = pieces_[i].first();
      const Vec3<double> before = pieces_[i - 1].velocity(t), after = pieces_[i].velocity(t);
      const double jump = norm(pieces_[i].position(t) - pieces_[i - 1].position(t));
      const double kink = std::atan2(norm(cross(before, after)), dot(before, after));
      if (jump > kSmallestJump * length || kink > kSmallestKink) throw not_smooth(t);
    }
  }

  static std::invalid_argument not_smooth(double t) {
    return std::invalid_argument(
        "The curve of the formulas has a jump or a kink, or is not smooth, near t = " + shortest(t) + ".");
  }

  std::array<Expression, 3> formula_;
  std::array<double, 2> range_;
  Vec3<double> origin_{};
  std::vector<PolynomialPiece> pieces_;
};

}  // namespace

PolynomialCurve make_formula_curve(const Curve& curve) {
  constexpr std::size_t kMostRemembered = 1000;
  static std::mutex mutex;
  static std::map<std::string, PolynomialCurve> known;
  const std::string key = curve.formula[0] + "|" + curve.formula[1] + "|" + curve.formula[2] + "|" +
                          shortest(curve.range[0]) + "|" + shortest(curve.range[1]);
  const std::lock_guard<std::mutex> lock(mutex);
  if (const auto found = known.find(key); found != known.end()) return found->second;
  if (known.size() >= kMostRemembered) known.clear();
  return known[key] = FormulaInterpolation(curve).take();
}

}  // namespace mixbeam
