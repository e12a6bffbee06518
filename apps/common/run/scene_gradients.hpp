/// The list "Gradient" of a scene: which quantities are differentiated with respect to which of its numbers.
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

/// As it was written.
struct GradientParameters {
  std::vector<std::string> of{};  ///< names or patterns of numbers that quantities have
  std::vector<std::string> by{};  ///< paths of numbers of the scene, or patterns of these
  bool by_element = false;
};

/// Numbers of a parameter; none where it holds no real numbers.
std::vector<double> numbers_in(const Teuchos::ParameterEntry& entry);
/// Of the list "Scene".
const Teuchos::ParameterEntry& entry_of(const Teuchos::ParameterList& scene, const NumberPath& path);
/// Finite real numbers below the list "Scene" that a path or pattern stands for.
std::vector<NumberPath> numbers_meant(const Teuchos::ParameterList& scene, const std::string& text);
/// Says that a path or pattern stands for none, what is allowed, and the nearest one.
std::string unknown_number(const Teuchos::ParameterList& scene, const std::string& text);
/// Columns that are numbers, as opposed to places of extremes.
std::vector<std::string> names_of_values(const QuantitySet& quantities);
/// The list "Quantities" with variables as the list "Scene" has them. Throws InputError.
QuantitySet quantities_of(const Teuchos::ParameterList& scene_list, const XmlParameters& xml, const Scene& scene);

/// Declaration of the list "Gradient".
ListSpec gradient_spec();

/// Reads the list and looks for all that it names. Throws InputError.
GradientParameters read_gradient(XmlParameters& xml, const QuantitySet& quantities, const Scene& scene);
/// Throws InputError at the list "Gradient" for what a scene does not have.
void require_known(const GradientParameters& asked, const XmlParameters& xml, const QuantitySet& quantities,
                   const Scene& scene);

/// What has gradients: quantities of a state, load factors of the critical points of its path.
struct Differentiable {
  const QuantitySet& quantities;
  const std::vector<CriticalPoint>& points;
};

/// At the present state of a simulation of a scene that `xml` tells, `load_case` of it. Throws InputError,
/// LinearSolverError.
RecordedGradients gradients_at(const Simulation& simulation, const GradientParameters& asked, const Differentiable& of,
                               const XmlParameters& xml, const std::string& load_case);
/// The same where a run must go on: RecordedGradients::not_found in place of an error.
RecordedGradients gradients_or_reason(const Simulation& simulation, const GradientParameters& asked,
                                      const Differentiable& of, const XmlParameters& xml, const std::string& load_case);
/// Whether load factors of critical points are among what is asked for.
bool asks_for_critical_points(const GradientParameters& asked);

}  // namespace mixbeam
