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

/// Both states, and the layers that neither sees.
class ErrorOfValues {
 public:
  ErrorOfValues(const Simulation& simulation, const ErrorEstimate& estimate)
      : simulation_(simulation), estimate_(estimate) {
    if (!estimate.exists()) return;
    richer_.emplace(simulation.richer(estimate, layers_));
  }

  const std::vector<EndLayer>& layers() const { return layers_; }

  /// `values`: of the columns of the set; NaN: not known.
  std::vector<EstimatedValue> of(const QuantitySet& set, const std::vector<double>& values) const {
    std::vector<EstimatedValue> all;
    for (std::size_t i = 0; i < values.size(); ++i) all.push_back({set.names()[i], values[i]});
    if (!richer_) {
      for (EstimatedValue& one : all) one.not_estimated = estimate_.not_estimated;
      return all;
    }
    const std::vector<Reaction> reactions = richer_->reactions();
    QuantityState there{richer_->model(),   richer_->state(),         richer_->load_factor(),
                        reactions,          richer_->strain_energy(), simulation_.stability().negative,
                        simulation_.jumps()};
    there.layers = &layers_;
    const std::vector<double> better = set.values(there);
    const std::vector<unsigned char> hidden = set.hidden_in_layers(there);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool is_same = better[i] == values[i] || (std::isnan(values[i]) && std::isnan(better[i]));
      if (is_same) all[i].error = 0.0;
      if (!is_same) all[i].error = kSafety * std::abs(better[i] - values[i]) + kRounding * std::abs(values[i]);
      if (hidden[i] != 0) all[i].error = std::nan("");
      if (!all[i].is_estimated())
        all[i].not_estimated = hidden[i] != 0 ? kHidden : "it is no number with one order more";
    }
    return all;
  }

 private:
  const Simulation& simulation_;
  const ErrorEstimate& estimate_;
  std::optional<Simulation> richer_;
  std::vector<EndLayer> layers_;
};

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

/// Those of the columns that are values, not places.
std::vector<EstimatedValue> values_alone(const QuantitySet& set, const std::vector<EstimatedValue>& all) {
  std::vector<EstimatedValue> values;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (set.columns()[i].is_value) values.push_back(all[i]);
  return values;
}

/// `present`: of each quantity.
std::vector<EstimatedValue> errors_of(const ErrorOfValues& errors, const QuantitySet& set,
                                      const std::vector<double>& present) {
  std::vector<double> values(set.columns().size(), std::nan(""));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (set.columns()[i].is_value) values[i] = present[set.columns()[i].quantity];
  return values_alone(set, errors.of(set, values));
}

std::vector<EstimatedValue> section_errors(const ErrorOfValues& errors, const Simulation& simulation,
                                           StepRecord& record) {
  StressSummary& stresses = *record.stresses;
  const QuantitySet forces =
      set_of({largest("material force", "*"), largest("material moment", "*")}, simulation.scene());
  std::vector<EstimatedValue> found = values_alone(forces, errors.of(forces, values_of(forces, simulation, record)));
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
  const std::vector<EstimatedValue> stress = errors_of(errors, set_of(asked, simulation.scene()), present);
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

void add_value_errors(const QuantitySet* quantities, const Simulation& simulation, const ErrorEstimate& estimate,
                      StepRecord& record) {
  if (quantities == nullptr && (!record.stresses || record.stresses->members.empty())) return;
  const ErrorOfValues errors(simulation, estimate);
  ErrorSummary& summary = *record.error_estimate;
  for (const MonitoredQuantity& series : record.monitored)
    if (quantities != nullptr && series.name == kQuantitySeries)
      summary.quantities = errors.of(*quantities, series.components);
  if (record.stresses) summary.sections = section_errors(errors, simulation, record);
  summary.layers = text_of(errors.layers(), simulation.scene());
}

namespace {

double judged_error_of(const std::string& name, const QuantitySet& quantities, const Simulation& simulation,
                       const ErrorEstimate& estimate) {
  const ErrorOfValues errors(simulation, estimate);
  std::vector<EstimatedValue> found;
  if (name == "stress") {
    const QuantitySet stress = set_of({largest("von Mises stress", "*")}, simulation.scene());
    found = values_alone(stress, errors.of(stress, values_of(stress, simulation)));
  } else {
    const std::vector<EstimatedValue> all = errors.of(quantities, values_of(quantities, simulation));
    for (std::size_t i = 0; i < all.size(); ++i)
      if (quantities.columns()[i].is_value && quantities.name_of(quantities.columns()[i]) == name)
        found.push_back(all[i]);
  }
  EstimatedValue worst{name, 0.0, 0.0, ""};
  for (const EstimatedValue& one : found) {
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
