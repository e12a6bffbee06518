// What a step is judged by at its points: the tangent of the path, the count of negative eigenvalues, the loads.
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/path/step_judge.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

/// Between an element and its vertices [rad]: at pi the relative rotation is not unique.
constexpr double kLargestEndAngle = 2.8;
/// Points of the middle rule for the change of loads.
constexpr int kHistoryParts = 64;
/// A last station of a stage belongs to that stage: its tangent must not be that of the loads to come.
double within_stage(double load_factor, double stage_end) {
  return std::min(load_factor, std::nextafter(stage_end, stage_end - 1.0));
}

}  // namespace

std::optional<StabilityResult> StepJudge::count(const State& state, double load_factor) const {
  if (problem_->leave_if_asked) problem_->leave_if_asked();
  if (stability_ == nullptr) return std::nullopt;
  try {
    const StabilityResult result = stability_->count(state, load_factor);
    // elements that turn nearly by pi against their vertices have no stiffness to count by
    if (result.end_angle > kLargestEndAngle) return std::nullopt;
    return result;
  } catch (const LinearSolverError&) {
    return std::nullopt;  // a singular tangent without symmetry has no count
  }
}

/// By the factors of the tangent here, where they tell.
std::optional<StabilityResult> StepJudge::count_by(Linearization& at) const {
  if (problem_->leave_if_asked) problem_->leave_if_asked();
  if (stability_ == nullptr) return std::nullopt;
  try {
    const std::optional<StabilityResult> result = stability_->count_by(at);
    return result && result->end_angle <= kLargestEndAngle ? result : std::nullopt;
  } catch (const LinearSolverError&) {
    return std::nullopt;
  }
}

/// Theory (54) for the given derivative of the residual with the load factor, which grows along it.
PathDirection StepJudge::tangent_of(BeamGroup& group, const MixedVector& slope) const {
  group.linearization();
  BeamVector by_load(problem_->model.create_vector());
  Teuchos::ParameterList none;
  group.applyJacobianInverse(none, BeamVector(slope), by_load);
  const PathDirection rate{by_load.values().clone(true), -1.0};
  return scaled(rate, -1.0 / measure_.length(rate));
}

Station StepJudge::station(const State& state, double load_factor, const PathDirection* along, bool counts) const {
  Station here{state, load_factor, {problem_->model.create_vector(), 0.0}};
  {
    TangentChoice choice;
    choice.counts_interior = counts;
    choice.enough = kEnoughForTangents;
    BeamGroup group(corrector_.global(), problem_, state, load_factor, {}, choice);
    group.computeF();
    if (counts) here.stability = count_by(group.linearization());
    MixedVector slope = problem_->model.create_vector();
    load_derivative(problem_->model, state, within_stage(load_factor, stage_end_), group.scales(), slope);
    here.tangent = tangent_of(group, slope);
  }
  if (along != nullptr && measure_.inner(*along, here.tangent) < 0.0) here.tangent = scaled(here.tangent, -1.0);
  if (counts && !here.stability) here.stability = count(state, load_factor);
  here.cap_ratio = here.stability
                       ? here.stability->cap_ratio
                       : cap_for(problem_->model, scales_of(problem_->model, state, load_factor)).least_ratio;
  return here;
}

/// For the mean of the derivatives between two load factors.
PathDirection StepJudge::secant_tangent(const Station& at, double from, double to) const {
  BeamGroup group(corrector_.global(), problem_, at.state, at.load_factor, {});
  group.computeF();
  MixedVector mean = problem_->model.create_vector(), slope = mean.clone(false);
  mean.fill(0.0);
  for (int part = 0; part < kHistoryParts; ++part) {
    load_derivative(problem_->model, at.state, from + (to - from) * (part + 0.5) / kHistoryParts, group.scales(),
                    slope);
    mean.update(1.0 / kHistoryParts, slope, 1.0);
  }
  return tangent_of(group, mean);
}

/// The tangent next to a critical point, maybe, at a state moved by a guess.
StepJudge::Linear StepJudge::linear_at(const State& start, const PathDirection& guess, double load_factor) const {
  const Model& model = problem_->model;
  const bool in_plane = start.in_plane && model.is_in_plane(guess.x);
  BeamGroup group(corrector_.global(), problem_, start, load_factor, {}, near_critical(!in_plane));
  group.setX(BeamVector(guess.x));
  group.computeJacobian();
  BeamVector slope(model.create_vector()), by_load(model.create_vector());
  load_derivative(model, group.state(), within_stage(load_factor, stage_end_), group.scales(), slope.values());
  Teuchos::ParameterList none;
  group.applyJacobianInverse(none, slope, by_load);
  return {group.state(), BeamVector::of(group.getNewton()).clone(true), std::move(by_load.values())};
}

}  // namespace mixbeam
