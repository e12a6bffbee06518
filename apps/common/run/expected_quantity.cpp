#include "apps/common/run/expected_quantity.hpp"

#include <algorithm>
#include <limits>

namespace mixbeam {

std::vector<double> values_of(const QuantitySet& quantities, const Simulation& simulation) {
  if (quantities.empty()) return {};
  const std::vector<Reaction> reactions = simulation.reactions();
  QuantityState at{simulation.model(), simulation.state(),         simulation.load_factor(),
                   reactions,          simulation.strain_energy(), simulation.stability().negative,
                   simulation.jumps()};
  at.natural_frequency = simulation.natural_frequency();
  return quantities.values(at);
}

std::vector<std::string> places_of(const QuantitySet& quantities, const Simulation& simulation) {
  if (quantities.empty()) return {};
  const std::vector<Reaction> reactions = simulation.reactions();
  return quantities.places({simulation.model(), simulation.state(), simulation.load_factor(), reactions,
                            simulation.strain_energy(), simulation.stability().negative, simulation.jumps()});
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

}  // namespace mixbeam
