/// The list "Gradient" of a scene: which quantities to differentiate with respect to which of its numbers.
#pragma once

#include "apps/common/run/number_path.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/quantities/quantity_set.hpp"
#include "nonlinear/run/simulation.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>
#include <vector>

namespace mixbeam {

struct XmlParameters;

/// The list as written.
struct GradientParameters {
  std::vector<std::string> of{};  ///< names of quantities' values, or patterns
  std::vector<std::string> by{};  ///< paths of numbers of the scene, or patterns
  bool by_element = false;
};

/// Numbers of a parameter; empty if it holds no real numbers.
std::vector<double> numbers_in(const Teuchos::ParameterEntry& entry);
/// Parameter at a path of the list "Scene".
const Teuchos::ParameterEntry& entry_of(const Teuchos::ParameterList& scene, const NumberPath& path);
/// Finite real numbers below the list "Scene" that match a path or pattern.
std::vector<NumberPath> numbers_meant(const Teuchos::ParameterList& scene, const std::string& text);
/// Message that nothing matches a path or pattern, with the allowed ones and the nearest.
std::string unknown_number(const Teuchos::ParameterList& scene, const std::string& text);
/// Names of the columns that are numbers, not places of extremes.
std::vector<std::string> names_of_values(const QuantitySet& quantities);
/// Quantities of the file, evaluated with the variables of `scene_list`. Throws InputError.
QuantitySet quantities_of(const Teuchos::ParameterList& scene_list, const XmlParameters& xml, const Scene& scene);

/// Declaration of the list "Gradient".
ListSpec gradient_spec();

/// Reads the list and checks that all names in it exist. Throws InputError.
GradientParameters read_gradient(XmlParameters& xml, const QuantitySet& quantities, const Scene& scene);
/// Throws InputError at the list "Gradient" for names that the scene does not have.
void require_known(const GradientParameters& asked, const XmlParameters& xml, const QuantitySet& quantities,
                   const Scene& scene);

/// Differentiable results: quantities of a state, load factors of the critical points of its path.
struct Differentiable {
  const QuantitySet& quantities;
  const std::vector<CriticalPoint>& points;
};

/// Gradients in the current state of a simulation of `load_case` of the scene in `xml`. Throws InputError,
/// LinearSolverError.
RecordedGradients gradients_at(const Simulation& simulation, const GradientParameters& asked, const Differentiable& of,
                               const XmlParameters& xml, const std::string& load_case);
/// Likewise, but sets RecordedGradients::not_found instead of throwing, so that the run continues.
RecordedGradients gradients_or_reason(const Simulation& simulation, const GradientParameters& asked,
                                      const Differentiable& of, const XmlParameters& xml, const std::string& load_case);
/// Whether gradients of load factors of critical points are requested.
bool asks_for_critical_points(const GradientParameters& asked);

}  // namespace mixbeam
