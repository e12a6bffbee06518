#include "nonlinear/critical_point_finder.hpp"

#include "discretization/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace mixbeam {

const char* name_of(CriticalKind kind) { return kind == CriticalKind::limit_point ? "limit point" : "bifurcation"; }

namespace {

/// Next to known points Newton's method takes three or four iterations.
constexpr int kMostIterations = 15;
/// Next to a bifurcation the equations are nearly singular, so the root is interpolated from points beside it: six of
/// them at multiples of this share of the segment leave an error of its sixth power.
constexpr double kSpacing = 0.005;
constexpr std::array<int, 6> kPlaces = {-3, -2, -1, 1, 2, 3};
/// A change of the load factor along the path, per length, that is rounding at a limit point: there it is quadratic in
/// the error of the place, which is 1e-9.
constexpr double kStationary = 1e-6;
/// Two eigenvalues whose roots are closer (share of the segment) vanish together.
constexpr double kTogether = 1e-5;
/// Deflated iterations: the state is known to 1e-6 or better from its neighbours, and each squares the error.
constexpr int kDeflatedIterations = 4;

/// The k-th smallest eigenvalue, k from 1, or one beyond all known ones on the right side of zero.
double eigenvalue(const Spectrum& spectrum, int k) {
  std::vector<double> below, above;  // each with the nearest to zero first
  for (const EigenMode& mode : spectrum.modes) (mode.eigenvalue < 0.0 ? below : above).push_back(mode.eigenvalue);
  std::sort(below.rbegin(), below.rend());
  std::sort(above.begin(), above.end());
  const int negative = spectrum.stability.negative;
  const bool is_below = k <= negative;
  const std::vector<double>& side = is_below ? below : above;
  const size_t place = static_cast<size_t>(is_below ? negative - k : k - negative - 1);
  if (place < side.size()) return side[place];
  return is_below ? (below.empty() ? -1.0 : below.back()) : (above.empty() ? 1.0 : above.back());
}

/// The mode of the k-th smallest eigenvalue, null if it is not among those known.
const EigenMode* mode_of_rank(const Spectrum& spectrum, int k) {
  const double value = eigenvalue(spectrum, k);
  for (const EigenMode& mode : spectrum.modes)
    if (mode.eigenvalue == value) return &mode;
  return nullptr;
}

/// Lagrange's polynomial through (kPlaces, y), and its slope.
std::pair<double, double> interpolate(const std::array<double, kPlaces.size()>& y, double x) {
  double value = 0.0, slope = 0.0;
  for (size_t i = 0; i < y.size(); ++i) {
    double basis = 1.0, basis_slope = 0.0;
    for (size_t j = 0; j < y.size(); ++j) {
      if (j == i) continue;
      const double width = kPlaces[i] - kPlaces[j];
      basis_slope = basis_slope * (x - kPlaces[j]) / width + basis / width;
      basis *= (x - kPlaces[j]) / width;
    }
    value += y[i] * basis;
    slope += y[i] * basis_slope;
  }
  return {value, slope};
}

/// Zero of the polynomial in [-4, 4], by Newton's method from the root of its secant.
double root_of(const std::array<double, kPlaces.size()>& y) {
  double x = 0.0;
  for (int i = 0; i < 20; ++i) {
    const auto [value, slope] = interpolate(y, x);
    const double next = std::clamp(x - value / slope, -4.0, 4.0);
    if (next == x) break;
    x = next;
  }
  return x;
}

}  // namespace

Correction CriticalPointFinder::correct(const PathSegment& segment, double at) {
  const PathDirection guess = scaled(segment.moved, at);
  ControlRow row = segment.row;
  row.target *= at;
  Correction result =
      corrector_.on_row({segment.start, segment.load_factor + guess.load, &guess.x}, row, kMostIterations);
  if (!result.converged)
    throw ConvergenceError("a critical point could not be located: near load factor " +
                           std::to_string(segment.load_factor + guess.load) + ", " + result.cause);
  return result;
}

CriticalPointFinder::Sample CriticalPointFinder::sample(const PathSegment& segment, double at, int modes) {
  const Correction found = correct(segment, at);
  Sample result{at, found.load_factor, found.state, stability_.spectrum(found.state, found.load_factor, modes)};
  if (result.spectrum.modes.empty())
    throw ConvergenceError("a critical point could not be located: at load factor " +
                           std::to_string(found.load_factor) + " no real eigenvalue lies near zero");
  return result;
}

/// Regula falsi (Illinois) until the place hardly moves.
double CriticalPointFinder::coarse_root(const PathSegment& segment, int k, int modes, const Sample& first,
                                        const Sample& last) {
  constexpr int kMostSteps = 30;
  double a = first.at, b = last.at;
  double fa = eigenvalue(first.spectrum, k), fb = eigenvalue(last.spectrum, k);
  double at = a;
  for (int i = 0; i < kMostSteps; ++i) {
    const double next = fb == fa ? 0.5 * (a + b) : b - fb * (b - a) / (fb - fa);
    if (std::abs(next - at) < 0.25 * kSpacing && i > 0) return next;
    at = next;
    const double f = eigenvalue(sample(segment, at, modes).spectrum, k);
    if (f == 0.0) return at;
    if ((f < 0.0) != (fb < 0.0)) {
      a = b;
      fa = fb;
    } else {
      fa *= 0.5;
    }
    b = at;
    fb = f;
  }
  return at;
}

/// The mode that is most nearly parallel to another one.
const EigenMode* CriticalPointFinder::most_like(const Spectrum& spectrum, const MixedVector& other) const {
  const EigenMode* best = nullptr;
  double largest = -1.0;
  for (const EigenMode& mode : spectrum.modes) {
    const PathDirection a{mode.mode.clone(true), 0.0}, b{other.clone(true), 0.0};
    const double cosine = std::abs(measure_.inner(a, b)) / (measure_.length(a) * measure_.length(b));
    if (!(cosine > largest)) continue;
    largest = cosine;
    best = &mode;
  }
  return best;
}

CriticalPointFinder::Root CriticalPointFinder::refined_root(const PathSegment& segment, int k, int modes, double near) {
  std::array<double, kPlaces.size()> value{}, load{};
  Root root;
  // Eigenvalues that meet at the root change their order there: the curve of one is followed by its mode.
  std::optional<MixedVector> followed;
  for (size_t i = 0; i < kPlaces.size(); ++i) {
    Sample here = sample(segment, near + kSpacing * kPlaces[i], modes);
    const EigenMode* mode = followed ? most_like(here.spectrum, *followed) : mode_of_rank(here.spectrum, k);
    value[i] = mode == nullptr ? eigenvalue(here.spectrum, k) : mode->eigenvalue;
    if (mode != nullptr) followed = mode->mode.clone(true);
    load[i] = here.load_factor;
    if (kPlaces[i] == 1) root.beside = std::move(here);
  }
  const double x = root_of(value);
  const auto [load_factor, slope] = interpolate(load, x);
  root.at = near + kSpacing * x;
  root.load_factor = load_factor;
  root.load_slope = slope / (kSpacing * measure_.length(segment.moved));
  return root;
}

/// Newton's method in the plane of the root with the critical mode taken out of every increment: regular where the path
/// crosses another one.
State CriticalPointFinder::state_at_bifurcation(const PathSegment& segment, const Root& root, const MixedVector& mode) {
  const PathDirection guess = scaled(segment.moved, root.at);
  BeamGroup group(corrector_.global(), problem_, segment.start, root.load_factor, {});
  group.setX(BeamVector(guess.x));
  const PathDirection critical{mode.clone(true), 0.0};
  const double square = measure_.inner(critical, critical);
  for (int i = 0; i < kDeflatedIterations; ++i) {
    group.computeJacobian();
    PathDirection increment{BeamVector::of(group.getNewton()).clone(true), 0.0};
    increment.x.update(-measure_.inner(increment, critical) / square, mode, 1.0);
    if (!std::isfinite(increment.x.maximum_norm())) break;
    BeamVector x(BeamVector::of(group.getX()).clone(true));
    x.values().update(1.0, increment.x, 1.0);
    group.setX(x);
  }
  return group.state();
}

CriticalPoint CriticalPointFinder::point_at(const PathSegment& segment, const Root& root) {
  CriticalPoint point{
      CriticalKind::bifurcation, root.load_factor, 0, 0, root.beside.state, root.beside.spectrum.modes.front().mode, 1};
  if (std::abs(root.load_slope) < kStationary) {
    point.kind = CriticalKind::limit_point;
    const Correction there = correct(segment, root.at);
    point.state = there.state;
    point.load_factor = there.load_factor;
  } else {
    point.state = state_at_bifurcation(segment, root, point.mode);
  }
  const std::vector<EigenMode> there = stability_.modes_near_zero(point.state, point.load_factor, 1);
  if (!there.empty()) point.mode = there.front().mode;
  return point;
}

std::vector<CriticalPoint> CriticalPointFinder::find(const PathSegment& segment) {
  constexpr int kFewModes = 4;
  Sample first{0.0, segment.load_factor, segment.start,
               stability_.spectrum(segment.start, segment.load_factor, kFewModes)};
  Sample last = sample(segment, 1.0, kFewModes);
  const int before = first.spectrum.stability.negative, after = last.spectrum.stability.negative;
  const int modes = kFewModes + std::abs(after - before);
  if (modes > 2 * kFewModes) {
    first.spectrum = stability_.spectrum(first.state, first.load_factor, modes);
    last.spectrum = stability_.spectrum(last.state, last.load_factor, modes);
  }
  std::vector<Root> roots;
  std::vector<CriticalPoint> points;
  for (int k = std::min(before, after) + 1; k <= std::max(before, after); ++k) {
    const double near = coarse_root(segment, k, modes, first, last);
    const bool again = !roots.empty() && std::abs(near - roots.back().at) < kSpacing;
    const Root root = refined_root(segment, k, modes, near);
    if (again && std::abs(root.at - roots.back().at) < kTogether) {
      ++points.back().modes;
      continue;
    }
    roots.push_back(root);
    points.push_back(point_at(segment, root));
  }
  if (after < before) std::reverse(points.begin(), points.end());
  int negative = before;
  for (CriticalPoint& point : points) {
    point.negative_before = negative;
    negative += after > before ? point.modes : -point.modes;
    point.negative_after = negative;
  }
  return points;
}

}  // namespace mixbeam
