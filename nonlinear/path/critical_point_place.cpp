// Where in a bracket a critical point lies, and the state there: theory (60), (61).
#include "nonlinear/path/critical_point_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Next to a bifurcation the equations are nearly singular, so the root is interpolated from four points beside it, at
/// multiples of this share of the bracket, and three from farther away: they leave an error of its fourth power and
/// less. Other points may lie beyond the ends of the bracket: the samples keep away from there, unless the share became
/// less than kLeastDistance.
constexpr double kDistance = 0.004, kLeastDistance = 1e-4;
/// At limit points nothing is singular, and the load factor's own rounding is what must be outweighed: six points leave
/// an error of the sixth power of a larger distance.
constexpr double kDistanceOfLimit = 0.016;
constexpr size_t kFarSamples = 3;
/// Where polynomials of two degrees differ by more than this share of the distance, the samples lie on no one smooth
/// path.
constexpr double kWorstRoot = 1e-2;
/// On the way to a root the next sample is taken where the polynomial through so many passes zero, but every so many
/// times half-way, since polynomials may mislead. Three samples as a rule.
constexpr size_t kPolynomialSamples = 5;
constexpr int kHalfway = 5, kMostRootSamples = 40;
/// Of the rule of false position for a polynomial.
constexpr int kMostRootSteps = 60;
constexpr double kRootRounding = 1e-15;
/// An imperfection e turns a path aside over a distance of about sqrt(e / 0.05) from a bifurcation: tangents at this
/// share of the distance of the samples still show those of 1e-8, and 1e-11 that Newton's method leaves is no corner.
constexpr double kCloseLook = 0.03;
/// A rate of the load factor over the largest in its bracket whose sign is not one of rounding.
constexpr double kSignificantRate = 1e-2;
/// Where no eigenvalue of the vertices passes zero, an element is unstable inside: the place is that where the count
/// changes, to this share of the step.
constexpr double kCountedPlace = 1e-10;
/// An eigenvalue that passes zero in a bracket as short as that is there below this share of what it was at the
/// start of the step.
constexpr double kPassedZero = 0.05;
/// Deflated iterations at most: the state is known to 1e-6 or better from its neighbours, and each squares the error.
constexpr int kDeflatedIterations = 4;

using Samples = std::vector<PassingSample>;

/// Value at x of the polynomial through the first `count` samples (Neville's scheme).
double interpolate(const Samples& samples, size_t count, double x, double PassingSample::*value) {
  std::vector<double> p;
  for (size_t i = 0; i < count; ++i) p.push_back(samples[i].*value);
  for (size_t k = 1; k < count; ++k)
    for (size_t i = 0; i + k < count; ++i)
      p[i] = ((x - samples[i + k].at) * p[i] + (samples[i].at - x) * p[i + 1]) / (samples[i].at - samples[i + k].at);
  return p[0];
}

/// Slope of that polynomial at x.
double slope_of(const Samples& samples, size_t count, double x, double PassingSample::*value) {
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

/// Zero of a function in [a, b], by secants that keep the bracket (rule of false position, Illinois); not a number
/// where it does not change its sign.
template <class Function>
double root_of(const Function& function, double a, double b) {
  double fa = function(a), fb = function(b);
  if ((fa < 0.0) == (fb < 0.0)) return std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < kMostRootSteps && std::abs(b - a) > kRootRounding; ++i) {
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

void sort_by_distance(Samples& samples, double at) {
  std::stable_sort(samples.begin(), samples.end(), [&](const PassingSample& a, const PassingSample& b) {
    return std::abs(a.at - at) < std::abs(b.at - at);
  });
}

/// Where the polynomial through the first `count` samples passes zero; at a limit point where that of the load factor,
/// which is known to more digits than its rate, is stationary.
double root_of_samples(const Samples& samples, size_t count, bool is_limit, double low, double high) {
  const bool by_load = is_limit && count >= 4;
  return root_of(
      [&](double x) {
        return by_load ? slope_of(samples, count, x, &PassingSample::load_factor)
                       : interpolate(samples, count, x, &PassingSample::passing);
      },
      low, high);
}

}  // namespace

/// On one path the load factor turns only where the count changes: a sample in the bracket of a bifurcation with a rate
/// of the other sign lies behind other critical points, or on another path.
void CriticalPointFinder::require_order(const Bracket& bracket, const Sample& here) {
  const double rate = here.station.tangent.load, low = bracket.low.station.tangent.load,
               high = bracket.high.station.tangent.load;
  if (turns(bracket) || (rate > 0.0) == (low > 0.0)) return;
  if (std::abs(rate) < kSignificantRate * std::max(std::abs(low), std::abs(high))) return;
  throw MorePoints{sample(here.at, Asked::count)};
}

/// Theory (60): at a limit point the load's rate along the path passes zero, else the mean of the eigenvalues that
/// vanish together, which is smooth even where they cross.
PassingSample CriticalPointFinder::passing(const Bracket& bracket, Sample& sample) {
  PassingSample result{sample.at, sample.station.tangent.load, sample.station.load_factor};
  if (turns(bracket)) return result;
  const std::vector<EigenMode>& modes = modes_of(sample, bracket.space);
  result.passing = 0.0;
  for (int i = 0; i < bracket.changes(); ++i)
    result.passing += modes[bracket.first_crossing() + i].eigenvalue / bracket.changes();
  return result;
}

/// Of the eigenvalues that vanish together.
std::vector<MixedVector> CriticalPointFinder::critical_modes(const Bracket& bracket, Sample& sample) {
  const std::vector<EigenMode>& seen = modes_of(sample, bracket.space);
  std::vector<MixedVector> modes;
  for (int i = 0; i < bracket.changes(); ++i) modes.push_back(seen[bracket.first_crossing() + i].mode.clone(true));
  return modes;
}

/// Theory (61), the critical modes taken out of every increment of Newton's method at the root's load: regular where
/// the path crosses other ones.
State CriticalPointFinder::state_at_bifurcation(double at, double load_factor,
                                                const std::vector<MixedVector>& critical) {
  const PathDirection guess = predicted(at);
  BeamGroup group(judge_.corrector().global(), judge_.problem(), piece_.start.state, load_factor, {});
  group.setX(BeamVector(guess.x));
  std::vector<MixedVector> orthogonal;
  for (const MixedVector& mode : critical) {
    MixedVector v = mode.clone(true);
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
    if (!std::isfinite(increment.maximum_norm()) || measure_.motion(increment) < kNoMotion) break;
    BeamVector x(BeamVector::of(group.getX()).clone(true));
    x.values().update(1.0, increment, 1.0);
    group.setX(x);
  }
  return group.state();
}

/// Where samples beside a critical point lie: multiples of this.
double CriticalPointFinder::distance_at(const Bracket& bracket, double at) const {
  const double to_end = std::min(at - bracket.low.at, bracket.high.at - at), width = bracket.width();
  return std::clamp(0.25 * to_end, kLeastDistance * width, (turns(bracket) ? kDistanceOfLimit : kDistance) * width);
}

/// The place as well as the distance of samples asks for; adds what was sampled on the way, the ends first.
double CriticalPointFinder::coarse_root(Bracket& bracket, std::vector<PassingSample>& samples) {
  const Asked asked = turns(bracket) ? Asked::tangent : Asked::state;
  samples = {passing(bracket, bracket.low), passing(bracket, bracket.high)};
  PassingSample low = samples.front(), high = samples.back();
  if ((low.passing < 0.0) == (high.passing < 0.0))
    throw NotLocated("a critical point could not be located: no eigenvalue passes zero");
  double at = low.at;
  for (int i = 1; i < kMostRootSamples; ++i) {
    const bool is_halfway = i % kHalfway == 0;
    const double middle = 0.5 * (low.at + high.at);
    sort_by_distance(samples, middle);
    const size_t count = std::min(samples.size(), kPolynomialSamples);
    const double next = is_halfway ? middle : root_of_samples(samples, count, false, low.at, high.at);
    if (i > 1 && !is_halfway && std::abs(next - at) < distance_at(bracket, next)) return next;
    at = next;
    Sample here = sample(at, asked);
    samples.push_back(passing(bracket, here));
    if (samples.back().passing == 0.0) return at;
    ((samples.back().passing < 0.0) == (low.passing < 0.0) ? low : high) = samples.back();
  }
  return at;
}

/// Of no modes where the count changes and nothing passes zero.
CriticalPoint CriticalPointFinder::locate_by_count(const Bracket& bracket) {
  Sample low = bracket.low, high = bracket.high;
  while (high.at - low.at > kCountedPlace) {
    Sample middle = sample(0.5 * (low.at + high.at), Asked::count);
    if (middle.negative() != low.negative() && middle.negative() != high.negative())
      throw NotLocated("a critical point could not be located: the count of negative eigenvalues alternates");
    (middle.negative() == low.negative() ? low : high) = std::move(middle);
  }
  require_smoothness(low.station, high.station);
  CriticalPoint point{CriticalKind::bifurcation, high.station.load_factor, low.negative(),
                      high.negative(),           high.station.state,       model_.create_vector()};
  point.mode.fill(0.0);
  point.modes = std::abs(high.negative() - low.negative());
  point.error = std::abs(high.station.load_factor - low.station.load_factor);
  if (high.station.stability->symmetric) return point;
  // counted as negative from the error of an eigenvalue on
  const double noise = find_modes(point);
  const Station& start = bracket.low.station;
  const std::vector<EigenMode> far = stability_.modes_near_zero(start.state, start.load_factor, 1);
  if (far.empty()) return point;
  const double left = noise / std::abs(far.front().eigenvalue);  // of what the eigenvalue was
  point.error += left * std::abs(point.load_factor - start.load_factor);
  // Two complex eigenvalues that meet below zero and become real change the count, too.
  if (point.modes % 2 == 0 && left > kPassedZero) point.modes = 0;
  return point;
}

/// Samples at multiples of the distance to both sides of `near`, which are those of one smooth path; the first of them
/// in `beside`.
std::vector<PassingSample> CriticalPointFinder::samples_beside(const Bracket& bracket, double near, double distance,
                                                               Sample& beside) {
  std::vector<Sample> nearest;
  Samples samples;
  for (int place = 1; place <= (turns(bracket) ? 3 : 2); ++place)
    for (const int side : {0, 1}) {
      Sample here = sample(near + (side == 0 ? place : -place) * distance, Asked::tangent);
      require_order(bracket, here);
      samples.push_back(passing(bracket, here));
      if (place > 1)
        require_smoothness(nearest[side].station, here.station);
      else
        nearest.push_back(std::move(here));
    }
  const Sample after = sample(near + kCloseLook * distance, Asked::tangent),
               before = sample(near - kCloseLook * distance, Asked::tangent);
  require_smoothness(nearest[0].station, after.station);
  require_smoothness(after.station, before.station);
  require_smoothness(before.station, nearest[1].station);
  beside = std::move(nearest[0]);
  return samples;
}

CriticalPoint CriticalPointFinder::locate(Bracket& bracket) {
  const bool is_limit = turns(bracket);
  if (!is_limit && !bracket.space) return locate_by_count(bracket);
  Samples on_the_way;
  const double near = coarse_root(bracket, on_the_way), distance = distance_at(bracket, near);
  Sample beside = bracket.low;
  Samples samples = samples_beside(bracket, near, distance, beside);
  const double low = near - 4.0 * distance, high = near + 4.0 * distance;
  sort_by_distance(on_the_way, near);
  const size_t most = samples.size() + kFarSamples;
  for (const PassingSample& far : on_the_way)
    if (samples.size() < most && (far.at < low || far.at > high)) samples.push_back(far);
  const size_t all = samples.size();
  const double root = root_of_samples(samples, all, is_limit, low, high);
  const double error = std::abs(root - root_of_samples(samples, all - 2, is_limit, low, high));
  if (!(error < kWorstRoot * distance))
    throw NotLocated("a critical point could not be located: its location is not certain");
  CriticalPoint point{is_limit ? CriticalKind::limit_point : CriticalKind::bifurcation,
                      interpolate(samples, all, root, &PassingSample::load_factor),
                      bracket.low.negative(),
                      bracket.high.negative(),
                      beside.station.state,
                      model_.create_vector()};
  point.modes = bracket.changes();
  if (is_limit) {
    const Sample there = sample(root, Asked::tangent);
    point.error = std::abs(point.load_factor - interpolate(samples, all - 2, root, &PassingSample::load_factor));
    point.state = there.station.state;
    point.load_factor = there.station.load_factor;
    find_modes(point);
    return point;
  }
  point.state = state_at_bifurcation(root, point.load_factor, critical_modes(bracket, beside));
  const double noise = find_modes(point);
  point.error = (error + noise / std::abs(slope_of(samples, all, root, &PassingSample::passing))) *
                std::abs(slope_of(samples, all, root, &PassingSample::load_factor));
  return point;
}

/// Returns the error of the eigenvalue nearest to zero; of several at one place how far they are from it.
double CriticalPointFinder::find_modes(CriticalPoint& point) {
  std::vector<EigenMode> modes = stability_.modes_near_zero(point.state, point.load_factor, point.modes);
  if (modes.empty()) return 0.0;
  for (EigenMode& mode : modes) point.eigenspace.push_back(std::move(mode.mode));
  point.mode = point.eigenspace.front().clone(true);
  double error = modes.front().error;
  for (const EigenMode& mode : modes)
    if (point.modes > 1) error = std::max(error, std::abs(mode.eigenvalue));
  return error;
}

}  // namespace mixbeam
