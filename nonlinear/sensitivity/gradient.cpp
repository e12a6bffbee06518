#include "nonlinear/sensitivity/gradient.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/state/reactions.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace mixbeam {

namespace {

class Gradients {
 public:
  Gradients(BeamProblem& problem, const State& state, double load_factor, const GradientRequest& request)
      : model_(problem.model),
        state_(NumberDerivatives::in_space(state)),
        load_factor_(load_factor),
        request_(request),
        reactions_(mixbeam::reactions(model_, state_, load_factor_)),
        energy_(strain_energy(model_, state_)),
        values_(request.quantities.values(here())),
        pinned_(request.quantities.pinned(here(), values_)),
        operator_(problem, state, load_factor),
        derivatives_(operator_, state_, [this](const NumberDerivatives::Moved& moved) { return values_asked(moved); }) {
  }

  std::vector<QuantityGradient> all() {
    std::vector<QuantityGradient> found;
    for (const std::size_t column : request_.columns) found.push_back(begin(column));
    for (const SceneNumber& number : request_.numbers) {
      const std::vector<NumberDerivatives::Derivative> by = derivatives_.by(number);
      for (std::size_t i = 0; i < found.size(); ++i) found[i].by_number.push_back(by[i].value);
    }
    return found;
  }

 private:
  QuantityState here() const { return {model_, state_, load_factor_, reactions_, energy_}; }
  std::vector<double> values_asked(const NumberDerivatives::Moved& moved) const {
    const Model& model = *moved.model;
    const std::vector<Reaction> reactions = mixbeam::reactions(model, state_, load_factor_);
    const QuantityState there{model, state_, load_factor_, reactions, strain_energy(model, state_)};
    const bool is_in_formulas = moved.number != nullptr && moved.number->quantities_with;
    const std::vector<double> all =
        is_in_formulas ? moved.number->quantities_with(moved.more).pinned(here(), values_).values(there)
                       : pinned_.values(there);
    std::vector<double> asked;
    for (const std::size_t column : request_.columns) asked.push_back(all[column]);
    return asked;
  }

  QuantityGradient begin(std::size_t column) {
    const std::string& name = pinned_.columns()[column].name;
    try {
      const StateDerivative of = pinned_.derivative(column, here(), values_);
      Adjoint adjoint = operator_.solve(of);
      QuantityGradient gradient{name, values_[column]};
      if (request_.by_element) gradient.elements = element_gradients(state_, of, adjoint);
      derivatives_.add(std::move(adjoint), operator_.held_motion(of));
      return gradient;
    } catch (const std::invalid_argument& error) {
      throw InputError("the gradient of \"" + excerpt(name) + "\": " + error.what());
    }
  }

  const Model& model_;
  State state_;
  double load_factor_;
  const GradientRequest& request_;
  std::vector<Reaction> reactions_;
  StrainEnergy energy_;
  std::vector<double> values_;
  QuantitySet pinned_;
  AdjointOperator operator_;
  NumberDerivatives derivatives_;
};

/// Adds dq/dS and dq/dgamma_0, dq/dkappa_0 of the products with N and M, theory (80).
void add_products(const ElementView& element, const double* stresses, const double* adjoint,
                  const StateDerivative& quantity, ElementDerivatives& gradient) {
  const std::vector<double> weight = weights_of(element);
  for (int i = 0; i < element.layout().moment(0); ++i) {
    const double n = stresses[i], w = weight[static_cast<size_t>(i)];
    gradient.compliance[i % 3] += w * (0.5 * quantity.force_energy() * n - adjoint[i]) * n;
    gradient.natural[i % 3] -= w * adjoint[i];
  }
  for (int j = 0; j <= element.order(); ++j)
    for (int i = 0; i < 3; ++i) {
      const double m = stresses[element.layout().moment(j) + i], of = adjoint[element.layout().moment(j) + i];
      gradient.compliance[3 + i] += element.length() / (2 * j + 1) * (0.5 * quantity.moment_energy() * m - of) * m;
      if (j == 0) gradient.natural[3 + i] -= element.length() * of;
    }
}

}  // namespace

std::vector<ElementDerivatives> element_gradients(const State& state, const StateDerivative& quantity,
                                                  const Adjoint& adjoint, const MixedVector* stresses) {
  if (quantity.knows_compliance())
    throw std::invalid_argument("a strain, whose derivatives by compliances of elements are not offered, so it");
  std::vector<ElementDerivatives> gradients(quantity.model().structure().mesh_elements);
  const Structure& structure = quantity.model().structure();
  // outside of the loop: threads must not count owners of views
  const KernelView<const double*> field = adjoint.field.interior();
  const KernelView<const double*> given = stresses == nullptr ? KernelView<const double*>() : stresses->interior();
  for_each_element_on_threads("mixbeam::gradient::products", structure, state.views, [&](const ElementView& element) {
    ElementDerivatives& gradient = gradients[element.mesh_element()];
    const double* of = stresses == nullptr ? element.unknowns() : element.increments_in(given);
    add_products(element, of, element.increments_in(field), quantity, gradient);
    const SectionConstants& section = element.section();
    for (int i = 0; i < 6; ++i) {
      const double compliance = i < 3 ? section.force_compliance[i] : section.moment_compliance[i - 3];
      gradient.stiffness[i] = element.block().general_section ? std::numeric_limits<double>::quiet_NaN()
                                                              : -compliance * compliance * gradient.compliance[i];
    }
  });
  return gradients;
}

void require_differentiable(const BeamProblem& problem) {
  if (problem.model.map()->getComm()->getSize() > 1)
    throw InputError("gradients are computed by one process alone; allowed: a run without mpirun");
  if (!problem.model.scene().rotating_frames.empty())
    throw InputError("gradients of structures in a rotating frame are not computed; allowed: a scene without it");
}

std::vector<QuantityGradient> gradients_of(BeamProblem& problem, const State& state, double load_factor,
                                           const GradientRequest& request) {
  require_differentiable(problem);
  return Gradients(problem, state, load_factor, request).all();
}

}  // namespace mixbeam
