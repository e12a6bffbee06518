/// Numbers of scenes and quantities of their states, for tests of gradients.
#pragma once

#include "discretization/quantities/quantity_set.hpp"
#include "discretization/scene/section_law.hpp"
#include "nonlinear/sensitivity/number_derivatives.hpp"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace mixbeam::test {

/// Read from pairs of a parameter and its value.
inline Quantity quantity(const std::string& name, const std::string& kind,
                         const std::map<std::string, std::string>& given) {
  Teuchos::ParameterList list;
  Teuchos::ParameterList& one = list.sublist(name);
  one.set("Quantity", kind);
  for (const auto& [parameter, value] : given) {
    if (parameter == "Position")
      one.set(parameter, std::stod(value));
    else if (parameter == "Mode")
      one.set(parameter, std::stoi(value));
    else
      one.set(parameter, value);
  }
  return read_quantities(list, ParameterSource("scene.xml")).front();
}

struct Parameter {
  std::string name;
  double value = 0.0, step = 0.0;  ///< of differences of runs
  std::function<void(Scene&, double)> set;
};

inline Scene with(const Scene& scene, const Parameter& parameter, double more) {
  Scene changed = scene;
  parameter.set(changed, parameter.value + more);
  return changed;
}

inline SceneNumber number_of(const Scene& scene, const Parameter& parameter) {
  return {parameter.name, 0.025 * parameter.step,
          [=](double more) { return std::make_shared<const Scene>(with(scene, parameter, more)); }};
}

/// That which `place` refers to.
template <class Place>
Parameter of_number(const std::string& name, Scene scene, double step, const Place& place) {
  return {name, place(scene), step, [=](Scene& changed, double value) { place(changed) = value; }};
}

inline Parameter of_force(const Scene& scene, std::size_t load, int component, double step) {
  return of_number("force " + std::to_string(load), scene, step,
                   [=](Scene& of) -> double& { return of.point_loads[load].force[component]; });
}

/// `share`: of the stiffness, as a step.
inline Parameter of_stiffness(const Scene& scene, int component, double share, std::size_t section = 0) {
  const std::array<double, 6> stiffness = diagonal(scene.sections[section]);
  return {"stiffness " + std::to_string(component), stiffness[component], share * stiffness[component],
          [=](Scene& changed, double value) {
            std::array<double, 6> numbers = diagonal(changed.sections[section]);
            numbers[component] = value;
            set_diagonal(changed.sections[section], numbers);
          }};
}

/// Of all six stiffnesses.
inline std::vector<Parameter> of_stiffnesses(const Scene& scene, double share) {
  std::vector<Parameter> all;
  for (int i = 0; i < 6; ++i) all.push_back(of_stiffness(scene, i, share));
  return all;
}

inline Parameter of_place(const Scene& scene, std::size_t point, int component, double step) {
  return of_number("place of " + scene.points[point].name, scene, step,
                   [=](Scene& of) -> double& { return of.points[point].position[component]; });
}

}  // namespace mixbeam::test
