/// Newton's method at one point of a path: at a given load factor, or with an unknown load factor and a control row.
#pragma once

#include "nonlinear/newton/newton_setup.hpp"
#include "nonlinear/path/path_measure.hpp"

#include <string>

namespace mixbeam {

/// Result of Newton's method, or the cause of its failure.
struct Correction {
  bool converged = false;
  State state;               ///< of the last iterate
  double load_factor = 0.0;  ///< of the last iterate
  MixedVector moved;         ///< sum of all increments since the start
  int iterations = 0;
  double residual = 0.0;  ///< scaled maximum norm
  std::string cause{};    ///< of a failure, in a few words
};

/// Start of the iteration: `state` moved by `moved`.
struct Guess {
  const State& state;
  double load_factor;
  const MixedVector* moved = nullptr;  ///< null: no motion
};

class Corrector {
 public:
  /// `record` must outlive this object. NewtonPurpose::check: work is counted separately, and failures are no failed
  /// attempts of the path.
  Corrector(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, SolveRecord& record,
            NewtonPurpose purpose = NewtonPurpose::step)
      : problem_(problem), parameters_(parameters), record_(record), purpose_(purpose) {}

  /// Finds equilibrium at a load factor. `way`: increments for the whole step predicted by the tangent, which replace
  /// the first iteration and are limited like it; null: unknown. `from_stable`: networks may be solved by iteration.
  Correction at_load(const State& from, double load_factor, int most_iterations, const MixedVector* way = nullptr,
                     bool from_stable = false);
  /// Finds equilibrium with an unknown load factor, for which the row holds.
  Correction on_row(const Guess& guess, const ControlRow& row, int most_iterations);

 private:
  Correction solve(const Teuchos::RCP<NOX::Abstract::Group>& group, int most_iterations, bool from_prediction = false);

  Teuchos::RCP<BeamProblem> problem_;
  const SolverParameters& parameters_;
  SolveRecord& record_;
  NewtonPurpose purpose_;
};

}  // namespace mixbeam
