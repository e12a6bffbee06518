/// Test whether two equilibria lie on one path, one step apart.
///
/// Newton's method from a distant start may converge to an equilibrium of another path, although the counts of negative
/// eigenvalues at both ends agree. Independent signs are checked, all in the measure of motion, theory (57) to
/// theory (59): the tangents at both ends point along the chord; the counts agree; if the path bends, a probe inside:
/// the cubic through both ends with their tangents is nearly an equilibrium half-way, with the same count and the same
/// direction of the load factor. If the cubic is too far from the path, the equilibrium half-way is computed, and each
/// half is judged separately. Disconnected parts of a structure are judged one by one, since a single one among many
/// may have jumped. If the step is acceptable, its critical points are sought.
///
/// judge_table() holds the signs, their thresholds and consequences, line by line.
#pragma once

#include "discretization/scene/amplitude.hpp"
#include "nonlinear/path/corrector.hpp"
#include "nonlinear/path/path_measure.hpp"
#include "nonlinear/stability/stability.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// A step; `moved`: increments from the first station to the second.
struct PathPiece {
  const Station& start;
  const PathDirection& moved;
  const Station& end;
};

struct StepTest {
  double smallest_cosine = 0.5;  ///< of the angles between the chord and the tangents at its ends
  /// Least cosine at the end with which a step is still judged by its halves: stiffening structures bend far in a step.
  double least_cosine_at_end = 0.5;
  bool counts_may_change = false;  ///< critical points inside are sought
  bool always_looks = false;
  /// Ignore the direction at the end if the structure has stiffened. Steps along the path can be shortened instead.
  bool may_stiffen = false;
};

/// Tests for steps of the load factor or of a controlled displacement, without a limit of length; in steps by LOCA,
/// which has no alternative method, critical points inside are sought.
inline constexpr StepTest kLoadStep{0.5, -0.5, false, false, true}, kExaminedStep{0.5, -0.5, true, false, true};
/// Tests for steps along the path, and along a traced path.
inline constexpr StepTest kPathStep{0.85, 0.85, true, false}, kTracedStep{0.95, 0.95, true, true};

/// Signs of a step. Cosines belong to angles with the chord, the least among the parts that move.
struct StepSigns {
  bool counts_change = false;    ///< from end to end, although they must not
  bool inverts = false;          ///< the axis of an element is shortened by more than its length at the end
  bool has_tangents = true;      ///< at both ends
  double motion = 1.0;           ///< of the step
  bool is_straight = false;      ///< StepJudge::is_straight()
  bool loads_move = false;       ///< loads move the structure within a step whose ends coincide
  bool loads_turn = false;       ///< loads turn back within the step
  double turn_cosine = 1.0;      ///< then: of the tangents for the whole change of the loads; NaN: there are none
  double first = HUGE_VAL;       ///< cosine of the tangent at the start, for parts with a nonzero initial rate
  double last = HUGE_VAL;        ///< cosine of the tangent at the end, for parts that have not stiffened
  double least = HUGE_VAL;       ///< least cosine at both ends, for all parts
  bool starts_still = false;     ///< the initial rate of a part is zero
  bool dips = false;             ///< the load factor nearly reverses on the cubic
  bool turns = false;            ///< the load factor runs in opposite directions at both ends
  bool turns_unseen = false;     ///< and no limit point can explain it
  int looks = 0;                 ///< probes: 1 half-way, 2 the same corrected, 3 and 4 at a quarter and three quarters
  double correction = 0.0;       ///< Newton's correction at the probe, over the chord
  bool count_outside = false;    ///< the count at the probe does not lie between those at the ends
  bool goes_back = false;        ///< half-way the load factor runs against its initial direction
  bool counts_agree = false;     ///< half-way and at both ends
  bool is_flat = false;          ///< the load factor hardly changes: the signs of its rates may be rounding
  bool is_last = false;          ///< no further halving, and counts indicate no other path
  double rate_error = 0.0;       ///< bound of the error of the load factor's rate along the step ...
  double least_gain = HUGE_VAL;  ///< ... and its least rate on the cubic
};

enum class Consequence { accept, refuse, halve, look, look_closer, look_aside };

/// One line of the table: the consequence holds if the line `applies` and the sign lies on that side of its threshold
/// (NaN lies below and above).
struct JudgeLine {
  enum class Side { below, above, at_least, at_most };
  bool (*applies)(const StepSigns&, const StepTest&);
  Consequence consequence;
  const char* objection = "";         ///< reason of a refusal
  double StepSigns::*sign = nullptr;  ///< null: no threshold
  Side side = Side::below;
  double (*threshold)(const StepSigns&, const StepTest&) = nullptr;
};

/// Table of lines, of which the first that decides holds; the last one always does.
const std::vector<JudgeLine>& judge_table();
const JudgeLine& deciding_line(const StepSigns& signs, const StepTest& test);

struct StepFindings {
  std::string objection{};              ///< empty: the step is accepted
  std::vector<CriticalPoint> passed{};  ///< in the order of the path
};

class StepJudge {
 public:
  /// `stability`: must outlive this object; null: counts are not compared. `stage_end`: load factor.
  StepJudge(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, Stability* stability,
            double stage_end)
      : problem_(problem),
        stability_(stability),
        stage_end_(stage_end),
        corrector_(problem, parameters, checks_, NewtonPurpose::check),
        measure_(problem->model) {}
  StepJudge(const StepJudge&) = delete;
  StepJudge& operator=(const StepJudge&) = delete;

  const Teuchos::RCP<BeamProblem>& problem() const { return problem_; }
  const PathMeasure& measure() const { return measure_; }
  const LoadClock& loads() const { return problem_->model.clock(); }
  /// Corrector for evaluations inside steps, which are counted separately and are no failed attempts of the path.
  Corrector& corrector() { return corrector_; }
  Stability* stability() const { return stability_; }

  /// Judges a step and finds its critical points. Collective.
  StepFindings examine(const PathPiece& piece, const StepTest& test);

  /// Makes the station at a converged state. The tangent runs in the direction of `along`, or of a growing load factor
  /// if that is null. Collective.
  Station station(const State& state, double load_factor, const PathDirection* along, bool counts = true) const;

  /// Point of the cubic of theory (56) at share `at` of the step, as increments from its start.
  PathDirection cubic(const PathPiece& piece, double at) const;
  /// Whether the tangent at one end leads to the other one, up to magnified rounding.
  bool is_straight(const PathPiece& piece) const;

 private:
  struct Look;
  struct Part;
  /// Reason against the step; empty if the end lies on the path of the start.
  std::string objection(const PathPiece& piece, const StepTest& test, int depth);
  StepSigns signs_of_ends(const PathPiece& piece, const StepTest& test, int depth) const;
  double cosine_where_loads_turn(const PathPiece& piece) const;
  bool loads_move_nothing(const PathPiece& piece) const;
  /// Results of the tangent at a state: Newton's increment, -du/dlambda, and a count.
  struct Linear {
    State state;
    MixedVector newton, less_rate;
    std::optional<StabilityResult> stability;  ///< none: the factors do not suffice
  };
  Linear linear_at(const State& start, const PathDirection& guess, double load_factor, bool vertices_alone) const;
  PathDirection tangent_of(BeamGroup& group, const MixedVector& slope) const;
  PathDirection secant_tangent(const Station& at, double from, double to) const;
  std::string objection_of_halves(const PathPiece& piece, const StepTest& test, int depth);
  /// Counts; none if that is not possible, as for a singular unsymmetric tangent.
  std::optional<StabilityResult> count(const Asked& at, How how) const;
  std::vector<Part> parts_of(const PathPiece& piece) const;
  Look look(const PathPiece& piece, PathDirection guess, bool corrects = false) const;
  Part whole(const PathPiece& piece) const;

  Teuchos::RCP<BeamProblem> problem_;
  Stability* stability_;
  double stage_end_;
  SolveRecord checks_;
  Corrector corrector_;
  PathMeasure measure_;
};

}  // namespace mixbeam
