/// Finds the points between two converged states of a path at which eigenvalues of the tangent pass zero.
#pragma once

#include "nonlinear/corrector.hpp"
#include "nonlinear/critical_point.hpp"
#include "nonlinear/path_measure.hpp"

namespace mixbeam {

/// A piece of a path, and the row by which its points are found: each share of the row's target is met once.
struct PathSegment {
  const State& start;
  double load_factor;   ///< at the start
  PathDirection moved;  ///< from start to end
  ControlRow row;       ///< holds at the end
};

class CriticalPointFinder {
 public:
  CriticalPointFinder(const Teuchos::RCP<BeamProblem>& problem, Corrector& corrector, Stability& stability,
                      const PathMeasure& measure)
      : problem_(problem), corrector_(corrector), stability_(stability), measure_(measure) {}

  /// In the order of the path, load factors to 1e-9 of the change over the segment or better. Throws ConvergenceError
  /// when a point of the segment cannot be computed. Collective.
  std::vector<CriticalPoint> find(const PathSegment& segment);

 private:
  struct Sample {
    double at = 0.0;  ///< share of the segment
    double load_factor = 0.0;
    State state;
    Spectrum spectrum;
  };

  Correction correct(const PathSegment& segment, double at);
  Sample sample(const PathSegment& segment, double at, int modes);
  double coarse_root(const PathSegment& segment, int k, int modes, const Sample& first, const Sample& last);
  struct Root {
    double at = 0.0, load_factor = 0.0, load_slope = 0.0;
    Sample beside;
  };
  const EigenMode* most_like(const Spectrum& spectrum, const MixedVector& other) const;
  Root refined_root(const PathSegment& segment, int k, int modes, double near);
  CriticalPoint point_at(const PathSegment& segment, const Root& root);
  State state_at_bifurcation(const PathSegment& segment, const Root& root, const MixedVector& mode);

  Teuchos::RCP<BeamProblem> problem_;
  Corrector& corrector_;
  Stability& stability_;
  const PathMeasure& measure_;
};

}  // namespace mixbeam
