#include "nonlinear/critical_point_finder.hpp"

#include "nonlinear/linear_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mixbeam {

const char* name_of(CriticalKind kind) { return kind == CriticalKind::limit_point ? "limit point" : "bifurcation"; }

namespace {

/// Next to known points Newton's method takes three or four iterations.
constexpr int kMostIterations = 15;
/// Samples of one step, far more than a few critical points need.
constexpr int kMostSamples = 120;
/// More eigenvalues than these are not separated: the first one is located, the others are told by their number.
constexpr int kMostSeparated = 6;
/// Points closer together than this share of the step are one multiple point.
constexpr double kTogether = 1e-6;
/// Eigenvalues vanish together when their secants cross zero within this share of a bracket, and again of one that
/// reaches from there by kCloser of it to both sides.
constexpr double kNearlyTogether = 1e-2, kCloser = 0.02;
/// Next to a bifurcation the equations are nearly singular, so the root is interpolated from six points beside it: at
/// multiples of this share of the bracket they leave an error of its sixth power.
constexpr double kDistance = 0.01;
/// Where polynomials of two degrees differ by more than this share of the distance, the samples lie on no one smooth
/// path.
constexpr double kWorstRoot = 1e-2;
/// Of the rule of false position, which takes five as a rule and halves its bracket at worst.
constexpr int kMostRootSamples = 30;
/// Samples belong to one path when their tangents point along the chord of the step, angles up to 60 degrees; and next
/// to a critical point those of neighbours differ by no more than 0.05 rad.
constexpr double kSmallestCosine = 0.5, kSmoothCosine = 0.999;
/// A rate of the load factor over the largest in its bracket whose sign is not one of rounding, nor of the place where
/// a limit point's count changes, which the cap shifts.
constexpr double kSignificantRate = 1e-2;
/// Where no eigenvalue of the vertices passes zero, an element is unstable inside: the place is that where the count
/// changes, to this share of the step.
constexpr double kCountedPlace = 1e-10;
/// Deflated iterations: the state is known to 1e-6 or better from its neighbours, and each squares the error.
constexpr int kDeflatedIterations = 4;

/// The k-th smallest eigenvalue, k from 1. Throws where it is not among those known: a number in its place would be
/// taken for one.
double eigenvalue(const Spectrum& spectrum, int k) {
  std::vector<double> below, above;  // each with the nearest to zero first
  for (const EigenMode& mode : spectrum.modes) (mode.eigenvalue < 0.0 ? below : above).push_back(mode.eigenvalue);
  std::sort(below.rbegin(), below.rend());
  std::sort(above.begin(), above.end());
  // the nearest to zero that count as zero have a sign as well
  const int null = std::min(spectrum.stability.null, static_cast<int>(spectrum.modes.size()));
  int negative = spectrum.stability.negative;
  for (int i = 0; i < null; ++i) negative += spectrum.modes[i].eigenvalue < 0.0 ? 1 : 0;
  const bool is_below = k <= negative;
  const std::vector<double>& side = is_below ? below : above;
  const size_t place = static_cast<size_t>(is_below ? negative - k : k - negative - 1);
  if (place < side.size()) return side[place];
  throw NotLocated("a critical point could not be located: its eigenvalue is not among those nearest to zero");
}

struct Sampled {
  double at, passing, load_factor;
};

/// Value at x of the polynomial through the first `count` samples (Neville's scheme).
double interpolate(const std::vector<Sampled>& samples, size_t count, double x, double Sampled::*value) {
  std::vector<double> p;
  for (size_t i = 0; i < count; ++i) p.push_back(samples[i].*value);
  for (size_t k = 1; k < count; ++k)
    for (size_t i = 0; i + k < count; ++i)
      p[i] = ((x - samples[i + k].at) * p[i] + (samples[i].at - x) * p[i + 1]) / (samples[i].at - samples[i + k].at);
  return p[0];
}

/// Slope of that polynomial at x.
double slope_of(const std::vector<Sampled>& samples, size_t count, double x, double Sampled::*value) {
  double slope = 0.0;
  for (size_t i = 0; i < count; ++i) {
    double basis = 1.0, basis_slope = 0.0;
    for (size_t j = 0; j < count; ++j) {
      if (j == i) continue;
      const double width = samples[i].at - samples[j].at;
      basis_slope = basis_slope * (x - samples[j].at) / width + basis / width;
      basis *= (x - samples[j].at) / width;
    }
    slope += samples[i].*value * basis_slope;
  }
  return slope;
}

/// Zero of a function in [low, high], by secants that keep the bracket (Illinois); not a number where it changes no
/// sign.
template <class Function>
double root_of(const Function& function, double low, double high) {
  double a = low, b = high, fa = function(a), fb = function(b);
  if ((fa < 0.0) == (fb < 0.0)) return std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 60 && std::abs(b - a) > 1e-15; ++i) {
    const double next = b - fb * (b - a) / (fb - fa), f = function(next);
    if (f == 0.0 || next == b) return next;
    if ((f < 0.0) != (fb < 0.0)) {
      a = b;
      fa = fb;
    } else {
      fa *= 0.5;
    }
    b = next;
    fb = f;
  }
  return b;
}

/// Where the polynomial through the first `count` samples passes zero; at a limit point where that of the load factor,
/// which is known to more digits than its rate, is stationary.
double root_of_samples(const std::vector<Sampled>& samples, size_t count, bool is_limit, double low, double high) {
  const bool by_load = is_limit && count >= 4;
  return root_of(
      [&](double x) {
        return by_load ? slope_of(samples, count, x, &Sampled::load_factor)
                       : interpolate(samples, count, x, &Sampled::passing);
      },
      low, high);
}

}  // namespace

CriticalPointFinder::Sample CriticalPointFinder::sample(const PathPiece& piece, double at) {
  if (++samples_ > kMostSamples) throw NotLocated("critical points could not be told apart");
  const double chord = measure_.length(piece.moved);
  const PathDirection guess = judge_.cubic(piece, at);
  const ControlRow row = measure_.row(scaled(piece.moved, 1.0 / chord), piece.start.load_factor, at * chord);
  const Correction found =
      corrector_.on_row({piece.start.state, piece.start.load_factor + guess.load, &guess.x}, row, kMostIterations);
  if (!found.converged)
    throw NotLocated("a critical point could not be located: near load factor " +
                     std::to_string(piece.start.load_factor + guess.load) + ", " + found.cause);
  Sample result{at, judge_.station(found.state, found.load_factor, &piece.moved)};
  if (measure_.motion(piece.moved.x) > kNoMotion && result.station.has_tangent() &&
      measure_.cosine(result.station.tangent.x, piece.moved.x) < kSmallestCosine)
    throw NotLocated("the path leaves the direction of the step: another one may have been met");
  if (!result.station.stability) throw NotLocated("the eigenvalues could not be counted");
  return result;
}

/// Whether the tangents of samples beside a critical point are those of one smooth path: an imperfect structure turns
/// aside there, and the other side of its corner belongs to another path.
void CriticalPointFinder::require_smoothness(const PathPiece& piece, const Station& a, const Station& b) const {
  if (measure_.motion(piece.moved.x) <= kNoMotion || !a.has_tangent() || !b.has_tangent()) return;
  if (measure_.cosine(a.tangent.x, b.tangent.x) < kSmoothCosine)
    throw NotLocated("the path turns aside close to a critical point: it is that of another path");
}

/// Eigenvalues number first .. first + count - 1 in the order of their size.
std::vector<double> CriticalPointFinder::critical_eigenvalues(const Sample& sample, int first, int count) {
  constexpr int kMore = 2;
  const Spectrum spectrum = stability_.spectrum(sample.station.state, sample.station.load_factor, count + kMore);
  std::vector<double> values;
  for (int k = first; k < first + count; ++k) values.push_back(eigenvalue(spectrum, k));
  return values;
}

bool CriticalPointFinder::turns(const Bracket& bracket) const {
  return (bracket.low.station.tangent.load > 0.0) != (bracket.high.station.tangent.load > 0.0);
}

/// Where the eigenvalues that change sign between two samples vanish by their secants: first and last place, as shares
/// of the bracket.
std::array<double, 2> CriticalPointFinder::secant_roots(const Bracket& bracket) {
  const int before = bracket.low.negative(), after = bracket.high.negative();
  const int first = std::min(before, after) + 1, count = std::abs(after - before);
  const std::vector<double> a = critical_eigenvalues(bracket.low, first, count),
                            b = critical_eigenvalues(bracket.high, first, count);
  std::array<double, 2> range{1.0, 0.0};
  for (int i = 0; i < count; ++i) {
    const double root = a[i] / (a[i] - b[i]);
    range = {std::min(range[0], root), std::max(range[1], root)};
  }
  return range;
}

/// Whether these eigenvalues vanish at one place: their secants say so, and once more close to that place.
bool CriticalPointFinder::vanish_together(const PathPiece& piece, const Bracket& bracket) {
  const double width = bracket.high.at - bracket.low.at;
  if (width < kTogether) return true;
  if (turns(bracket)) return false;
  if (needs_counting(bracket)) return true;
  const auto [first, last] = secant_roots(bracket);
  if (!(last - first < kNearlyTogether)) return false;
  const double root = bracket.low.at + 0.5 * (first + last) * width;
  const Bracket closer{sample(piece, root - kCloser * width), sample(piece, root + kCloser * width)};
  if (closer.low.negative() != bracket.low.negative() || closer.high.negative() != bracket.high.negative())
    return false;
  const auto [closer_first, closer_last] = secant_roots(closer);
  return closer_last - closer_first < kNearlyTogether;
}

/// Halves brackets until one critical point is left in each.
void CriticalPointFinder::isolate(const PathPiece& piece, const Bracket& bracket, std::vector<Bracket>& found) {
  const int changes = std::abs(bracket.high.negative() - bracket.low.negative());
  if (changes == 0) {
    if (!turns(bracket)) return;
    if (bracket.high.at - bracket.low.at < kTogether)
      return require_smoothness(piece, bracket.low.station, bracket.high.station);
    const Sample middle = sample(piece, 0.5 * (bracket.low.at + bracket.high.at));  // a limit point and another one
    isolate(piece, {bracket.low, middle}, found);
    isolate(piece, {middle, bracket.high}, found);
    return;
  }
  const bool first_only = !found.empty() && !separates_;
  if (changes == 1 || first_only || (changes <= kMostSeparated && vanish_together(piece, bracket))) {
    found.push_back(bracket);
    return;
  }
  const Sample middle = sample(piece, 0.5 * (bracket.low.at + bracket.high.at));
  isolate(piece, {bracket.low, middle}, found);
  isolate(piece, {middle, bracket.high}, found);
}

/// On one path the load factor turns only where the count changes: a sample at which it runs as at no end of the
/// bracket with the same count lies behind other critical points, or on another path.
void CriticalPointFinder::require_order(const Bracket& bracket, const Sample& sample) const {
  const double rate = sample.station.tangent.load, low = bracket.low.station.tangent.load,
               high = bracket.high.station.tangent.load;
  if (std::abs(rate) < kSignificantRate * std::max(std::abs(low), std::abs(high))) return;
  const bool as_low = (rate > 0.0) == (low > 0.0), as_high = (rate > 0.0) == (high > 0.0);
  if (!turns(bracket) && as_low) return;
  if (turns(bracket) && (sample.negative() == bracket.low.negative() ? as_low : as_high)) return;
  throw MorePoints{sample};
}

/// What passes zero at the critical point of the bracket: the load's rate along the path at a limit point, else the
/// mean of the eigenvalues that vanish together, which is smooth even where they cross.
double CriticalPointFinder::passing(const Bracket& bracket, const Sample& sample) {
  if (turns(bracket)) return sample.station.tangent.load;
  const int before = bracket.low.negative(), after = bracket.high.negative();
  const std::vector<double> values =
      critical_eigenvalues(sample, std::min(before, after) + 1, std::abs(after - before));
  double sum = 0.0;
  for (double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Newton's method at the load factor of the root with the critical modes taken out of every increment: regular where
/// the path crosses other ones.
State CriticalPointFinder::state_at_bifurcation(const PathPiece& piece, double at, double load_factor,
                                                const std::vector<EigenMode>& critical) {
  const PathDirection guess = judge_.cubic(piece, at);
  BeamGroup group(corrector_.global(), problem_, piece.start.state, load_factor, {});
  group.setX(BeamVector(guess.x));
  std::vector<MixedVector> orthogonal;
  for (const EigenMode& mode : critical) {
    MixedVector v = mode.mode.clone(true);
    for (const MixedVector& o : orthogonal) v.update(-measure_.motion(v, o), o, 1.0);
    const double size = measure_.motion(v);
    if (!(size > 0.0)) continue;
    v.scale(1.0 / size);
    orthogonal.push_back(std::move(v));
  }
  for (int i = 0; i < kDeflatedIterations; ++i) {
    group.computeJacobian();
    MixedVector increment = BeamVector::of(group.getNewton()).clone(true);
    for (const MixedVector& o : orthogonal) increment.update(-measure_.motion(increment, o), o, 1.0);
    if (!std::isfinite(increment.maximum_norm())) break;
    BeamVector x(BeamVector::of(group.getX()).clone(true));
    x.values().update(1.0, increment, 1.0);
    group.setX(x);
  }
  return group.state();
}

/// The place by the rule of false position (Illinois), to a quarter of `distance`.
double CriticalPointFinder::coarse_root(const PathPiece& piece, const Bracket& bracket, double distance) {
  double a = bracket.low.at, b = bracket.high.at, fa = passing(bracket, bracket.low),
         fb = passing(bracket, bracket.high);
  if ((fa < 0.0) == (fb < 0.0)) throw NotLocated("a critical point could not be located: no eigenvalue passes zero");
  double at = a;
  for (int i = 0; i < kMostRootSamples; ++i) {
    const double next = std::clamp(b - fb * (b - a) / (fb - fa), std::min(a, b), std::max(a, b));
    if (std::abs(next - at) < 0.25 * distance && i > 0) return next;
    at = next;
    const Sample there = sample(piece, at);
    require_order(bracket, there);
    const double f = passing(bracket, there);
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

/// Whether elements become unstable inside, between vertices that stand still, or the tangent has no symmetry and its
/// count only tells the sign of the determinant: then no eigenvalue of the vertices needs to pass zero.
bool CriticalPointFinder::needs_counting(const Bracket& bracket) {
  if (turns(bracket)) return false;
  if (!bracket.low.station.stability->symmetric || !bracket.high.station.stability->symmetric) return true;
  try {
    if ((passing(bracket, bracket.low) < 0.0) != (passing(bracket, bracket.high) < 0.0)) return false;
  } catch (const NotLocated&) {
    // the vertices have no such eigenvalue
  }
  const auto interior = [&](const Sample& sample) {
    stability_.count(sample.station.state, sample.station.load_factor);
    return problem_->assembler.interior_count().negative;
  };
  return interior(bracket.low) != interior(bracket.high);
}

CriticalPoint CriticalPointFinder::locate_by_count(const PathPiece& piece, const Bracket& bracket) {
  Sample low = bracket.low, high = bracket.high;
  while (high.at - low.at > kCountedPlace) {
    Sample middle = sample(piece, 0.5 * (low.at + high.at));
    if (middle.negative() != low.negative() && middle.negative() != high.negative())
      throw NotLocated("a critical point could not be located: the count changes to and fro");
    (middle.negative() == low.negative() ? low : high) = std::move(middle);
  }
  require_smoothness(piece, low.station, high.station);
  CriticalPoint point{CriticalKind::bifurcation, high.station.load_factor, low.negative(),
                      high.negative(),           high.station.state,       problem_->assembler.create_vector()};
  point.mode.fill(0.0);
  point.modes = std::abs(high.negative() - low.negative());
  if (!high.station.stability->symmetric) find_modes(point);
  point.error = std::abs(high.station.load_factor - low.station.load_factor);
  return point;
}

CriticalPoint CriticalPointFinder::locate(const PathPiece& piece, const Bracket& bracket) {
  const bool is_limit = turns(bracket);
  const double distance = kDistance * (bracket.high.at - bracket.low.at);
  if (needs_counting(bracket)) return locate_by_count(piece, bracket);
  const double near = coarse_root(piece, bracket, distance);
  std::vector<Sampled> samples;
  std::optional<Sample> beside, other_side;
  for (const int place : {1, -1, 2, -2, 3, -3}) {
    Sample here = sample(piece, near + place * distance);
    samples.push_back({here.at, passing(bracket, here), here.station.load_factor});
    std::optional<Sample>& nearest = place > 0 ? beside : other_side;
    if (!nearest)
      nearest = std::move(here);
    else
      require_smoothness(piece, nearest->station, here.station);
  }
  require_smoothness(piece, beside->station, other_side->station);
  const size_t all = samples.size();
  const double low = near - 4.0 * distance, high = near + 4.0 * distance;
  const double root = root_of_samples(samples, all, is_limit, low, high);
  const double error = std::abs(root - root_of_samples(samples, all - 2, is_limit, low, high));
  if (!(error < kWorstRoot * distance))
    throw NotLocated("a critical point could not be located: its place is not certain");
  CriticalPoint point{is_limit ? CriticalKind::limit_point : CriticalKind::bifurcation,
                      0.0,
                      bracket.low.negative(),
                      bracket.high.negative(),
                      beside->station.state,
                      problem_->assembler.create_vector()};
  point.modes = std::abs(bracket.high.negative() - bracket.low.negative());
  point.load_factor = interpolate(samples, all, root, &Sampled::load_factor);
  if (is_limit) {
    const Sample there = sample(piece, root);
    point.state = there.station.state;
    point.load_factor = there.station.load_factor;
    point.error = std::abs(interpolate(samples, all, root, &Sampled::load_factor) -
                           interpolate(samples, all - 2, root, &Sampled::load_factor));
  } else {
    const std::vector<EigenMode> modes =
        stability_.modes_near_zero(beside->station.state, beside->station.load_factor, point.modes);
    point.state = state_at_bifurcation(piece, root, point.load_factor, modes);
    const double noise = modes.empty() ? 0.0 : modes.front().error;  // of the eigenvalue
    point.error = (error + noise / std::abs(slope_of(samples, all, root, &Sampled::passing))) *
                  std::abs(slope_of(samples, all, root, &Sampled::load_factor));
  }
  find_modes(point);
  return point;
}

void CriticalPointFinder::find_modes(CriticalPoint& point) {
  for (EigenMode& mode : stability_.modes_near_zero(point.state, point.load_factor, point.modes))
    point.eigenspace.push_back(std::move(mode.mode));
  if (!point.eigenspace.empty()) point.mode = point.eigenspace.front().clone(true);
}

std::vector<CriticalPoint> CriticalPointFinder::find(const PathPiece& piece) {
  try {
    return find_all(piece);
  } catch (const LinearSolverError& error) {
    throw NotLocated(error.what());
  }
}

std::vector<CriticalPoint> CriticalPointFinder::find_all(const PathPiece& piece) {
  samples_ = 0;
  separates_ = std::abs(piece.end.stability->negative - piece.start.stability->negative) <= kMostSeparated;
  std::vector<Bracket> brackets;
  isolate(piece, {{0.0, piece.start}, {1.0, piece.end}}, brackets);
  std::vector<CriticalPoint> points;
  for (size_t i = 0; i < brackets.size(); ++i) {
    const Bracket bracket = brackets[i];
    const int changes = std::abs(bracket.high.negative() - bracket.low.negative());
    if (separates_ || points.empty()) {
      try {
        points.push_back(locate(piece, bracket));
      } catch (const MorePoints& more) {
        std::vector<Bracket> parts;
        isolate(piece, {bracket.low, more.sample}, parts);
        isolate(piece, {more.sample, bracket.high}, parts);
        brackets.erase(brackets.begin() + i);
        brackets.insert(brackets.begin() + i, parts.begin(), parts.end());
        --i;
      }
      continue;
    }
    CriticalPoint point{
        CriticalKind::bifurcation,  0.5 * (bracket.low.station.load_factor + bracket.high.station.load_factor),
        bracket.low.negative(),     bracket.high.negative(),
        bracket.high.station.state, problem_->assembler.create_vector()};
    point.modes = changes;
    point.error = 0.5 * std::abs(bracket.high.station.load_factor - bracket.low.station.load_factor);
    point.located = false;
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace mixbeam
