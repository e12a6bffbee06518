/// How far two points of a path are apart, and the direction in which it runs.
#pragma once

#include "nonlinear/beam_group.hpp"
#include "nonlinear/linear_control.hpp"

namespace mixbeam {

/// Increments (spatial, Assembler::apply) and change of the load factor, of length one where it is a tangent.
struct PathDirection {
  MixedVector x;
  double load = 0.0;
};

/// Length: root mean square over the vertices of displacement / scene length and rotation, together with the change of
/// the load factor. All functions are collective.
class PathMeasure {
 public:
  explicit PathMeasure(const Assembler& assembler);
  double inner(const PathDirection& a, const PathDirection& b) const;
  double length(const PathDirection& a) const;
  /// The row "way along the unit vector `direction` since load_start = length".
  ControlRow row(const PathDirection& direction, double load_start, double length) const;

 private:
  MixedVector weights_;
};

/// `a` times factor.
PathDirection scaled(const PathDirection& a, double factor);

/// Unit tangent of the path at a converged state, in the direction in which the load factor grows.
PathDirection path_tangent(const Teuchos::RCP<LOCA::GlobalData>& global, const Teuchos::RCP<BeamProblem>& problem,
                           const PathMeasure& measure, const State& state, double load_factor);

}  // namespace mixbeam
