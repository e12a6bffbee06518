#include "discretization/quantities/member_extreme.hpp"

#include "kernels/math/vector_algebra.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace mixbeam {

namespace {

/// Allowed height of a peak above the larger of two samples, in second differences, before the peak is left out of the
/// search; in a parabola it is an eighth.
constexpr double kPeakOverSecondDifference = 2.0;

/// Peaks whose upper bound exceeds the best sample by less than this (relative) are skipped: a tenth of the promised
/// error, and more than Newton's method leaves of a force that is the same in ten thousand elements.
constexpr double kNegligible = 1e-9;

/// Width of a parabola over the one before it. Through samples of distance h it finds the value of a peak to h^4.
constexpr double kShrink = 0.1;
constexpr int kParabolas = 3;

PointSample sample_in(const MemberSamples& member, std::size_t i) {
  using vector_algebra::to_vec3;
  PointSample sample;
  sample.arc_length = member.arc_length[i];
  sample.reference_position = to_vec3(member.reference_position[i]);
  sample.position = to_vec3(member.position[i]);
  sample.displacement = to_vec3(member.displacement[i]);
  const TriadQuaternion& q = member.triad[i];
  sample.triad = Quaternion<double>{q[0], q[1], q[2], q[3]};
  sample.force = to_vec3(member.material_force[i]);
  sample.moment = to_vec3(member.material_moment[i]);
  sample.force_strain = to_vec3(member.force_strain[i]);
  sample.moment_strain = to_vec3(member.moment_strain[i]);
  return sample;
}

/// Equidistant samples of one element, both ends included: those of a record, from `first` on, or taken here.
struct ElementSamples {
  int member = 0, element = 0;  ///< element within the member
  const MemberSamples* record = nullptr;
  std::size_t first = 0;
  std::vector<PointSample> points{};  ///< empty: not yet made from the record

  void values_of(const FieldAlongMember& field, std::size_t count, std::vector<double>& values) {
    values.resize(count);
    if (record != nullptr && field.recorded != nullptr) {
      const Vector3* const vectors = (record->*field.recorded).data() + first;
      for (std::size_t i = 0; i < count; ++i) values[i] = vectors[i][field.component];
      return;
    }
    for (std::size_t i = points.size(); i < count; ++i) points.push_back(sample_in(*record, first + i));
    for (std::size_t i = 0; i < count; ++i) values[i] = field.at(points[i], member);
  }
};

double rank_of(Take take, double value) {
  if (take == Take::largest_size) return std::abs(value);
  return take == Take::largest ? value : -value;
}

/// NaN comes first; of two values of one size the positive one.
bool is_better(Take take, const MemberExtreme& a, const MemberExtreme& than) {
  if (than.member < 0 || std::isnan(than.value) || std::isnan(a.value))
    return than.member < 0 || !std::isnan(than.value);
  const double rank = rank_of(take, a.value), other = rank_of(take, than.value);
  return rank > other || (rank == other && a.value > than.value);
}

class Search {
 public:
  Search(const Model& model, const State& state, const ExtremeRequest& request, ForceComponents components)
      : model_(model), state_(state), request_(request), components_(components) {}

  /// Keeps the best sample, and the places where peaks between samples may be higher.
  void look_at(ElementSamples& samples, std::size_t count) {
    samples.values_of(request_.field, count, values_);
    const auto at = [&](std::size_t i) { return rank_of(request_.take, values_[i]); };
    for (std::size_t i = 0; i < count; ++i) {
      const double xi = -1.0 + 2.0 * static_cast<double>(i) / static_cast<double>(count - 1);
      take(values_[i], samples.member, samples.element, xi);
      if ((i > 0 && at(i - 1) > at(i)) || (i + 1 < count && at(i + 1) > at(i)) || count < 3) continue;
      const std::size_t middle = std::clamp<std::size_t>(i, 1, count - 2);
      const double bend = std::abs(at(middle - 1) - 2.0 * at(middle) + at(middle + 1));
      const Peak peak{samples.member, samples.element, xi, 2.0 / static_cast<double>(count - 1),
                      at(i) + kPeakOverSecondDifference * bend};
      if (may_raise_best(peak)) peaks_.push_back(peak);
    }
  }

  /// Includes the closed form of a layer at the end of an element.
  void look_at(const EndLayer& layer) {
    const bool is_asked = std::count(request_.members.begin(), request_.members.end(), layer.member) > 0;
    if (is_asked && layer.is_known && model_.mesh().members.keeps(static_cast<std::size_t>(layer.member)))
      take(request_.field.at(layer.sample, layer.member), layer.member, layer.element, -layer.side);
  }

  /// The best of all ranks; of equal ones the first along the scene. Collective.
  MemberExtreme result() {
    std::stable_sort(peaks_.begin(), peaks_.end(), [](const Peak& a, const Peak& b) { return a.bound > b.bound; });
    for (const Peak& peak : peaks_)
      if (may_raise_best(peak)) climb(peak);
    const Teuchos::Comm<int>& comm = *model_.map()->getComm();
    const std::array<double, 4> own = {best_.value, static_cast<double>(best_.member), best_.arc_length,
                                       static_cast<double>(best_.side)};
    std::vector<double> all(own.size() * static_cast<std::size_t>(comm.getSize()));
    Teuchos::gatherAll(comm, static_cast<int>(own.size()), own.data(), static_cast<int>(all.size()), all.data());
    MemberExtreme best{std::numeric_limits<double>::quiet_NaN()};
    for (std::size_t i = 0; i < all.size(); i += own.size()) {
      const MemberExtreme other{all[i], static_cast<int>(all[i + 1]), all[i + 2], static_cast<int>(all[i + 3])};
      if (other.member < 0) continue;
      const bool is_first =
          std::make_pair(other.member, other.arc_length) < std::make_pair(best.member, best.arc_length);
      if (is_better(request_.take, other, best) || (other.value == best.value && is_first)) best = other;
    }
    return best;
  }

 private:
  struct Peak {
    int member = 0, element = 0;
    double xi = 0.0, gap = 0.0;  ///< sample near it, and distance of the samples
    double bound = 0.0;          ///< no value near it has a higher rank
  };

  bool may_raise_best(const Peak& peak) const {
    const double best = rank_of(request_.take, best_.value);
    return peak.bound > best + kNegligible * std::abs(best);
  }

  void take(double value, int member, int element, double xi) {
    if (best_.member >= 0 && rank_of(request_.take, value) < rank_of(request_.take, best_.value)) return;
    const MeshMember& mesh = model_.mesh().members[member];
    const MemberExtreme here{value, member, mesh.arc_length(element, xi), xi <= -1.0 ? 1 : (xi >= 1.0 ? -1 : 0)};
    if (is_better(request_.take, here, best_)) best_ = here;
  }

  /// Fits parabolas through three places, closer together each time. The ends of the element are samples already.
  void climb(const Peak& peak) {
    const int local = model_.structure().local_element(model_.mesh().members[peak.member].first_element + peak.element);
    const auto rank_at = [&](double xi) {
      const double value = request_.field.at(
          sample_element(model_.structure(), model_.mesh(), state_, local, xi, components_), peak.member);
      if (std::abs(xi) < 1.0) take(value, peak.member, peak.element, xi);
      return rank_of(request_.take, value);
    };
    double xi = peak.xi, gap = peak.gap;
    for (int parabola = 0; parabola < kParabolas; ++parabola, gap *= kShrink) {
      const double middle = std::clamp(xi, gap - 1.0, 1.0 - gap);
      const double before = rank_at(std::max(middle - gap, -1.0)), here = rank_at(middle),
                   after = rank_at(std::min(middle + gap, 1.0)), bend = before - 2.0 * here + after;
      xi = middle +
           (bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -1.0, 1.0) : std::copysign(1.0, after - before)) *
               gap;
    }
    rank_at(xi);
  }

  const Model& model_;
  const State& state_;
  const ExtremeRequest& request_;
  ForceComponents components_;
  MemberExtreme best_{};
  std::vector<Peak> peaks_{};
  std::vector<double> values_{};
};

/// Calls action(samples, count) for each element of a member that this rank answers for.
template <class Action>
void for_each_element(const Model& model, const State& state, const SampledMembers* records, int member,
                      ForceComponents components, const Action& action) {
  const std::size_t m = static_cast<std::size_t>(member);
  if (!model.mesh().members.keeps(m)) return;
  const int points = smooth_points(model.scene().members[m].order);
  const MemberSamples* const record = records != nullptr ? records->find(member) : nullptr;
  if (record != nullptr && record->points_per_element >= points) {
    const std::size_t count = static_cast<std::size_t>(record->points_per_element);
    for (std::size_t first = 0; first + count <= record->size(); first += count) {
      ElementSamples samples{member, record->element[first], record, first};
      action(samples, count);
    }
    return;
  }
  const MeshMember& mesh = model.mesh().members[m];
  for (int e = 0; e < mesh.elements; ++e) {
    if (!answers_for(model.structure(), mesh.first_element + e)) continue;
    const int local = model.structure().local_element(mesh.first_element + e);
    ElementSamples samples{member, e};
    for (int i = 0; i < points; ++i)
      samples.points.push_back(
          sample_element(model.structure(), model.mesh(), state, local, -1.0 + 2.0 * i / (points - 1), components));
    action(samples, static_cast<std::size_t>(points));
  }
}

}  // namespace

std::vector<MemberExtreme> extremes_along_members(const Model& model, const State& state,
                                                  const std::vector<ExtremeRequest>& requests,
                                                  const SampledMembers* samples, const std::vector<EndLayer>* layers) {
  const ForceComponents components = layers == nullptr ? ForceComponents::material : ForceComponents::spatial;
  std::vector<Search> searches;
  std::map<int, std::vector<std::size_t>> of_member;  // in the order of the scene
  for (const ExtremeRequest& request : requests) {
    for (const int member : request.members) of_member[member].push_back(searches.size());
    searches.emplace_back(model, state, request, components);
  }
  for (const auto& [member, interested] : of_member)
    for_each_element(model, state, samples, member, components,
                     [&, &wanted = interested](ElementSamples& element, std::size_t count) {
                       for (const std::size_t i : wanted) searches[i].look_at(element, count);
                     });
  std::vector<MemberExtreme> found;
  for (Search& search : searches) {
    for (std::size_t i = 0; layers != nullptr && i < layers->size(); ++i) search.look_at((*layers)[i]);
    found.push_back(search.result());
  }
  return found;
}

}  // namespace mixbeam
