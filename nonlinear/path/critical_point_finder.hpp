/// Location of the points within a step at which eigenvalues of the tangent pass zero: theory (60).
#pragma once

#include "nonlinear/path/step_judge.hpp"
#include "nonlinear/stability/stability.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>

namespace mixbeam {

/// Thrown if critical points of one path do not explain the change of the count within a step.
class NotLocated : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Point of a step (share of the chord), with the value that passes zero at the critical point.
struct PassingSample {
  double at, passing, load_factor;
};

/// Number of eigenvalues up to which they are separated. Of more, the first is located and the others are counted.
inline constexpr int kMostSeparated = 6;

/// Finder for one step, whose counts at both ends are known and differ.
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

  /// Finds the points, in the order of the path. If there are more than kMostSeparated, only the first is located, see
  /// CriticalPoint::located. Throws NotLocated, LinearSolverError. Collective.
  std::vector<CriticalPoint> find();

 private:
  using Space = std::shared_ptr<const CriticalSpace>;
  /// A point of the path within the step.
  struct Sample {
    double at = 0.0;  ///< share of the chord
    Station station;
    Space space{};       ///< the last one used
    SpaceValues seen{};  ///< its values
    int negative() const { return station.stability->negative; }
  };
  /// Data of a sample: state alone, with its tangent, or also with the count.
  enum class Asked { state, tangent, count };
  /// Two samples between which eigenvalues pass zero.
  struct Bracket {
    Sample low, high;
    Space space{};  ///< sees all that passes zero; none: unknown
    int changes() const { return std::abs(high.negative() - low.negative()); }
    double width() const { return high.at - low.at; }
    /// Index of the first value of the space that changes its sign.
    int first_crossing() const { return std::min(low.seen.negative(), high.seen.negative()); }
  };
  /// Known state of the path, as increments since the start of the step.
  struct Known {
    double at;
    PathDirection moved;
  };

  /// Thrown if a bracket contains several critical points; it must be divided at this sample.
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
  bool straight_;   ///< up to rounding, in which the directions of tangents are lost
  bool separates_;  ///< there are few enough critical points to locate each
  std::vector<Known> known_;
  int samples_ = 0;  ///< number taken
};

}  // namespace mixbeam
