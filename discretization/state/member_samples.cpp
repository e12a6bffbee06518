#include "discretization/state/member_samples.hpp"

namespace mixbeam {

namespace {

StateShare without_rows(const StateShare& state) {
  StateShare kept{{}, state.vertices, state.elements, state.interior};
  kept.held.in_plane = state.held.in_plane;
  return kept;
}

/// The summary alone.
template <class Summary, class Record>
Record summary_of(const Record& record) {
  Record kept;
  static_cast<Summary&>(kept) = record;
  return kept;
}

}  // namespace

RecordedCriticalPoint without_rows(const RecordedCriticalPoint& point) {
  auto kept = summary_of<CriticalPointSummary>(point);
  kept.state = without_rows(point.state);
  return kept;
}

StepRecord without_rows(const StepRecord& record) {
  auto kept = summary_of<StepSummary>(record);
  for (const RecordedCriticalPoint& point : record.critical_points) kept.critical_points.push_back(without_rows(point));
  for (const RecordedBucklingMode& mode : record.buckling)
    kept.buckling.push_back({mode.load_factor, {}, mode.residual, mode.confirmed});
  if (record.error_estimate) kept.error_estimate = summary_of<ErrorSummary>(*record.error_estimate);
  kept.state = without_rows(record.state);
  return kept;
}

}  // namespace mixbeam
