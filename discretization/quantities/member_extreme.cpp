#include "discretization/quantities/member_extreme.hpp"

#include "discretization/geometry/vector_algebra.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>

namespace mixbeam {

namespace {

/// A peak between two samples rises above the larger of them by an eighth of the second difference where the field is a
/// parabola. So much more is allowed for before an element is left out of the search.
constexpr double kPeakOverSecondDifference = 2.0;

/// Elements whose upper bound exceeds the best sample by less than this (relative) are skipped: a tenth of the digits
/// that are promised, and what Newton's method leaves of a force that is the same in ten thousand elements.
constexpr double kNegligible = 1e-11;

/// The search of a peak by parabolas ends where a step changes the value by less, or its place by less of the element.
constexpr double kSettledValue = 1e-13, kSettledPlace = 1e-9;
constexpr int kMostParabolas = 40;

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

/// Samples of one element: those of a record, from `first` on, or taken here.
struct ElementSamples {
  const MemberSamples* record = nullptr;
  std::size_t first = 0;
  std::vector<PointSample> points{};
  bool has_points = false;       ///< whether `points` are those of this element
  std::vector<double> values{};  ///< of the field that is looked at, and what searches ask of them
  double highest = 0.0, lowest = 0.0, second_difference = 0.0;
  bool has_nan = false;

  void build() {
    for (std::size_t i = 0; i < points.size() && !has_points; ++i) points[i] = sample_in(*record, first + i);
    has_points = true;
  }
  void look_at(const FieldAlongMember& field, int member) {
    values.resize(points.size());
    if (record != nullptr && field.recorded != nullptr) {
      const Vector3* const vectors = (record->*field.recorded).data() + first;
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = vectors[i][field.component];
    } else {
      build();
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = field.at(points[i], member);
    }
    highest = -HUGE_VAL, lowest = HUGE_VAL, second_difference = 0.0, has_nan = false;
    for (std::size_t i = 0; i < values.size(); ++i) {
      has_nan = has_nan || std::isnan(values[i]);
      highest = std::max(highest, values[i]), lowest = std::min(lowest, values[i]);
      if (i > 0 && i + 1 < values.size())
        second_difference = std::max(second_difference, std::abs(values[i - 1] - 2.0 * values[i] + values[i + 1]));
    }
  }
};

class Search {
 public:
  Search(const Model& model, const State& state, const ExtremeRequest& request, ForceComponents components)
      : model_(model), state_(state), request_(request), components_(components) {}

  const ExtremeRequest& request() const { return request_; }

  /// Keeps the best sample, and the element where its peaks may be higher. `samples`: equidistant ones along an
  /// element, both ends included, whose values are those of the field.
  void look_at(int member, int element, const ElementSamples& samples) {
    if (samples.has_nan) return take(std::numeric_limits<double>::quiet_NaN(), member, element, 0.0);
    const std::size_t points = samples.values.size();
    const double highest = request_.sign > 0.0 ? samples.highest : -samples.lowest;
    for (std::size_t i = 0; i < points && !(highest <= best_.value); ++i)
      take(request_.sign * samples.values[i], member, element,
           -1.0 + 2.0 * static_cast<double>(i) / static_cast<double>(points - 1));
    const double bound = highest + kPeakOverSecondDifference * samples.second_difference;
    if (may_raise_best(bound)) candidates_.push_back({member, element, bound});
  }

  /// What a layer at the end of an element has in closed form.
  void look_at(const EndLayer& layer) {
    const bool is_asked = std::count(request_.members.begin(), request_.members.end(), layer.member) > 0;
    if (is_asked && layer.is_known && model_.mesh().members.keeps(static_cast<std::size_t>(layer.member)))
      take(request_.sign * request_.field.at(layer.sample, layer.member), layer.member, layer.element, -layer.side);
  }

  MemberExtreme result() {
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.bound > b.bound; });
    for (const Candidate& candidate : candidates_) {
      if (!may_raise_best(candidate.bound)) break;
      refine(candidate);
    }
    return best_;
  }

 private:
  struct Candidate {
    int member = 0, element = 0;  ///< element within the member
    double bound = 0.0;           ///< no value in it is larger
  };

  bool may_raise_best(double bound) const { return bound > best_.value + kNegligible * std::abs(best_.value); }

  void take(double value, int member, int element, double xi) {
    const bool is_first = best_.member < 0;
    if (!is_first && !(value > best_.value) && !std::isnan(value)) return;
    if (std::isnan(best_.value) && !is_first) return;
    const MeshMember& mesh = model_.mesh().members[member];
    best_ = {value, member, mesh.arc_length(element, xi), xi <= -1.0 ? 1 : (xi >= 1.0 ? -1 : 0)};
  }

  double at(const Candidate& place, double xi) const {
    const int element = model_.mesh().members[place.member].first_element + place.element;
    const int local = model_.structure().local_element(element);
    const PointSample sample = sample_element(model_.structure(), model_.mesh(), state_, local, xi, components_);
    return request_.sign * request_.field.at(sample, place.member);
  }

  /// Every peak among samples twice as dense as the coarse ones, to the last digits.
  void refine(const Candidate& place) {
    const int order = model_.scene().members[place.member].order;
    const int points = 2 * smooth_points(order) - 1;
    std::vector<double> xi(points), value(points);
    for (int i = 0; i < points; ++i) {
      xi[i] = -1.0 + 2.0 * i / (points - 1);
      value[i] = at(place, xi[i]);
      take(value[i], place.member, place.element, xi[i]);
    }
    for (int i = 0; i < points; ++i) {
      const bool left = i == 0 || value[i] >= value[i - 1], right = i + 1 == points || value[i] >= value[i + 1];
      if (!left || !right) continue;
      const int middle = std::clamp(i, 1, points - 2);
      climb(place, {xi[middle - 1], xi[middle], xi[middle + 1]}, {value[middle - 1], value[middle], value[middle + 1]});
    }
  }

  /// The top of the parabola through three points; not a number where they lie on a line.
  static double top_of(const std::array<double, 3>& x, const std::array<double, 3>& f) {
    const double before = x[1] - x[0], after = x[1] - x[2];
    const double rise = before * (f[1] - f[2]), fall = after * (f[1] - f[0]);
    return x[1] - 0.5 * (before * rise - after * fall) / (rise - fall);
  }

  /// The field has one peak near the three places x. Where it is at an end of the element, the sample there is the
  /// best.
  void climb(const Candidate& place, std::array<double, 3> x, std::array<double, 3> f) {
    for (int step = 0; step < kMostParabolas; ++step) {
      const double top = top_of(x, f);
      if (!(top > x[0] && top < x[2]) || std::abs(top - x[1]) < kSettledPlace) return;
      const double value = at(place, top);
      take(value, place.member, place.element, top);
      const double change = std::abs(value - f[1]);
      const bool is_before = top < x[1];
      if (value > f[1]) {
        (is_before ? x[2] : x[0]) = x[1];
        (is_before ? f[2] : f[0]) = f[1];
        x[1] = top;
        f[1] = value;
      } else {
        (is_before ? x[0] : x[2]) = top;
        (is_before ? f[0] : f[2]) = value;
      }
      if (change <= kSettledValue * std::abs(f[1])) return;
    }
  }

  const Model& model_;
  const State& state_;
  const ExtremeRequest& request_;
  ForceComponents components_;
  MemberExtreme best_{-HUGE_VAL};
  std::vector<Candidate> candidates_;
};

/// The best of all ranks; of equal ones the first along the scene.
MemberExtreme best_of_ranks(const Teuchos::Comm<int>& comm, const MemberExtreme& mine) {
  if (comm.getSize() == 1) return mine;
  const std::array<double, 4> own = {mine.value, static_cast<double>(mine.member), mine.arc_length,
                                     static_cast<double>(mine.side)};
  std::vector<double> all(4 * static_cast<std::size_t>(comm.getSize()));
  Teuchos::gatherAll(comm, 4, own.data(), static_cast<int>(all.size()), all.data());
  MemberExtreme best;
  for (std::size_t i = 0; i < all.size(); i += 4) {
    const MemberExtreme other{all[i], static_cast<int>(all[i + 1]), all[i + 2], static_cast<int>(all[i + 3])};
    if (other.member < 0) continue;
    const bool is_first = std::make_pair(other.member, other.arc_length) < std::make_pair(best.member, best.arc_length);
    const bool is_better = best.member < 0 || other.value > best.value || std::isnan(other.value);
    if (is_better || (other.value == best.value && is_first)) best = other;
  }
  return best;
}

/// Hands the samples of every element of some members to whoever asks for them.
class ElementWalk {
 public:
  ElementWalk(const Model& model, const State& state, const SampledMembers* samples, ForceComponents components)
      : model_(model), state_(state), samples_(samples), components_(components) {}

  template <class Action>
  void operator()(int member, const Action& action) {
    const std::size_t m = static_cast<std::size_t>(member);
    if (!model_.mesh().members.keeps(m)) return;
    const int points = smooth_points(model_.scene().members[m].order);
    const MemberSamples* const record = samples_ != nullptr ? samples_->find(member) : nullptr;
    const bool is_sampled = record != nullptr && record->points_per_element >= points;
    is_sampled ? walk_record(*record, action) : walk_elements(model_.mesh().members[m], points, action);
  }

 private:
  template <class Action>
  void walk_record(const MemberSamples& record, const Action& action) {
    const std::size_t points = static_cast<std::size_t>(record.points_per_element);
    element_.record = &record;
    element_.points.resize(points);
    for (element_.first = 0; element_.first + points <= record.size(); element_.first += points) {
      element_.has_points = false;
      action(record.element[element_.first], element_);
    }
  }
  template <class Action>
  void walk_elements(const MeshMember& member, int points, const Action& action) {
    element_.record = nullptr;
    element_.points.resize(static_cast<std::size_t>(points));
    for (int e = 0; e < member.elements; ++e) {
      const int element = member.first_element + e;
      if (!answers_for(model_.structure(), element)) continue;
      const int local = model_.structure().local_element(element);
      for (int i = 0; i < points; ++i)
        element_.points[static_cast<std::size_t>(i)] = sample_element(model_.structure(), model_.mesh(), state_, local,
                                                                      -1.0 + 2.0 * i / (points - 1), components_);
      element_.has_points = true;
      action(e, element_);
    }
  }

  const Model& model_;
  const State& state_;
  const SampledMembers* samples_;
  ForceComponents components_;
  ElementSamples element_{};
};

}  // namespace

std::vector<MemberExtreme> largest_along_members(const Model& model, const State& state,
                                                 const std::vector<ExtremeRequest>& requests,
                                                 const SampledMembers* samples, const std::vector<EndLayer>* layers) {
  const ForceComponents components = layers == nullptr ? ForceComponents::material : ForceComponents::spatial;
  std::vector<Search> searches;
  std::vector<std::size_t> search_of;  // (request)
  std::map<std::tuple<std::string, double, std::vector<int>>, std::size_t> known;
  std::map<int, std::map<std::string, std::vector<std::size_t>>> of_member;  // in the order of the scene, by fields
  for (const ExtremeRequest& request : requests) {
    const auto [found, is_new] =
        known.emplace(std::make_tuple(request.field.name, request.sign, request.members), searches.size());
    search_of.push_back(found->second);
    if (!is_new) continue;
    for (const int member : request.members) of_member[member][request.field.name].push_back(searches.size());
    searches.emplace_back(model, state, request, components);
  }
  ElementWalk walk(model, state, samples, components);
  for (const auto& [member, wanted] : of_member)
    walk(member, [&, m = member, &of_field = wanted](int element, ElementSamples& points) {
      for (const auto& [name, interested] : of_field) {
        points.look_at(searches[interested.front()].request().field, m);
        for (const std::size_t i : interested) searches[i].look_at(m, element, points);
      }
    });
  std::vector<MemberExtreme> found;
  for (Search& search : searches) {
    for (std::size_t i = 0; layers != nullptr && i < layers->size(); ++i) search.look_at((*layers)[i]);
    found.push_back(best_of_ranks(*model.map()->getComm(), search.result()));
    if (found.back().member < 0) found.back().value = std::numeric_limits<double>::quiet_NaN();
  }
  std::vector<MemberExtreme> extremes;
  for (const std::size_t i : search_of) extremes.push_back(found[i]);
  return extremes;
}

}  // namespace mixbeam
