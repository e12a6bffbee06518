#include "apps/common/run/value_errors.hpp"

#include "apps/common/run/expected_quantity.hpp"
#include "apps/common/tables/formatted.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// What is left of the error with one order more, beside the difference of both: in 40 structures the true error of the
/// largest stress was at most 1.11 of the estimate.
constexpr double kSafety = 1.5;
/// What Newton's method leaves of a value.
constexpr double kRounding = 1e-10;

constexpr const char* kHidden = "an element is longer than the layer in which its end bends, and no formula tells more";
constexpr const char* kNoNumber = "it is no number with one order more";

Quantity largest(const std::string& kind, const std::string& member) {
  Quantity quantity;
  quantity.name = "largest " + kind;
  quantity.kind = kind;
  quantity.member = member;
  quantity.take = Take::largest;
  if (!is_stress(kind)) quantity.component = "norm";
  return quantity;
}

QuantitySet set_of(const std::vector<Quantity>& quantities, const Scene& scene) {
  static const ParameterSource source;
  return QuantitySet(quantities, scene, {source, {"Quantities"}});
}

/// `present`: of each quantity.
std::vector<EstimatedValue> errors_of(const QuantitySet& set, const std::vector<double>& present,
                                      const Simulation& simulation, const RicherStates& richer) {
  std::vector<double> values(set.columns().size(), std::nan(""));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (set.columns()[i].is_value) values[i] = present[set.columns()[i].quantity];
  return with_errors(set, values, simulation, richer);
}

std::vector<EstimatedValue> section_errors(const Simulation& simulation, const RicherStates& richer,
                                           StepRecord& record) {
  StressSummary& stresses = *record.stresses;
  const QuantitySet forces =
      set_of({largest("material force", "*"), largest("material moment", "*")}, simulation.scene());
  std::vector<EstimatedValue> found = with_errors(forces, values_of(forces, simulation, record), simulation, richer);
  if (stresses.members.empty()) return found;
  std::vector<Quantity> asked = {largest("von Mises stress", "*")};
  std::vector<double> present = {stresses.members.front().stresses.von_mises.value};
  for (const StressedMember& member : stresses.members) {
    asked.push_back(largest("von Mises stress", member.member));
    present.push_back(member.stresses.von_mises.value);
  }
  const bool has_utilisation = !stresses.utilisation.member.empty();
  if (has_utilisation) {
    asked.push_back(largest("utilisation", "*"));
    present.push_back(stresses.utilisation.value);
  }
  const std::vector<EstimatedValue> stress = errors_of(set_of(asked, simulation.scene()), present, simulation, richer);
  found.push_back(stress.front());
  for (std::size_t i = 0; i < stresses.members.size(); ++i) stresses.members[i].estimated = stress[i + 1];
  if (!has_utilisation) return found;
  found.push_back(stress.back());
  if (found.back().is_estimated()) stresses.utilisation.error = found.back().error;
  return found;
}

std::string text_of(const std::vector<EndLayer>& layers, const Scene& scene) {
  if (layers.empty()) return "";
  const auto thinnest = std::max_element(layers.begin(), layers.end(), [](const EndLayer& a, const EndLayer& b) {
    return a.length * b.thickness < b.length * a.thickness;
  });
  return "the end of member \"" + scene.members[static_cast<std::size_t>(thinnest->member)].name +
         formatted("\" bends within sqrt(EI/N) = %.3g, but its element there is %.3g long", thinnest->thickness,
                   thinnest->length) +
         (layers.size() > 1 ? formatted(" (and %zu more such ends)", layers.size() - 1) : "") +
         (thinnest->is_known ? ": section forces and stresses there are too small; their errors are estimated by the "
                               "closed form of that layer"
                             : ": section forces and stresses there are wrong, and not estimated") +
         "; more \"Elements\", or \"Accuracy\" with \"Accuracy Of\" = \"stress\"";
}

}  // namespace

RicherStates::RicherStates(const Simulation& simulation, const ErrorEstimate& estimate)
    : layers(1), not_estimated(estimate.not_estimated) {
  if (!estimate.exists()) return;
  states.push_back(simulation.richer(estimate, layers.front()));
  if (layers.front().empty()) return;
  states.push_back(states.front().at(estimate.richer_state, simulation.load_factor(), simulation.stability()));
  layers.emplace_back();
}

std::vector<EstimatedValue> with_errors(const QuantitySet& set, const std::vector<double>& values,
                                        const std::vector<QuantityState>& richer, const std::string& not_estimated) {
  std::vector<std::vector<double>> better;
  for (const QuantityState& state : richer) better.push_back(set.values(state));
  std::vector<unsigned char> hidden(values.size(), 0);
  if (!richer.empty()) hidden = set.hidden_in_layers(richer.front());
  std::vector<EstimatedValue> all;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!set.columns()[i].is_value) continue;
    EstimatedValue& one = all.emplace_back(EstimatedValue{set.names()[i], values[i]});
    double change = 0.0, before = values[i];  // by one order more, then by layers: they may cancel each other here
    for (auto there = better.rbegin(); there != better.rend(); ++there) {
      const double next = (*there)[i];
      if (!(next == before) && !(std::isnan(next) && std::isnan(before))) change += std::abs(next - before);
      before = next;
    }
    if (!richer.empty() && hidden[i] == 0)
      one.error = change == 0.0 ? 0.0 : kSafety * change + kRounding * std::abs(values[i]);
    if (!one.is_estimated()) one.not_estimated = richer.empty() ? not_estimated : hidden[i] != 0 ? kHidden : kNoNumber;
  }
  return all;
}

std::vector<EstimatedValue> with_errors(const QuantitySet& set, const std::vector<double>& values,
                                        const Simulation& simulation, const RicherStates& richer) {
  std::vector<std::vector<Reaction>> reactions;
  for (const Simulation& state : richer.states) reactions.push_back(state.reactions());
  std::vector<QuantityState> there;
  for (std::size_t i = 0; i < reactions.size(); ++i) {
    const Simulation& state = richer.states[i];
    there.push_back({state.model(), state.state(), state.load_factor(), reactions[i], state.strain_energy(),
                     simulation.stability().negative, simulation.jumps()});
    there.back().layers = &richer.layers[i];
  }
  return with_errors(set, values, there, richer.not_estimated);
}

void add_value_errors(const QuantitySet* quantities, const Simulation& simulation, const ErrorEstimate& estimate,
                      StepRecord& record) {
  if (quantities == nullptr && (!record.stresses || record.stresses->members.empty())) return;
  const RicherStates richer(simulation, estimate);
  ErrorSummary& summary = *record.error_estimate;
  for (const MonitoredQuantity& series : record.monitored)
    if (quantities != nullptr && series.name == kQuantitySeries)
      summary.quantities = with_errors(*quantities, series.components, simulation, richer);
  if (record.stresses) summary.sections = section_errors(simulation, richer, record);
  summary.layers = text_of(richer.layers.front(), simulation.scene());
}

namespace {

double judged_error_of(const std::string& name, const QuantitySet& quantities, const Simulation& simulation,
                       const ErrorEstimate& estimate) {
  const bool is_stress = name == "stress";
  const QuantitySet set = is_stress ? set_of({largest("von Mises stress", "*")}, simulation.scene()) : quantities;
  const std::vector<EstimatedValue> all =
      with_errors(set, values_of(set, simulation), simulation, RicherStates(simulation, estimate));
  auto next = all.begin();
  EstimatedValue worst{name, 0.0, 0.0, ""};
  for (const QuantitySet::Column& column : set.columns()) {
    if (!column.is_value) continue;
    const EstimatedValue& one = *next++;
    if (!is_stress && set.name_of(column) != name) continue;
    if (!one.is_estimated()) return std::nan("");
    worst.value = std::max(worst.value, std::abs(one.value));
    worst.error = std::max(worst.error, one.error);
  }
  return worst.relative();
}

}  // namespace

AccurateRunObserver::ErrorOf error_of_wanted(const Scene& scene, const QuantitySet& quantities) {
  if (scene.accuracy_of.empty()) return {};
  return [&scene, &quantities](const Simulation& simulation, const ErrorEstimate& estimate) {
    return judged_error_of(scene.accuracy_of, quantities, simulation, estimate);
  };
}

}  // namespace mixbeam
