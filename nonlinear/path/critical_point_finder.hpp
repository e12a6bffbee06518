/// Finds the points within a step at which eigenvalues of the tangent pass zero: theory (60).
#pragma once

#include "nonlinear/path/step_judge.hpp"
#include "nonlinear/stability/stability.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>

namespace mixbeam {

/// The change of the count within a step is not explained by critical points of one path.
class NotLocated : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A point of a step, with what passes zero at its critical point.
struct PassingSample {
  double at, passing, load_factor;
};

/// More eigenvalues than these are not separated: the first one is located, of the others the number is reported.
inline constexpr int kMostSeparated = 6;

/// Of one step, whose counts at both ends are known and differ.
class CriticalPointFinder {
 public:
  CriticalPointFinder(StepJudge& judge, const PathPiece& piece)
      : judge_(judge),
        measure_(judge.measure()),
        stability_(*judge.stability()),
        model_(judge.problem()->model),
        piece_(piece),
        chord_(measure_.length(piece.moved)),
        straight_(judge.is_straight(piece)),
        separates_(std::abs(piece.end.stability->negative - piece.start.stability->negative) <= kMostSeparated) {
    known_.push_back({0.0, scaled(piece.moved, 0.0)});
    known_.push_back({1.0, scaled(piece.moved, 1.0)});
  }

  /// In the order of the path. Points of a step with more than a few are not located one by one but the first, see
  /// CriticalPoint::located. Throws NotLocated, LinearSolverError. Collective.
  std::vector<CriticalPoint> find();

 private:
  using Space = std::shared_ptr<const CriticalSpace>;
  /// A point of the path within the step.
  struct Sample {
    double at = 0.0;  ///< share of the chord
    Station station;
    Space space{};       ///< the last one asked for
    SpaceValues seen{};  ///< with it
    int negative() const { return station.stability->negative; }
  };
  /// What is asked of a sample beside its state.
  enum class Asked { state, tangent, count };
  /// Two samples between which eigenvalues pass zero.
  struct Bracket {
    Sample low, high;
    Space space{};  ///< sees all that passes zero; none: not known
    int changes() const { return std::abs(high.negative() - low.negative()); }
    double width() const { return high.at - low.at; }
    /// Of the values that the space sees at both ends.
    int first_crossing() const { return std::min(low.seen.negative(), high.seen.negative()); }
  };
  /// A state of the path, as increments since the start of the step.
  struct Known {
    double at;
    PathDirection moved;
  };

  /// There is more than one critical point in a bracket: it is to be divided at this sample.
  struct MorePoints {
    Sample sample;
  };

  Sample end_of_step(double at, const Station& station);
  bool is_one_point(Bracket whole);
  Sample sample(double at, Asked asked);
  PathDirection predicted(double at) const;
  void require_smoothness(const Station& a, const Station& b) const;
  bool turns(const Bracket& bracket) const;
  const SpaceValues& values_of(Sample& sample, const Space& space);
  const std::vector<EigenMode>& modes_of(Sample& sample, const Space& space);
  bool sees_changes(Bracket& bracket, const Space& space);
  void choose_space(Bracket& bracket);
  bool needs_counting(const Bracket& bracket);
  std::vector<Sample> between(const Bracket& bracket);
  void isolate(Bracket bracket, std::vector<Bracket>& found);
  void require_order(const Bracket& bracket, const Sample& here);
  PassingSample passing(const Bracket& bracket, Sample& sample);
  double distance_at(const Bracket& bracket, double at) const;
  double coarse_root(Bracket& bracket, std::vector<PassingSample>& samples);
  double find_modes(CriticalPoint& point);
  std::vector<PassingSample> samples_beside(const Bracket& bracket, double near, double distance, Sample& beside);
  CriticalPoint locate_by_count(const Bracket& bracket);
  CriticalPoint locate(Bracket& bracket);
  std::vector<MixedVector> critical_modes(const Bracket& bracket, Sample& sample);
  State state_at_bifurcation(double at, double load_factor, const std::vector<MixedVector>& critical);

  StepJudge& judge_;
  const PathMeasure& measure_;
  Stability& stability_;
  const Model& model_;
  const PathPiece& piece_;
  double chord_;
  bool straight_;   ///< to rounding: tangents have no directions of their own
  bool separates_;  ///< its critical points are few enough to be located one by one
  std::vector<Known> known_;
  int samples_ = 0;  ///< taken
};

}  // namespace mixbeam
