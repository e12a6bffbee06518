#include "apps/mixbeam/case_quantities.hpp"

#include "apps/common/run/expected_quantity.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/scene/merged_scene.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

const char* const kAxes[3] = {"x", "y", "z"};

Vector3 to_array(const Vec3<double>& v) { return {v[0], v[1], v[2]}; }

std::string name_of(const SolvedCases& solved, int part, const std::string& name) {
  return solved.merged ? MergedScene::name_in_part(part, name) : name;
}

}  // namespace

CaseQuantities::CaseQuantities(const Application& app, BatchOutput output, const std::string& load_case) {
  for (const Support& support : app.scene.supports) support_points_.push_back(support.point);
  for (const Member& member : app.scene.members) member_names_.push_back(member.name);
  if (output == BatchOutput::followed) {
    points_ = followed_points(app.scene);
    for (const std::string& point : points_)
      for (const char* quantity : {"displacement", "rotation", "reaction_force", "reaction_moment"}) {
        const bool is_reaction = std::string(quantity).rfind("reaction", 0) == 0;
        if (is_reaction && std::count(support_points_.begin(), support_points_.end(), point) == 0) continue;
        for (const char* axis : kAxes) names_.push_back(point + "." + quantity + "." + axis);
      }
    return;
  }
  for (const ExpectedValue& value : app.expected) {
    if (value.load_case != load_case || !value.word.empty()) continue;  // every case tells whether it is stable
    const char* own_place = value.critical_point ? "Critical Point" : "Load Factor";
    if (value.critical_point || value.load_factor.value_or(app.scene.stages) != app.scene.stages)
      throw app.xml.source.error({"Expected", value.name, own_place},
                                 "a batch evaluates the ends of paths; allowed with \"Output\" = \"expected\" in "
                                 "\"Batch\": no value, or that of the end");
    expected_.push_back(value);
    names_.push_back(value.name);
  }
  if (names_.empty())
    throw app.xml.source.error({"Batch", "Output"}, "value \"expected\", but the list \"Expected\" holds nothing");
}

std::vector<double> CaseQuantities::of(const SolvedCases& solved, int part) const {
  std::vector<double> values;
  for (const ExpectedValue& value : expected_) values.push_back(present_value(solved, part, value));
  const auto append = [&values](const Vector3& v) { values.insert(values.end(), v.begin(), v.end()); };
  for (const std::string& point : points_) {
    const std::string name = name_of(solved, part, point);
    append(solved.simulation.displacement(name));
    append(solved.simulation.rotation(name));
    Vector3 force{}, moment{};
    bool is_held = false;
    for (std::size_t i = 0; i < support_points_.size(); ++i) {
      if (support_points_[i] != point) continue;
      is_held = true;
      const Reaction& reaction = solved.reactions[solved.first_support[part] + i];
      for (int c = 0; c < 3; ++c) {
        force[c] += reaction.force[c];
        moment[c] += reaction.moment[c];
      }
    }
    if (!is_held) continue;
    append(force);
    append(moment);
  }
  return values;
}

double CaseQuantities::present_value(const SolvedCases& solved, int part, const ExpectedValue& wanted) const {
  const std::string& quantity = wanted.quantity;
  const StrainEnergy& energy = solved.energies[part];
  if (quantity == "strain energy") return energy.force + energy.moment;
  if (quantity == kMomentEnergyName) return energy.moment;
  if (quantity == "reaction force" || quantity == "reaction moment") {
    const auto support = std::find(support_points_.begin(), support_points_.end(), wanted.point);
    const Reaction& reaction = solved.reactions[solved.first_support[part] + (support - support_points_.begin())];
    return component_of(quantity == "reaction force" ? reaction.force : reaction.moment, wanted.component);
  }
  if (quantity == "material force" || quantity == "material moment") {
    const auto member = std::find(member_names_.begin(), member_names_.end(), wanted.member) - member_names_.begin();
    const Simulation& simulation = solved.simulation;
    const PointSample sample = sample_member(simulation.model(), simulation.state(),
                                             solved.first_member[part] + static_cast<int>(member), wanted.position);
    return component_of(to_array(quantity == "material force" ? sample.force : sample.moment), wanted.component);
  }
  ExpectedValue here = wanted;
  here.point = name_of(solved, part, wanted.point);
  return *mixbeam::present_value(solved.simulation, here);
}

}  // namespace mixbeam
