#include "nonlinear/path/path_goal.hpp"

#include "discretization/state/resume_point.hpp"
#include "discretization/state/sampling.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/path/step_judge.hpp"
#include "nonlinear/path/thresholds.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

double PathGoal::at(const State& state, double load_factor) const {
  if (!is_controlled()) return load_factor;
  return vertex_motion(model_, state, vertex_of(model_.mesh(), control_->point))[control_->component] /
         model_.structure().length;
}

double PathGoal::rate(const PathDirection& direction) const {
  return is_controlled() ? row(0.0, 0.0).weights.inner_product(direction.x) : direction.load;
}

bool PathGoal::is_reached(const State& state, double load_factor) const {
  return is_controlled() ? std::abs(at(state, load_factor) - value()) <= path_limit.control_precision
                         : is_end_of_stage(load_factor, end_);
}

bool PathGoal::is_moved_by(const PathMeasure& measure, const PathDirection& direction) const {
  const double rounding =
      std::max(path_limit.still * measure.motion(direction.x), path_limit.no_motion * std::abs(direction.load));
  return std::abs(rate(direction)) > rounding;
}

Correction PathGoal::correct(Corrector& corrector, const Station& from, double value, const PathDirection* way,
                             int most_iterations) const {
  if (!is_controlled()) {
    const bool predicts = way != nullptr && from.cap_ratio == 0.0;
    const bool is_stable = from.stability && from.stability->verdict() == Verdict::stable;
    return corrector.at_load(from.state, value, most_iterations, predicts ? &way->x : nullptr, is_stable);
  }
  Guess guess{from.state, from.load_factor};
  if (way != nullptr) {
    guess.load_factor += way->load;
    guess.moved = &way->x;
  }
  return corrector.on_row(guess, row(from.load_factor, value - at(from.state, from.load_factor)), most_iterations);
}

Correction PathGoal::within(Corrector& corrector, const Station& from, Correction found, double largest,
                            int most_iterations) const {
  if (!found.converged) return found;
  const double now = at(from.state, from.load_factor), rest = value() - now;
  const double reached = at(found.state, found.load_factor) - now;
  const bool passes = reached * rest > 0.0 && std::abs(reached) > std::abs(rest);
  const double allowed = std::min(passes ? std::abs(rest) : std::abs(reached), largest);
  if (std::abs(reached) <= allowed) return found;
  const PathDirection way{std::move(found.moved), found.load_factor - from.load_factor};
  const PathDirection part = scaled(way, allowed / std::abs(reached));
  const bool ends = passes && allowed == std::abs(rest);
  return correct(corrector, from, ends ? value() : now + std::copysign(allowed, reached), &part, most_iterations);
}

void PathGoal::require_motion(double start, const Station& here, const std::string& until) const {
  if (!is_controlled() || std::abs(at(here.state, here.load_factor) - start) > path_limit.still) return;
  throw GaveUp{"the load does not move point \"" + control_->point + "\" along " +
               std::string(1, "xyz"[control_->component]) + " before " + until +
               ": follow a branch (\"Branch\" in \"Analysis\") or add a small lateral load"};
}

ControlRow PathGoal::row(double load_start, double change) const {
  MixedVector weights = model_.create_vector();
  weights.fill(0.0);
  if (!is_controlled()) return {weights, 1.0, load_start, change};
  const int local = model_.structure().partition.place(vertex_of(model_.mesh(), control_->point));
  if (local >= 0) weights.vertex()(kVertexDofs * local + control_->component) = 1.0 / model_.structure().length;
  return {weights, 0.0, load_start, change};
}

bool load_moves_control(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters) {
  if (!parameters.analysis.control) return true;
  StepJudge judge(problem, parameters, nullptr, 1.0);
  const PathGoal goal(problem->model, parameters.analysis.control, 1.0);
  try {
    const PathDirection tangent = judge.station(problem->model.reference_state(), 0.0, nullptr).tangent;
    return !std::isfinite(goal.rate(tangent)) || goal.is_moved_by(judge.measure(), tangent);
  } catch (const LinearSolverError&) {
    return true;
  }
}

}  // namespace mixbeam
