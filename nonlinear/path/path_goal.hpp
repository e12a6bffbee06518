/// Goal of a path: a load factor, or a controlled displacement.
#pragma once

#include "nonlinear/path/corrector.hpp"

namespace mixbeam {

/// Thrown if no further attempt can reach the end of the path.
struct GaveUp {
  std::string cause;
};

/// Values are load factors, or the controlled displacement over the length of the scene.
class PathGoal {
 public:
  /// `end`: load factor, ignored under displacement control. The model must outlive this object.
  PathGoal(const Model& model, const std::optional<MonitoredComponent>& control, double end)
      : model_(model), control_(control), end_(end) {}

  bool is_controlled() const { return control_.has_value(); }
  double value() const { return is_controlled() ? control_->target / model_.structure().length : end_; }
  double at(const State& state, double load_factor) const;
  double rate(const PathDirection& direction) const;
  bool is_reached(const State& state, double load_factor) const;
  /// Whether a direction changes the value by more than rounding.
  bool is_moved_by(const PathMeasure& measure, const PathDirection& direction) const;
  /// Newton's method from a point of the path to another value. `way`: predicted increments; may be null.
  Correction correct(Corrector& corrector, const Station& from, double value, const PathDirection* way,
                     int most_iterations) const;
  /// Returns `found`, or if the goal, or a change by `largest`, lies between `from` and it, corrects to that point.
  Correction within(Corrector& corrector, const Station& from, Correction found, double largest,
                    int most_iterations) const;
  /// Throws GaveUp if the controlled displacement has not moved from `start`: following the path further is useless.
  void require_motion(double start, const Station& here, const std::string& until) const;
  /// Row that changes the controlled displacement, or else the load factor, by `change`.
  ControlRow row(double load_start, double change) const;

 private:
  const Model& model_;
  std::optional<MonitoredComponent> control_;
  double end_;
};

/// Whether the load moves the controlled displacement of the unloaded structure; true if there is no control or the
/// tangent is singular. Takes one solve. Collective.
bool load_moves_control(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters);

}  // namespace mixbeam
