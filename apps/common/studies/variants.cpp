#include "apps/common/studies/variants.hpp"

namespace mixbeam {

Scene with_mesh(Scene scene, int order, int elements_per_member) {
  for (Member& member : scene.members) {
    member.order = order;
    member.elements = elements_per_member;
  }
  return scene;
}

SolverParameters with_fixed_steps(SolverParameters parameters, int steps) {
  parameters.load_path.method = LoadPathMethod::fixed;
  parameters.load_path.steps = steps;
  return parameters;
}

}  // namespace mixbeam
