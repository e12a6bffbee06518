/// Descent from any state along the total potential to a stable equilibrium, which models a jump, theory (67).
///
/// Takes steps of a gradient flow, each to the minimum of the potential with springs from all vertices to their
/// previous positions: the potential falls from step to step, and Newton's method has a tangent without negative
/// eigenvalues, with all rows of the mixed system solved together as on any path. Springs stiffen until no pivot is
/// negative and the potential has fallen, and soften from step to step; the equilibrium is finally found without them.
/// If the tangent itself has a negative eigenvalue the structure is pushed along its mode first.
#pragma once

#include "nonlinear/path/corrector.hpp"
#include "nonlinear/path/load_path.hpp"
#include "nonlinear/stability/stability.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace mixbeam {

/// Limit of factorisations of one descent.
inline constexpr int kMostFactorizationsOfDescent = 500;

/// Final state, or the cause of failure.
struct DescentResult {
  std::optional<Correction> found{};
  std::string cause{};
  int factorizations = 0;
};

class Descent {
 public:
  using Observer = std::function<void(const DescentProgress&)>;

  /// All arguments must outlive this object.
  Descent(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, Corrector& corrector,
          Stability& stability, const PathMeasure& measure, const Observer& observer);
  ~Descent();
  Descent(const Descent&) = delete;
  Descent& operator=(const Descent&) = delete;

  /// Finds a stable equilibrium at a load factor. Collective.
  DescentResult from(const State& start, double load_factor);

 private:
  class ShiftedTangent;
  enum class Outcome { arrived, indefinite, failed };
  struct Relaxed {
    Outcome outcome = Outcome::failed;
    State state{};
    double potential = 0.0;
    int iterations = 0;
  };

  long factorize(const EvaluationPoint& point, double shift);
  State moved_by_supports(const State& start);
  Relaxed relax(const State& centre, double shift);
  std::optional<MixedVector> falling_motion(const State& state, double shift);
  State pushed(const State& state, const MixedVector& motion, double amplitude) const;
  MixedVector spring_forces(const State& state, const MixedVector& moved, double shift) const;
  std::optional<Correction> equilibrium(const State& near);
  double potential(const State& state) const;
  Verdict verdict_on(const State& state);
  double precision(const State& state) const;

  Teuchos::RCP<BeamProblem> problem_;
  const SolverParameters& parameters_;
  Corrector& corrector_;
  Stability& stability_;
  const PathMeasure& measure_;
  Observer observer_;
  std::unique_ptr<ShiftedTangent> tangent_;
  double load_factor_ = 0.0;
  int factorizations_ = 0;
};

}  // namespace mixbeam
