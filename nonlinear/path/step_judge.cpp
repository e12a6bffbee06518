#include "nonlinear/path/step_judge.hpp"

#include "discretization/text/number_text.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/path/critical_point_finder.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// The chord and the tangents at its ends are taken for one line when their cosines are at least this: a path that
/// turns aside by less has no room for another one.
constexpr double kStraight = 0.97;
/// Newton's correction half-way, over the chord, up to which the cubic counts as the path.
constexpr double kLargestCorrection = 0.2;
/// A correction this small leaves no doubt that the cubic is the path.
constexpr double kSure = 1e-2;
/// A step is halved for a closer look so many times at most.
constexpr int kMostHalvings = 3;
/// Between points in which the load factor changes at rates of one sign the rate stays above this share of the smaller
/// one, or the load may have gone back and forth between them.
constexpr double kLeastGain = 0.5;
/// Of the load factor's last rate over its mean: it grows with this power of the motion. Bars in tension make it grow
/// with the third, what is bent until it is straight with any power, and a cubic says nothing of that.
constexpr double kFastestGrowth = 6.0;
/// What the cubic leaves out of the load factor half-way, e, is at least a multiple of the parabola of fourth degree
/// 16 e s^2 (1 - s)^2, whose slope reaches this times e.
constexpr double kErrorOfRate = 3.1;
/// A change of the load factor along a step, over the load factor: the cap alone shifts critical loads by 1e-7.
constexpr double kFlat = 1e-5;
/// A structure has stiffened when its rate at the end would move it by less than this share of the step's chord, and
/// the direction of that rate is of no importance from angles of 60 degrees on.
constexpr double kStiffened = 0.1, kEndCosine = 0.5;
/// Parts that move by a smaller share of what the part that moves farthest does stand still.
constexpr double kLeastShare = 1e-8;
/// In which loads are looked at.
constexpr int kPartsOfStep = 8;
/// Newton's method half-way starts near the path.
constexpr int kMostIterationsHalfway = 15;

const char* const kBends = "the path bends too much: another one may have been met";
const char* const kTurnBack = "the loads turn back within the step";
const char* const kGoesBack = "the load factor goes back within the step";

/// Whether counts exist at both ends and inside, and agree.
bool has_counts(const PathPiece& piece, int inside) {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  return a && b && a->negative == b->negative && inside == a->negative;
}

/// The load factor turns at limit points alone, and each of them changes the count by one.
bool may_turn(const PathPiece& piece, const StepTest& test) {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  return test.counts_may_change && (!a || !b || a->negative != b->negative);
}

/// Whether the load factor hardly changes along the step, so that the signs of its rates may be those of rounding.
bool load_is_flat(const PathMeasure& measure, const PathPiece& piece) {
  const double rate = std::max(std::abs(piece.start.tangent.load), std::abs(piece.end.tangent.load));
  return rate * measure.motion(piece.moved.x) <= kFlat * std::max(1.0, std::abs(piece.end.load_factor));
}

}  // namespace

/// A step of one part, in motions; rates: of the load factor along the chord.
struct StepJudge::Part {
  Part(const PathPiece& piece, double chord_chord, double chord_start, double chord_end, double start_start,
       double end_end)
      : chord(std::sqrt(chord_chord)),
        first(start_start > 0.0 ? chord_start / (chord * std::sqrt(start_start)) : 0.0),
        last(end_end > 0.0 ? chord_end / (chord * std::sqrt(end_end)) : 0.0),
        first_rate(piece.start.tangent.load * chord / chord_start),
        last_rate(piece.end.tangent.load * chord / chord_end),
        mean_rate(piece.moved.load / chord),
        starts_still(std::sqrt(start_start) < kNoMotion * std::abs(piece.start.tangent.load)),
        ends_stiff(last < kEndCosine && std::sqrt(end_end) * std::abs(piece.moved.load) <
                                            kStiffened * chord * std::abs(piece.end.tangent.load)) {}

  double chord;                             ///< its length
  double first, last;                       ///< cosines of the angles with the tangents at both ends
  double first_rate, last_rate, mean_rate;  ///< of the load factor
  bool starts_still;                        ///< loads set out with no rate: the start has no direction
  bool ends_stiff;                          ///< the last bit of a way on which it has stiffened

  double least_rate() const;
  bool load_dips(const StepTest& test) const;
};

/// What is seen at a guess of a point inside a step, theory (58), and Newton's correction at right angles to the chord.
struct StepJudge::Look {
  PathDirection corrected;  ///< the guess with that correction, as increments from the start of the step
  double correction = 0.0;  ///< over the chord, of the part where it is largest
  double load_error = 0.0;  ///< of the cubic
  bool goes_back = false;   ///< the load factor, against its rate at the start
  int negative = -1;        ///< none: not counted
};

/// The least rate of the load factor, in the direction of the first one, on the cubic of theory (59).
double StepJudge::Part::least_rate() const {
  const double sign = first_rate > 0.0 ? 1.0 : -1.0;
  const double begin = sign * first_rate, end = sign * last_rate, mean = sign * mean_rate;
  // its rate at share s: begin + linear s + square s^2
  const double linear = 6.0 * mean - 4.0 * begin - 2.0 * end, square = 3.0 * (begin + end - 2.0 * mean);
  const bool is_inside = square > 0.0 && linear < 0.0 && -linear < 2.0 * square;
  return is_inside ? begin - linear * linear / (4.0 * square) : std::min(begin, end);
}

/// Whether the load factor may go back somewhere between the ends: the cubic nearly does. A shallow arch that has
/// snapped through and stiffened far beyond gains on the mean, which tells nothing unless the cubic tells less.
bool StepJudge::Part::load_dips(const StepTest& test) const {
  if ((first_rate > 0.0) != (last_rate > 0.0)) return false;
  const double mean = first_rate > 0.0 ? mean_rate : -mean_rate;
  const bool outgrows_cubic = test.may_stiffen && std::abs(last_rate) > kFastestGrowth * mean;
  return (outgrows_cubic ? mean : least_rate()) < kLeastGain * std::min(std::abs(first_rate), std::abs(last_rate));
}

/// Those that move.
std::vector<StepJudge::Part> StepJudge::parts_of(const PathPiece& piece) const {
  const MixedVector &chord = piece.moved.x, &start = piece.start.tangent.x, &end = piece.end.tangent.x;
  const std::vector<double> cc = measure_.motion_of_parts(chord, chord), cs = measure_.motion_of_parts(chord, start),
                            ce = measure_.motion_of_parts(chord, end), ss = measure_.motion_of_parts(start, start),
                            ee = measure_.motion_of_parts(end, end);
  const double largest = *std::max_element(cc.begin(), cc.end());
  const double still = std::max(kNoMotion, kLeastShare * std::sqrt(largest));
  std::vector<Part> parts;
  for (size_t p = 0; p < cc.size(); ++p)
    if (std::sqrt(cc[p]) >= still) parts.emplace_back(piece, cc[p], cs[p], ce[p], ss[p], ee[p]);
  return parts;
}

/// Where loads turn back, the structure follows the change of the loads from end to end, if it is nearly linear: then
/// the tangents for that change point along the chord at both ends.
std::string StepJudge::objection_where_loads_turn(const PathPiece& piece) const {
  const double from = piece.start.load_factor, to = piece.end.load_factor;
  Station start = piece.start, end = piece.end;
  start.tangent = secant_tangent(piece.start, from, to);
  end.tangent = secant_tangent(piece.end, from, to);
  if (!start.has_tangent() || !end.has_tangent()) return kBends;
  for (const Part& part : parts_of({start, piece.moved, end}))
    if (!(std::min(part.first, part.last) >= kStraight)) return kTurnBack;
  return "";
}

/// Where the ends lie together: whether the loads move nothing on the way either.
bool StepJudge::loads_move_nothing(const PathPiece& piece) const {
  const double from = piece.start.load_factor, size = piece.end.load_factor - from;
  for (int part = 0; part < kPartsOfStep; ++part) {
    const PathDirection rate =
        secant_tangent(piece.start, from + size * part / kPartsOfStep, from + size * (part + 1) / kPartsOfStep);
    if (!(measure_.motion(rate.x) < kNoMotion * std::abs(rate.load))) return false;
  }
  return true;
}

PathDirection StepJudge::cubic(const PathPiece& piece, double at) const {
  const double length = measure_.length(piece.moved);
  const double s = at, whole = s * s * (3.0 - 2.0 * s), first = s * (1.0 - s) * (1.0 - s) * length,
               last = s * s * (s - 1.0) * length;
  PathDirection result = scaled(piece.moved, whole);
  if (!piece.start.has_tangent() || !piece.end.has_tangent()) return scaled(piece.moved, at);
  if (ends_stiff(piece)) {  // the end's tangent says nothing of the way there: the parabola along the first one
    PathDirection parabola = scaled(piece.moved, s * s);
    parabola.x.update(s * (1.0 - s) * length, piece.start.tangent.x, 1.0);
    parabola.load += s * (1.0 - s) * length * piece.start.tangent.load;
    return parabola;
  }
  result.x.update(first, piece.start.tangent.x, last, piece.end.tangent.x, 1.0);
  result.load += first * piece.start.tangent.load + last * piece.end.tangent.load;
  return result;
}

StepJudge::Part StepJudge::whole(const PathPiece& piece) const {
  const MixedVector &chord = piece.moved.x, &start = piece.start.tangent.x, &end = piece.end.tangent.x;
  return Part(piece, measure_.motion(chord, chord), measure_.motion(chord, start), measure_.motion(chord, end),
              measure_.motion(start, start), measure_.motion(end, end));
}

/// Whether the structure hardly moves any more at the end, and in another direction: nothing to judge the way by.
bool StepJudge::ends_stiff(const PathPiece& piece) const { return whole(piece).ends_stiff; }

StepJudge::Look StepJudge::look(const PathPiece& piece, PathDirection guess) const {
  const double load_factor = piece.start.load_factor + guess.load;
  const Linear at = linear_at(piece.start.state, guess, load_factor);
  const MixedVector &chord = piece.moved.x, &newton = at.newton, &rate = at.less_rate;
  const std::vector<double> cc = measure_.motion_of_parts(chord, chord), cr = measure_.motion_of_parts(chord, rate),
                            cn = measure_.motion_of_parts(chord, newton), nn = measure_.motion_of_parts(newton, newton),
                            nr = measure_.motion_of_parts(newton, rate), rr = measure_.motion_of_parts(rate, rate);
  const double still = std::max(kNoMotion, kLeastShare * measure_.motion(chord));
  Look seen{std::move(guess)};
  for (size_t p = 0; p < cc.size(); ++p) {
    if (std::sqrt(cc[p]) < still) continue;
    const double change = cn[p] / cr[p];  // of the load factor, for a correction at right angles to the chord
    const double square = std::max(0.0, nn[p] - change * (2.0 * nr[p] - change * rr[p])) / cc[p];
    seen.correction = square >= 0.0 ? std::max(seen.correction, std::sqrt(square)) : HUGE_VAL;
    seen.goes_back = seen.goes_back || (cr[p] < 0.0) != (piece.start.tangent.load > 0.0);
  }
  const double change = measure_.motion(chord, newton) / measure_.motion(chord, rate);
  seen.load_error = std::abs(change);
  ++problem_->work.looks;
  if (!std::isfinite(seen.correction)) return seen;
  seen.corrected.x.update(1.0, newton, -change, rate, 1.0);
  seen.corrected.load += change;
  const std::optional<StabilityResult> there = count(at.state, load_factor + change);
  if (there) seen.negative = there->negative;
  return seen;
}

std::string StepJudge::objection(const PathPiece& piece, const StepTest& test) {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  if (a && b && !test.counts_may_change && a->negative != b->negative)
    return "stability changes within the step: the path is followed by its length";
  return objection(piece, test, kMostHalvings);
}

/// A count inside a step must lie between those of its ends, theory (57). Without symmetry it is the parity that the
/// sign of the determinant tells, which changes where an eigenvalue passes zero all the same.
std::string StepJudge::objection_to_count(const PathPiece& piece, int negative) const {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  if (!a || !b || negative < 0) return "";
  const auto [least, most] = std::minmax(a->negative, b->negative);
  if (least <= negative && negative <= most) return "";
  return "stability changes several times within the step";
}

std::string StepJudge::objection(const PathPiece& piece, const StepTest& test, int depth) {
  if (!piece.start.has_tangent() || !piece.end.has_tangent()) return "";
  // Loads of many formulas that cancel each other at both ends need not do so in between.
  if (measure_.motion(piece.moved.x) < kNoMotion)
    return !loads().have_formulas() || loads_move_nothing(piece) ? "" : kTurnBack;
  if (!loads().is_straight(piece.start.load_factor, piece.end.load_factor)) return objection_where_loads_turn(piece);
  bool looks = test.always_looks, dips = false, is_bent = false;
  for (const Part& part : parts_of(piece)) {
    const bool hardly_moves = test.may_stiffen && part.ends_stiff;
    if (!(part.starts_still || part.first >= test.smallest_cosine)) return kBends;
    if (!hardly_moves && !(part.last >= test.least_cosine_at_end)) return kBends;
    is_bent = is_bent || (!hardly_moves && part.last < test.smallest_cosine);
    dips = dips || part.load_dips(test);
    looks = looks || part.starts_still || std::min(part.first, part.last) < kStraight;
  }
  if (is_bent) return objection_of_halves(piece, test, depth);
  const bool turns = (piece.start.tangent.load > 0.0) != (piece.end.tangent.load > 0.0);
  const bool turns_unseen = turns && !may_turn(piece, test);
  if (!looks && !dips && !turns_unseen) return "";
  Look seen = look(piece, cubic(piece, 0.5));
  const double load_error = seen.load_error;
  // Where rates at the ends differ by decades the cubic overshoots in the forces: they alone may falsify count and
  // rate.
  if (seen.correction <= kSure && (seen.goes_back || !objection_to_count(piece, seen.negative).empty()))
    seen = look(piece, std::move(seen.corrected));
  if (!(seen.correction <= kLargestCorrection)) return objection_of_halves(piece, test, depth);
  const std::string count = objection_to_count(piece, seen.negative);
  if (!count.empty()) return objection_of_halves(piece, test, depth);  // beside the path counts may differ
  // Stiff beside soft, next to a bifurcation, the rate's sign is one of rounding: counts that agree tell better.
  if (turns_unseen)
    return load_is_flat(measure_, piece) && has_counts(piece, seen.negative) && seen.correction <= kSure ? ""
                                                                                                         : kGoesBack;
  const bool is_last =
      depth == 0 && has_counts(piece, seen.negative) && (!test.always_looks || load_is_flat(measure_, piece));
  if (dips && is_last) return "";
  if (!turns && !dips && seen.goes_back) return kGoesBack;
  if (dips) return objection_of_halves(piece, test, depth);
  if (!test.always_looks) return "";
  // where all critical points are looked for the cubic must leave no room for a dip, and pairs between which the count
  // has changed several times are found by further evaluations
  const bool is_sure =
      !turns && kErrorOfRate * load_error <= whole(piece).least_rate() * measure_.motion(piece.moved.x);
  if (!turns && !is_sure && !is_last) return objection_of_halves(piece, test, depth);
  for (const double at : {0.25, 0.75}) {
    const Look there = look(piece, cubic(piece, at));
    if (!(there.correction <= kLargestCorrection) || !objection_to_count(piece, there.negative).empty())
      return objection_of_halves(piece, test, depth);
  }
  return "";
}

std::string StepJudge::objection_of_halves(const PathPiece& piece, const StepTest& test, int depth) {
  if (depth == 0) return kBends;
  const double chord = measure_.length(piece.moved);
  const PathDirection guess = cubic(piece, 0.5);
  const Correction found = corrector_.on_row(
      {piece.start.state, piece.start.load_factor + guess.load, &guess.x},
      measure_.row(scaled(piece.moved, 1.0 / chord), piece.start.load_factor, 0.5 * chord), kMostIterationsHalfway);
  if (!found.converged) return "no equilibrium half-way: " + found.cause;
  const PathDirection there{found.moved.clone(true), found.load_factor - piece.start.load_factor};
  PathDirection rest = scaled(piece.moved, 1.0);
  rest.x.update(-1.0, there.x, 1.0);
  rest.load -= there.load;
  const Station middle = station(found.state, found.load_factor, test.counts_may_change ? &piece.moved : nullptr);
  if (middle.stability) {
    const std::string count = objection_to_count(piece, middle.stability->negative);
    if (!count.empty()) return count;
  }
  const std::string of_first = objection({piece.start, there, middle}, test, depth - 1);
  return of_first.empty() ? objection({middle, rest, piece.end}, test, depth - 1) : of_first;
}

namespace {

/// Whether the load factor turns at each limit point: it lies beyond those before and after it, or what was sampled
/// beside it belongs to two paths.
bool turns_at_limits(const PathPiece& piece, const std::vector<CriticalPoint>& passed) {
  const auto load_at = [&](size_t i) { return i < passed.size() ? passed[i].load_factor : piece.end.load_factor; };
  double before = piece.start.load_factor;
  for (size_t i = 0; i < passed.size(); before = passed[i++].load_factor) {
    const double here = passed[i].load_factor, gain = here - before, rest = load_at(i + 1) - here;
    const double known = passed[i].error + kFlat * std::max(1.0, std::abs(here));
    const bool passes = gain * rest > 0.0 && std::min(std::abs(gain), std::abs(rest)) > known;
    if (passes && passed[i].kind == CriticalKind::limit_point) return false;
  }
  return true;
}

}  // namespace

StepFindings StepJudge::examine(const PathPiece& piece, const StepTest& test) {
  StepFindings findings;
  findings.objection = objection(piece, test);
  const std::optional<StabilityResult>&before = piece.start.stability, &after = piece.end.stability;
  const bool changes = before && after && before->negative != after->negative;
  if (findings.objection.empty() && changes) {
    try {
      findings.passed = CriticalPointFinder(*this, piece).find();
      if (!turns_at_limits(piece, findings.passed))
        findings.objection = "the load factor does not turn at a limit point: the step leads to another path";
    } catch (const NotLocated& error) {
      findings.objection = error.what();
    } catch (const LinearSolverError& error) {
      findings.objection = error.what();
    }
  }
  if (!findings.objection.empty())
    findings.objection += " (load factor " + rounded(loads().load_factor(piece.start.load_factor), 6) + " to " +
                          rounded(loads().load_factor(piece.end.load_factor), 6) + ")";
  return findings;
}

}  // namespace mixbeam
