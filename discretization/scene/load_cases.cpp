#include "discretization/scene/load_cases.hpp"

#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>

namespace mixbeam {
namespace {

/// By how much acts what belongs to a case and a stage: factors of a combination, or 1 for one case alone.
class Factors {
 public:
  explicit Factors(const std::string& load_case) : cases_{{load_case, 1.0}} {}
  explicit Factors(const Combination& combination)
      : cases_(combination.cases.begin(), combination.cases.end()),
        stages_(combination.stages.begin(), combination.stages.end()) {}

  /// None: it does not act.
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
void scale(double factor, std::array<std::string, 3>& formula) {
  for (std::string& component : formula)
    if (!component.empty()) component = shortest(factor) + " * (" + component + ")";
}
void scale(double factor, PointLoad& load) {
  scale(factor, load.force);
  scale(factor, load.moment);
}
void scale(double factor, DistributedLoad& load) {
  scale(factor, load.force);
  scale(factor, load.couple);
  scale(factor, load.force_formula);
  scale(factor, load.couple_formula);
}
void scale(double factor, Eigenstrain& strain) {
  scale(factor, strain.strain);
  scale(factor, strain.curvature);
  scale(factor, strain.strain_formula);
  scale(factor, strain.curvature_formula);
}

/// Drops what does not act; what stays acts unconditionally.
template <typename Load>
void keep_acting(std::vector<Load>& loads, const Factors& factors) {
  const auto is_out = [&](const Load& load) { return !factors.of(load.load_case, load.stage); };
  loads.erase(std::remove_if(loads.begin(), loads.end(), is_out), loads.end());
  for (Load& load : loads) {
    if (const double factor = *factors.of(load.load_case, load.stage); factor != 1.0) scale(factor, load);
    load.load_case.clear();
  }
}

void hold_still(Support& support) {
  support.prescribed_displacement = {};
  support.prescribed_rotation = {};
  support.amplitude.clear();
  support.stage = 1;
}

template <typename Load>
int largest_stage(const std::vector<Load>& loads, int largest) {
  for (const Load& load : loads) largest = std::max(largest, load.stage);
  return largest;
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
  keep_acting(one.point_loads, factors);
  keep_acting(one.distributed_loads, factors);
  keep_acting(one.eigenstrains, factors);
  for (Support& support : one.supports) {
    const std::optional<double> factor = factors.of(support.load_case, support.stage);
    if (!factor) hold_still(support);
    scale(factor.value_or(1.0), support.prescribed_displacement);
    scale(factor.value_or(1.0), support.prescribed_rotation);
    support.load_case.clear();
  }
  one.load_cases.clear();
  one.combinations.clear();
  one.stages = stages_in_use(one);
  return one;
}

bool prescribes_motion(const Support& support) {
  return !vector_algebra::is_zero(support.prescribed_displacement) ||
         !vector_algebra::is_zero(support.prescribed_rotation);
}

int stages_in_use(const Scene& scene) {
  int largest = largest_stage(scene.point_loads, 1);
  largest = largest_stage(scene.distributed_loads, largest);
  largest = largest_stage(scene.eigenstrains, largest);
  for (const Support& support : scene.supports) {
    if (prescribes_motion(support)) largest = std::max(largest, support.stage);
  }
  return largest;
}

}  // namespace mixbeam
