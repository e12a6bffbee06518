#include "nonlinear/path/critical_point_finder.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

const char* name_of(CriticalKind kind) { return kind == CriticalKind::limit_point ? "limit point" : "bifurcation"; }

namespace {

/// Next to known points Newton's method takes three or four iterations.
constexpr int kMostIterations = 15;
/// Samples of one step, far more than a few critical points need.
constexpr int kMostSamples = 120;
/// More eigenvalues than kMostSeparated are located where they vanish at one place, up to these, as those of symmetric
/// structures with as many equal parts.
constexpr int kMostMultiple = 24;
/// More of them are told by their number only in steps as short as this (the structure moves by so much of its size);
/// longer ones are halved.
constexpr double kShortStep = 1e-3;
/// Points closer together than this share of the step are one multiple point.
constexpr double kTogether = 1e-6;
/// Eigenvalues vanish together when their secants cross zero within this share of a bracket, and again of one that
/// reaches from there by kCloser of it to both sides, nearly to rounding. Else the bracket is divided, at this share of
/// it at least.
constexpr double kNearlyTogether = 1e-2, kCloser = 0.02, kLeastPart = 0.1;
/// The latter secants of eigenvalues that do vanish together, those of equal parts, agree to rounding.
constexpr double kTogetherCloser = 1e-4;
/// A prediction by the cubic through known points has the error of the one along the tangents at both ends times the
/// ratio of the products of the distances to the four points of support. The latter are not quite those of the path
/// where rotations do not commute.
constexpr size_t kSupports = 4;
/// Samples belong to one path when their tangents point along the chord of the step, angles up to 60 degrees; and next
/// to a critical point those of neighbours differ by no more than 0.05 rad.
constexpr double kSmallestCosine = 0.5, kSmoothCosine = 0.999;
}  // namespace

/// Through the nearest points known, where they are nearer than the ends of the step.
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
  if (++samples_ > kMostSamples) throw NotLocated("critical points could not be separated");
  const PathDirection guess = predicted(at);
  const ControlRow row = measure_.row(scaled(piece_.moved, 1.0 / chord_), piece_.start.load_factor, at * chord_);
  const Correction found = judge_.corrector().on_row(
      {piece_.start.state, piece_.start.load_factor + guess.load, &guess.x}, row, kMostIterations);
  if (!found.converged)
    throw NotLocated("a critical point could not be located: near load factor " +
                     std::to_string(piece_.start.load_factor + guess.load) + ", " + found.cause);
  Sample result{at, {found.state, found.load_factor, {scaled(guess, 0.0).x, std::nan("")}}};
  if (asked != Asked::state)
    result.station = judge_.station(found.state, found.load_factor, &piece_.moved, asked == Asked::count);
  if (measure_.motion(piece_.moved.x) > kNoMotion && result.station.has_tangent() &&
      measure_.cosine(result.station.tangent.x, piece_.moved.x) < kSmallestCosine)
    throw NotLocated("the path leaves the direction of the step: another one may have been met");
  if (asked == Asked::count && !result.station.stability) throw NotLocated("the eigenvalues could not be counted");
  if (std::none_of(known_.begin(), known_.end(), [&](const Known& known) { return known.at == at; }))
    known_.push_back({at, {found.moved.clone(true), found.load_factor - piece_.start.load_factor}});
  return result;
}

/// Whether the tangents of samples beside a critical point are those of one smooth path: an imperfect structure turns
/// aside there, and the other side of its corner belongs to another path.
void CriticalPointFinder::require_smoothness(const Station& a, const Station& b) const {
  if (measure_.motion(piece_.moved.x) <= kNoMotion || !a.has_tangent() || !b.has_tangent()) return;
  if (measure_.cosine(a.tangent.x, b.tangent.x) < kSmoothCosine)
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

/// Throws where there are none.
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

/// That of the larger bracket, or the modes at one of the ends.
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

/// Whether elements become unstable inside, between vertices that stand still, or the tangent has no symmetry and its
/// count only tells the sign of the determinant: then no eigenvalue of the vertices needs to pass zero.
bool CriticalPointFinder::needs_counting(const Bracket& bracket) {
  if (turns(bracket) || bracket.space) return false;
  if (!bracket.low.station.stability->symmetric || !bracket.high.station.stability->symmetric)
    return bracket.changes() == 1 || bracket.width() < kTogether;
  const auto interior = [&](const Sample& sample) {
    return stability_.count(sample.station.state, sample.station.load_factor).inside;
  };
  const int changes = std::abs(interior(bracket.high) - interior(bracket.low));
  return changes == bracket.changes() || (changes > 0 && bracket.width() < kTogether);
}

/// Samples that divide the bracket; none where its eigenvalues vanish at one place: their secants say so, and once more
/// close to that place.
std::vector<CriticalPointFinder::Sample> CriticalPointFinder::between(const Bracket& bracket) {
  using Modes = std::vector<EigenMode>;
  const auto secant_places = [&](const Modes& low, const Modes& high) {
    std::vector<double> places;  // as shares
    const int first = bracket.first_crossing(), last = first + bracket.changes();
    for (int i = first; i < last; ++i) places.push_back(low[i].eigenvalue / (low[i].eigenvalue - high[i].eigenvalue));
    std::sort(places.begin(), places.end());
    return places;
  };
  const std::vector<double> places = secant_places(bracket.low.seen.modes, bracket.high.seen.modes);
  if (places.back() - places.front() >= kNearlyTogether) {  // at the widest gap
    size_t gap = 1;
    for (size_t i = 2; i < places.size(); ++i)
      if (places[i] - places[i - 1] > places[gap] - places[gap - 1]) gap = i;
    const double share = std::clamp(0.5 * (places[gap - 1] + places[gap]), kLeastPart, 1.0 - kLeastPart);
    return {sample(bracket.low.at + share * bracket.width(), Asked::count)};
  }
  const double share = std::clamp(0.5 * (places.front() + places.back()), 2.0 * kCloser, 1.0 - 2.0 * kCloser);
  const double place = bracket.low.at + share * bracket.width();
  std::vector<Sample> closer{sample(place - kCloser * bracket.width(), Asked::count),
                             sample(place + kCloser * bracket.width(), Asked::count)};
  if (closer.front().negative() != bracket.low.negative() || closer.back().negative() != bracket.high.negative())
    return closer;
  const std::vector<double> again =
      secant_places(modes_of(closer.front(), bracket.space), modes_of(closer.back(), bracket.space));
  if (again.back() - again.front() < kTogetherCloser) closer.clear();
  return closer;
}

/// Divides brackets until one critical point is left in each.
void CriticalPointFinder::isolate(Bracket bracket, std::vector<Bracket>& found) {
  const int changes = bracket.changes();
  const bool first_only = !found.empty() && !separates_, is_short = bracket.width() < kTogether;
  if (changes == 0 && !turns(bracket)) return;
  if (changes == 0 && is_short)  // else a limit point and another one are two
    return require_smoothness(bracket.low.station, bracket.high.station);
  if (changes > 0 && (first_only || (turns(bracket) && (changes == 1 || is_short)))) {
    found.push_back(std::move(bracket));
    return;
  }
  std::vector<Sample> middle;
  if (changes > 0 && changes <= kMostMultiple && !turns(bracket)) {
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

/// Whether all that passes zero in the step does so at one place.
bool CriticalPointFinder::is_one_point() {
  Bracket whole{{0.0, piece_.start}, {1.0, piece_.end}};
  if (turns(whole) || whole.changes() > kMostMultiple) return false;
  choose_space(whole);
  return whole.space && between(whole).empty();
}

std::vector<CriticalPoint> CriticalPointFinder::find() {
  if (!separates_ && chord_ > kShortStep && !is_one_point())
    throw NotLocated("more than " + std::to_string(kMostSeparated) + " critical points in one step");
  std::vector<Bracket> brackets;
  isolate({{0.0, piece_.start}, {1.0, piece_.end}}, brackets);
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
