#include "nonlinear/path/critical_point_finder.hpp"

#include "nonlinear/path/branch.hpp"
#include "nonlinear/path/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

const char* name_of(CriticalKind kind) {
  if (kind == CriticalKind::flutter) return "flutter";
  return kind == CriticalKind::limit_point ? "limit point" : "bifurcation";
}

namespace {

/// Number of known points through which a cubic predicts others. Its error is that of the cubic along the tangents at
/// both ends, times the ratio of the products of the distances to the four supporting points.
constexpr size_t kSupports = 4;
constexpr size_t kFarSamples = 3;
/// Samples of the polynomial whose zero is the next sample on the way to a root, and period at which the bracket is
/// halved instead, since polynomials may mislead. Three samples usually suffice.
constexpr size_t kPolynomialSamples = 5;
constexpr int kHalfway = 5;

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

/// Finds the zero of a function in [a, b] by regula falsi (Illinois); NaN if it does not change its sign.
template <class Function>
double root_of(const Function& function, double a, double b) {
  double fa = function(a), fb = function(b);
  if ((fa < 0.0) == (fb < 0.0)) return std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < path_limit.most_root_steps && std::abs(b - a) > path_limit.root_rounding; ++i) {
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

/// Finds the zero of the polynomial through the first `count` samples; at a limit point the stationary point of that of
/// the load factor, which has more digits than its rate.
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

/// Predicts a point by the cubic through the nearest known points, if they are nearer than the ends of the step.
PathDirection CriticalPointFinder::predicted(double at) const {
  std::vector<const Known*> nearest;
  for (const Known& known : known_) nearest.push_back(&known);
  std::stable_sort(nearest.begin(), nearest.end(),
                   [&](const Known* a, const Known* b) { return std::abs(a->at - at) < std::abs(b->at - at); });
  nearest.resize(std::min(nearest.size(), kSupports));
  double distances = 1.0;
  for (const Known* known : nearest) distances *= std::abs(known->at - at);
  if (nearest.size() < kSupports || distances > at * at * (1.0 - at) * (1.0 - at)) return judge_.cubic(piece_, at);
  PathDirection result = scaled(piece_.moved, 0.0);
  for (const Known* known : nearest) {
    double weight = 1.0;
    for (const Known* other : nearest)
      if (other != known) weight *= (at - other->at) / (known->at - other->at);
    result.x.update(weight, known->moved.x, 1.0);
    result.load += weight * known->moved.load;
  }
  return result;
}

CriticalPointFinder::Sample CriticalPointFinder::sample(double at, Asked asked) {
  if (++samples_ > path_limit.most_samples) throw NotLocated("critical points could not be separated");
  const PathDirection guess = predicted(at);
  const ControlRow row = measure_.row(scaled(piece_.moved, 1.0 / chord_), piece_.start.load_factor, at * chord_);
  const Correction found = judge_.corrector().on_row(
      {piece_.start.state, piece_.start.load_factor + guess.load, &guess.x}, row, path_limit.most_iterations_nearby);
  if (!found.converged)
    throw NotLocated("a critical point could not be located: near load factor " +
                     std::to_string(piece_.start.load_factor + guess.load) + ", " + found.cause);
  Sample result{at, {found.state, found.load_factor, {scaled(guess, 0.0).x, std::nan("")}}};
  if (asked != Asked::state)
    result.station = judge_.station(found.state, found.load_factor, &piece_.moved, asked == Asked::count);
  if (!straight_ && result.station.has_tangent() &&
      measure_.cosine(result.station.tangent.x, piece_.moved.x) < path_limit.least_cosine)
    throw NotLocated("the path leaves the direction of the step: another one may have been met");
  if (asked == Asked::count && !result.station.stability) throw NotLocated("the eigenvalues could not be counted");
  if (std::none_of(known_.begin(), known_.end(), [&](const Known& known) { return known.at == at; }))
    known_.push_back({at, {found.moved.clone(true), found.load_factor - piece_.start.load_factor}});
  return result;
}

/// Throws if tangents beside a critical point do not belong to one smooth path: the path of an imperfect structure
/// turns off sharply there, and points beyond the corner belong to another path.
void CriticalPointFinder::require_smoothness(const Station& a, const Station& b) const {
  if (straight_ || !a.has_tangent() || !b.has_tangent()) return;
  if (measure_.cosine(a.tangent.x, b.tangent.x) < path_limit.smooth_cosine)
    throw NotLocated("the path turns aside close to a critical point: it is that of another path");
}

bool CriticalPointFinder::turns(const Bracket& bracket) const {
  return (bracket.low.station.tangent.load > 0.0) != (bracket.high.station.tangent.load > 0.0);
}

const SpaceValues& CriticalPointFinder::values_of(Sample& sample, const Space& space) {
  if (sample.space != space) {
    sample.seen = stability_.in_space(sample.station.state, sample.station.load_factor, *space);
    sample.space = space;
  }
  return sample.seen;
}

/// Modes in the space at a sample; throws if there are none.
const std::vector<EigenMode>& CriticalPointFinder::modes_of(Sample& sample, const Space& space) {
  const std::vector<EigenMode>& modes = values_of(sample, space).modes;
  if (modes.empty()) throw NotLocated("a critical point could not be located: the tangent loses its symmetry");
  return modes;
}

/// Whether the space sees all that passes zero in the bracket.
bool CriticalPointFinder::sees_changes(Bracket& bracket, const Space& space) {
  const SpaceValues &low = values_of(bracket.low, space), &high = values_of(bracket.high, space);
  return !low.modes.empty() && !high.modes.empty() && low.unseen == high.unseen &&
         std::abs(low.negative() - high.negative()) == bracket.changes();
}

/// Chooses a space for the bracket: that of the larger bracket, or the modes at one of the ends.
void CriticalPointFinder::choose_space(Bracket& bracket) {
  if (bracket.space && sees_changes(bracket, bracket.space)) return;
  bracket.space.reset();
  const int first = std::min(bracket.low.negative(), bracket.high.negative()) + 1;
  for (const Sample* end : {&bracket.low, &bracket.high}) {
    const auto space = std::make_shared<const CriticalSpace>(
        stability_.space_of(end->station.state, end->station.load_factor, first, bracket.changes()));
    if (space->size == 0 || !sees_changes(bracket, space)) continue;
    bracket.space = space;
    return;
  }
}

/// Whether elements become unstable inside, between fixed vertices, or the tangent is unsymmetric and its count only
/// means the sign of the determinant: then no eigenvalue of the vertices needs to pass zero.
bool CriticalPointFinder::needs_counting(const Bracket& bracket) {
  if (turns(bracket) || bracket.space) return false;
  if (!bracket.low.station.stability->symmetric || !bracket.high.station.stability->symmetric)
    return bracket.changes() == 1 || bracket.width() < path_limit.together;
  const auto interior = [&](const Sample& sample) {
    return stability_.ask({sample.station.state, sample.station.load_factor}, How::inertia)->inside;
  };
  const int changes = std::abs(interior(bracket.high) - interior(bracket.low));
  return changes == bracket.changes() || (changes > 0 && bracket.width() < path_limit.together);
}

/// Takes samples that divide the bracket; none if its eigenvalues vanish together, according to their secants in the
/// bracket and again close to their zero.
std::vector<CriticalPointFinder::Sample> CriticalPointFinder::between(const Bracket& bracket) {
  using Modes = std::vector<EigenMode>;
  const auto secant_places = [&](const Modes& low, const Modes& high) {
    std::vector<double> places;  // as shares of the bracket
    const int first = bracket.first_crossing(), last = first + bracket.changes();
    for (int i = first; i < last; ++i) places.push_back(low[i].eigenvalue / (low[i].eigenvalue - high[i].eigenvalue));
    std::sort(places.begin(), places.end());
    return places;
  };
  const std::vector<double> places = secant_places(bracket.low.seen.modes, bracket.high.seen.modes);
  if (places.back() - places.front() >= path_limit.nearly_together) {  // at the widest gap
    size_t gap = 1;
    for (size_t i = 2; i < places.size(); ++i)
      if (places[i] - places[i - 1] > places[gap] - places[gap - 1]) gap = i;
    const double share =
        std::clamp(0.5 * (places[gap - 1] + places[gap]), path_limit.least_part, 1.0 - path_limit.least_part);
    return {sample(bracket.low.at + share * bracket.width(), Asked::count)};
  }
  const double share =
      std::clamp(0.5 * (places.front() + places.back()), 2.0 * path_limit.closer, 1.0 - 2.0 * path_limit.closer);
  const double place = bracket.low.at + share * bracket.width();
  std::vector<Sample> closer{sample(place - path_limit.closer * bracket.width(), Asked::count),
                             sample(place + path_limit.closer * bracket.width(), Asked::count)};
  if (closer.front().negative() != bracket.low.negative() || closer.back().negative() != bracket.high.negative())
    return closer;
  const std::vector<double> again =
      secant_places(modes_of(closer.front(), bracket.space), modes_of(closer.back(), bracket.space));
  if (again.back() - again.front() < path_limit.together_closer) closer.clear();
  return closer;
}

/// Divides brackets until one critical point is left in each.
void CriticalPointFinder::isolate(Bracket bracket, std::vector<Bracket>& found) {
  const int changes = bracket.changes();
  const bool first_only = !found.empty() && !separates_, is_short = bracket.width() < path_limit.together;
  if (changes == 0 && !turns(bracket)) return;
  if (changes == 0 && is_short)  // otherwise there are two points, one of them a limit point
    return require_smoothness(bracket.low.station, bracket.high.station);
  if (changes > 0 && (first_only || (turns(bracket) && (changes == 1 || is_short)))) {
    found.push_back(std::move(bracket));
    return;
  }
  std::vector<Sample> middle;
  if (changes > 0 && changes <= path_limit.most_multiple && !turns(bracket)) {
    choose_space(bracket);
    if (bracket.space && changes > 1 && !is_short) middle = between(bracket);
    if (middle.empty() && (bracket.space || needs_counting(bracket))) {
      found.push_back(std::move(bracket));
      return;
    }
    if (is_short) throw NotLocated("a critical point could not be located: no eigenvalue passes zero");
  }
  if (middle.empty()) middle.push_back(sample(bracket.low.at + 0.5 * bracket.width(), Asked::count));
  middle.push_back(bracket.high);
  Sample low = bracket.low;
  for (Sample& high : middle) {
    isolate({low, high, bracket.space}, found);
    low = std::move(high);
  }
}

// Location of the critical point in a bracket, and the state there: theory (60), (61).

/// Throws MorePoints if a sample in the bracket of a bifurcation has a rate of the load factor of the other sign: on
/// one path that requires further critical points.
void CriticalPointFinder::require_order(const Bracket& bracket, const Sample& here) {
  const double rate = here.station.tangent.load, low = bracket.low.station.tangent.load,
               high = bracket.high.station.tangent.load;
  if (turns(bracket) || (rate > 0.0) == (low > 0.0)) return;
  if (std::abs(rate) < path_limit.significant_rate * std::max(std::abs(low), std::abs(high))) return;
  throw MorePoints{sample(here.at, Asked::count)};
}

/// Evaluates the value that passes zero, theory (60): at a limit point the rate of the load factor along the path, else
/// the mean of the eigenvalues that vanish together, which is smooth even if they cross.
PassingSample CriticalPointFinder::passing(const Bracket& bracket, Sample& sample) {
  PassingSample result{sample.at, sample.station.tangent.load, sample.station.load_factor};
  if (turns(bracket)) return result;
  const std::vector<EigenMode>& modes = modes_of(sample, bracket.space);
  result.passing = 0.0;
  for (int i = 0; i < bracket.changes(); ++i)
    result.passing += modes[bracket.first_crossing() + i].eigenvalue / bracket.changes();
  return result;
}

/// Modes of the eigenvalues that vanish together.
std::vector<MixedVector> CriticalPointFinder::critical_modes(const Bracket& bracket, Sample& sample) {
  const std::vector<EigenMode>& seen = modes_of(sample, bracket.space);
  std::vector<MixedVector> modes;
  for (int i = 0; i < bracket.changes(); ++i) modes.push_back(seen[bracket.first_crossing() + i].mode.clone(true));
  return modes;
}

/// Finds the state by theory (61): Newton's method at the root's load with critical modes deflated from every
/// increment, which is regular where the path crosses others.
State CriticalPointFinder::state_at_bifurcation(double at, double load_factor,
                                                const std::vector<MixedVector>& critical) {
  const PathDirection guess = predicted(at);
  BeamGroup group(judge_.problem(), piece_.start.state, load_factor);
  group.setX(BeamVector(guess.x));
  const std::vector<MixedVector> orthogonal = orthonormal(measure_, critical);
  Teuchos::ParameterList none;
  for (int i = 0; i < path_limit.deflated_iterations; ++i) {
    group.computeNewton(none);
    MixedVector increment = BeamVector::of(group.getNewton()).clone(true);
    for (const MixedVector& o : orthogonal) increment.update(-measure_.motion(increment, o), o, 1.0);
    if (!std::isfinite(increment.maximum_norm()) || measure_.motion(increment) < path_limit.no_motion) break;
    BeamVector x(BeamVector::of(group.getX()).clone(true));
    x.values().update(1.0, increment, 1.0);
    group.setX(x);
  }
  return group.state();
}

/// Distance of samples from a critical point, which they take at multiples of it.
double CriticalPointFinder::distance_at(const Bracket& bracket, double at) const {
  const double to_end = std::min(at - bracket.low.at, bracket.high.at - at), width = bracket.width();
  return std::clamp(0.25 * to_end, path_limit.least_distance * width,
                    (turns(bracket) ? path_limit.distance_of_limit : path_limit.distance_of_samples) * width);
}

/// Locates the root as accurately as the distance of samples requires; returns the samples on the way, ends first.
double CriticalPointFinder::coarse_root(Bracket& bracket, std::vector<PassingSample>& samples) {
  const Asked asked = turns(bracket) ? Asked::tangent : Asked::state;
  samples = {passing(bracket, bracket.low), passing(bracket, bracket.high)};
  PassingSample low = samples.front(), high = samples.back();
  if ((low.passing < 0.0) == (high.passing < 0.0))
    throw NotLocated("a critical point could not be located: no eigenvalue passes zero");
  double at = low.at;
  for (int i = 1; i < path_limit.most_root_samples; ++i) {
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

/// Locates the point by bisection of the count. The result has no modes if nothing passes zero.
CriticalPoint CriticalPointFinder::locate_by_count(const Bracket& bracket) {
  Sample low = bracket.low, high = bracket.high;
  while (high.at - low.at > path_limit.counted_place) {
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
  // An eigenvalue counts as negative only beyond its error, which shifts the place of the change.
  const double noise = find_modes(point);
  const Station& start = bracket.low.station;
  const std::vector<EigenMode> far = stability_.modes_near_zero(start.state, start.load_factor, 1);
  if (far.empty()) return point;
  const double left = noise / std::abs(far.front().eigenvalue);  // relative to the eigenvalue at the start
  point.error += left * std::abs(point.load_factor - start.load_factor);
  // The count also changes if two complex eigenvalues meet below zero and become real.
  if (point.modes % 2 == 0 && left > path_limit.passed_zero) point.modes = 0;
  return point;
}

/// Takes samples at multiples of the distance on both sides of `near`, which must lie on one smooth path; returns the
/// first of them in `beside`.
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
  const Sample after = sample(near + path_limit.close_look * distance, Asked::tangent),
               before = sample(near - path_limit.close_look * distance, Asked::tangent);
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
  if (!(error < path_limit.worst_root * distance))
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

/// Finds the modes at a point. Returns the error of the eigenvalue nearest to zero; for several, at least their largest
/// magnitude.
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

/// Sample at an end of the step, or a little beyond it if an eigenvalue is zero there and belongs to neither side.
CriticalPointFinder::Sample CriticalPointFinder::end_of_step(double at, const Station& station) {
  if (station.stability->null == 0) return {at, station};
  try {
    Sample beyond = sample(at == 0.0 ? -path_limit.beyond_step : at + path_limit.beyond_step, Asked::count);
    if (beyond.station.stability->null == 0) return beyond;
  } catch (const NotLocated&) {  // the path has a corner there, for example between stages
  }
  return {at, station};
}

/// Whether all eigenvalues that pass zero in the step do so at one point.
bool CriticalPointFinder::is_one_point(Bracket whole) {
  if (turns(whole) || whole.changes() > path_limit.most_multiple) return false;
  choose_space(whole);
  return whole.space && between(whole).empty();
}

std::vector<CriticalPoint> CriticalPointFinder::find() {
  const Bracket whole{end_of_step(0.0, piece_.start), end_of_step(1.0, piece_.end)};
  if (!separates_ && chord_ > path_limit.short_step && !is_one_point(whole))
    throw NotLocated("more than " + std::to_string(kMostSeparated) + " critical points in one step");
  std::vector<Bracket> brackets;
  isolate(whole, brackets);
  std::vector<CriticalPoint> points;
  for (size_t i = 0; i < brackets.size(); ++i) {
    Bracket& bracket = brackets[i];
    if (separates_ || points.empty()) {
      try {
        CriticalPoint point = locate(bracket);
        if (point.modes > 0) points.push_back(std::move(point));
      } catch (const MorePoints& more) {
        std::vector<Bracket> parts;
        isolate({bracket.low, more.sample, bracket.space}, parts);
        isolate({more.sample, bracket.high, bracket.space}, parts);
        brackets.erase(brackets.begin() + i);
        brackets.insert(brackets.begin() + i, parts.begin(), parts.end());
        --i;
      }
      continue;
    }
    CriticalPoint point{
        CriticalKind::bifurcation,  0.5 * (bracket.low.station.load_factor + bracket.high.station.load_factor),
        bracket.low.negative(),     bracket.high.negative(),
        bracket.high.station.state, model_.create_vector()};
    point.modes = bracket.changes();
    point.error = 0.5 * std::abs(bracket.high.station.load_factor - bracket.low.station.load_factor);
    point.located = false;
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace mixbeam
