/// Newton's method at one point of a path: at a given load factor, or with the load factor as an unknown and one
/// control row.
#pragma once

#include "nonlinear/newton/newton_setup.hpp"
#include "nonlinear/path/path_measure.hpp"

#include <LOCA_GlobalData.H>

#include <string>

namespace mixbeam {

/// What Newton's method found, or how it failed.
struct Correction {
  bool converged = false;
  State state;               ///< the last iterate
  double load_factor = 0.0;  ///< likewise
  MixedVector moved;         ///< sum of all increments since the start
  int iterations = 0;
  double residual = 0.0;  ///< scaled maximum norm
  std::string cause{};    ///< of a failure, in a few words
};

/// Where the iteration starts: at `state` moved by `moved`.
struct Guess {
  const State& state;
  double load_factor;
  const MixedVector* moved = nullptr;  ///< null: not at all
};

class Corrector {
 public:
  /// `record` must outlive this object. What is done to check a step is counted apart and no failed attempt of the
  /// path. Throws InputError for NOX parameters that NOX refuses.
  Corrector(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, SolveRecord& record,
            NewtonPurpose purpose = NewtonPurpose::step);
  ~Corrector();
  Corrector(const Corrector&) = delete;
  Corrector& operator=(const Corrector&) = delete;

  /// Equilibrium at a load factor. What the tangent says of the way there (increments for the whole step, null where it
  /// is not known) takes the place of the first iteration, limited as that is.
  /// `from_stable`: networks may be iterated with.
  Correction at_load(const State& from, double load_factor, int most_iterations, const MixedVector* way = nullptr,
                     bool from_stable = false);
  /// Equilibrium at which the row holds.
  Correction on_row(const Guess& guess, const ControlRow& row, int most_iterations);

  const Teuchos::RCP<LOCA::GlobalData>& global() const { return global_; }

 private:
  Correction solve(const Teuchos::RCP<NOX::Abstract::Group>& group, int most_iterations, bool from_prediction = false);

  Teuchos::RCP<BeamProblem> problem_;
  const SolverParameters& parameters_;
  SolveRecord& record_;
  NewtonPurpose purpose_;
  Teuchos::RCP<Teuchos::ParameterList> lists_;
  Teuchos::RCP<LOCA::GlobalData> global_;
};

}  // namespace mixbeam
