#include "apps/mixbeam/batch_cases.hpp"

#include "apps/common/run/followed_points.hpp"
#include "apps/common/run/quantity_values.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/scene/merged_scene.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

constexpr std::size_t kNotAsked = ~std::size_t{0};
constexpr double kRoundingOfStage = 1e-9;  // steps are sums of rounded numbers

QuantityState state_of(const SolvedCases& solved, int part) {
  const Simulation& simulation = solved.simulation;
  const auto i = static_cast<std::size_t>(part);
  QuantityState at{simulation.model(), simulation.state(), simulation.load_factor(),
                   solved.reactions,   solved.energies[i], simulation.stability().negative};
  at.first_member = solved.first_member[i];
  at.first_support = solved.first_support[i];
  if (solved.merged) at.prefix_of_points = MergedScene::name_in_part(part, "");
  at.layers = solved.layers;
  if (!solved.merged) at.natural_frequency = simulation.natural_frequency();
  return at;
}

}  // namespace

CaseQuantities::CaseQuantities(const Application& app, BatchOutput output, const std::string& load_case) {
  const std::vector<QuantitySet::Column>& asked = app.quantities.columns();
  const Scene& scene = app.scene;
  const int stages = alternatives(scene).empty() ? scene.stages : scene_of_case(scene, load_case).stages;
  for (const QuantitySet::Column& column : asked) {
    const Quantity& quantity = app.quantities.asked(column);
    is_limited_.push_back(column.is_limited && quantity.is_limited_in(load_case));
    if (!is_limited_.back()) continue;
    const bool is_early = quantity.stage.value_or(stages) < stages;
    if (is_early)
      throw app.xml.source.error({"Quantities", quantity.name, "Stage"},
                                 "value " + std::to_string(*quantity.stage) + ": a batch looks at the ends of paths; " +
                                     "allowed in it: the last stage, " + std::to_string(stages));
    limits_.push_back({column.name, *quantity.allowed(), column.quantity, quantity.relative_to});
  }
  if (!limits_.empty()) asked_ = app.quantities;
  if (output == BatchOutput::expected) take_expected(app, load_case);
  if (output == BatchOutput::followed) take_followed(app);
  if (output != BatchOutput::quantities) return;
  if (asked.empty())
    throw app.xml.source.error({"Batch", "Output"}, "value \"quantities\", but the list \"Quantities\" holds nothing");
  asked_ = app.quantities;
  names_ = asked_.names();
  for (const Member& member : app.scene.members) members_.push_back(member.name);
  for (std::size_t i = 0; i < names_.size(); ++i) asked_columns_.push_back(i);
}

/// Selects motion and reactions of the points that the monitor of a run follows.
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
  names_ = quantities_.names();
  asked_columns_.assign(names_.size(), kNotAsked);
}

void CaseQuantities::take_expected(const Application& app, const std::string& load_case) {
  std::vector<Quantity> common;
  for (const ExpectedValue& value : app.expected) {
    if (value.load_case != load_case || !value.word.empty()) continue;  // stability is a column of every case
    const char* own_place = value.critical_point ? "Critical Point" : "Load Factor";
    if (value.critical_point || value.load_factor.value_or(app.scene.stages) != app.scene.stages)
      throw app.xml.source.error({"Expected", value.name, own_place},
                                 "a batch evaluates the ends of paths; allowed with \"Output\" = \"expected\" in "
                                 "\"Batch\": no value, or that of the end");
    expected_.push_back(value);
    names_.push_back(value.name);
    asked_columns_.push_back(kNotAsked);
    if (!value.is_asked) {
      common.push_back(quantity_of(value));
      continue;
    }
    asked_ = app.quantities;
    const std::vector<std::string> asked = asked_.names();
    asked_columns_.back() =
        static_cast<std::size_t>(std::find(asked.begin(), asked.end(), value.quantity) - asked.begin());
  }
  if (expected_.empty())
    throw app.xml.source.error({"Batch", "Output"}, "value \"expected\", but the list \"Expected\" holds nothing");
  quantities_ = QuantitySet(common, app.scene, {app.xml.source, {"Expected"}});
}

std::string CaseQuantities::member_of(std::size_t name, double value) const {
  const std::size_t column = asked_columns_[name];
  const bool is_member = !members_.empty() && column != kNotAsked && asked_.columns()[column].is_member;
  return is_member && value >= 0.0 ? members_.at(static_cast<std::size_t>(value)) : "";
}

bool CaseQuantities::needs_path() const {
  return std::any_of(limits_.begin(), limits_.end(), [](const Limit& limit) { return limit.relative_to.has_value(); });
}

bool CaseQuantities::is_reference(double load_factor) const {
  return std::any_of(limits_.begin(), limits_.end(), [&](const Limit& limit) {
    return limit.relative_to && std::abs(load_factor - *limit.relative_to) <= kRoundingOfStage;
  });
}

std::vector<double> CaseQuantities::asked_of(const SolvedCases& solved, int part) const {
  return asked_.values(state_of(solved, part));
}

CaseValues CaseQuantities::of(const SolvedCases& solved, const RicherCases& richer, int part,
                              const References& references) const {
  const QuantityState at = state_of(solved, part);
  const std::vector<double> own = quantities_.values(at), asked = asked_.values(at);
  CaseValues values;
  values.written.reserve(asked_columns_.size());
  auto next = own.begin();
  for (const std::size_t column : asked_columns_)
    values.written.push_back(column == kNotAsked ? *next++ : asked[column]);
  std::vector<QuantityState> there;
  for (const SolvedCases& state : richer.states) there.push_back(state_of(state, part));
  if (limits_.empty()) return values;
  const std::vector<EstimatedValue> estimated = with_errors(asked_, asked, there, richer.not_estimated);
  auto one = estimated.begin();
  for (std::size_t i = 0; i < is_limited_.size(); ++i) {
    if (is_limited_[i]) {
      const std::optional<Stage>& since = limits_[values.limited.size()].relative_to;
      const double reference = since ? references.at(*since)[static_cast<std::size_t>(part)][i] : 0.0;
      values.limited.push_back(*one);
      if (std::isfinite(reference) || since.value_or(0) > 0) values.limited.back().value -= reference;
    }
    if (asked_.columns()[i].is_value) ++one;
  }
  if (there.empty() && richer.not_estimated.empty())
    for (EstimatedValue& limited : values.limited) limited.error = 0.0;
  return values;
}

}  // namespace mixbeam
