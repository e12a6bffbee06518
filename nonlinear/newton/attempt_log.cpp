#include "nonlinear/newton/attempt_log.hpp"

#include "discretization/scene/what_acts.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/newton/beam_group.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace mixbeam {

namespace {

std::string short_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1e", value);
  return text.data();
}

bool all_finite(const Vector3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

/// Names a load or prescribed motion that is not finite. They do not depend on the iterate, so it is checked first.
std::string load_not_finite(const Scene& scene, double load_factor) {
  std::string found;
  for_each_acting(scene, [&](const auto& load, auto kind) {
    bool is_finite = std::isfinite(Amplitude(load.stage, scene.stages, load.amplitude)(load_factor));
    kind.for_each_vector(
        load, [&](const Vector3& v, const Formulas*, VectorRole) { is_finite = is_finite && all_finite(v); });
    if (!is_finite && found.empty()) found = std::string(kind.words) + " \"" + excerpt(load.*kind.target) + "\"";
  });
  return found;
}

NotFinite origin_of(const BeamGroup& group, const BeamGroup* previous, int iteration) {
  const Model& model = group.problem().model;
  NotFinite origin;
  origin.iteration = iteration;
  if (!std::isfinite(group.load_factor())) {
    origin.source = NotFinite::Source::load_factor;
    return origin;
  }
  origin.what = load_not_finite(model.scene(), model.clock().load_factor(group.load_factor()));
  if (!origin.what.empty()) {
    origin.source = NotFinite::Source::load;
    return origin;
  }
  if (previous != nullptr) {
    origin.source = NotFinite::Source::tangent;
    origin.place = first_tangent_not_finite(previous->tangent());
    if (origin.place) return origin;
    origin.source = NotFinite::Source::increment;
    origin.place = first_not_finite(model, BeamVector::of(previous->getNewton()), SearchOrder::vertices_first);
    if (origin.place) return origin;
  }
  origin.source = NotFinite::Source::residual;
  origin.place = first_not_finite(model, BeamVector::of(group.getF()), SearchOrder::elements_first);
  return origin;
}

std::string where_not_finite(const NotFinite& origin) {
  const std::string place = origin.place ? text_of(*origin.place) : "";
  const std::string iteration =
      origin.iteration == 0 ? "before the first iteration" : "in iteration " + std::to_string(origin.iteration);
  switch (origin.source) {
    case NotFinite::Source::load_factor:
      return "no load factor to go to: the direction of the path could not be computed";
    case NotFinite::Source::load:
      return origin.what + " is not a finite number";
    case NotFinite::Source::tangent:
      return "the tangent of " + place + " is not finite " + iteration;
    case NotFinite::Source::increment:
      return "the correction is not finite " + iteration + " (" + unknown_text(*origin.place) + ", " + place + ")";
    case NotFinite::Source::residual:
      break;
  }
  return "the residual is not finite " + iteration +
         (origin.place ? " (" + equation_text(*origin.place) + ", " + place + ")" : "");
}

}  // namespace

std::string cause_text(const FailedAttempt& attempt) {
  if (attempt.end == AttemptEnd::not_finite && attempt.not_finite) return where_not_finite(*attempt.not_finite);
  if (attempt.end == AttemptEnd::refused) return attempt.refused_because;
  if (attempt.end == AttemptEnd::linear_solver) return "linear solve: " + attempt.linear_solver;
  std::string text = "no equilibrium in " + std::to_string(attempt.iterations) +
                     (attempt.iterations == 1 ? " iteration" : " iterations");
  text += ", residual " + short_text(attempt.last_residual);
  if (attempt.peak) text += " (" + equation_text(attempt.peak->place) + ", " + text_of(attempt.peak->place) + ")";
  return text;
}

void AttemptLog::start_path(int steps, Observer observer) {
  *this = AttemptLog();
  steps_ = steps;
  observer_ = std::move(observer);
}

void AttemptLog::step_completed(int steps) {
  steps_ = steps;
  failures_ = 0;
  attempts_.clear();
}

void AttemptLog::start_attempt() { present_ = {}; }

void AttemptLog::iterated(const BeamGroup& group, const BeamGroup* previous, int iteration) {
  if (!group.isF()) return;
  const double norm = group.getNormF();
  if (std::isfinite(norm)) {
    if (iteration <= 1) present_.first_residual = present_.smallest_residual = norm;
    present_.last_residual = norm;
    present_.smallest_residual = std::min(present_.smallest_residual, norm);
    return;
  }
  if (present_.not_finite) return;
  if (previous != nullptr && std::isfinite(previous->getNormF()))
    present_.peak = largest_row(group.problem().model, BeamVector::of(previous->getF()), previous->scales());
  present_.not_finite = origin_of(group, previous, iteration);
}

void AttemptLog::failed(const BeamGroup& group, int iterations) {
  const BeamProblem& problem = group.problem();
  present_.step = steps_ + 1;
  present_.load_factor = problem.model.clock().load_factor(group.load_factor());
  present_.iterations = iterations;
  present_.linear_solver = problem.last_failure;
  const bool has_origin = present_.not_finite && present_.not_finite->source != NotFinite::Source::increment;
  if (has_origin || (present_.not_finite && problem.last_failure.empty()))
    present_.end = AttemptEnd::not_finite;
  else
    present_.end = problem.last_failure.empty() ? AttemptEnd::iterations_used_up : AttemptEnd::linear_solver;
  if (present_.end != AttemptEnd::not_finite) present_.not_finite.reset();
  if (!problem.objection.empty()) {
    present_.end = AttemptEnd::refused;
    present_.refused_because = problem.objection;
  }
  if (!present_.peak && group.isF())
    present_.peak = largest_row(problem.model, BeamVector::of(group.getF()), group.scales());
  if (group.isF()) present_.end_angle = largest_end_angle(problem.model, group.point());
  add(present_);
  if (observer_) observer_({present_.step, present_.load_factor, iterations, cause_text(present_)});
}

void AttemptLog::refused(double load_factor, const std::string& cause) {
  FailedAttempt attempt;
  attempt.step = steps_ + 1;
  attempt.load_factor = load_factor;
  attempt.end = AttemptEnd::refused;
  attempt.refused_because = cause;
  add(attempt);
}

void AttemptLog::add(const FailedAttempt& attempt) {
  ++failures_;
  if (attempts_.size() == kMostKept) attempts_.erase(attempts_.begin());
  attempts_.push_back(attempt);
}

}  // namespace mixbeam
