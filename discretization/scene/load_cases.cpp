#include "discretization/scene/load_cases.hpp"

#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>

namespace mixbeam {
namespace {

/// Factors of loads by case and stage: those of a combination, or 1 for one case alone.
class Factors {
 public:
  explicit Factors(const std::string& load_case) : cases_{{load_case, 1.0}} {}
  explicit Factors(const Combination& combination)
      : cases_(combination.cases.begin(), combination.cases.end()),
        stages_(combination.stages.begin(), combination.stages.end()) {}

  /// Factor of a load; none: it does not act.
  std::optional<double> of(const std::string& load_case, Stage stage) const {
    const auto found = cases_.find(load_case);
    if (!load_case.empty() && found == cases_.end()) return {};
    const auto in_stage = stages_.find(stage);
    return (load_case.empty() ? 1.0 : found->second) * (in_stage == stages_.end() ? 1.0 : in_stage->second);
  }

 private:
  std::map<std::string, double> cases_;
  std::map<Stage, double> stages_;
};

void scale(double factor, Vector3& vector) { vector = vector_algebra::scaled(factor, vector); }
void scale(double factor, Formulas& formula) {
  for (std::string& component : formula)
    if (!component.empty()) component = shortest(factor) + " * (" + component + ")";
}

template <class Load>
void scale(double factor, Load& load) {
  if (factor == 1.0) return;
  ActingKind<Load>::for_each_vector(load, [factor](Vector3& vector, Formulas* formula, VectorRole) {
    scale(factor, vector);
    if (formula != nullptr) scale(factor, *formula);
  });
  if constexpr (std::is_same_v<Load, Eigenstrain>) load.table_factor *= factor;
}

/// Keeps a load in the scene without any action.
template <class Load>
void hold_still(Load& load) {
  ActingKind<Load>::for_each_vector(load, [](Vector3& vector, Formulas*, VectorRole) { vector = {}; });
  load.amplitude.clear();
  load.stage = 1;
}

/// Drops loads that do not act, unless their kind stays; the others act unconditionally.
template <class Load>
void keep_acting(std::vector<Load>& loads, const Factors& factors) {
  const auto is_out = [&](const Load& load) { return !factors.of(load.load_case, load.stage); };
  if (!ActingKind<Load>::stays) loads.erase(std::remove_if(loads.begin(), loads.end(), is_out), loads.end());
  for (Load& load : loads) {
    if (const auto factor = factors.of(load.load_case, load.stage))
      scale(*factor, load);
    else
      hold_still(load);
    load.load_case.clear();
  }
}

}  // namespace

std::vector<std::string> alternatives(const Scene& scene) {
  std::vector<std::string> names = scene.load_cases;
  for (const Combination& combination : scene.combinations) names.push_back(combination.name);
  return names;
}

Scene scene_of_case(const Scene& scene, const std::string& name) {
  const std::vector<std::string> cases = alternatives(scene);
  if (!name.empty() && std::find(cases.begin(), cases.end(), name) == cases.end()) {
    throw std::invalid_argument("\"" + excerpt(name) + "\" is not a load case or combination of the scene; allowed: " +
                                quoted_list(cases) + did_you_mean(name, cases));
  }
  Factors factors(name);
  for (const Combination& combination : scene.combinations)
    if (combination.name == name) factors = Factors(combination);
  Scene one = scene;
  for_each_kind([&](auto kind) { keep_acting(one.*kind.list, factors); });
  one.load_cases.clear();
  one.combinations.clear();
  one.stages = stages_in_use(one);
  return one;
}

int stages_in_use(const Scene& scene) {
  int largest = 1;
  for_each_acting(scene, [&](const auto& load, auto kind) {
    if (kind.acts(load)) largest = std::max(largest, load.stage);
  });
  return largest;
}

}  // namespace mixbeam
