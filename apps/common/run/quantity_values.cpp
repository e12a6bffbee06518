#include "apps/common/run/quantity_values.hpp"

#include "apps/common/tables/formatted.hpp"
#include "discretization/mesh/element_view.hpp"
#include "discretization/text/result_names.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace mixbeam {

namespace {

/// Returns the reactions, which take a sweep over all elements, if some quantity needs them.
std::vector<Reaction> reactions_for(const QuantitySet& quantities, const Simulation& simulation) {
  for (const QuantitySet::Column& column : quantities.columns())
    if (quantity_kind(quantities.asked(column).kind).is(QuantitySource::reaction)) return simulation.reactions();
  return {};
}

/// `reactions`: of the simulation; they must outlive the result.
QuantityState quantity_state_of(const Simulation& simulation, const std::vector<Reaction>& reactions) {
  return {simulation.model(), simulation.state(),         simulation.load_factor(),
          reactions,          simulation.strain_energy(), simulation.stability().negative,
          simulation.jumps()};
}

}  // namespace

std::vector<double> values_of(const QuantitySet& quantities, const Simulation& simulation) {
  if (quantities.empty()) return {};
  const std::vector<Reaction> reactions = reactions_for(quantities, simulation);
  QuantityState at = quantity_state_of(simulation, reactions);
  at.natural_frequency = simulation.natural_frequency();
  return quantities.values(at);
}

std::vector<std::string> places_of(const QuantitySet& quantities, const Simulation& simulation) {
  if (quantities.empty()) return {};
  const std::vector<Reaction> reactions = reactions_for(quantities, simulation);
  return quantities.places(quantity_state_of(simulation, reactions));
}

std::vector<double> values_of(const QuantitySet& quantities, const Simulation& simulation, const StepRecord& record) {
  if (quantities.empty()) return {};
  QuantityState at{simulation.model(),
                   simulation.state(),
                   record.load_factor,
                   record.reactions,
                   StrainEnergy{record.force_energy, record.moment_energy},
                   record.stability.negative,
                   record.point.jumps,
                   &record.members};
  at.natural_frequency = [&](int mode) {
    return mode <= static_cast<int>(record.vibration.size()) ? record.vibration[mode - 1].frequency
                                                             : std::numeric_limits<double>::quiet_NaN();
  };
  return quantities.values(at);
}

std::vector<std::optional<double>> present_values(const Simulation& simulation,
                                                  const std::vector<ExpectedValue>& wanted, const QuantitySet& asked) {
  std::vector<Quantity> quantities;
  bool is_any_asked = false;
  const auto is_common = [](const ExpectedValue& value) {
    const std::vector<std::string>& common = common_quantities();
    return !value.is_asked && std::find(common.begin(), common.end(), value.quantity) != common.end();
  };
  for (const ExpectedValue& value : wanted) {
    is_any_asked = is_any_asked || value.is_asked;
    if (is_common(value)) quantities.push_back(quantity_of(value));
  }
  const ParameterSource source;
  const std::vector<double> common =
      values_of(QuantitySet(quantities, simulation.scene(), {source, {"Expected"}}), simulation);
  const std::vector<std::string> names = asked.names();
  const std::vector<double> numbers = is_any_asked ? values_of(asked, simulation) : std::vector<double>{};
  std::vector<std::optional<double>> values;
  std::size_t next = 0;
  for (const ExpectedValue& value : wanted) {
    std::optional<double>& found = values.emplace_back();
    if (is_common(value)) found = common[next++];
    if (value.is_asked)
      found = numbers[static_cast<std::size_t>(std::find(names.begin(), names.end(), value.quantity) - names.begin())];
  }
  return values;
}

std::optional<double> present_value(const Simulation& simulation, const ExpectedValue& wanted) {
  return present_values(simulation, {wanted}).front();
}

namespace {

/// Factor for the remaining error in the richer space: in 40 structures the true error of the largest stress was at
/// most 1.11 times the estimated difference.
constexpr double kSafety = 1.5;
/// Relative error of a value after Newton's method.
constexpr double kRoundingOfValues = 1e-10;

constexpr const char* kHidden = "an element is longer than the layer in which its end bends, and no formula tells more";
constexpr const char* kNoNumber = "it is no finite number, here or in the richer space of the estimate";

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

/// `present`: value of each quantity.
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

/// The largest error of several numbers, relative to the largest of them.
struct WantedError {
  double value = 0.0, error = 0.0;
  std::size_t column = 0;  ///< column of the largest error
  double relative() const { return EstimatedValue{"", value, error, ""}.relative(); }
};

WantedError wanted_error(const QuantitySet& set, const std::string& name, const Simulation& simulation,
                         const RicherStates& richer) {
  const std::vector<EstimatedValue> all = with_errors(set, values_of(set, simulation), simulation, richer);
  auto next = all.begin();
  WantedError worst;
  for (std::size_t i = 0; i < set.columns().size(); ++i) {
    if (!set.columns()[i].is_value) continue;
    const EstimatedValue& one = *next++;
    if (!name.empty() && set.name_of(set.columns()[i]) != name) continue;
    if (!one.is_estimated()) return {1.0, std::nan(""), i};
    worst.value = std::max(worst.value, std::abs(one.value));
    if (one.error > worst.error) worst.column = i;
    worst.error = std::max(worst.error, one.error);
  }
  return worst;
}

/// (member): whether a derivative has nonzero rows inside its elements.
std::vector<unsigned char> asked_inside(const StateDerivative& quantity) {
  const Model& model = quantity.model();
  std::vector<unsigned char> is_asked(model.scene().members.size(), 0);
  for_each_element(model.structure(), [&](const ElementView& element) {
    const double* row = element.increments_in(quantity.rows().interior());
    if (std::all_of(row, row + element.layout().increments(), [](double x) { return x == 0.0; })) return;
    is_asked[static_cast<std::size_t>(model.mesh().elements[static_cast<std::size_t>(element.mesh_element())].member)] =
        1;
  });
  return is_asked;
}

/// Shares of members in the error; empty if there are end layers, several processes, or no derivative of the number.
std::vector<ErrorOfMember> shares_of_wanted(const QuantitySet& set, const std::string& name,
                                            const Simulation& simulation, const ErrorEstimate& estimate) {
  const RicherStates richer(simulation, estimate);
  if (richer.states.size() != 1 || simulation.model().map()->getComm()->getSize() > 1) return {};
  const WantedError worst = wanted_error(set, name, simulation, richer);
  const Model& model = richer.states.front().model();
  State state = richer.states.front().state();
  state.in_plane = false;
  const std::vector<Reaction> reactions = mixbeam::reactions(model, state, simulation.load_factor());
  const QuantityState there{model, state, simulation.load_factor(), reactions, strain_energy(model, state)};
  try {
    const std::vector<double> values = set.values(there);
    const StateDerivative quantity = set.pinned(there, values).derivative(worst.column, there, values);
    const std::vector<double> shares =
        shares_of_members(simulation.model(), simulation.state(), simulation.load_factor(), estimate, quantity);
    const std::vector<unsigned char> is_inside = asked_inside(quantity);
    std::vector<ErrorOfMember> errors;
    for (std::size_t m = 0; m < shares.size(); ++m) {
      const double error = kSafety * std::abs(shares[m]) / worst.value;
      errors.push_back(is_inside[m] != 0 ? ErrorOfMember{error, 0.0} : ErrorOfMember{0.0, error});
    }
    return errors;
  } catch (const std::invalid_argument&) {  // no derivative
    return {};
  } catch (const LinearSolverError&) {
    return {};
  }
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
    double change = 0.0, before = values[i];  // by the richer space, then by layers, which might cancel it
    for (auto there = better.rbegin(); there != better.rend(); ++there) {
      const double next = (*there)[i];
      if (!(next == before) && !(std::isnan(next) && std::isnan(before))) change += std::abs(next - before);
      before = next;
    }
    if (!richer.empty() && hidden[i] == 0 && std::isfinite(values[i]))
      one.error = change == 0.0 ? 0.0 : kSafety * change + kRoundingOfValues * std::abs(values[i]);
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
    there.back().natural_frequency = state.natural_frequency();
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

bool wants_vertices(const Scene& scene, const QuantitySet& quantities) {
  static const char* const kinds[] = {"displacement", "rotation", "position", "distance", "angle", "reaction force"};
  const auto is_vertex = [](const std::string& point) { return point.find('@') == std::string::npos; };
  for (const QuantitySet::Column& column : quantities.columns()) {
    if (quantities.name_of(column) != scene.accuracy_of) continue;
    const Quantity& asked = quantities.asked(column);
    return std::find(std::begin(kinds), std::end(kinds), asked.kind) != std::end(kinds) && is_vertex(asked.point) &&
           is_vertex(asked.other_point) && is_vertex(asked.corner);
  }
  return false;
}

void judge_wanted(const Scene& scene, const QuantitySet& quantities, AccurateRunObserver& observer) {
  const std::string& name = scene.accuracy_of;
  if (name.empty()) return;
  if (name == "stress") {
    observer.error_of = [](const Simulation& simulation, const ErrorEstimate& estimate) {
      const QuantitySet set = set_of({largest("von Mises stress", "*")}, simulation.scene());
      return wanted_error(set, "", simulation, RicherStates(simulation, estimate)).relative();
    };
    return;
  }
  observer.of_vertices = wants_vertices(scene, quantities);
  observer.error_of = [&](const Simulation& simulation, const ErrorEstimate& estimate) {
    return wanted_error(quantities, name, simulation, RicherStates(simulation, estimate)).relative();
  };
  observer.shares_of = [&](const Simulation& simulation, const ErrorEstimate& estimate) {
    return shares_of_wanted(quantities, name, simulation, estimate);
  };
}

}  // namespace mixbeam
