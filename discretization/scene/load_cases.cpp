#include "discretization/scene/load_cases.hpp"

#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <stdexcept>

namespace mixbeam {
namespace {

/// Drops what belongs to other cases; what stays acts unconditionally.
template <typename Load>
void keep_case(std::vector<Load>& loads, const std::string& name) {
  loads.erase(std::remove_if(loads.begin(), loads.end(),
                             [&](const Load& load) { return !load.load_case.empty() && load.load_case != name; }),
              loads.end());
  for (Load& load : loads) load.load_case.clear();
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

Scene scene_of_case(const Scene& scene, const std::string& name) {
  const std::vector<std::string>& cases = scene.load_cases;
  if (!name.empty() && std::find(cases.begin(), cases.end(), name) == cases.end()) {
    throw std::invalid_argument("\"" + excerpt(name) + "\" is not a load case of the scene; allowed: " +
                                quoted_list(cases) + did_you_mean(name, cases));
  }
  Scene one = scene;
  keep_case(one.point_loads, name);
  keep_case(one.distributed_loads, name);
  keep_case(one.eigenstrains, name);
  for (Support& support : one.supports) {
    if (!support.load_case.empty() && support.load_case != name) hold_still(support);
    support.load_case.clear();
  }
  one.load_cases.clear();
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
