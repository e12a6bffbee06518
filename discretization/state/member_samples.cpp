#include "discretization/state/member_samples.hpp"

namespace mixbeam {

namespace {

MemberSamples without_rows(const MemberSamples& member) {
  MemberSamples kept;
  kept.name = member.name;
  kept.order = member.order;
  kept.elements = member.elements;
  kept.points_per_element = member.points_per_element;
  kept.share = member.share;
  return kept;
}

StateShare without_rows(const StateShare& state) {
  StateShare kept{{}, state.vertices, state.elements, state.interior};
  kept.held.in_plane = state.held.in_plane;
  return kept;
}

RecordedErrorEstimate without_rows(const RecordedErrorEstimate& estimate) {
  RecordedErrorEstimate kept;
  kept.not_estimated = estimate.not_estimated;
  kept.largest_displacement = estimate.largest_displacement;
  kept.displacement = estimate.displacement;
  kept.moment = estimate.moment;
  kept.energy = estimate.energy;
  kept.points = estimate.points;
  return kept;
}

}  // namespace

RecordedCriticalPoint without_rows(const RecordedCriticalPoint& point) {
  RecordedCriticalPoint kept;
  kept.kind = point.kind;
  kept.load_factor = point.load_factor;
  kept.load_factor_error = point.load_factor_error;
  kept.negative_before = point.negative_before;
  kept.negative_after = point.negative_after;
  kept.modes = point.modes;
  kept.monitored = point.monitored;
  kept.reactions = point.reactions;
  kept.state = without_rows(point.state);
  return kept;
}

StepRecord without_rows(const StepRecord& record) {
  StepRecord kept;
  kept.step = record.step;
  kept.load_factor = record.load_factor;
  kept.newton_iterations = record.newton_iterations;
  kept.residual = record.residual;
  kept.strain_energy = record.strain_energy;
  kept.force_energy = record.force_energy;
  kept.moment_energy = record.moment_energy;
  for (const MemberSamples& member : record.members) kept.members.push_back(without_rows(member));
  kept.monitored = record.monitored;
  kept.reactions = record.reactions;
  kept.balance = record.balance;
  kept.stability = record.stability;
  for (const RecordedCriticalPoint& point : record.critical_points) kept.critical_points.push_back(without_rows(point));
  for (const RecordedBucklingMode& mode : record.buckling)
    kept.buckling.push_back({mode.load_factor, {}, mode.residual, mode.confirmed});
  if (record.error_estimate) kept.error_estimate = without_rows(*record.error_estimate);
  kept.history = record.history;
  kept.state = without_rows(record.state);
  kept.point = record.point;
  return kept;
}

}  // namespace mixbeam
