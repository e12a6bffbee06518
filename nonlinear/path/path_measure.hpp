/// Distance between points of a path, its direction, and the data of a point.
#pragma once

#include "nonlinear/newton/beam_group.hpp"
#include "nonlinear/stability/stability.hpp"

#include <cmath>
#include <optional>
#include <vector>

namespace mixbeam {

/// Increments (spatial, Model::apply) and change of the load factor.
struct PathDirection {
  MixedVector x;
  double load = 0.0;
};

/// Returns `a` times factor.
PathDirection scaled(const PathDirection& a, double factor);

/// The equation, theory (55), that replaces a given load factor if a path is followed by arc length, by the motion of a
/// point or by the amplitude of a mode:
/// <weights, x> + load_weight (load factor - load_start) = target, x the increments since the start of the step. Linear
/// in the increments of Newton's method, hence satisfied after the first full step.
struct ControlRow {
  MixedVector weights;
  double load_weight = 0.0, load_start = 0.0, target = 0.0;
};

/// Measure of the motion of the structure, theory (53): root mean square over the vertices of displacement / scene
/// length and rotation. Paths are measured by motion alone; the weight of the load factor is so small that it counts
/// only if nothing moves. All functions are collective.
class PathMeasure {
 public:
  explicit PathMeasure(const Model& model);
  /// Inner product of motions, without load factors.
  double motion(const MixedVector& a, const MixedVector& b) const;
  double motion(const MixedVector& a) const;
  /// Motion of a - factor b.
  double motion_beside(const MixedVector& a, double factor, const MixedVector& b) const;
  /// Inner products for each part of the structure that is not connected to others: parts follow paths of their own.
  std::vector<double> motion_of_parts(const MixedVector& a, const MixedVector& b) const;
  /// Cosine of the angle between two motions; zero if one of them is zero.
  double cosine(const MixedVector& a, const MixedVector& b) const;
  double inner(const PathDirection& a, const PathDirection& b) const;
  double length(const PathDirection& a) const;
  /// Row "distance along the unit vector `direction` since load_start = length": theory (55).
  ControlRow row(const PathDirection& direction, double load_start, double length) const;

 private:
  MixedVector weights_;
  int parts_ = 1;
  std::vector<int> part_of_vertex_;  ///< (owned vertex); empty: there is one part
};

/// A converged point of a path and its direction from there.
struct Station {
  State state;
  double load_factor = 0.0;
  PathDirection tangent;                       ///< theory (54); not finite if the tangent matrix is singular
  std::optional<StabilityResult> stability{};  ///< none: too expensive
  /// Cap::least_ratio of the tangent for counting. Above zero, forces are distributed by stiffnesses that the cap cuts
  /// off, and a prediction distributes them less accurately than iterations do.
  double cap_ratio = 0.0;

  bool has_tangent() const { return std::isfinite(tangent.load); }
};

/// Way of a path from its start to the present point.
class Way {
 public:
  explicit Way(const Station& begin) : begin_(begin), sum_(begin.tangent.x.clone(false)) { sum_.fill(0.0); }
  /// Adds a step, with the critical points in it.
  void add(const PathMeasure& measure, const PathDirection& moved, const Model& model,
           const std::vector<CriticalPoint>& passed);
  /// Whether the last step has led back to the start in the same direction, or the path has met a limit point again:
  /// only one path runs through a limit point, once, so that it has turned back somewhere undetected.
  bool returns(const PathMeasure& measure, const Station& here, const PathDirection& last) const;

 private:
  Station begin_;
  MixedVector sum_;         ///< of all increments
  double travelled_ = 0.0;  ///< sum of their lengths
  struct LimitPoint {
    State state;
    double load_factor;
  };
  std::vector<LimitPoint> limits_{};
  bool meets_again_ = false;  ///< a limit point was met twice
};

}  // namespace mixbeam
