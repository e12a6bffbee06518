/// What a path is followed to: a load factor, or a displacement that is controlled.
#pragma once

#include "nonlinear/path/corrector.hpp"

namespace mixbeam {

/// Nothing that could be tried further on leads to the end.
struct GaveUp {
  std::string cause;
};

/// Numbers are load factors, or the controlled displacement over the length of the scene.
class PathGoal {
 public:
  /// `end`: load factor, of no importance where a displacement is controlled. The model must outlive this object.
  PathGoal(const Model& model, const std::optional<MonitoredComponent>& control, double end)
      : model_(model), control_(control), end_(end) {}

  bool is_controlled() const { return control_.has_value(); }
  double value() const { return is_controlled() ? control_->target / model_.structure().length : end_; }
  double at(const State& state, double load_factor) const;
  double rate(const PathDirection& direction) const;
  bool is_reached(const State& state, double load_factor) const;
  /// Whether a direction moves what is controlled, by more than rounding.
  bool is_moved_by(const PathMeasure& measure, const PathDirection& direction) const;
  /// Newton's method from a point of the path at another value. `way`: what is known of the way there; may be null.
  Correction correct(Corrector& corrector, const Station& from, double value, const PathDirection* way,
                     int most_iterations) const;
  /// What was found along the path from there, or where the goal, or a way of `largest`, lies before it, that point.
  Correction within(Corrector& corrector, const Station& from, Correction found, double largest,
                    int most_iterations) const;
  /// Throws GaveUp where what is controlled has not moved from `start`: following the path further is of no use.
  void require_motion(double start, const Station& here, const std::string& until) const;
  /// The controlled displacement, or else the load factor, moves by `change`.
  ControlRow row(double load_start, double change) const;

 private:
  const Model& model_;
  std::optional<MonitoredComponent> control_;
  double end_;
};

/// Whether the load moves the controlled displacement of the unloaded structure; true where none is controlled or the
/// tangent there is singular. One solve. Collective.
bool load_moves_control(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters);

}  // namespace mixbeam
