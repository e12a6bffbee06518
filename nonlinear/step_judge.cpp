#include "nonlinear/step_judge.hpp"

#include "nonlinear/linear_solver.hpp"

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
/// Between points in which the load factor changes at rates of one sign it changes by at least this share of the
/// smaller rate, or it may have gone back and forth between them.
constexpr double kLeastGain = 0.5;
/// Between an element and its vertices [rad]: at pi the relative rotation is not unique.
constexpr double kLargestEndAngle = 2.8;
/// A structure has stiffened when its rate at the end would move it by less than this share of the step's chord, and
/// the direction of that rate is of no importance from angles of 60 degrees on.
constexpr double kStiffened = 0.1, kEndCosine = 0.5;
/// Newton's method half-way starts near the path.
constexpr int kMostIterations = 15;

const char* const kBends = "the path bends too much: another one may have been met";
const char* const kGoesBack = "the load factor goes back within the step";

/// Without symmetry a count is the parity that the sign of the determinant tells: it changes where an eigenvalue passes
/// zero all the same.
bool comparable(const std::optional<StabilityResult>& a, const std::optional<StabilityResult>& b) { return a && b; }

/// Whether counts exist at both ends and inside, and agree.
bool has_counts(const PathPiece& piece, int inside) {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  return comparable(a, b) && a->negative == b->negative && inside == a->negative;
}

/// The load factor turns at limit points alone, and each of them changes the count by one.
bool may_turn(const PathPiece& piece, const StepTest& test) {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  return test.counts_may_change && (!comparable(a, b) || a->negative != b->negative);
}

/// Rate of the load factor along the chord at a station; infinite where the structure does not move along it.
double rate_along(const PathMeasure& measure, const PathDirection& chord, double length, const PathDirection& tangent) {
  return tangent.load * length / measure.motion(chord.x, tangent.x);
}

}  // namespace

/// What is seen at a point of the cubic after one Newton correction at right angles to the chord.
struct StepJudge::Look {
  double correction = 0.0;  ///< over the chord
  double load_factor = 0.0;
  double rate = 0.0;  ///< of the load factor along the chord
  int negative = -1;  ///< none: not counted
};

std::optional<StabilityResult> StepJudge::count(const State& state, double load_factor) const {
  if (problem_->leave_if_asked) problem_->leave_if_asked();
  if (stability_ == nullptr) return std::nullopt;
  try {
    const StabilityResult result = stability_->count(state, load_factor);
    // elements that turn nearly by pi against their vertices have no stiffness to count by
    if (problem_->assembler.largest_end_angle().angle > kLargestEndAngle) return std::nullopt;
    return result;
  } catch (const LinearSolverError&) {
    return std::nullopt;  // a singular tangent without symmetry has no count
  }
}

Station StepJudge::station(const State& state, double load_factor, const PathDirection* along) const {
  BeamGroup group(corrector_.global(), problem_, state, load_factor, {});
  group.computeJacobian();
  BeamVector slope(problem_->assembler.create_vector()), by_load(problem_->assembler.create_vector());
  problem_->assembler.load_derivative(state, within_stage(load_factor, stage_end_), slope.values());
  Teuchos::ParameterList none;
  group.applyJacobianInverse(none, slope, by_load);
  const PathDirection rate{by_load.values().clone(true), -1.0};
  PathDirection tangent = scaled(rate, -1.0 / measure_.length(rate));
  if (along != nullptr && measure_.inner(*along, tangent) < 0.0) tangent = scaled(tangent, -1.0);
  return {state, load_factor, std::move(tangent), count(state, load_factor)};
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

/// Whether the structure hardly moves any more at the end, and in another direction: the last bit of a way on which it
/// has stiffened, and nothing to judge the way by.
bool StepJudge::ends_stiff(const PathPiece& piece) const {
  const double rate = measure_.motion(piece.end.tangent.x) / std::abs(piece.end.tangent.load);
  return measure_.cosine(piece.end.tangent.x, piece.moved.x) < kEndCosine &&
         rate * std::abs(piece.moved.load) < kStiffened * measure_.motion(piece.moved.x);
}

StepJudge::Look StepJudge::look(const PathPiece& piece, double at) const {
  const PathDirection guess = cubic(piece, at);
  const bool in_plane = piece.start.state.in_plane && problem_->assembler.is_in_plane(guess.x);
  const NearCritical near(*problem_, !in_plane);
  const double load_factor = piece.start.load_factor + guess.load;
  BeamGroup group(corrector_.global(), problem_, piece.start.state, load_factor, {});
  group.setX(BeamVector(guess.x));
  group.computeJacobian();
  BeamVector slope(problem_->assembler.create_vector()), by_load(problem_->assembler.create_vector());
  problem_->assembler.load_derivative(group.state(), within_stage(load_factor, stage_end_), slope.values());
  Teuchos::ParameterList none;
  group.applyJacobianInverse(none, slope, by_load);  // less du/dlambda
  const MixedVector& newton = BeamVector::of(group.getNewton());
  const double chord = measure_.motion(piece.moved.x);
  const double along = measure_.motion(piece.moved.x, by_load.values());
  const double change = measure_.motion(piece.moved.x, newton) / along;
  MixedVector correction = newton.clone(true);
  correction.update(-change, by_load.values(), 1.0);
  Look seen{measure_.motion(correction) / chord, load_factor + change, -chord / along, -1};
  ++problem_->work.looks;
  if (!std::isfinite(seen.correction)) return seen;
  const std::optional<StabilityResult> there = count(group.state(), seen.load_factor);
  if (there) seen.negative = there->negative;
  return seen;
}

std::string StepJudge::objection(const PathPiece& piece, const StepTest& test) const {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  if (comparable(a, b) && !test.counts_may_change && a->negative != b->negative)
    return "stability changes within the step: the path is followed by its length";
  return objection(piece, test, kMostHalvings);
}

/// A count inside a step must lie between those of its ends.
std::string StepJudge::objection_to_count(const PathPiece& piece, const StepTest&, int negative) const {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  if (!comparable(a, b) || negative < 0) return "";
  const auto [least, most] = std::minmax(a->negative, b->negative);
  if (least <= negative && negative <= most) return "";
  return "stability changes to and fro within the step";
}

/// Whether the load factor goes back somewhere between the ends, as far as their rates can tell.
bool StepJudge::load_dips(const PathPiece& piece) const {
  const double chord = measure_.motion(piece.moved.x), mean = piece.moved.load / chord;
  const double first = rate_along(measure_, piece.moved, chord, piece.start.tangent),
               last = rate_along(measure_, piece.moved, chord, piece.end.tangent);
  if ((first > 0.0) != (last > 0.0)) return false;
  const double least = std::min(std::abs(first), std::abs(last));
  return (first > 0.0 ? mean : -mean) < kLeastGain * least;
}

std::string StepJudge::objection(const PathPiece& piece, const StepTest& test, int depth) const {
  const double chord = measure_.motion(piece.moved.x);
  if (chord < kNoMotion || !piece.start.has_tangent() || !piece.end.has_tangent()) return "";
  const double first = measure_.cosine(piece.start.tangent.x, piece.moved.x),
               last = measure_.cosine(piece.end.tangent.x, piece.moved.x);
  // Loads that set out with no rate (a square of the load factor) give the start no direction.
  const bool starts_still = measure_.motion(piece.start.tangent.x) < kNoMotion * std::abs(piece.start.tangent.load);
  const bool hardly_moves = !test.counts_may_change && ends_stiff(piece);
  if (!(starts_still || first >= test.smallest_cosine)) return kBends;
  if (!hardly_moves && !(last >= test.least_cosine_at_end)) return kBends;
  if (!hardly_moves && last < test.smallest_cosine) return objection_of_halves(piece, test, depth);
  const bool turns = (piece.start.tangent.load > 0.0) != (piece.end.tangent.load > 0.0);
  const bool turns_unseen = turns && !may_turn(piece, test);
  const bool dips = load_dips(piece);
  if (!test.always_looks && !dips && !turns_unseen && !starts_still && std::min(first, last) >= kStraight) return "";
  const Look seen = look(piece, 0.5);
  if (!(seen.correction <= kLargestCorrection)) return objection_of_halves(piece, test, depth);
  const std::string count = objection_to_count(piece, test, seen.negative);
  if (!count.empty()) return objection_of_halves(piece, test, depth);  // beside the path counts may differ
  // Stiff beside soft, next to a bifurcation, the rate's sign is one of rounding: counts that agree tell better.
  if (turns_unseen) return has_counts(piece, seen.negative) && seen.correction <= kSure ? "" : kGoesBack;
  if (dips && depth == 0 && has_counts(piece, seen.negative)) return "";
  if (!turns && !dips && (seen.rate > 0.0) != (piece.start.tangent.load > 0.0)) return kGoesBack;
  if (dips) return objection_of_halves(piece, test, depth);
  return "";
}

std::string StepJudge::objection_of_halves(const PathPiece& piece, const StepTest& test, int depth) const {
  if (depth == 0) return kBends;
  const double chord = measure_.length(piece.moved);
  const PathDirection guess = cubic(piece, 0.5);
  const Correction found = corrector_.on_row(
      {piece.start.state, piece.start.load_factor + guess.load, &guess.x},
      measure_.row(scaled(piece.moved, 1.0 / chord), piece.start.load_factor, 0.5 * chord), kMostIterations);
  if (!found.converged) return "no equilibrium half-way: " + found.cause;
  const PathDirection there{found.moved.clone(true), found.load_factor - piece.start.load_factor};
  PathDirection rest = scaled(piece.moved, 1.0);
  rest.x.update(-1.0, there.x, 1.0);
  rest.load -= there.load;
  const Station middle = station(found.state, found.load_factor, test.counts_may_change ? &piece.moved : nullptr);
  if (middle.stability) {
    const std::string count = objection_to_count(piece, test, middle.stability->negative);
    if (!count.empty()) return count;
  }
  const std::string of_first = objection({piece.start, there, middle}, test, depth - 1);
  return of_first.empty() ? objection({middle, rest, piece.end}, test, depth - 1) : of_first;
}

}  // namespace mixbeam
