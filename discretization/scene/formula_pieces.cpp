#include "discretization/scene/formula_pieces.hpp"

#include "discretization/geometry/polynomial_curve.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/expression.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/gauss.hpp"
#include "kernels/math/legendre.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>

namespace mixbeam {

namespace {

constexpr int kFirstLook = 16384;     // samples of a member: one or two in a feature of 1e-4 of it
constexpr int kLaterLook = 32;        // samples of a piece
constexpr double kUnresolved = 1e-9;  // error of a piece times its length, over the integral of |function|
constexpr double kShortestPiece = 1e-12;
constexpr double kClosestLook = 2e-6;      // distance of the closest samples from the ends of a piece
constexpr std::size_t kMostPieces = 4096;  // of a formula that is noise, or oscillates as no beam does
constexpr double kShortPiece = 1.0 / 32;   // longer ones need no vertices of their own: few equal elements resolve them
constexpr std::size_t kMostPlaces = 500;   // of one member: more are an oscillation, which equal elements meet
constexpr int kPieceOrder = 8;             // points of a piece: degree 7

struct GaussRule {
  std::array<double, kPieceOrder> xi{}, weight{};
  GaussRule() { gauss_rule(kPieceOrder, xi.data(), weight.data()); }
};

/// Polynomial through the Chebyshev points of [a, b].
class Interpolation {
 public:
  Interpolation(const FormulaFunction& f, double a, double b) {
    for (int i = 0; i < kPieceOrder; ++i) {
      const double angle = (2 * i + 1) * kPi / (2 * kPieceOrder);
      x_[i] = 0.5 * (a + b) + 0.5 * (b - a) * std::cos(angle);
      weight_[i] = (i % 2 == 0 ? 1.0 : -1.0) * std::sin(angle);
      value_[i] = f(x_[i]);
    }
  }
  double operator()(double x) const {
    double above = 0.0, below = 0.0;
    for (int i = 0; i < kPieceOrder; ++i) {
      if (x == x_[i]) return value_[i];
      const double part = weight_[i] / (x - x_[i]);
      above += part * value_[i];
      below += part;
    }
    return above / below;
  }

 private:
  std::array<double, kPieceOrder> x_{}, weight_{}, value_{};
};

/// Divides [0, 1] until the function is resolved on every piece: at jumps and kinks, else in the middle.
class PieceSearch {
 public:
  explicit PieceSearch(FormulaFunction f) : f_(std::move(f)), look_(kFirstLook) {
    for (int i = 0; i < kFirstLook; ++i) {
      look_[i] = f_((i + 0.5) / kFirstLook);
      size_ += std::abs(look_[i]) / kFirstLook;
      largest_ = std::max(largest_, std::abs(look_[i]));
    }
  }
  /// For a function about as smooth as the known pieces.
  PieceSearch(FormulaFunction f, const FormulaPieces& known) : f_(std::move(f)) {
    for (const double x : known.end) largest_ = std::max(largest_, std::abs(f_(x)));
    size_ = largest_;
    known_ = &known;
  }

  FormulaPieces run() {
    const std::vector<double> ends = known_ != nullptr ? known_->end : std::vector<double>{0.0, 1.0};
    pieces_.end = {0.0};
    for (std::size_t i = 1; i < ends.size(); ++i) divide(ends[i - 1], ends[i]);
    if (known_ != nullptr) marks_.insert(marks_.end(), known_->places.begin(), known_->places.end());
    choose_places();
    return std::move(pieces_);
  }

 private:
  struct Look {
    double first = 0.0, distance = 0.0;  ///< places first + i distance
    std::vector<double> value{};
  };

  /// Samples of [a, b]: those of the whole member if enough of them lie there.
  Look look_at(double a, double b) const {
    const double margin = 1e-3 / kFirstLook;
    const int first = static_cast<int>(std::ceil((a + margin) * kFirstLook - 0.5)),
              last = static_cast<int>(std::floor((b - margin) * kFirstLook - 0.5));
    if (!look_.empty() && last - first >= kLaterLook)
      return {(first + 0.5) / kFirstLook, 1.0 / kFirstLook, {look_.begin() + first, look_.begin() + last + 1}};
    Look look{a + 0.5 * (b - a) / kLaterLook, (b - a) / kLaterLook};
    for (int i = 0; i < kLaterLook; ++i) look.value.push_back(f_(look.first + i * look.distance));
    return look;
  }

  /// Checks close to the ends too: a flank beside a jump or kink may be narrower than the distance of the samples.
  bool is_resolved(const Look& look, double a, double b) const {
    const Interpolation p(f_, a, b);
    const auto differs = [&](double x, double f) { return !(std::abs(f - p(x)) * (b - a) <= kUnresolved * size_); };
    for (std::size_t i = 0; i < look.value.size(); ++i)
      if (differs(look.first + static_cast<double>(i) * look.distance, look.value[i])) return false;
    for (double offset = 0.25 * (b - a); offset > kClosestLook; offset *= 0.5)
      if (differs(a + offset, f_(a + offset)) || differs(b - offset, f_(b - offset))) return false;
    return true;
  }

  /// Jump or kink next to the largest second difference, which halving the distances divides by 1 or 2, and by 4 where
  /// the function is smooth; negative if there is none.
  double break_in(const Look& look) const {
    constexpr int kBreakHalvings = 24;  // a kink has fallen to 6e-8 and a smooth function to rounding
    constexpr double kStillKink = 1e-9, kStillJump = 0.1, kNoise = 1e-14;
    const auto bend = [](double f, double g, double h) { return std::abs(f - 2.0 * g + h); };
    std::size_t at = 1;
    for (std::size_t i = 1; i + 1 < look.value.size(); ++i)
      if (bend(look.value[i - 1], look.value[i], look.value[i + 1]) >
          bend(look.value[at - 1], look.value[at], look.value[at + 1]))
        at = i;
    std::array<double, 3> f{look.value[at - 1], look.value[at], look.value[at + 1]};
    double middle = look.first + static_cast<double>(at) * look.distance, distance = look.distance;
    const double first = bend(f[0], f[1], f[2]);
    for (int halving = 1;; ++halving) {
      distance *= 0.5;
      if (middle + 0.5 * distance == middle || middle - 0.5 * distance == middle) return middle;
      const std::array<double, 5> g{f[0], f_(middle - distance), f[1], f_(middle + distance), f[2]};
      int best = 2;
      for (int i = 1; i <= 3; ++i)
        if (bend(g[i - 1], g[i], g[i + 1]) > bend(g[best - 1], g[best], g[best + 1])) best = i;
      middle += (best - 2) * distance;
      f = {g[best - 1], g[best], g[best + 1]};
      const double now = bend(f[0], f[1], f[2]);
      if (halving < kBreakHalvings) continue;
      if (now <= kStillKink * first || now <= kNoise * largest_) return -1.0;
      if (now <= kStillJump * first) return middle;
    }
  }

  void divide(double a, double b) {
    const Look look = look_at(a, b);
    if (b - a < kShortestPiece || pieces_.end.size() > kMostPieces || is_resolved(look, a, b)) {
      pieces_.end.push_back(b);
      return;
    }
    double place = break_in(look);
    if (place - a > kShortestPiece && b - place > kShortestPiece)
      marks_.push_back(place);
    else
      place = 0.5 * (a + b);
    divide(a, place);
    divide(place, b);
  }

  void choose_places() {
    std::vector<double>& places = pieces_.places;
    const auto add = [&](double place) {
      const auto after = std::lower_bound(places.begin(), places.end(), place);
      const double before = after == places.begin() ? 0.0 : *(after - 1), next = after == places.end() ? 1.0 : *after;
      if (place - before > kNearestPlaces && next - place > kNearestPlaces) places.insert(after, place);
    };
    for (const double mark : marks_) add(mark);
    for (std::size_t i = 1; i + 1 < pieces_.end.size(); ++i) {
      const double here = pieces_.end[i];
      if (std::min(here - pieces_.end[i - 1], pieces_.end[i + 1] - here) < kShortPiece) add(here);
    }
    if (places.size() > kMostPlaces) places.clear();
  }

  FormulaFunction f_;
  std::vector<double> look_{};
  double size_ = 0.0, largest_ = 0.0;
  const FormulaPieces* known_ = nullptr;
  FormulaPieces pieces_{};
  std::vector<double> marks_{};  ///< jumps and kinks
};

double finite_or_zero(double value) { return std::isfinite(value) ? value : 0.0; }

/// Sum over the diagonal, so that it shows whichever component a notch weakens; zero where the law is not defined.
FormulaFunction relative_compliance(const SectionLaw& law) {
  return [law, first = law.compliance(0.0)](double x) {
    double sum = 0.0;
    try {
      const Matrix6 here = law.compliance(x);
      for (int i = 0; i < 6; ++i)
        if (first[i][i] > 0.0) sum += here[i][i] / first[i][i];
    } catch (const std::invalid_argument&) {  // reported where it is evaluated
    }
    return sum;
  };
}

/// Quarters of the polynomials that replace formulas. Their ends need not be exact: the curve is smooth there.
std::shared_ptr<const FormulaPieces> pieces_of(const Curve& curve) {
  constexpr int kQuarters = 4;
  FormulaPieces pieces{{0.0}};
  for (const PolynomialPiece& piece : make_formula_curve(curve).pieces)
    for (int i = 0; i < kQuarters; ++i) {
      const double t = piece.first(), part = (piece.last() - t) / kQuarters;
      const double chord = norm(piece.position(t + (i + 1) * part) - piece.position(t + i * part));
      pieces.end.push_back(pieces.end.back() + chord);
    }
  for (double& end : pieces.end) end /= pieces.end.back();
  return std::make_shared<const FormulaPieces>(std::move(pieces));
}

/// Pieces of a function that is sampled once in a process.
std::shared_ptr<const FormulaPieces> remembered(const std::string& key, const std::function<FormulaPieces()>& look) {
  constexpr std::size_t kMostRemembered = 10'000;  // members with a length each: then it starts anew
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<const FormulaPieces>> known;
  const std::lock_guard<std::mutex> lock(mutex);
  if (const auto found = known.find(key); found != known.end()) return found->second;
  if (known.size() >= kMostRemembered) known.clear();
  return known[key] = std::make_shared<const FormulaPieces>(look());
}

}  // namespace

std::vector<std::pair<double, double>> FormulaPieces::points(double a, double b) const {
  static const GaussRule rule;
  std::vector<std::pair<double, double>> all;
  auto next = std::upper_bound(end.begin(), end.end(), a);
  if (next == end.end() || *next >= b) return all;
  for (double from = a; from < b; ++next) {
    const double to = next == end.end() ? b : std::min(b, *next), half = 0.5 * (to - from);
    for (int i = 0; i < kPieceOrder; ++i) all.emplace_back(from + half * (1.0 + rule.xi[i]), half * rule.weight[i]);
    from = to;
    if (next == end.end()) break;
  }
  return all;
}

FormulaVector pieces_of(const std::array<std::string, 3>& formula, double length) {
  constexpr int kDigits = 12;  // copies have lengths that differ by rounding
  FormulaVector result;
  for (int i = 0; i < 3; ++i) {
    double constant = 0.0;
    if (formula[i].empty() || parse_number(formula[i], constant).empty()) continue;
    result.component[i] = remembered(rounded(length, kDigits) + "|" + formula[i], [&] {
      const Expression expression(formula[i], {"s", "x"});
      return PieceSearch([&](double x) { return finite_or_zero(expression({x * length, x})); }).run();
    });
  }
  return result;
}

std::shared_ptr<const FormulaPieces> pieces_of_taper(const Scene& scene, const Member& member) {
  if (member.end_section.empty() || member.taper.empty()) return nullptr;
  const SectionLaw law(scene, member);
  std::string key = "taper|" + member.taper;
  for (const double x : {0.0, 1.0})
    for (const double stiffness : diagonal(law.section_of_weight(x))) key += "|" + shortest(stiffness);
  return remembered(key, [&] {
    const Expression weight(member.taper, {"x"});
    const FormulaPieces of_weight = PieceSearch([&](double x) { return finite_or_zero(weight(x)); }).run();
    return PieceSearch(relative_compliance(law), of_weight).run();
  });
}

std::vector<FormulaAlong> formulas_along(const Scene& scene, const std::function<bool(const Member&)>& wanted,
                                         const std::function<const ReferenceCurve&(size_t)>& curve, bool places) {
  std::vector<FormulaAlong> all;
  std::optional<SceneNames> names;
  const auto add = [&](const std::string& list, const std::string& name, const std::array<std::string, 3>& formula,
                       const std::array<double, 2>& range) {
    if (!is_given(formula)) return;
    if (!names) names.emplace(scene);
    const size_t m = static_cast<size_t>(names->member(name) - scene.members.data());
    if (!wanted(scene.members[m])) return;
    const double length = curve(m).length;
    const FormulaVector pieces = pieces_of(formula, length);
    for (int i = 0; i < 3; ++i) {
      if (!pieces.component[i]) continue;
      const auto value = [length, expression = Expression(formula[i], {"s", "x"})](double x) {
        return expression({x * length, x});
      };
      all.push_back({m, list, formula[i], range, pieces.component[i], value});
    }
  };
  for_each_acting(scene, [&](const auto& load, auto kind) {
    if constexpr (kind.along_member)
      kind.for_each_vector(load, [&](const Vector3&, const Formulas* formula, VectorRole) {
        if (formula != nullptr) add(kind.name, load.*kind.target, *formula, kind.range(load));
      });
  });
  for (size_t m = 0; m < scene.members.size(); ++m) {
    const Member& member = scene.members[m];
    if (!wanted(member)) continue;
    if (const auto pieces = pieces_of_taper(scene, member))
      all.push_back({m, "Taper", member.taper, {0.0, 1.0}, pieces, relative_compliance(SectionLaw(scene, member))});
    if (member.curve.shape != CurveShape::parametric) continue;
    std::string text = member.curve.formula[0], key;
    for (int i = 1; i < 3; ++i) text += ", " + member.curve.formula[i];
    key = "curve|" + text + "|" + shortest(member.curve.range[0]) + "|" + shortest(member.curve.range[1]);
    // a component of the tangent that no bump is normal to by chance
    const auto tangent = [along = curve(m)](double x) {
      return dot(along.tangent(x * along.length), Vec3<double>{{0.48, 0.6, 0.64}});
    };
    const auto bending = [along = curve(m)](double x) {
      const Vec3<double> kappa = along.curvature(x * along.length);
      return kappa[1] * kappa[1] + kappa[2] * kappa[2];
    };
    const auto pieces = places ? remembered(key, [&] { return PieceSearch(tangent).run(); }) : pieces_of(member.curve);
    all.push_back({m, "Curve", text, {0.0, 1.0}, pieces, bending});
  }
  return all;
}

MissedIntegral integrate_at_points(const FormulaPieces& pieces, const FormulaFunction& function, double a, double b,
                                   const std::vector<double>& xi, const std::vector<double>& weight,
                                   std::vector<double>& value) {
  const int n = static_cast<int>(xi.size());
  const double half = 0.5 * (b - a);
  MissedIntegral missed;
  std::array<double, 2 * kMaximumOrder + 2> integral{}, sum{}, P{};
  for (const auto& [x, w] : pieces.points(a, b)) {
    const double f = function(x);
    legendre(n, (x - a) / half - 1.0, P.data());
    for (int j = 0; j < n; ++j) integral[j] += w / half * f * P[j];
    missed.total += w * std::abs(f);
  }
  if (missed.total == 0.0) return missed;  // in one piece, or nothing there
  for (int q = 0; q < n; ++q) {
    legendre(n, xi[q], P.data());
    for (int j = 0; j < n; ++j) sum[j] += weight[q] * value[q] * P[j];
  }
  for (int j = 0; j < std::min(n, 2); ++j)
    missed.missed = std::max(missed.missed, half * std::abs(sum[j] - integral[j]));
  if (missed.missed <= kMissedShare * missed.total) return missed;
  for (int q = 0; q < n; ++q) {
    legendre(n, xi[q], P.data());
    value[q] = 0.0;
    for (int j = 0; j < n; ++j) value[q] += (j + 0.5) * integral[j] * P[j];
  }
  return missed;
}

}  // namespace mixbeam
