#include "apps/common/run/expected_quantity.hpp"

#include <cmath>
#include <stdexcept>

namespace mixbeam {

double component_of(const Vector3& v, const std::string& name) {
  if (name == "norm") return std::hypot(v[0], v[1], v[2]);
  if (name == "x" || name == "1") return v[0];
  return v[name == "y" || name == "2" ? 1 : 2];
}

namespace {

Vector3 to_array(const Vec3<double>& v) { return {v[0], v[1], v[2]}; }

Reaction reaction_at(const Simulation& simulation, const std::string& point) {
  for (const Reaction& reaction : simulation.reactions())
    if (reaction.point == point) return reaction;
  throw std::invalid_argument("no support at point \"" + point + "\"");
}

}  // namespace

std::optional<double> present_value(const Simulation& simulation, const ExpectedValue& wanted) {
  const std::string& quantity = wanted.quantity;
  if (quantity == "displacement") return component_of(simulation.displacement(wanted.point), wanted.component);
  if (quantity == "position") return component_of(simulation.position(wanted.point), wanted.component);
  if (quantity == "rotation") return component_of(simulation.rotation(wanted.point), wanted.component);
  if (quantity == "reaction force") return component_of(reaction_at(simulation, wanted.point).force, wanted.component);
  if (quantity == "reaction moment")
    return component_of(reaction_at(simulation, wanted.point).moment, wanted.component);
  if (quantity == "material force")
    return component_of(to_array(simulation.sample(wanted.member, wanted.position).force), wanted.component);
  if (quantity == "material moment")
    return component_of(to_array(simulation.sample(wanted.member, wanted.position).moment), wanted.component);
  if (quantity == "load factor") return simulation.load_factor();
  if (quantity != "strain energy") return std::nullopt;
  const StrainEnergy energy = simulation.strain_energy();
  return energy.force + energy.moment;
}

}  // namespace mixbeam
