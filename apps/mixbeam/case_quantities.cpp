#include "apps/mixbeam/case_quantities.hpp"

#include "apps/common/run/followed_points.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/scene/merged_scene.hpp"

#include <algorithm>

namespace mixbeam {

CaseQuantities::CaseQuantities(const Application& app, BatchOutput output, const std::string& load_case) {
  if (output == BatchOutput::expected) take_expected(app, load_case);
  if (output == BatchOutput::followed) take_followed(app);
  if (output == BatchOutput::quantities) quantities_ = app.quantities;
  if (output == BatchOutput::quantities && quantities_.empty())
    throw app.xml.source.error({"Batch", "Output"}, "value \"quantities\", but the list \"Quantities\" holds nothing");
  names_ = quantities_.names();
}

/// Motion and reactions of the points that the monitor of a run follows.
void CaseQuantities::take_followed(const Application& app) {
  std::vector<Quantity> followed;
  for (const std::string& point : followed_points(app.scene))
    for (const std::string kind : {"displacement", "rotation", "reaction force", "reaction moment"}) {
      const auto is_here = [&point](const Support& support) { return support.point == point; };
      const bool is_held = std::any_of(app.scene.supports.begin(), app.scene.supports.end(), is_here);
      if (kind.rfind("reaction", 0) == 0 && !is_held) continue;
      Quantity& one = followed.emplace_back();
      one.kind = kind;
      one.point = point;
      one.name = point + "." + kind;
      std::replace(one.name.begin() + static_cast<std::ptrdiff_t>(point.size()), one.name.end(), ' ', '_');
    }
  quantities_ = QuantitySet(followed, app.scene, {app.xml.source, {}});
}

void CaseQuantities::take_expected(const Application& app, const std::string& load_case) {
  std::vector<Quantity> common;
  for (const ExpectedValue& value : app.expected) {
    if (value.load_case != load_case || !value.word.empty()) continue;  // every case tells whether it is stable
    const char* own_place = value.critical_point ? "Critical Point" : "Load Factor";
    if (value.critical_point || value.load_factor.value_or(app.scene.stages) != app.scene.stages)
      throw app.xml.source.error({"Expected", value.name, own_place},
                                 "a batch evaluates the ends of paths; allowed with \"Output\" = \"expected\" in "
                                 "\"Batch\": no value, or that of the end");
    if (value.is_asked)
      throw app.xml.source.error(
          {"Expected", value.name, "Quantity"},
          "value \"" + value.quantity +
              "\" of the list \"Quantities\"; allowed in a batch with \"Output\" = \"expected\": "
              "quantities of points, sections and energies (\"Output\" = \"quantities\" writes "
              "those of the list)");
    expected_.push_back(value);
    common.push_back(quantity_of(value));
  }
  if (common.empty())
    throw app.xml.source.error({"Batch", "Output"}, "value \"expected\", but the list \"Expected\" holds nothing");
  quantities_ = QuantitySet(common, app.scene, {app.xml.source, {"Expected"}});
  names_ = quantities_.names();
}

std::vector<double> CaseQuantities::of(const SolvedCases& solved, int part) const {
  const Simulation& simulation = solved.simulation;
  const auto i = static_cast<std::size_t>(part);
  QuantityState at{simulation.model(), simulation.state(), simulation.load_factor(),
                   solved.reactions,   solved.energies[i], simulation.stability().negative};
  at.first_member = solved.first_member[i];
  at.first_support = solved.first_support[i];
  if (solved.merged) at.prefix_of_points = MergedScene::name_in_part(part, "");
  return quantities_.values(at);
}

}  // namespace mixbeam
