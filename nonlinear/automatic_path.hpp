/// A load path without tuning: load steps as large as Newton's method takes them, and where it fails, the path itself,
/// by its length, through limit points and snap-backs.
#pragma once

#include "nonlinear/corrector.hpp"

#include <functional>

namespace mixbeam {

/// Unit tangent of the path: increments and load factor per unit of path length.
struct PathDirection {
  MixedVector x;
  double load = 0.0;
};

/// Length of increments of a path: root mean square over the vertices of displacement / scene length and rotation,
/// together with the change of the load factor.
class PathMeasure {
 public:
  explicit PathMeasure(const Assembler& assembler);
  double inner(const MixedVector& a, const MixedVector& b) const;
  double length(const MixedVector& x, double load) const;
  /// The row "way along `direction` = length".
  ControlRow row(const PathDirection& direction, double load_start, double length) const;

 private:
  MixedVector weights_;
};

}  // namespace mixbeam
