/// Whether two equilibria lie on one path, one step apart.
///
/// Newton's method from a far start may converge to an equilibrium of another path, and the counts of negative
/// eigenvalues at both ends may agree all the same. Independent signs are asked, all in motion, theory (57) to
/// theory (59): the tangents at both ends point along the chord; the counts agree; where the path bends, a look inside:
/// the cubic through both ends with their tangents is nearly an equilibrium half-way, with the same count and the same
/// direction of the load factor. Where the cubic is too far from the path, the equilibrium half-way is computed, and
/// each half judged by itself. Parts of a structure that touch no other one are judged one by one: a single one among
/// many may have jumped. Within a step that may be taken its critical points are looked for.
#pragma once

#include "discretization/scene/amplitude.hpp"
#include "nonlinear/path/corrector.hpp"
#include "nonlinear/path/path_measure.hpp"
#include "nonlinear/stability/critical_point.hpp"

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

 private:
  struct Look;
  struct Part;
  /// Empty when the end lies on the path of the start; else what disagrees.
  std::string objection(const PathPiece& piece, const StepTest& test);
  std::string objection(const PathPiece& piece, const StepTest& test, int depth);
  std::string objection_where_loads_turn(const PathPiece& piece) const;
  bool loads_move_nothing(const PathPiece& piece) const;
  /// What the tangent at a state yields: Newton's increment, and that for the load less du/dlambda.
  struct Linear {
    State state;
    MixedVector newton, less_rate;
  };
  Linear linear_at(const State& start, const PathDirection& guess, double load_factor) const;
  PathDirection tangent_of(BeamGroup& group, const MixedVector& slope) const;
  PathDirection secant_tangent(const Station& at, double from, double to) const;
  std::string objection_of_halves(const PathPiece& piece, const StepTest& test, int depth);
  std::string objection_to_count(const PathPiece& piece, int negative) const;
  std::optional<StabilityResult> count(const State& state, double load_factor) const;
  std::optional<StabilityResult> count_by(Linearization& at) const;
  std::vector<Part> parts_of(const PathPiece& piece) const;
  Look look(const PathPiece& piece, PathDirection guess) const;
  Part whole(const PathPiece& piece) const;
  bool ends_stiff(const PathPiece& piece) const;

  Teuchos::RCP<BeamProblem> problem_;
  Stability* stability_;
  double stage_end_;
  SolveRecord checks_;
  Corrector corrector_;
  PathMeasure measure_;
};

}  // namespace mixbeam
