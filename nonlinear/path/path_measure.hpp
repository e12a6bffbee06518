/// How far two points of a path are apart, the direction in which it runs, and what is known at a point of it.
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

/// `a` times factor.
PathDirection scaled(const PathDirection& a, double factor);

/// The equation, theory (55), that takes the place of a given load factor where a path is followed by its length, by
/// the motion of a point or by the amplitude of a mode:
/// <weights, x> + load_weight (load factor - load_start) = target, x the increments since the start of the step. Linear
/// in what Newton's method adds, hence satisfied after the first full step.
struct ControlRow {
  MixedVector weights;
  double load_weight = 0.0, load_start = 0.0, target = 0.0;
};

/// The motion of the structure, theory (53): root mean square over the vertices of displacement / scene length and
/// rotation. Paths are measured by motion alone; the load factor joins with a weight so small that it counts only where
/// nothing moves. All functions are collective.
class PathMeasure {
 public:
  explicit PathMeasure(const Model& model);
  /// Of the motions alone.
  double motion(const MixedVector& a, const MixedVector& b) const;
  double motion(const MixedVector& a) const;
  /// Motion of a - factor b.
  double motion_beside(const MixedVector& a, double factor, const MixedVector& b) const;
  /// The same of each part of the structure that touches no other one: parts follow paths of their own.
  std::vector<double> motion_of_parts(const MixedVector& a, const MixedVector& b) const;
  /// Cosine of the angle between two motions; zero where one of them is none.
  double cosine(const MixedVector& a, const MixedVector& b) const;
  double inner(const PathDirection& a, const PathDirection& b) const;
  double length(const PathDirection& a) const;
  /// The row "way along the unit vector `direction` since load_start = length": theory (55).
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
  PathDirection tangent;                       ///< theory (54); not finite where the tangent matrix is singular
  std::optional<StabilityResult> stability{};  ///< none: not affordable
  /// Cap::least_ratio of the tangent that was counted, or would have been: above zero, forces are shared by stiffnesses
  /// that it cuts off, and a prediction shares them less well than iterations do.
  double cap_ratio = 0.0;

  bool has_tangent() const { return std::isfinite(tangent.load); }
};

/// What lies between a point of a path and where it began.
class Way {
 public:
  explicit Way(const Station& begin) : begin_(begin), sum_(begin.tangent.x.clone(false)) { sum_.fill(0.0); }
  /// A step, and the critical points in it.
  void add(const PathMeasure& measure, const PathDirection& moved, const Model& model,
           const std::vector<CriticalPoint>& passed);
  /// Whether the path has come back to its start, in the same direction, with the last step. Or to a limit point: one
  /// path alone runs through it, and once, so that the path has turned back somewhere, unseen.
  bool returns(const PathMeasure& measure, const Station& here, const PathDirection& last) const;

 private:
  Station begin_;
  MixedVector sum_;         ///< of the increments
  double travelled_ = 0.0;  ///< sum of their lengths
  struct LimitPoint {
    State state;
    double load_factor;
  };
  std::vector<LimitPoint> limits_{};
  bool meets_again_ = false;  ///< one of them
};

}  // namespace mixbeam
