#include "discretization/state/member_samples.hpp"

#include <algorithm>
#include <utility>

namespace mixbeam {

SampledMembers::SampledMembers(std::vector<MemberSamples> all) : held_(std::move(all)) {
  for (MemberSamples& member : held_) number(member);
}

void SampledMembers::number(SampledMember& member) {
  member.number = static_cast<int>(members_);
  member.first_sample = samples_;
  add_absent(member.share.rows, member.elements);
}

void SampledMembers::add_absent(std::size_t samples, int elements) {
  ++members_;
  samples_ += samples;
  elements_ += static_cast<std::size_t>(elements);
}

void SampledMembers::add_absent(SampledMember member) {
  number(member);
  absent_.push_back(std::move(member));
}

void SampledMembers::add(MemberSamples member) {
  number(member);
  held_.push_back(std::move(member));
}

const MemberSamples* SampledMembers::find(int number) const {
  const auto found = std::lower_bound(held_.begin(), held_.end(), number,
                                      [](const MemberSamples& member, int wanted) { return member.number < wanted; });
  return found != held_.end() && found->number == number ? &*found : nullptr;
}

namespace {

StateShare without_rows(const StateShare& state) {
  StateShare kept{{}, state.vertices, state.elements, state.interior};
  kept.held.in_plane = state.held.in_plane;
  return kept;
}

/// Copies only the summary.
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
  kept.vibration = record.vibration;
  for (RecordedVibrationMode& mode : kept.vibration) mode.mode.clear();
  if (record.error_estimate) kept.error_estimate = summary_of<ErrorSummary>(*record.error_estimate);
  kept.gradients = record.gradients;
  kept.state = without_rows(record.state);
  return kept;
}

}  // namespace mixbeam
