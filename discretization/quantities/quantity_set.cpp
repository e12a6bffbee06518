#include "discretization/quantities/quantity_set.hpp"

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/quantities/member_extreme.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>

namespace mixbeam {

namespace {

using vector_algebra::to_array;
using vector_algebra::to_vec3;

constexpr const char* kArcLength = ".arc_length";

/// Numbers of a quantity: a scalar is the first, a vector the first three; a triad is g1, g2, g3.
using Numbers = std::array<double, 9>;

/// Index that means the norm of the vector.
constexpr int kNorm = -1;

Numbers not_there() {
  Numbers numbers;
  numbers.fill(std::numeric_limits<double>::quiet_NaN());
  return numbers;
}
Numbers numbers_from(const Vector3& v) { return {v[0], v[1], v[2]}; }
/// The columns of a rotation matrix.
Numbers numbers_from(const Mat3<double>& axes) {
  Numbers numbers{};
  for (int i = 0; i < 9; ++i) numbers[static_cast<std::size_t>(i)] = axes(i % 3, i / 3);
  return numbers;
}
double picked(const Numbers& numbers, int which) {
  return which == kNorm ? std::hypot(numbers[0], numbers[1], numbers[2]) : numbers[static_cast<std::size_t>(which)];
}

/// Indices of the Numbers that a quantity requests.
std::vector<int> asked_numbers(const Quantity& quantity) {
  static const std::map<std::string, std::vector<int>> of_component = {
      {"x", {0}}, {"y", {1}},        {"z", {2}},        {"1", {0}},        {"2", {1}},
      {"3", {2}}, {"norm", {kNorm}}, {"g1", {0, 1, 2}}, {"g2", {3, 4, 5}}, {"g3", {6, 7, 8}}};
  if (!quantity.component.empty()) return of_component.at(quantity.component);
  const QuantityKind& kind = quantity_kind(quantity.kind);
  if (kind.is(QuantitySource::triad)) return {0, 1, 2, 3, 4, 5, 6, 7, 8};
  if (kind.is_vector()) return {0, 1, 2};
  return {0};
}

/// Endings of the names of asked_numbers().
std::vector<std::string> endings_of(const Quantity& quantity) {
  const std::size_t count = asked_numbers(quantity).size();
  if (count == 1) return {""};
  if (count == 9) return {".g1.x", ".g1.y", ".g1.z", ".g2.x", ".g2.y", ".g2.z", ".g3.x", ".g3.y", ".g3.z"};
  if (quantity_kind(quantity.kind).is_material()) return {".1", ".2", ".3"};
  return {".x", ".y", ".z"};
}

/// NaN comes first.
bool is_better(Take take, double value, double than) {
  if (std::isnan(value) || std::isnan(than)) return !std::isnan(than);
  if (take == Take::largest) return value > than;
  if (take == Take::smallest) return value < than;
  return std::abs(value) > std::abs(than);
}

/// Share of a member within which a place counts as a vertex.
constexpr double kAtVertex = 1e-9;

/// Layer at this place of a member, on the requested side of a vertex; null: none.
const EndLayer* layer_at(const QuantityState& at, int member, double arc_length, bool before_vertex) {
  if (at.layers == nullptr) return nullptr;
  const double length = at.model.mesh().member_length[static_cast<std::size_t>(member)];
  const double rounding = kAtVertex * length;
  const bool ends_there = (before_vertex && arc_length > rounding) || arc_length > length - rounding;
  for (const EndLayer& layer : *at.layers)
    if (layer.member == member && (layer.side < 0) == ends_there &&
        std::abs(layer.vertex_arc_length() - arc_length) <= rounding)
      return &layer;
  return nullptr;
}

std::invalid_argument without_derivative(const std::string& what) {
  return std::invalid_argument(what + " has no derivative here");
}

Vec vec_from(const Numbers& numbers) { return {{numbers[0], numbers[1], numbers[2]}}; }

/// Relative step of a difference of fourth order, and share of the largest number for one that is nearly zero.
constexpr double kStepOfFormula = 1e-3, kLeastOfFormula = 1e-3;

/// Derivative at `middle` of a function of one number by a difference of fourth order.
template <typename F>
double slope_at(double middle, double size, F&& function) {
  const double step = kStepOfFormula * (size > 0.0 ? size : 1.0);
  const auto at = [&](double steps) { return function(middle + steps * step); };
  return (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
}

double slope_of(const Expression& formula, std::vector<double> values, std::size_t i) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return slope_at(values[i], std::max(std::abs(values[i]), kLeastOfFormula * largest), [&](double value) {
    values[i] = value;
    return formula(values);
  });
}

}  // namespace

std::string name_in_formulas(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) != 0 ? "_" + name : name;
}

constexpr double kRoundingOfLength = 1e-9;  ///< share of a member by which a written arc length may exceed it

/// A point, or a place along a member.
struct QuantityPlace {
  std::string label{};                 ///< as the user would write it: "tip", "rod@50%"
  std::string point{};                 ///< name; empty: a place along a member
  int member = -1;                     ///< in the scene
  double position = 0.0;               ///< arc length over length of the member
  std::optional<double> arc_length{};  ///< requested arc length in place of that share [length]
};

/// Resolves names of places and members in a scene.
class QuantityPlaces {
 public:
  /// The scene must outlive it.
  explicit QuantityPlaces(const Scene& scene) : scene_(scene), names_(scene) {
    std::set<std::string> seen;
    const auto add = [&](const std::string& point) {
      if (seen.insert(point).second) points_.push_back(point);
    };
    for (const std::string& point : names_.point_names())
      if (names_.members_at(point) != nullptr) add(point);
    for (const Member& member : scene.members)
      for (const InnerPoint& inner : member.inner_points) add(inner.point);
  }

  /// Resolves `text` (a point, MEMBER@s, MEMBER@p%, or a pattern of either). Throws InputError at `place`.
  std::vector<QuantityPlace> places(const std::string& text, const InputPlace& place) const {
    std::vector<QuantityPlace> found;
    if (names_.members_at(text) != nullptr) return {{text, text}};
    for (const std::string& point : names_meant(text, points_)) found.push_back({point, point});
    if (found.empty() && text.find('@') != std::string::npos) return along_members(text, place);
    if (found.empty() && names_.has_point(text) && place.source().has_mistakes()) throw InputError("");  // of members
    if (found.empty()) throw unknown_name(place, "point", text, points_);
    return found;
  }

  /// Resolves `text` to places on members, for quantities of a section: a point must have one member only.
  std::vector<QuantityPlace> places_in_members(const std::string& text, const InputPlace& place) const {
    std::vector<QuantityPlace> found = places(text, place);
    for (QuantityPlace& one : found) {
      if (one.point.empty()) continue;
      const std::vector<const Member*>& members = *names_.members_at(one.point);
      if (members.size() > 1)
        throw place.error("value \"" + excerpt(text) + "\": several members meet at the point \"" + one.point +
                          "\"; allowed for a quantity of a section: MEMBER@s, MEMBER@p%");
      const Member& member = *members.front();
      one.member = index_of(&member);
      one.position = member.end_point == one.point ? 1.0 : 0.0;
      for (const InnerPoint& inner : member.inner_points)
        if (inner.point == one.point) one.position = inner.position;
      one.point.clear();
    }
    return found;
  }

  /// Members that a name or pattern matches.
  std::vector<int> members(const std::string& text, const InputPlace& place) const {
    if (const Member* const member = names_.member(text)) return {index_of(member)};
    std::vector<int> found;
    const std::vector<std::string> known = names_.member_names();
    for (const std::string& name : names_meant(text, known)) found.push_back(index_of(names_.member(name)));
    if (found.empty()) throw unknown_name(place, "member", text, known);
    return found;
  }

  /// Supported points that a name or pattern matches.
  std::vector<QuantityPlace> supported(const std::string& text, const InputPlace& place) const {
    std::vector<std::string> points;
    std::set<std::string> seen;
    for (const Support& support : scene_.supports)
      if (seen.insert(support.point).second) points.push_back(support.point);
    std::vector<QuantityPlace> found;
    for (const std::string& point : names_meant(text, points)) found.push_back({point, point});
    if (found.empty())
      throw place.error("value \"" + excerpt(text) + "\" has no support, so no reaction; allowed: " +
                        quoted_list(points) + did_you_mean(text, points));
    return found;
  }

  /// The place `position` (arc length over length) of a member.
  QuantityPlace at(int member, double position) const {
    return {scene_.members[static_cast<std::size_t>(member)].name + "@" + shortest(100.0 * position) + "%", "", member,
            position};
  }

 private:
  int index_of(const Member* member) const { return static_cast<int>(member - scene_.members.data()); }

  std::vector<QuantityPlace> along_members(const std::string& text, const InputPlace& place) const {
    const std::size_t sign = text.rfind('@');
    std::string written = text.substr(sign + 1);
    const bool is_share = !written.empty() && written.back() == '%';
    if (is_share) written.pop_back();
    double number = 0.0;
    if (written.empty() || !parse_number(written, number).empty() || !(number >= 0.0))
      throw place.error("value \"" + excerpt(text) +
                        "\"; allowed after @: an arc length from the start of the member, " +
                        "or a share of its length as 50%");
    std::vector<QuantityPlace> found;
    for (const int index : members(text.substr(0, sign), place)) {
      const Member& member = scene_.members[static_cast<std::size_t>(index)];
      const double length = is_share ? 100.0 : length_of(member);
      if (number > length * (1.0 + kRoundingOfLength))
        throw place.error("value \"" + excerpt(text) + "\" is beyond the end of \"" + member.name +
                          "\"; allowed: up to " + shortest(length) + (is_share ? "%" : ""));
      found.push_back({member.name + text.substr(sign), "", index, std::min(1.0, number / length)});
      if (!is_share) found.back().arc_length = number;
    }
    return found;
  }

  double length_of(const Member& member) const {
    const auto position = [this](const std::string& point) {
      return names_.has_point(point) ? names_.position(point) : Vector3{};
    };
    return make_reference_curve(member, position(member.start_point), position(member.end_point)).length;
  }

  const Scene& scene_;
  SceneNames names_;
  std::vector<std::string> points_{};  ///< on members
};

/// A quantity with all names resolved.
struct QuantitySet::Resolved {
  Resolved(const Quantity& quantity) : asked(quantity), kind(quantity_kind(quantity.kind)) {}

  Quantity asked;
  const QuantityKind& kind;
  std::vector<QuantityPlace> places{};
  std::vector<QuantityPlace> others{}, corners{};    ///< of distance and angle: one each
  std::vector<std::vector<std::size_t>> supports{};  ///< of each place, for reactions
  std::vector<int> members{};                        ///< of extremes along whole ones
  std::vector<int> numbers{};
  Expression formula{};
  std::vector<double> pinned_place{};  ///< of a pinned extreme along members, as in its columns

  bool is_along_members() const { return !members.empty(); }
  bool is_of_whole() const { return places.empty() || !others.empty(); }  ///< or of two and three places together

  /// Finds the places and members that a quantity names.
  void find_places(const Scene& scene, const QuantityPlaces& found, const InputPlace& place) {
    const bool is_of_two = !asked.other_point.empty();
    if (kind.is(QuantitySource::reaction)) {
      places = found.supported(asked.point, place["Point"]);
      std::map<std::string, std::vector<std::size_t>> at_point;
      for (std::size_t i = 0; i < scene.supports.size(); ++i) at_point[scene.supports[i].point].push_back(i);
      for (const QuantityPlace& point : places) supports.push_back(at_point.at(point.point));
    } else if (!asked.point.empty()) {
      const bool is_of_section = kind.is(QuantitySource::section) || kind.is(QuantitySource::stress);
      places = is_of_section ? found.places_in_members(asked.point, place["Point"])
                             : found.places(asked.point, place["Point"]);
    }
    if (is_of_two) others = found.places(asked.other_point, place["Other Point"]);
    if (!asked.corner.empty()) corners = found.places(asked.corner, place["Corner"]);
    for (const auto& [some, parameter] :
         {std::make_pair(&places, "Point"), std::make_pair(&others, "Other Point"), std::make_pair(&corners, "Corner")})
      if (is_of_two && some->size() > 1)
        throw place[parameter].error("stands for several places; allowed for the quantity \"" + asked.kind + "\": one");
    if (!asked.member.empty()) find_in_members(found, place);
    if (kind.is(QuantitySource::stress)) require_stresses(scene, place[asked.member.empty() ? "Point" : "Member"]);
  }

  Numbers at(std::size_t place, const QuantityState& at) const {
    if (kind.is(QuantitySource::length))
      return {deformed_length(at.model, at.state, at.first_member + places[place].member)};
    if (!kind.is(QuantitySource::reaction)) return at_place(places[place], at);
    Numbers sum{};
    for (const std::size_t support : supports[place]) {
      const Vector3& v = at.reactions[at.first_support + support].*kind.reaction;
      for (int i = 0; i < 3; ++i) sum[i] += v[i];
    }
    if (kind.reaction != &RecordedReaction::moment || at.layers == nullptr || !is_clamped(place, at)) return sum;
    const int vertex = vertex_of(at.model.mesh(), at.prefix_of_points + places[place].point);
    for (const EndLayer& layer : *at.layers)
      for (int i = 0; i < 3; ++i)
        if (layer.vertex == vertex && layer.is_known) sum[i] -= layer.side * layer.surplus[i];
    return sum;
  }

  Numbers at_place(const QuantityPlace& place, const QuantityState& at) const {
    if (place.point.empty()) {
      const int member = at.first_member + place.member;
      double position = place.position;
      if (place.arc_length) {  // cases of a batch may have other lengths
        position = *place.arc_length / at.model.mesh().member_length[member];
        if (position > 1.0 + kRoundingOfLength) return not_there();
        position = std::min(1.0, position);
      }
      PointSample sample = sample_member(at.model, at.state, member, position, asked.before_vertex,
                                         at.layers == nullptr ? ForceComponents::material : ForceComponents::spatial);
      if (const EndLayer* const layer = layer_at(at, member, sample.arc_length, asked.before_vertex))
        sample = layer->sample;
      if (kind.is(QuantitySource::stress)) return {stress_at(at, member, sample)};
      if (kind.field != nullptr) return section_at(at, member, position, sample);
      return kind.is(QuantitySource::triad) ? numbers_from(rotation_matrix(sample.triad))
                                            : numbers_from(to_array(sample.position));
    }
    const int vertex = vertex_of(at.model.mesh(), at.prefix_of_points + place.point);
    const std::array<double, 6> motion = vertex_motion(at.model, at.state, vertex);
    if (kind.name == "displacement") return {motion[0], motion[1], motion[2]};
    if (kind.name == "rotation") return {motion[3], motion[4], motion[5]};
    if (kind.is(QuantitySource::triad))
      return numbers_from(rotation_matrix(exp_quaternion(Vec3<double>{{motion[3], motion[4], motion[5]}})));
    const Vector3 reference = reference_position(at.model, vertex);
    return {reference[0] + motion[0], reference[1] + motion[1], reference[2] + motion[2]};
  }

  /// Value from the rank that has this place of the member.
  Numbers section_at(const QuantityState& at, int member, double position, const PointSample& sample) const {
    Numbers mine{}, all{};
    if (answers_for(at.model, member, position, asked.before_vertex))
      mine = numbers_from(kind.field(sample, at.model.mesh().members[member]));
    const Teuchos::Comm<int>& comm = *at.model.map()->getComm();
    if (comm.getSize() == 1) return mine;
    Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, static_cast<int>(mine.size()), mine.data(), all.data());
    return all;
  }

  double stress_at(const QuantityState& at, int member, const PointSample& sample) const {
    const KnownSection section = at.stresses->of(static_cast<std::size_t>(member)).at(sample.arc_length);
    if (!section.stresses) return std::numeric_limits<double>::quiet_NaN();
    return kind.stress(section.stresses->largest({to_array(sample.force), to_array(sample.moment)}),
                       section.strength.value_or(0.0));
  }

  ExtremeRequest request(const QuantityState& at) const {
    ExtremeRequest request;
    for (const int member : members) request.members.push_back(at.first_member + member);
    request.take = asked.take;
    request.field.at = [this, &at](const PointSample& sample, int member) {
      if (kind.field == nullptr) return stress_at(at, member, sample);
      return picked(numbers_from(kind.field(sample, at.model.mesh().members[member])), numbers[0]);
    };
    if (numbers[0] == kNorm) return request;
    request.field.recorded = kind.recorded;
    request.field.component = static_cast<std::size_t>(numbers[0]);
    return request;
  }

  /// Value of kinds that have no place, or two or three.
  Numbers whole(const QuantityState& at) const {
    if (kind.of_structure != nullptr) return {kind.of_structure(at)};
    if (kind.is(QuantitySource::mode))
      return {at.natural_frequency ? at.natural_frequency(asked.mode) : std::numeric_limits<double>::quiet_NaN()};
    const auto position = [&](const QuantityPlace& place) {
      const Numbers p = at_place(place, at);
      return Vector3{p[0], p[1], p[2]};
    };
    using namespace vector_algebra;
    if (corners.empty()) return {norm(difference(position(others[0]), position(places[0])))};
    const Vector3 corner = position(corners[0]);
    const Vector3 a = difference(position(places[0]), corner), b = difference(position(others[0]), corner);
    constexpr double kNoSide = 1e-13;  // of the length of the structure: rounding
    const double shorter = std::min(norm(a), norm(b));
    if (shorter <= kNoSide * at.model.structure().length) return {std::numeric_limits<double>::quiet_NaN()};
    return {std::atan2(norm(cross(a, b)), dot(a, b))};
  }

  bool is_extreme_of_places() const {
    return places.size() > 1 && !is_of_whole() && asked.take != Take::each && asked.take != Take::sum;
  }
  /// Value reduced over several places, and the index of an extreme.
  std::pair<Numbers, std::size_t> taken(const QuantityState& state) const {
    Numbers total = at(0, state);
    std::size_t best = 0;
    for (std::size_t i = 1; i < places.size(); ++i) {
      const Numbers next = at(i, state);
      if (asked.take == Take::sum)
        for (std::size_t j = 0; j < total.size(); ++j) total[j] += next[j];
      else if (is_better(asked.take, picked(next, numbers[0]), picked(total, numbers[0])))
        std::tie(total, best) = std::tuple(next, i);
    }
    return {total, best};
  }

  /// Adds the derivative of weights . at().
  void add_derivative(std::size_t place, const Numbers& weights, const QuantityState& at, StateDerivative& sum) const {
    if (kind.is(QuantitySource::length)) return sum.add_length(at.first_member + places[place].member, weights[0]);
    if (kind.is(QuantitySource::reaction)) return add_of_reaction(place, vec_from(weights), at, sum);
    add_derivative(places[place], weights, at, sum);
  }

  void add_derivative(const QuantityPlace& place, const Numbers& weights, const QuantityState& at,
                      StateDerivative& sum) const {
    if (!place.point.empty()) {
      const int vertex =
          at.model.structure().partition.place(vertex_of(at.model.mesh(), at.prefix_of_points + place.point));
      if (kind.name == "rotation") return sum.add_rotation_vector(vertex, vec_from(weights));
      if (!kind.is(QuantitySource::triad)) return sum.add_displacement(vertex, vec_from(weights));
      Mat of_axes;
      for (int i = 0; i < 9; ++i) of_axes(i / 3, i % 3) = weights[static_cast<std::size_t>(i)];
      return sum.add_triad(vertex, of_axes);
    }
    const int member = at.first_member + place.member;
    const double length = at.model.mesh().member_length[static_cast<std::size_t>(member)];
    const double position = place.arc_length ? std::min(1.0, *place.arc_length / length) : place.position;
    const auto in_element = place_in_element(at.model, member, position, asked.before_vertex);
    if (!in_element) throw without_derivative("a place of another process");
    if (kind.is(QuantitySource::section) || kind.is(QuantitySource::stress))
      return add_of_section(*in_element, member, weights, at, sum);
    if (kind.name != "rotation" && !kind.is(QuantitySource::triad))
      return sum.add_displacement(*in_element, vec_from(weights));
    const PointSample sample =
        sample_element(at.model.structure(), at.model.mesh(), at.state, in_element->local_element, in_element->xi);
    if (kind.name == "rotation") {
      const Vec theta =
          log_quaternion(sample.triad * conjugate(at.model.mesh().members[member].curve.triad(sample.arc_length)));
      return sum.add_spin(*in_element, transpose_times(inverse_tangent_map(theta), vec_from(weights)));
    }
    const Mat triad = rotation_matrix(sample.triad);
    Vec spin{};
    for (int j = 0; j < 3; ++j) {
      const std::size_t of_axis = 3 * static_cast<std::size_t>(j);
      spin += cross(Vec{{triad(0, j), triad(1, j), triad(2, j)}},
                    Vec{{weights[of_axis], weights[of_axis + 1], weights[of_axis + 2]}});
    }
    sum.add_spin(*in_element, spin);
  }

  /// Adds the derivative of numbers of N, M and the triad, by differences of fourth order: exact for linear functions;
  /// stresses are searched over a section.
  void add_of_section(const PlaceInElement& place, int member, const Numbers& weights, const QuantityState& at,
                      StateDerivative& sum) const {
    const Structure& structure = at.model.structure();
    const PointSample sample = sample_element(structure, at.model.mesh(), at.state, place.local_element, place.xi);
    const auto value = [&](const Vec& force, const Vec& moment) {
      PointSample moved = sample;
      moved.force = force;
      moved.moment = moment;
      if (kind.is(QuantitySource::stress)) return weights[0] * stress_at(at, member, moved);
      set_strains(structure, at.model.mesh(), place.local_element, moved);
      return dot(vec_from(weights), to_vec3(kind.field(moved, at.model.mesh().members[member])));
    };
    const double sizes[2] = {norm(sample.force), norm(sample.moment)};
    Vec by[2]{};
    for (int part = 0; part < 2; ++part)
      for (int i = 0; i < 3; ++i) {
        Vec stress[2] = {sample.force, sample.moment};
        by[part][i] = slope_at(stress[part][i], sizes[part], [&](double number) {
          stress[part][i] = number;
          return value(stress[0], stress[1]);
        });
      }
    sum.add_stress(place, by[0], by[1]);
    if (kind.name.find("strain") != std::string::npos || kind.name.find("curvature") != std::string::npos)
      sum.know_compliance();
    if (kind.name.rfind("spatial ", 0) != 0) return;
    sum.add_spin(place, cross(to_vec3(kind.field(sample, at.model.mesh().members[member])), vec_from(weights)));
  }

  /// Adds a derivative: displacement springs give their force; other held rows are those of the equations.
  void add_of_reaction(std::size_t place, const Vec& weight, const QuantityState& at, StateDerivative& sum) const {
    const bool is_moment = kind.reaction == &RecordedReaction::moment;
    for (const VertexSupport& support : at.model.conditions().supports) {
      const std::size_t index = static_cast<std::size_t>(support.index) - at.first_support;
      if (std::count(supports[place].begin(), supports[place].end(), index) == 0) continue;
      if (is_moment && support.rotation_kind != SupportRotation::free &&
          support.rotation_kind != SupportRotation::fixed)
        throw without_derivative("the reaction moment of a support that holds some rotations, not all,");
      HeldRows held{support.vertex};
      if (is_moment && support.rotation_kind == SupportRotation::fixed) held.moment = weight;
      for (int i = 0; i < 3 && !is_moment; ++i) {
        const Vec axis{{support.axes(i, 0), support.axes(i, 1), support.axes(i, 2)}};
        const Vec along = dot(axis, weight) * axis;
        if (support.fixed[i])
          held.force += along;
        else
          sum.add_displacement(support.vertex, -support.displacement_stiffness[i] * along);
      }
      if (norm(held.force) + norm(held.moment) > 0.0) sum.add_held(held);
    }
  }

  /// Adds the derivative of kinds that have no place, or two or three.
  void add_of_whole(double weight, const QuantityState& at, StateDerivative& sum) const {
    if (kind.name == "load factor") return;
    if (kind.is(QuantitySource::mode)) return sum.know_mode(asked.mode);
    if (kind.name.find("energy") != std::string::npos)
      return sum.add_energy(kind.name == "moment energy" ? 0.0 : weight, kind.name == "force energy" ? 0.0 : weight);
    if (!kind.is(QuantitySource::between)) throw without_derivative("the quantity \"" + kind.name + "\"");
    const auto position = [&](const QuantityPlace& place) { return vec_from(at_place(place, at)); };
    const auto add = [&](const QuantityPlace& place, const Vec& by) {
      add_derivative(place, numbers_from(to_array(weight * by)), at, sum);
    };
    const Vec a = position(places[0]), b = position(others[0]);
    if (corners.empty()) {
      const double distance = norm(b - a);
      if (!(distance > 0.0)) throw without_derivative("a distance of zero");
      add(others[0], (1.0 / distance) * (b - a));
      return add(places[0], (1.0 / distance) * (a - b));
    }
    const Vec corner = position(corners[0]), normal = cross(a - corner, b - corner);
    if (!(norm(normal) > 0.0)) throw without_derivative("an angle of 0 or pi");
    const Vec n = (1.0 / norm(normal)) * normal;
    const Vec by_a = (1.0 / dot(a - corner, a - corner)) * cross(a - corner, n);
    const Vec by_b = (1.0 / dot(b - corner, b - corner)) * cross(n, b - corner);
    add(places[0], by_a);
    add(others[0], by_b);
    add(corners[0], -(by_a + by_b));
  }

  /// Whether it is taken at the end of an element with a layer of unknown form, or inside any element with a layer.
  bool is_hidden(const QuantityState& at) const {
    const bool is_of_section = kind.is(QuantitySource::section) || kind.is(QuantitySource::stress);
    if (!is_of_section && kind.reaction != &RecordedReaction::moment) return false;
    const Mesh& mesh = at.model.mesh();
    return std::any_of(at.layers->begin(), at.layers->end(), [&](const EndLayer& layer) {
      const int member = layer.member - at.first_member;
      if (std::count(members.begin(), members.end(), member) > 0) return !layer.is_known;
      return std::any_of(places.begin(), places.end(), [&](const QuantityPlace& place) {
        if (!place.point.empty())
          return (!layer.is_known || !is_clamped(static_cast<std::size_t>(&place - places.data()), at)) &&
                 layer.vertex == vertex_of(mesh, at.prefix_of_points + place.point);
        const double length = mesh.member_length[static_cast<std::size_t>(layer.member)];
        const double arc_length = place.arc_length.value_or(place.position * length);
        const double inside = layer.side * (arc_length - layer.vertex_arc_length()), rounding = kAtVertex * length;
        if (place.member != member || inside < -rounding || inside > layer.length - rounding) return false;
        return inside > rounding || !layer.is_known;
      });
    });
  }

  /// Whether one support there holds all rotations: it takes every moment of the layers that end at it.
  bool is_clamped(std::size_t place, const QuantityState& at) const {
    return std::any_of(supports[place].begin(), supports[place].end(), [&](std::size_t support) {
      const auto& fixed = at.model.scene().supports[at.first_support + support].rotation_fixed;
      return fixed[0] && fixed[1] && fixed[2];
    });
  }

 private:
  void find_in_members(const QuantityPlaces& found, const InputPlace& place) {
    for (const int member : found.members(asked.member, place["Member"])) {
      QuantityPlace at = found.at(member, asked.position.value_or(0.0));
      const bool is_whole = kind.is(QuantitySource::length);
      if (is_whole) at.label = at.label.substr(0, at.label.rfind('@'));
      if (is_whole || asked.position)
        places.push_back(at);
      else
        members.push_back(member);
    }
  }

  /// Removes members and places without stresses; something must be left.
  void require_stresses(const Scene& scene, const InputPlace& place) {
    const auto is_without = [&](int member) {
      return !has_stress(scene, scene.members[static_cast<std::size_t>(member)], asked.kind);
    };
    members.erase(std::remove_if(members.begin(), members.end(), is_without), members.end());
    places.erase(
        std::remove_if(places.begin(), places.end(), [&](const QuantityPlace& at) { return is_without(at.member); }),
        places.end());
    const bool needs_strength = kind.needs_strength();
    if (members.empty() && places.empty())
      throw place.error("no member there has a section of known shape" +
                        std::string(needs_strength ? " and strength" : "") + ", so no " + kind.name +
                        "; allowed: sections given by \"Shape\" and \"Material\", or with \"Stress Points\"" +
                        (needs_strength ? ", and \"Strength\"" : ""));
  }
};

QuantitySet::QuantitySet() : resolved_(std::make_shared<std::vector<Resolved>>()) {}

QuantitySet::QuantitySet(const std::vector<Quantity>& quantities, const Scene& scene, const InputPlace& place)
    : QuantitySet() {
  if (quantities.empty()) return;
  const QuantityPlaces found(scene);  // an index of the whole scene
  place.source().collect([&] {
    for (std::size_t i = 0; i < quantities.size(); ++i) {
      const InputPlace own = place[quantities[i].name];
      own.attempt([&] {
        if (quantities[i].kind != "formula")
          resolve(quantities[i], i, scene, found, own);
        else if (!place.source().has_mistakes())  // in the quantities that it names
          add_formula(quantities[i], i, own);
      });
    }
  });
}

std::vector<std::string> QuantitySet::names() const {
  std::vector<std::string> all;
  for (const Column& column : columns_) all.push_back(column.name);
  return all;
}

const Quantity& QuantitySet::asked(const Column& column) const { return (*resolved_)[column.quantity].asked; }

std::vector<std::string> QuantitySet::units(const std::string& scene_units) const {
  const std::size_t comma = scene_units.find(',');
  if (comma == std::string::npos) return {};
  const std::string length = trimmed(scene_units.substr(0, comma)), force = trimmed(scene_units.substr(comma + 1));
  std::vector<std::string> found;
  for (const Column& column : columns_) {
    const bool is_length = !column.is_value && column.name.rfind(kArcLength) != std::string::npos;
    const QuantityKind& kind = (*resolved_)[column.quantity].kind;
    found.push_back(is_length ? length : column.is_value ? kind.unit_of(length, force) : "");
  }
  return found;
}

void QuantitySet::resolve(const Quantity& quantity, std::size_t index, const Scene& scene, const QuantityPlaces& found,
                          const InputPlace& place) {
  Resolved one(quantity);
  one.numbers = asked_numbers(quantity);
  one.find_places(scene, found, place);
  if (quantity.take != Take::each || one.is_of_whole())
    add_columns(quantity, index, "");
  else
    for (const QuantityPlace& p : one.places)
      add_columns(quantity, index, one.places.size() == 1 ? "" : "[" + p.label + "]");
  if (one.is_along_members())
    for (const char* ending : {".member", kArcLength, ".side"})
      columns_.push_back({quantity.name + ending, index, false, std::string(ending) == ".member"});
  resolved_->push_back(std::move(one));
}

void QuantitySet::add_columns(const Quantity& quantity, std::size_t index, const std::string& place) {
  for (const std::string& ending : endings_of(quantity))
    columns_.push_back({quantity.name + place + ending, index, true, false, quantity.allowed().has_value()});
}

void QuantitySet::add_formula(const Quantity& quantity, std::size_t index, const InputPlace& place) {
  std::vector<std::string> variables;
  for (const Column& column : columns_) {
    variables.push_back(name_in_formulas(column.name));
    if (std::count(variables.begin(), variables.end(), variables.back()) > 1)
      throw place.error("two quantities above it would both be " + variables.back() +
                        " in a formula; allowed: names that differ in letters and digits");
  }
  Resolved one(quantity);
  one.numbers = {0};
  one.formula = checked_formula(quantity.formula, variables, place["Formula"]);
  add_columns(quantity, index, "");
  resolved_->push_back(std::move(one));
}

std::vector<std::string> QuantitySet::places(const QuantityState& state) const {
  QuantityState at = state;
  at.stresses = std::make_shared<StressedSections>(at.model.scene(), at.model.mesh());
  std::vector<std::string> found;
  for (const Column& column : columns_) {
    const Resolved& one = (*resolved_)[column.quantity];
    found.push_back(one.is_extreme_of_places() ? one.places[one.taken(at).second].label : "");
  }
  return found;
}

std::vector<unsigned char> QuantitySet::hidden_in_layers(const QuantityState& at) const {
  std::vector<unsigned char> hidden;
  for (const Column& column : columns_) {
    const Resolved& one = (*resolved_)[column.quantity];
    const bool is_of_last = !hidden.empty() && columns_[hidden.size() - 1].quantity == column.quantity;
    if (is_of_last)
      hidden.push_back(hidden.back());
    else if (one.kind.is(QuantitySource::formula))
      hidden.push_back(std::count(hidden.begin(), hidden.end(), 1) > 0);
    else
      hidden.push_back(one.is_hidden(at));
  }
  return hidden;
}

std::vector<double> QuantitySet::values(const QuantityState& state) const {
  if (empty()) return {};
  QuantityState at = state;
  at.stresses = std::make_shared<StressedSections>(at.model.scene(), at.model.mesh());
  std::vector<ExtremeRequest> requests;
  for (const Resolved& one : *resolved_)
    if (one.is_along_members()) requests.push_back(one.request(at));
  const auto extremes = extremes_along_members(at.model, at.state, requests, at.samples, at.layers);
  auto found = extremes.begin();
  std::vector<double> values;
  values.reserve(columns_.size());
  const auto add = [&values](const Resolved& one, const Numbers& numbers) {
    for (const int which : one.numbers) values.push_back(picked(numbers, which));
  };
  for (const Resolved& one : *resolved_) {
    if (one.kind.is(QuantitySource::formula)) {
      values.push_back(one.formula(values));
    } else if (one.is_along_members()) {
      const MemberExtreme& best = *found++;
      values.insert(values.end(), {best.value, static_cast<double>(best.member - at.first_member), best.arc_length,
                                   static_cast<double>(best.side)});
    } else if (one.is_of_whole()) {
      add(one, one.whole(at));
    } else if (one.asked.take == Take::each) {
      for (std::size_t i = 0; i < one.places.size(); ++i) add(one, one.at(i, at));
      values.insert(values.end(), one.pinned_place.begin(), one.pinned_place.end());
    } else {
      add(one, one.taken(at).first);
    }
  }
  return values;
}

std::size_t QuantitySet::first_column_of(std::size_t quantity) const {
  const auto is_its = [&](const Column& column) { return column.quantity == quantity; };
  return static_cast<std::size_t>(std::find_if(columns_.begin(), columns_.end(), is_its) - columns_.begin());
}

QuantitySet QuantitySet::pinned(const QuantityState& at, const std::vector<double>& values) const {
  QuantitySet fixed = *this;
  fixed.resolved_ = std::make_shared<std::vector<Resolved>>();
  for (std::size_t q = 0; q < resolved_->size(); ++q) {
    Resolved one = (*resolved_)[q];
    if (one.is_along_members()) {
      const std::size_t first = first_column_of(q);
      one.pinned_place = {values[first + 1], values[first + 2], values[first + 3]};
      QuantityPlace place;
      place.member = static_cast<int>(one.pinned_place[0]);
      place.position = one.pinned_place[1] / at.model.mesh().member_length[static_cast<std::size_t>(place.member)];
      one.places = {place};
      one.asked.before_vertex = one.pinned_place[2] < 0.0;
      one.members.clear();
      one.asked.take = Take::each;
    } else if (one.is_extreme_of_places()) {
      const std::size_t best = one.taken(at).second;
      one.places = {one.places[best]};
      if (!one.supports.empty()) one.supports = {one.supports[best]};
      one.asked.take = Take::each;
    }
    fixed.resolved_->push_back(std::move(one));
  }
  return fixed;
}

StateDerivative QuantitySet::derivative(std::size_t column, const QuantityState& state,
                                        const std::vector<double>& values) const {
  QuantityState at = state;
  at.stresses = std::make_shared<StressedSections>(at.model.scene(), at.model.mesh());
  StateDerivative sum(at.model, at.state);
  add_derivative(column, 1.0, at, values, sum);
  return sum;
}

void QuantitySet::add_derivative(std::size_t column, double factor, const QuantityState& at,
                                 const std::vector<double>& values, StateDerivative& sum) const {
  const Column& asked = columns_[column];
  const Resolved& one = (*resolved_)[asked.quantity];
  const std::size_t first = first_column_of(asked.quantity), offset = column - first, width = one.numbers.size();
  if (!asked.is_value) throw without_derivative("the place of an extreme");
  if (one.kind.is(QuantitySource::formula)) {
    const std::vector<double> before(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
    for (std::size_t i = 0; i < first; ++i)
      if (const double slope = slope_of(one.formula, before, i); slope != 0.0)  // NaN too
        add_derivative(i, factor * slope, at, values, sum);
    return;
  }
  if (one.is_of_whole()) return one.add_of_whole(factor, at, sum);
  const int which = one.numbers[offset % width];
  const bool sums = one.asked.take == Take::sum;
  Numbers weights{};
  if (which != kNorm) {
    weights[static_cast<std::size_t>(which)] = factor;
  } else {
    const Numbers value = sums ? one.taken(at).first : one.at(offset / width, at);
    const double norm = picked(value, kNorm);
    if (!(norm > 0.0)) throw without_derivative("a norm that is zero");
    for (std::size_t i = 0; i < 3; ++i) weights[i] = factor * value[i] / norm;
  }
  for (std::size_t place = 0; place < one.places.size(); ++place)
    if (sums || place == offset / width) one.add_derivative(place, weights, at, sum);
}

}  // namespace mixbeam
