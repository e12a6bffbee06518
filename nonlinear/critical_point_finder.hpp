/// Finds the points within a step at which eigenvalues of the tangent pass zero.
#pragma once

#include "nonlinear/critical_point.hpp"
#include "nonlinear/step_judge.hpp"

#include <array>
#include <stdexcept>

namespace mixbeam {

/// The change of the count within a step is not explained by critical points of one path.
class NotLocated : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class CriticalPointFinder {
 public:
  CriticalPointFinder(const Teuchos::RCP<BeamProblem>& problem, Corrector& corrector, Stability& stability,
                      const PathMeasure& measure, const StepJudge& judge)
      : problem_(problem), corrector_(corrector), stability_(stability), measure_(measure), judge_(judge) {}

  /// In the order of the path. Points of a step with more than a few are not located one by one but the first, see
  /// CriticalPoint::located. Throws NotLocated. Collective.
  std::vector<CriticalPoint> find(const PathPiece& piece);

 private:
  /// A point of the path within the step.
  struct Sample {
    double at = 0.0;  ///< share of the chord
    Station station;
    int negative() const { return station.stability->negative; }
  };
  /// Two samples between which eigenvalues pass zero together.
  struct Bracket {
    Sample low, high;
  };

  /// There is more than one critical point in a bracket: it is to be divided at this sample.
  struct MorePoints {
    Sample sample;
  };

  std::vector<CriticalPoint> find_all(const PathPiece& piece);
  Sample sample(const PathPiece& piece, double at);
  void require_smoothness(const PathPiece& piece, const Station& a, const Station& b) const;
  std::vector<double> critical_eigenvalues(const Sample& sample, int first, int count);
  std::array<double, 2> secant_roots(const Bracket& bracket);
  bool vanish_together(const PathPiece& piece, const Bracket& bracket);
  void isolate(const PathPiece& piece, const Bracket& bracket, std::vector<Bracket>& found);
  bool turns(const Bracket& bracket) const;
  void require_order(const Bracket& bracket, const Sample& sample) const;
  double passing(const Bracket& bracket, const Sample& sample);
  double coarse_root(const PathPiece& piece, const Bracket& bracket, double distance);
  bool needs_counting(const Bracket& bracket);
  void find_modes(CriticalPoint& point);
  CriticalPoint locate_by_count(const PathPiece& piece, const Bracket& bracket);
  CriticalPoint locate(const PathPiece& piece, const Bracket& bracket);
  State state_at_bifurcation(const PathPiece& piece, double at, double load_factor,
                             const std::vector<EigenMode>& critical);

  Teuchos::RCP<BeamProblem> problem_;
  Corrector& corrector_;
  Stability& stability_;
  const PathMeasure& measure_;
  const StepJudge& judge_;
  int samples_ = 0;        ///< taken in this step
  bool separates_ = true;  ///< its critical points are few enough to be located one by one
};

}  // namespace mixbeam
