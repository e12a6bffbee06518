#include "discretization/quantities/quantity_place.hpp"

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <set>

namespace mixbeam {

namespace {

int index_of(const Scene& scene, const Member* member) { return static_cast<int>(member - scene.members.data()); }

}  // namespace

QuantityPlaces::QuantityPlaces(const Scene& scene) : scene_(scene), names_(scene) {
  std::set<std::string> seen;
  const auto add = [&](const std::string& point) {
    if (seen.insert(point).second) points_.push_back(point);
  };
  for (const std::string& point : names_.point_names())
    if (names_.members_at(point) != nullptr) add(point);
  for (const Member& member : scene.members)
    for (const InnerPoint& inner : member.inner_points) add(inner.point);
}

std::vector<QuantityPlace> QuantityPlaces::places(const std::string& text, const InputPlace& place) const {
  std::vector<QuantityPlace> found;
  if (names_.members_at(text) != nullptr) return {{text, text}};
  for (const std::string& point : names_meant(text, points_)) found.push_back({point, point});
  if (found.empty() && text.find('@') != std::string::npos) return along_members(text, place);
  if (found.empty() && names_.has_point(text) && place.source().has_mistakes()) throw InputError("");  // of members
  if (found.empty()) throw unknown_name(place, "point", text, points_);
  return found;
}

std::vector<QuantityPlace> QuantityPlaces::places_in_members(const std::string& text, const InputPlace& place) const {
  std::vector<QuantityPlace> found = places(text, place);
  for (QuantityPlace& one : found) {
    if (one.point.empty()) continue;
    const std::vector<const Member*>& members = *names_.members_at(one.point);
    if (members.size() > 1)
      throw place.error("value \"" + excerpt(text) + "\": several members meet at the point \"" + one.point +
                        "\"; allowed for a quantity of a section: MEMBER@s, MEMBER@p%");
    const Member& member = *members.front();
    one.member = index_of(scene_, &member);
    one.position = member.end_point == one.point ? 1.0 : 0.0;
    for (const InnerPoint& inner : member.inner_points)
      if (inner.point == one.point) one.position = inner.position;
    one.point.clear();
  }
  return found;
}

std::vector<int> QuantityPlaces::members(const std::string& text, const InputPlace& place) const {
  if (const Member* const member = names_.member(text)) return {index_of(scene_, member)};
  std::vector<int> found;
  const std::vector<std::string> known = names_.member_names();
  for (const std::string& name : names_meant(text, known)) found.push_back(index_of(scene_, names_.member(name)));
  if (found.empty()) throw unknown_name(place, "member", text, known);
  return found;
}

std::vector<QuantityPlace> QuantityPlaces::supported(const std::string& text, const InputPlace& place) const {
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

QuantityPlace QuantityPlaces::at(int member, double position) const {
  return {scene_.members[static_cast<std::size_t>(member)].name + "@" + shortest(100.0 * position) + "%", "", member,
          position};
}

std::vector<QuantityPlace> QuantityPlaces::along_members(const std::string& text, const InputPlace& place) const {
  const std::size_t sign = text.rfind('@');
  std::string written = text.substr(sign + 1);
  const bool is_share = !written.empty() && written.back() == '%';
  if (is_share) written.pop_back();
  double number = 0.0;
  if (written.empty() || !parse_number(written, number).empty() || !(number >= 0.0))
    throw place.error("value \"" + excerpt(text) + "\"; allowed after @: an arc length from the start of the member, " +
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

double QuantityPlaces::length_of(const Member& member) const {
  const auto position = [this](const std::string& point) {
    return names_.has_point(point) ? names_.position(point) : Vector3{};
  };
  return make_reference_curve(member, position(member.start_point), position(member.end_point)).length;
}

}  // namespace mixbeam
