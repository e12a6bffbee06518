/// Whether two equilibria lie on one path, one step apart.
///
/// Newton's method from a far start may converge to an equilibrium of another path, and the counts of negative
/// eigenvalues at both ends may agree all the same. Independent signs are asked, all in motion, theory (57) to
/// theory (59): the tangents at both ends point along the chord; the counts agree; where the path bends, a look inside:
/// the cubic through both ends with their tangents is nearly an equilibrium half-way, with the same count and the same
/// direction of the load factor. Where the cubic is too far from the path, the equilibrium half-way is computed, and
/// each half judged by itself. Parts of a structure that touch no other one are judged one by one: a single one among
/// many may have jumped. Within a step that may be taken its critical points are looked for.
///
/// judge_table() holds the signs, their thresholds and what follows from them, line by line.
#pragma once

#include "discretization/scene/amplitude.hpp"
#include "nonlinear/path/corrector.hpp"
#include "nonlinear/path/path_measure.hpp"
#include "nonlinear/stability/stability.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// A step: `moved` leads from the first station to the second.
struct PathPiece {
  const Station& start;
  const PathDirection& moved;
  const Station& end;
};

struct StepTest {
  double smallest_cosine = 0.5;  ///< of the angles between the chord and the tangents at its ends
  /// A step whose end misses that, but not this, is judged by its halves: long steps of stiffening structures bend far.
  double least_cosine_at_end = 0.5;
  bool counts_may_change = false;  ///< critical points inside are looked for
  bool always_looks = false;
  /// The direction at the end is of no importance where the structure has stiffened: steps along the path can be
  /// shorter.
  bool may_stiffen = false;
};

/// No limit on the length of steps of the load factor or of a controlled displacement; by LOCA, where no other
/// method follows, critical points inside are looked for.
inline constexpr StepTest kLoadStep{0.5, -0.5, false, false, true}, kExaminedStep{0.5, -0.5, true, false, true};
/// Steps along the path, and where it is traced.
inline constexpr StepTest kPathStep{0.85, 0.85, true, false}, kTracedStep{0.95, 0.95, true, true};

/// What a step shows. Cosines are those of angles with the chord, the least among the parts that move.
struct StepSigns {
  bool counts_change = false;    ///< from end to end, where they must not
  bool inverts = false;          ///< the axis of an element is shortened by more than its length at the end
  bool has_tangents = true;      ///< at both ends
  double motion = 1.0;           ///< of the step
  bool is_straight = false;      ///< StepJudge::is_straight()
  bool loads_move = false;       ///< the structure within a step whose ends lie together
  bool loads_turn = false;       ///< within the step
  double turn_cosine = 1.0;      ///< then: of the tangents for the whole change of the loads; NaN: there are none
  double first = HUGE_VAL;       ///< of the tangent at the start, of parts that loads set out with a rate
  double last = HUGE_VAL;        ///< of that at the end, of parts that have not stiffened
  double least = HUGE_VAL;       ///< of both, of all parts
  bool starts_still = false;     ///< loads set out with no rate
  bool dips = false;             ///< the load factor nearly goes back on the cubic
  bool turns = false;            ///< the load factor runs in opposite directions at both ends
  bool turns_unseen = false;     ///< and no limit point can explain it
  int looks = 0;                 ///< inside: 1 half-way, 2 the same corrected, 3 and 4 at a quarter and three quarters
  double correction = 0.0;       ///< Newton's, there, over the chord
  bool count_outside = false;    ///< the count there does not lie between those at the ends
  bool goes_back = false;        ///< the load factor half-way
  bool counts_agree = false;     ///< half-way and at both ends
  bool is_flat = false;          ///< the load factor hardly changes: the signs of its rates may be those of rounding
  bool is_last = false;          ///< no further halving, and counts say that nothing was met
  double rate_error = 0.0;       ///< of the load factor along the step, at most ...
  double least_gain = HUGE_VAL;  ///< ... and its least rate on the cubic
};

enum class Consequence { accept, refuse, halve, look, look_closer, look_aside };

/// One line: where it `applies` and the sign lies on that side of its threshold (NaN lies below and above), the
/// consequence follows.
struct JudgeLine {
  enum class Side { below, above, at_least, at_most };
  bool (*applies)(const StepSigns&, const StepTest&);
  Consequence consequence;
  const char* objection = "";         ///< of a refusal
  double StepSigns::*sign = nullptr;  ///< none: it applies, and that is all
  Side side = Side::below;
  double (*threshold)(const StepSigns&, const StepTest&) = nullptr;
};

/// The first line that decides is followed; the last one always does.
const std::vector<JudgeLine>& judge_table();
const JudgeLine& deciding_line(const StepSigns& signs, const StepTest& test);

struct StepFindings {
  std::string objection{};              ///< empty: the step may be taken
  std::vector<CriticalPoint> passed{};  ///< in the order of the path
};

class StepJudge {
 public:
  /// `stability` may be null: then counts are not compared. It must outlive this object. `stage_end`: load factor.
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
  /// Of evaluations inside steps: counted separately, and no failed attempts of the path.
  Corrector& corrector() { return corrector_; }
  Stability* stability() const { return stability_; }

  /// Collective.
  StepFindings examine(const PathPiece& piece, const StepTest& test);

  /// The station at a converged state. The tangent runs in the direction of `along`, or of a growing load factor where
  /// that is null. Collective.
  Station station(const State& state, double load_factor, const PathDirection* along, bool counts = true) const;

  /// Point of the cubic of theory (56) at share `at` of the way, as increments from its start.
  PathDirection cubic(const PathPiece& piece, double at) const;
  /// Whether the tangent of one end leads to the other one, but for magnified rounding.
  bool is_straight(const PathPiece& piece) const;

 private:
  struct Look;
  struct Part;
  /// Empty when the end lies on the path of the start; else what disagrees.
  std::string objection(const PathPiece& piece, const StepTest& test, int depth);
  StepSigns signs_of_ends(const PathPiece& piece, const StepTest& test, int depth) const;
  double cosine_where_loads_turn(const PathPiece& piece) const;
  bool loads_move_nothing(const PathPiece& piece) const;
  /// What the tangent at a state yields: Newton's increment, that for the load less du/dlambda, and a count.
  struct Linear {
    State state;
    MixedVector newton, less_rate;
    std::optional<StabilityResult> stability;  ///< none: its factors do not tell
  };
  Linear linear_at(const State& start, const PathDirection& guess, double load_factor, bool vertices_alone) const;
  PathDirection tangent_of(BeamGroup& group, const MixedVector& slope) const;
  PathDirection secant_tangent(const Station& at, double from, double to) const;
  std::string objection_of_halves(const PathPiece& piece, const StepTest& test, int depth);
  /// None where nothing tells. A singular tangent without symmetry has no count.
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
