#include "nonlinear/path/step_judge.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/newton/thresholds.hpp"
#include "nonlinear/path/critical_point_finder.hpp"
#include "nonlinear/path/thresholds.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

/// Parts of a step in which loads are probed.
constexpr int kPartsOfStep = 8;
/// Number of probes half-way (the second one corrected), and in all.
constexpr int kLooksHalfway = 2, kLooks = 4;
/// Points of the midpoint rule for the change of loads.
constexpr int kHistoryParts = 64;

const char* const kBends = "the path bends too much: another one may have been met";

/// Whether counts exist at both ends and inside, and agree.
bool has_counts(const PathPiece& piece, int inside) {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  return a && b && a->negative == b->negative && inside == a->negative;
}

bool counts_differ(const PathPiece& piece) {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  return a && b && a->negative != b->negative;
}

/// Whether a count inside a step does not lie between those of its ends, theory (57). Unsymmetric: counts are parities
/// from the sign of the determinant, which also change where an eigenvalue passes zero.
bool is_outside(const PathPiece& piece, int negative) {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  if (!a || !b || negative < 0) return false;
  const auto [least, most] = std::minmax(a->negative, b->negative);
  return negative < least || most < negative;
}

/// Whether the load factor may turn: only at limit points, each of which changes the count by one.
bool may_turn(const PathPiece& piece, const StepTest& test) {
  const std::optional<StabilityResult>&a = piece.start.stability, &b = piece.end.stability;
  return test.counts_may_change && (!a || !b || counts_differ(piece));
}

/// Whether the load factor hardly changes along the step, so that the signs of its rates may be rounding.
bool load_is_flat(const PathMeasure& measure, const PathPiece& piece) {
  const double rate = std::max(std::abs(piece.start.tangent.load), std::abs(piece.end.tangent.load));
  return rate * measure.motion(piece.moved.x) <= path_limit.flat_load * std::max(1.0, std::abs(piece.end.load_factor));
}

/// Minimum, or NaN if one of them is.
double lower(double a, double b) { return b >= a || std::isnan(a) ? a : b; }

/// Whether the load factor turns at each limit point, and is extreme among its neighbours; otherwise samples beside it
/// belong to two paths.
bool turns_at_limits(const PathPiece& piece, const std::vector<CriticalPoint>& passed) {
  const auto load_at = [&](size_t i) { return i < passed.size() ? passed[i].load_factor : piece.end.load_factor; };
  double before = piece.start.load_factor;
  for (size_t i = 0; i < passed.size(); before = passed[i++].load_factor) {
    const double here = passed[i].load_factor, gain = here - before, rest = load_at(i + 1) - here;
    const double known = passed[i].error + path_limit.flat_load * std::max(1.0, std::abs(here));
    const bool passes = gain * rest > 0.0 && std::min(std::abs(gain), std::abs(rest)) > known;
    if (passes && passed[i].kind == CriticalKind::limit_point) return false;
  }
  return true;
}

/// Whether the axis of an element is inverted: a member is pushed past its other end in one step. Not determined with
/// eigenstrains, and for coupled and tapered sections, for which compliance alone does not suffice.
bool is_inverted(const Model& model, const State& state) {
  if (!model.scene().eigenstrains.empty()) return false;
  double largest = 0.0;
  for_each_element(model.structure(), &state.views, [&](const ElementView& element) {
    if (element.block().general_section) return;
    const int points = axial_points(element.order(), element.block().force_integration);
    for (int q = 0; q < points; ++q)
      largest = std::max(largest, -element.force(q)[0] * element.section().force_compliance[0]);
  });
  return maximum_over_ranks(*model.map()->getComm(), largest) >= 1.0;
}

/// Moves a load factor at the end of a stage into the stage: the tangent there must not be that of the next loads.
double within_stage(double load_factor, double stage_end) {
  return std::min(load_factor, std::nextafter(stage_end, stage_end - 1.0));
}

}  // namespace

const std::vector<JudgeLine>& judge_table() {
  using S = const StepSigns&;
  using T = const StepTest&;
  using Signs = StepSigns;
  using Side = JudgeLine::Side;
  using Then = Consequence;
  const auto always = [](S, T) { return true; };
  const auto turn = [](S s, T) { return s.loads_turn; };
  const auto straight = [](S, T) { return path_limit.straight; };
  const auto sure = [](S, T) { return path_limit.sure_correction; };
  const auto no_motion = [](S, T) { return path_limit.no_motion; };
  const auto smallest = [](S, T t) { return t.smallest_cosine; };
  const char* const turn_back = "the loads turn back within the step";
  const char* const goes_back = "the load factor goes back within the step";
  static const std::vector<JudgeLine> table = {
      // Signs of both ends.
      {[](S s, T) { return s.counts_change; }, Then::refuse,
       "stability changes within the step: the path is followed by its length"},
      // Both ends may be straight and stable although the member buckles in between; a soft spring just continues.
      {[](S s, T) { return s.inverts; }, Then::halve},
      {[](S s, T) { return !s.has_tangents; }, Then::accept},
      {[](S s, T) { return !s.loads_move; }, Then::accept, "", &Signs::motion, Side::at_most, no_motion},
      {always, Then::refuse, turn_back, &Signs::motion, Side::at_most, no_motion},
      {[](S s, T) { return s.loads_turn && std::isnan(s.turn_cosine); }, Then::refuse, kBends},
      {turn, Then::refuse, turn_back, &Signs::turn_cosine, Side::below, straight},
      {turn, Then::accept},
      // Next to a critical point angles are rounding.
      {[](S s, T) { return s.is_straight; }, Then::accept},
      {always, Then::refuse, kBends, &Signs::first, Side::below, smallest},
      {always, Then::refuse, kBends, &Signs::last, Side::below, [](S, T t) { return t.least_cosine_at_end; }},
      {always, Then::halve, "", &Signs::last, Side::below, smallest},
      {[](S s, T t) { return s.looks == 0 && !t.always_looks && !s.starts_still && !s.dips && !s.turns_unseen; },
       Then::accept, "", &Signs::least, Side::at_least, straight},
      {[](S s, T) { return s.looks == 0; }, Then::look},
      // Signs of probes inside. If rates at the ends differ by decades the cubic overshoots in the forces, which alone
      // may falsify count and rate; and beside the path counts may differ.
      {[](S s, T) { return s.looks == 1 && (s.goes_back || s.count_outside); }, Then::look_closer, "",
       &Signs::correction, Side::at_most, sure},
      {always, Then::halve, "", &Signs::correction, Side::above, [](S, T) { return path_limit.largest_correction; }},
      {[](S s, T) { return s.count_outside; }, Then::halve},
      // Stiff beside soft, next to a bifurcation, the rate's sign is rounding: agreeing counts are more reliable.
      {[](S s, T) { return s.turns_unseen && s.is_flat && s.counts_agree; }, Then::accept, "", &Signs::correction,
       Side::at_most, sure},
      {[](S s, T) { return s.turns_unseen; }, Then::refuse, goes_back},
      {[](S s, T) { return s.dips && s.is_last; }, Then::accept},
      {[](S s, T) { return !s.turns && !s.dips && s.goes_back; }, Then::refuse, goes_back},
      {[](S s, T) { return s.dips; }, Then::halve},
      {[](S, T t) { return !t.always_looks; }, Then::accept},
      // If all critical points are sought the cubic must leave no room for a dip, and pairs between which the count
      // changes several times are found by further probes.
      {[](S s, T) { return !s.turns && !s.is_last; }, Then::halve, "", &Signs::rate_error, Side::above,
       [](S s, T) { return s.least_gain; }},
      {[](S s, T) { return s.looks < kLooks; }, Then::look_aside},
      {always, Then::accept},
  };
  return table;
}

const JudgeLine& deciding_line(const StepSigns& signs, const StepTest& test) {
  return *std::find_if(judge_table().begin(), judge_table().end(), [&](const JudgeLine& line) {
    if (!line.applies(signs, test)) return false;
    if (line.sign == nullptr) return true;
    const double value = signs.*line.sign, threshold = line.threshold(signs, test);
    return line.side == JudgeLine::Side::below      ? !(value >= threshold)
           : line.side == JudgeLine::Side::above    ? !(value <= threshold)
           : line.side == JudgeLine::Side::at_least ? value >= threshold
                                                    : value <= threshold;
  });
}

/// A step of one part, in the measure of motion; rates: of the load factor along the chord.
struct StepJudge::Part {
  Part(const PathPiece& piece, double chord_chord, double chord_start, double chord_end, double start_start,
       double end_end)
      : chord(std::sqrt(chord_chord)),
        first(start_start > 0.0 ? chord_start / (chord * std::sqrt(start_start)) : 0.0),
        last(end_end > 0.0 ? chord_end / (chord * std::sqrt(end_end)) : 0.0),
        first_rate(piece.start.tangent.load * chord / chord_start),
        last_rate(piece.end.tangent.load * chord / chord_end),
        mean_rate(piece.moved.load / chord),
        starts_still(std::sqrt(start_start) < path_limit.no_motion * std::abs(piece.start.tangent.load)),
        ends_stiff(last < path_limit.least_cosine &&
                   std::sqrt(end_end) * std::abs(piece.moved.load) <
                       path_limit.stiffened * chord * std::abs(piece.end.tangent.load)) {}

  double chord;                             ///< its length
  double first, last;                       ///< cosines of the angles with the tangents at both ends
  double first_rate, last_rate, mean_rate;  ///< of the load factor
  bool starts_still;                        ///< the initial rate is zero: the start has no direction
  bool ends_stiff;                          ///< the part has stiffened towards the end

  double least_rate() const;
  bool load_dips(const StepTest& test) const;
};

/// Probe of a guess inside a step, theory (58), with Newton's correction perpendicular to the chord.
struct StepJudge::Look {
  PathDirection corrected;  ///< the guess, corrected if requested, as increments from the start of the step
  double correction = 0.0;  ///< over the chord, for the part where it is largest
  double load_error = 0.0;  ///< of the cubic
  bool goes_back = false;   ///< the load factor, against its rate at the start
  int negative = -1;        ///< -1: not counted
};

/// Least rate of the load factor, in the direction of the first one, on the cubic of theory (59).
double StepJudge::Part::least_rate() const {
  const double sign = first_rate > 0.0 ? 1.0 : -1.0;
  const double begin = sign * first_rate, end = sign * last_rate, mean = sign * mean_rate;
  // The rate at share s is begin + linear s + square s^2.
  const double linear = 6.0 * mean - 4.0 * begin - 2.0 * end, square = 3.0 * (begin + end - 2.0 * mean);
  const bool is_inside = square > 0.0 && linear < 0.0 && -linear < 2.0 * square;
  return is_inside ? begin - linear * linear / (4.0 * square) : std::min(begin, end);
}

/// Whether the load factor may decrease between the ends: it nearly does on the cubic. If the load grows much faster at
/// the end than a cubic could (an arch stiffened far beyond snap-through), the mean rate is used instead.
bool StepJudge::Part::load_dips(const StepTest& test) const {
  if ((first_rate > 0.0) != (last_rate > 0.0)) return false;
  const double mean = first_rate > 0.0 ? mean_rate : -mean_rate;
  const bool outgrows_cubic = test.may_stiffen && std::abs(last_rate) > path_limit.fastest_growth * mean;
  return (outgrows_cubic ? mean : least_rate()) <
         path_limit.least_gain * std::min(std::abs(first_rate), std::abs(last_rate));
}

/// Parts that move.
std::vector<StepJudge::Part> StepJudge::parts_of(const PathPiece& piece) const {
  const MixedVector &chord = piece.moved.x, &start = piece.start.tangent.x, &end = piece.end.tangent.x;
  const std::vector<double> cc = measure_.motion_of_parts(chord, chord), cs = measure_.motion_of_parts(chord, start),
                            ce = measure_.motion_of_parts(chord, end), ss = measure_.motion_of_parts(start, start),
                            ee = measure_.motion_of_parts(end, end);
  const double largest = *std::max_element(cc.begin(), cc.end());
  const double still = std::max(path_limit.no_motion, path_limit.least_share * std::sqrt(largest));
  std::vector<Part> parts;
  for (size_t p = 0; p < cc.size(); ++p)
    if (std::sqrt(cc[p]) >= still) parts.emplace_back(piece, cc[p], cs[p], ce[p], ss[p], ee[p]);
  return parts;
}

/// Least cosine of the tangents for the change of the loads from end to end, if loads turn back: a nearly linear
/// structure follows that change, so that these tangents point along the chord.
double StepJudge::cosine_where_loads_turn(const PathPiece& piece) const {
  const double from = piece.start.load_factor, to = piece.end.load_factor;
  Station start = piece.start, end = piece.end;
  start.tangent = secant_tangent(piece.start, from, to);
  end.tangent = secant_tangent(piece.end, from, to);
  if (!start.has_tangent() || !end.has_tangent()) return std::nan("");
  double cosine = HUGE_VAL;
  for (const Part& part : parts_of({start, piece.moved, end})) cosine = lower(cosine, std::min(part.first, part.last));
  return cosine;
}

/// Whether the loads move nothing within a step whose ends coincide.
bool StepJudge::loads_move_nothing(const PathPiece& piece) const {
  const double from = piece.start.load_factor, size = piece.end.load_factor - from;
  for (int part = 0; part < kPartsOfStep; ++part) {
    const PathDirection rate =
        secant_tangent(piece.start, from + size * part / kPartsOfStep, from + size * (part + 1) / kPartsOfStep);
    if (!(measure_.motion(rate.x) < path_limit.no_motion * std::abs(rate.load))) return false;
  }
  return true;
}

PathDirection StepJudge::cubic(const PathPiece& piece, double at) const {
  const double length = measure_.length(piece.moved);
  const double s = at, whole = s * s * (3.0 - 2.0 * s), first = s * (1.0 - s) * (1.0 - s) * length,
               last = s * s * (s - 1.0) * length;
  PathDirection result = scaled(piece.moved, whole);
  if (!piece.start.has_tangent() || !piece.end.has_tangent()) return scaled(piece.moved, at);
  if (this->whole(piece)
          .ends_stiff) {  // the tangent at the end does not represent the step: use a parabola along the first one
    PathDirection parabola = scaled(piece.moved, s * s);
    parabola.x.update(s * (1.0 - s) * length, piece.start.tangent.x, 1.0);
    parabola.load += s * (1.0 - s) * length * piece.start.tangent.load;
    return parabola;
  }
  result.x.update(first, piece.start.tangent.x, last, piece.end.tangent.x, 1.0);
  result.load += first * piece.start.tangent.load + last * piece.end.tangent.load;
  return result;
}

bool StepJudge::is_straight(const PathPiece& piece) const {
  const double most =
      std::min(path_limit.magnified_rounding, path_limit.largest_correction * measure_.length(piece.moved));
  const auto leads = [&](const PathDirection& tangent) {
    return measure_.motion_beside(piece.moved.x, piece.moved.load / tangent.load, tangent.x) <= most;
  };
  return leads(piece.start.tangent) || leads(piece.end.tangent);
}

StepJudge::Part StepJudge::whole(const PathPiece& piece) const {
  const MixedVector &chord = piece.moved.x, &start = piece.start.tangent.x, &end = piece.end.tangent.x;
  return Part(piece, measure_.motion(chord, chord), measure_.motion(chord, start), measure_.motion(chord, end),
              measure_.motion(start, start), measure_.motion(end, end));
}

StepJudge::Look StepJudge::look(const PathPiece& piece, PathDirection guess, bool corrects) const {
  const double load_factor = piece.start.load_factor + guess.load;
  const Linear at = linear_at(piece.start.state, guess, load_factor, !corrects);
  const MixedVector &chord = piece.moved.x, &newton = at.newton, &rate = at.less_rate;
  const std::vector<double> cc = measure_.motion_of_parts(chord, chord), cr = measure_.motion_of_parts(chord, rate),
                            cn = measure_.motion_of_parts(chord, newton), nn = measure_.motion_of_parts(newton, newton),
                            nr = measure_.motion_of_parts(newton, rate), rr = measure_.motion_of_parts(rate, rate);
  const double still = std::max(path_limit.no_motion, path_limit.least_share * measure_.motion(chord));
  Look seen{std::move(guess)};
  for (size_t p = 0; p < cc.size(); ++p) {
    if (std::sqrt(cc[p]) < still) continue;
    const double change = cn[p] / cr[p];  // of the load factor, for a correction perpendicular to the chord
    const double square = std::max(0.0, nn[p] - change * (2.0 * nr[p] - change * rr[p])) / cc[p];
    seen.correction = square >= 0.0 ? std::max(seen.correction, std::sqrt(square)) : HUGE_VAL;
    seen.goes_back = seen.goes_back || (cr[p] < 0.0) != (piece.start.tangent.load > 0.0);
  }
  const double change = measure_.motion(chord, newton) / measure_.motion(chord, rate);
  seen.load_error = std::abs(change);
  ++problem_->work.looks;
  if (!std::isfinite(seen.correction)) return seen;
  if (corrects) {
    seen.corrected.x.update(1.0, newton, -change, rate, 1.0);
    seen.corrected.load += change;
    return seen;
  }
  std::optional<StabilityResult> there = at.stability;
  if (!there) there = count({at.state, load_factor + change}, How::inertia);
  if (there) seen.negative = there->negative;
  return seen;
}

StepSigns StepJudge::signs_of_ends(const PathPiece& piece, const StepTest& test, int depth) const {
  StepSigns signs;
  signs.counts_change = depth == path_limit.most_halvings && !test.counts_may_change && counts_differ(piece);
  signs.has_tangents = piece.start.has_tangent() && piece.end.has_tangent();
  if (signs.counts_change || !signs.has_tangents) return signs;
  signs.motion = measure_.motion(piece.moved.x);
  if (signs.motion <= path_limit.no_motion) {
    // Loads of several formulas that cancel at both ends need not do so in between.
    signs.loads_move = loads().have_several() && !loads_move_nothing(piece);
    return signs;
  }
  signs.loads_turn = !loads().is_straight(piece.start.load_factor, piece.end.load_factor);
  if (signs.loads_turn) {
    signs.turn_cosine = cosine_where_loads_turn(piece);
    return signs;
  }
  signs.inverts = depth == path_limit.most_halvings && is_inverted(problem_->model, piece.end.state);
  for (const Part& part : parts_of(piece)) {
    if (!part.starts_still) signs.first = lower(signs.first, part.first);
    if (!test.may_stiffen || !part.ends_stiff) signs.last = lower(signs.last, part.last);
    signs.least = std::min({signs.least, part.first, part.last});
    signs.starts_still = signs.starts_still || part.starts_still;
    signs.dips = signs.dips || part.load_dips(test);
  }
  if (!(signs.least >= path_limit.straight)) signs.is_straight = is_straight(piece);
  signs.turns = (piece.start.tangent.load > 0.0) != (piece.end.tangent.load > 0.0);
  signs.turns_unseen = signs.turns && !may_turn(piece, test);
  return signs;
}

std::string StepJudge::objection(const PathPiece& piece, const StepTest& test, int depth) {
  StepSigns signs = signs_of_ends(piece, test, depth);
  for (std::optional<Look> seen;;) {
    const JudgeLine& line = deciding_line(signs, test);
    if (line.consequence == Consequence::accept) return "";
    if (line.consequence == Consequence::refuse) return line.objection;
    if (line.consequence == Consequence::halve) return objection_of_halves(piece, test, depth);
    const bool is_aside = line.consequence == Consequence::look_aside, is_first = signs.looks == 0;
    signs.looks = is_aside ? std::max(signs.looks, kLooksHalfway) + 1 : signs.looks + 1;
    const double at = !is_aside ? 0.5 : (signs.looks < kLooks ? 0.25 : 0.75);
    PathDirection guess = cubic(piece, at);
    if (line.consequence == Consequence::look_closer) guess = look(piece, std::move(guess), true).corrected;
    seen = look(piece, std::move(guess));
    signs.correction = seen->correction;
    signs.count_outside = is_outside(piece, seen->negative);
    if (is_aside) continue;
    signs.goes_back = seen->goes_back;
    signs.counts_agree = has_counts(piece, seen->negative);
    signs.is_flat = load_is_flat(measure_, piece);
    signs.is_last = depth == 0 && signs.counts_agree && (!test.always_looks || signs.is_flat);
    if (is_first) signs.rate_error = path_limit.error_of_rate * seen->load_error;
    signs.least_gain = whole(piece).least_rate() * signs.motion;
  }
}

std::string StepJudge::objection_of_halves(const PathPiece& piece, const StepTest& test, int depth) {
  if (depth == 0) return kBends;
  const double chord = measure_.length(piece.moved);
  const PathDirection guess = cubic(piece, 0.5);
  const Correction found =
      corrector_.on_row({piece.start.state, piece.start.load_factor + guess.load, &guess.x},
                        measure_.row(scaled(piece.moved, 1.0 / chord), piece.start.load_factor, 0.5 * chord),
                        path_limit.most_iterations_nearby);
  if (!found.converged) return "no equilibrium half-way: " + found.cause;
  const PathDirection there{found.moved.clone(true), found.load_factor - piece.start.load_factor};
  PathDirection rest = scaled(piece.moved, 1.0);
  rest.x.update(-1.0, there.x, 1.0);
  rest.load -= there.load;
  const Station middle = station(found.state, found.load_factor, test.counts_may_change ? &piece.moved : nullptr);
  if (middle.stability && is_outside(piece, middle.stability->negative))
    return "stability changes several times within the step";
  const std::string of_first = objection({piece.start, there, middle}, test, depth - 1);
  return of_first.empty() ? objection({middle, rest, piece.end}, test, depth - 1) : of_first;
}

StepFindings StepJudge::examine(const PathPiece& piece, const StepTest& test) {
  StepFindings findings;
  findings.objection = objection(piece, test, path_limit.most_halvings);
  if (findings.objection.empty() && counts_differ(piece)) {
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

std::optional<StabilityResult> StepJudge::count(const Asked& at, How how) const {
  if (problem_->leave_if_asked) problem_->leave_if_asked();
  if (stability_ == nullptr) return std::nullopt;
  const std::optional<StabilityResult> result = stability_->try_ask(at, how);
  // Elements that rotate by nearly pi against their vertices have no stiffness to count with.
  return result && result->end_angle <= path_limit.largest_end_angle ? result : std::nullopt;
}

/// Tangent by theory (54) for the given derivative of the residual by the load factor, which grows along it.
PathDirection StepJudge::tangent_of(BeamGroup& group, const MixedVector& slope) const {
  group.linearization(&slope);
  BeamVector by_load(problem_->model.create_vector());
  Teuchos::ParameterList none;
  group.applyJacobianInverse(none, BeamVector(slope), by_load);
  by_load.scale(-1.0);
  const PathDirection rate{by_load.values().clone(true), 1.0};
  return scaled(rate, 1.0 / measure_.length(rate));
}

Station StepJudge::station(const State& state, double load_factor, const PathDirection* along, bool counts) const {
  Station here{state, load_factor, {problem_->model.create_vector(), 0.0}};
  ResidualScales scales;
  {
    TangentChoice choice;
    choice.counts_interior = counts;
    choice.enough = newton_limit.enough_for_tangents;
    choice.may_iterate = true;
    BeamGroup group(problem_, state, load_factor, choice);
    group.computeF();
    scales = group.scales();
    MixedVector slope = problem_->model.create_vector();
    load_derivative(problem_->model, state, within_stage(load_factor, stage_end_), scales, slope);
    if (counts) here.stability = count({state, load_factor, &group.linearization(&slope)}, How::factors);
    here.tangent = tangent_of(group, slope);
  }
  if (along != nullptr && measure_.inner(*along, here.tangent) < 0.0) here.tangent = scaled(here.tangent, -1.0);
  if (counts && !here.stability) here.stability = count({state, load_factor}, How::inertia);
  here.cap_ratio = here.stability ? here.stability->cap_ratio
                                  : cap_for(problem_->model, scales, stability_limit.cap_of_count).least_ratio;
  return here;
}

/// Tangent for the mean of the derivatives between two load factors.
PathDirection StepJudge::secant_tangent(const Station& at, double from, double to) const {
  BeamGroup group(problem_, at.state, at.load_factor);
  group.computeF();
  MixedVector mean = problem_->model.create_vector(), slope = mean.clone(false);
  mean.fill(0.0);
  for (int part = 0; part < kHistoryParts; ++part) {
    load_derivative(problem_->model, at.state, from + (to - from) * (part + 0.5) / kHistoryParts, group.scales(),
                    slope);
    mean.update(1.0 / kHistoryParts, slope, 1.0);
  }
  return tangent_of(group, mean);
}

/// Linearises at a state moved by a guess, possibly next to a critical point.
StepJudge::Linear StepJudge::linear_at(const State& start, const PathDirection& guess, double load_factor,
                                       bool vertices_alone) const {
  const Model& model = problem_->model;
  const bool in_plane = start.in_plane && model.is_in_plane(guess.x);
  TangentChoice choice = near_critical(!in_plane);
  choice.counts_interior = stability_ != nullptr;
  choice.vertices_alone = vertices_alone;
  BeamGroup group(problem_, start, load_factor, choice);
  group.setX(BeamVector(guess.x));
  Teuchos::ParameterList none;
  group.computeNewton(none);
  BeamVector slope(model.create_vector()), by_load(model.create_vector());
  load_derivative(model, group.state(), within_stage(load_factor, stage_end_), group.scales(), slope.values());
  group.applyJacobianInverse(none, slope, by_load);
  std::optional<StabilityResult> stability;
  if (stability_ != nullptr) stability = count({group.state(), load_factor, &group.linearization()}, How::factors);
  return {group.state(), BeamVector::of(group.getNewton()).clone(true), std::move(by_load.values()), stability};
}

}  // namespace mixbeam
