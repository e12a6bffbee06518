/// The part of ConditionReader that reads loads and eigenstrains.

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/parameters/access.hpp"
#include "discretization/parameters/formula.hpp"
#include "discretization/reading/conditions/condition_reader.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/name_pattern.hpp"
#include "discretization/text/nearest_name.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mixbeam {
namespace {

const std::map<std::string, LoadFrame> kFrames = {{"dead", LoadFrame::dead}, {"follower", LoadFrame::follower}};
const std::vector<std::string> kAlongMember = {"s", "x"};
constexpr int kSamplesPerMember = 4;  // intervals: ends, middle, quarters

/// Values of s and x at the ends of the intervals.
std::vector<std::vector<double>> samples_along(double length) {
  std::vector<std::vector<double>> samples;
  for (int k = 0; k <= kSamplesPerMember; ++k) {
    const double x = static_cast<double>(k) / kSamplesPerMember;
    samples.push_back({x * length, x});
  }
  return samples;
}

}  // namespace

void ConditionReader::read_point_loads() {
  const List& loads = scene_list_.sublist("Point Loads");
  for (const std::string& name : names_of(loads)) {
    const List& list = loads.sublist(name);
    const ParameterPath path = child(child(path_, "Point Loads"), name);
    const std::vector<std::string> points = points_meant(list, path);
    check_any_given(list, {"Force", "Moment"}, "loads nothing", path);
    PointLoad load;
    load.force = get_vector(list, "Force");
    load.moment = get_vector(list, "Moment");
    load.frame = translated(list, "Frame", kFrames);
    const std::string member = get_text_or_empty(list, "Member");
    if (load.frame == LoadFrame::dead && list.isParameter("Member")) {
      throw source_.error(child(path, "Member"), "value \"" + excerpt(member) +
                                                     "\" has no meaning for a dead load; allowed: with \"Frame\" = "
                                                     "\"follower\" only");
    }
    const Schedule schedule = read_schedule(list, path);
    schedule.assign_to(load);
    for (const std::string& point : points) {
      load.point = point;
      if (load.frame == LoadFrame::follower) load.member = follower_member(member, point, path);
      scene_.point_loads.push_back(load);
    }
  }
}

/// The one member with one end at the point that `text` means. The load acts on the point: members in a joint there
/// turn without it.
std::string ConditionReader::follower_member(const std::string& text, const std::string& point,
                                             const ParameterPath& path) const {
  const auto joined = joined_at_.find(point);
  const auto is_joined = [&](const std::string& name) {
    return joined != joined_at_.end() && joined->second.count(name) > 0;
  };
  std::vector<std::string> touching;
  for (const Member* candidate : *names_.members_at(point))
    if (has_one_end_at(*candidate, point) && !is_joined(candidate->name)) touching.push_back(candidate->name);
  const std::vector<std::string> meant = names_meant(text, touching);
  if (meant.size() == 1) return meant.front();
  const Member* const member = names_.member(text);
  const bool closed = member != nullptr && member->start_point == point && member->end_point == point;
  const std::string seen = text.empty() ? "missing for a follower load" : "value \"" + excerpt(text) + "\"";
  const std::string problem = closed            ? " has both ends at the point"
                              : is_joined(text) ? " is in a joint at the point, and turns without it"
                              : meant.empty()   ? ""
                                                : " means several of them";
  throw source_.error(child(path, "Member"), seen + problem + "; allowed: a member with one end at \"" +
                                                 excerpt(point) + "\", not in a joint there: " + quoted_list(touching) +
                                                 did_you_mean(text, touching));
}

void ConditionReader::read_distributed_loads() {
  const List& loads = scene_list_.sublist("Distributed Loads");
  for (const std::string& name : names_of(loads)) {
    const List& list = loads.sublist(name);
    const ParameterPath path = child(child(path_, "Distributed Loads"), name);
    const std::vector<const Member*> members = members_meant(list, path);
    check_any_given(list, {"Force", "Couple", "Force Formula", "Couple Formula"}, "loads nothing", path);
    DistributedLoad load;
    read_field(list, "Force", members, load.force, load.force_formula, path);
    read_field(list, "Couple", members, load.couple, load.couple_formula, path);
    load.frame = translated(list, "Frame", kFrames);
    const Schedule schedule = read_schedule(list, path);
    schedule.assign_to(load);
    for (const Member* member : members) {
      load.member = member->name;
      scene_.distributed_loads.push_back(load);
    }
  }
}

void ConditionReader::read_eigenstrains() {
  const List& strains = scene_list_.sublist("Eigenstrains");
  for (const std::string& name : names_of(strains)) {
    const List& list = strains.sublist(name);
    const ParameterPath path = child(child(path_, "Eigenstrains"), name);
    const std::vector<const Member*> members = members_meant(list, path);
    check_any_given(list, {"Strain", "Curvature", "Strain Formula", "Curvature Formula", "Temperature"},
                    "strains nothing", path);
    Eigenstrain strain;
    read_field(list, "Strain", members, strain.strain, strain.strain_formula, path);
    read_field(list, "Curvature", members, strain.curvature, strain.curvature_formula, path);
    add_temperature(list, strain, path);
    const Schedule schedule = read_schedule(list, path);
    schedule.assign_to(strain);
    for (const Member* member : members) {
      strain.member = member->name;
      scene_.eigenstrains.push_back(strain);
    }
  }
}

void ConditionReader::add_temperature(const List& list, Eigenstrain& strain, const ParameterPath& path) const {
  const bool heated = list.isParameter("Temperature");
  if (heated != list.isParameter("Expansion Coefficient")) {
    throw source_.error(child(path, heated ? "Expansion Coefficient" : "Temperature"),
                        "missing; allowed: both \"Temperature\" and \"Expansion Coefficient\", or none");
  }
  if (!heated) return;
  const double expansion = list.get<double>("Temperature") * list.get<double>("Expansion Coefficient");
  if (!std::isfinite(expansion)) throw source_.error(child(path, "Temperature"), "gives a strain beyond all numbers");
  std::string& formula = strain.strain_formula[0];
  if (formula.empty()) {
    strain.strain[0] += expansion;
    return;
  }
  formula = "(" + formula + ") + (" + shortest(expansion) + ")";
  checked_formula(formula, kAlongMember, source_, child(path, "Strain Formula"));  // it may have become too long
}

void ConditionReader::read_field(const List& list, const std::string& name, const std::vector<const Member*>& members,
                                 Vector3& constant, std::array<std::string, 3>& formula,
                                 const ParameterPath& list_path) const {
  constant = get_vector(list, name);
  if (!list.isParameter(name + " Formula")) return;
  const ParameterPath path = child(list_path, name + " Formula");
  if (is_given(list, name)) throw source_.error(path, "given beside \"" + name + "\"; allowed: one of the two");
  const auto& texts = list.get<Teuchos::Array<std::string>>(name + " Formula");
  std::copy(texts.begin(), texts.end(), formula.begin());
  std::vector<Expression> parsed;
  for (const std::string& text : formula) parsed.push_back(checked_formula(text, kAlongMember, source_, path));
  for (const Member* member : members) {
    const std::vector<std::vector<double>> samples = samples_along(length_of(*member));
    for (const Expression& component : parsed) check_finite(component, kAlongMember, samples, source_, path);
  }
}

double ConditionReader::length_of(const Member& member) const {
  try {
    return make_reference_curve(member, names_.position(member.start_point), names_.position(member.end_point)).length;
  } catch (const std::invalid_argument& error) {  // extreme numbers, where the checks of the curve see no fault
    throw source_.error(child(child(path_, "Members"), member.name), error.what());
  }
}

}  // namespace mixbeam
