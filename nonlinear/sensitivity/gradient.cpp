#include "nonlinear/sensitivity/gradient.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/state/reactions.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "nonlinear/sensitivity/lasting_modes.hpp"
#include "nonlinear/stability/block_krylov.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

namespace mixbeam {

namespace {

class Gradients {
 public:
  Gradients(BeamProblem& problem, const State& state, double load_factor, const GradientRequest& request)
      : problem_(problem),
        model_(problem.model),
        given_(state),
        state_(NumberDerivatives::in_space(state)),
        load_factor_(load_factor),
        request_(request),
        reactions_(mixbeam::reactions(model_, state_, load_factor_)),
        energy_(strain_energy(model_, state_)),
        values_(request.quantities.values(here())),
        pinned_(request.quantities.pinned(here(), values_)) {}

  std::vector<RecordedGradient> all() {
    std::vector<RecordedGradient> found;
    for (std::size_t place = 0; place < request_.columns.size(); ++place) found.push_back(begin(place));
    finish_modes(found);
    if (motion_) take_sizes();
    for (const SceneNumber& number : request_.numbers)
      add_number(number, found, [&] {
        if (derivatives_) take(derivatives_->by(number), by_adjoint_, found);
        if (motion_) take_direct(motion_->by(number), found);
      });
    return found;
  }

 private:
  using Moved = NumberDerivatives::Moved;
  using Derivatives = std::vector<NumberDerivatives::Derivative>;

  QuantityState here() const {
    QuantityState at{model_, state_, load_factor_, reactions_, energy_};
    at.natural_frequency = [this](int mode) { return asked_modes_.count(mode) > 0 ? modes_->frequency(mode) : kAny; };
    return at;
  }

  /// Values of the columns with adjoints, or of those differentiated directly, which include frequencies.
  std::vector<double> values_asked(bool direct, const Moved& moved) const {
    const Model& model = *moved.model;
    const std::vector<Reaction> reactions = mixbeam::reactions(model, *moved.state, load_factor_);
    QuantityState there{model, *moved.state, load_factor_, reactions, strain_energy(model, *moved.state)};
    std::map<int, std::vector<double>> changes;
    for (const int mode : direct ? asked_modes_ : std::set<int>{})
      changes[mode] = modes_->changes(mode, model, *moved.state);
    there.natural_frequency = [&](int mode) {
      return changes.count(mode) == 0 ? kAny : modes_->frequency(mode) + changes[mode][0];
    };
    const bool is_in_formulas = moved.number != nullptr && moved.number->quantities_with;
    const std::vector<double> all =
        is_in_formulas ? moved.number->quantities_with(moved.more).pinned(here(), values_).values(there)
                       : pinned_.values(there);
    std::vector<double> asked;
    for (const std::size_t place : direct ? direct_ : by_adjoint_) asked.push_back(all[request_.columns[place]]);
    if (!direct) return asked;
    for (const auto& [name, mode] : directions_)
      for (const double change : changes[mode]) asked.push_back(modes_->frequency(mode) + change);
    return asked;
  }

  static void take(const Derivatives& by, const std::vector<std::size_t>& places,
                   std::vector<RecordedGradient>& found) {
    for (std::size_t i = 0; i < places.size(); ++i) found[places[i]].derivative.back() = by[i].value;
  }

  void take_direct(const Derivatives& by, std::vector<RecordedGradient>& found) const {
    take(by, direct_, found);
    for (const std::size_t place : several_) found[place].derivative.back() = std::nan("");
    std::size_t next = direct_.size(), place = request_.columns.size();
    for (const auto& [column, mode] : directions_) {
      const int m = modes_->together(mode);
      std::vector<double> form, slopes;
      for (int k = 0; k < m * m; ++k) form.push_back(by[next++].value);
      small_eigenproblem(form, m);
      for (int k = 0; k < m; ++k) slopes.push_back(form[k * (m + 1)]);
      std::sort(slopes.begin(), slopes.end());
      for (const double slope : slopes) found[place++].derivative.back() = slope;
    }
  }

  void take_modes(std::size_t place, const std::vector<int>& modes, RecordedGradient& gradient) {
    if (!modes_) modes_ = std::make_unique<LastingModes>(problem_, given_, load_factor_, request_.modes);
    for (const int mode : modes) {
      const bool is_alone = modes_->together(mode) == 1;
      asked_modes_.insert(mode);
      if (is_alone) continue;
      gradient.note = "of several modes with one frequency, but one for each direction";
      several_.insert(place);
    }
    if (request_.by_element && gradient.note.empty()) gradient.note = "of frequencies by numbers of elements";
    if (const int mode = request_.quantities.asked(pinned_.columns()[request_.columns[place]]).mode;
        mode > 0 && modes_->together(mode) > 1)
      directions_.emplace_back(gradient.quantity, mode);
  }

  /// Sets values of frequencies, and adds gradients for their directions, when the modes are known.
  void finish_modes(std::vector<RecordedGradient>& found) {
    if (!modes_) return;
    values_ = request_.quantities.values(here());
    for (const std::size_t place : direct_) found[place].value = values_[request_.columns[place]];
    for (const auto& [name, mode] : directions_)
      for (int k = 1; k <= modes_->together(mode); ++k)
        found.push_back({name + ", direction " + std::to_string(k), modes_->frequency(mode)});
  }

  /// Sets the sizes of values that are differentiated directly, at least those typical for their unit.
  void take_sizes() {
    const double length = model_.structure().length;
    const ResidualScales scales = scales_of(model_, state_, load_factor_);
    const std::map<std::string, double> size = {{"L", length},         {"F", scales.force}, {"F L", scales.moment},
                                                {"1/L", 1.0 / length}, {"rad", 1.0},        {"", 1.0}};
    const std::vector<std::string> units = pinned_.units("L, F");
    for (const std::size_t place : direct_) {
      const std::size_t column = request_.columns[place];
      const auto known = size.find(units[column]);
      motion_->add(std::max(std::abs(values_[column]), known == size.end() ? 0.0 : known->second));
    }
    for (const auto& [name, mode] : directions_)
      for (int k = 0; k < modes_->together(mode) * modes_->together(mode); ++k) motion_->add(modes_->frequency(mode));
  }

  RecordedGradient begin(std::size_t place) {
    const std::size_t column = request_.columns[place];
    const std::string& name = pinned_.columns()[column].name;
    const bool has_fewer_numbers = !request_.numbers.empty() && request_.numbers.size() < request_.columns.size();
    try {
      const StateDerivative of = pinned_.derivative(column, here(), values_);
      if (!std::isfinite(values_[column]) || !std::isfinite(of.rows().one_norm()))
        throw std::invalid_argument("it has no finite value, or no finite derivative");
      RecordedGradient gradient{name, values_[column]};
      if (!of.modes().empty()) take_modes(place, of.modes(), gradient);
      if (!of.modes().empty() || request_.direct.value_or(has_fewer_numbers && !request_.by_element)) {
        direct_.push_back(place);
        if (!motion_)
          motion_.emplace(tangent_.emplace(problem_, given_, load_factor_, false), state_,
                          [this](const Moved& moved) { return values_asked(true, moved); });
        return gradient;
      }
      if (!derivatives_)
        derivatives_.emplace(adjoint_.emplace(problem_, given_, load_factor_), state_,
                             [this](const Moved& moved) { return values_asked(false, moved); });
      Adjoint adjoint = adjoint_->solve(of);
      if (request_.by_element) find_by_element(state_, of, adjoint, gradient);
      by_adjoint_.push_back(place);
      if (!request_.numbers.empty()) derivatives_->add(std::move(adjoint), adjoint_->held_motion(of));
      return gradient;
    } catch (const std::invalid_argument& error) {
      const std::string why = "the gradient of \"" + excerpt(name) + "\": " + error.what();
      if (std::count(request_.of_patterns.begin(), request_.of_patterns.end(), column) == 0) throw InputError(why);
      RecordedGradient none{name, values_[column]};
      none.note = why;
      return none;
    }
  }

  /// Placeholder for unknown frequencies, so that other values can be evaluated.
  static constexpr double kAny = 1.0;

  BeamProblem& problem_;
  const Model& model_;
  State given_, state_;
  double load_factor_;
  const GradientRequest& request_;
  std::unique_ptr<LastingModes> modes_{};
  std::set<int> asked_modes_{};
  std::set<std::size_t> several_{};                        ///< places of quantities of modes that share a frequency
  std::vector<std::pair<std::string, int>> directions_{};  ///< quantities that are frequencies of several modes
  std::vector<Reaction> reactions_;
  StrainEnergy energy_;
  std::vector<double> values_;
  QuantitySet pinned_;
  std::vector<std::size_t> by_adjoint_{}, direct_{};  ///< indices into the requested columns
  std::optional<AdjointOperator> adjoint_{}, tangent_{};
  std::optional<NumberDerivatives> derivatives_{}, motion_{};
};

using SixNumbers = std::array<double, 6>;

/// Adds dq/dS and dq/dgamma_0, dq/dkappa_0 from products with N and M, theory (80).
void add_products(const ElementView& element, const double* stresses, const double* adjoint,
                  const StateDerivative& quantity, SixNumbers& compliance, SixNumbers& natural) {
  const std::vector<double> weight = weights_of(element);
  for (int i = 0; i < element.layout().moment(0); ++i) {
    const double n = stresses[i], w = weight[static_cast<size_t>(i)];
    compliance[i % 3] += w * (0.5 * quantity.force_energy() * n - adjoint[i]) * n;
    natural[i % 3] -= w * adjoint[i];
  }
  for (int j = 0; j <= element.order(); ++j)
    for (int i = 0; i < 3; ++i) {
      const double m = stresses[element.layout().moment(j) + i], of = adjoint[element.layout().moment(j) + i];
      compliance[3 + i] += element.length() / (2 * j + 1) * (0.5 * quantity.moment_energy() * m - of) * m;
      if (j == 0) natural[3 + i] -= element.length() * of;
    }
}

}  // namespace

void find_by_element(const State& state, const StateDerivative& quantity, const Adjoint& adjoint,
                     RecordedGradient& gradient, const MixedVector* stresses) {
  if (quantity.knows_compliance())
    throw std::invalid_argument("derivatives of strains by compliances of elements are not offered");
  const Structure& structure = quantity.model().structure();
  for (auto* numbers : {&gradient.stiffness, &gradient.compliance, &gradient.natural})
    numbers->assign(static_cast<size_t>(structure.mesh_elements), SixNumbers{});
  // Taken outside of the loop: threads must not change reference counts of views.
  const KernelView<const double*> field = adjoint.field.interior();
  const KernelView<const double*> given = stresses == nullptr ? KernelView<const double*>() : stresses->interior();
  for_each_element_on_threads("mixbeam::gradient::products", structure, state.views, [&](const ElementView& element) {
    const int at = element.mesh_element();
    const double* of = stresses == nullptr ? element.unknowns() : element.increments_in(given);
    add_products(element, of, element.increments_in(field), quantity, gradient.compliance[at], gradient.natural[at]);
    const SectionConstants& section = element.section();
    for (int i = 0; i < 6; ++i) {
      const double compliance = i < 3 ? section.force_compliance[i] : section.moment_compliance[i - 3];
      gradient.stiffness[at][i] = element.block().general_section
                                      ? std::numeric_limits<double>::quiet_NaN()
                                      : -compliance * compliance * gradient.compliance[at][i];
    }
  });
}

void add_number(const SceneNumber& number, std::vector<RecordedGradient>& gradients,
                const std::function<void()>& take) {
  for (RecordedGradient& one : gradients) one.derivative.push_back(std::numeric_limits<double>::quiet_NaN());
  try {
    take();
  } catch (const InputError& error) {
    if (!number.is_of_pattern) throw;
    for (RecordedGradient& one : gradients)
      if (one.note.empty()) one.note = error.what();
  }
}

void require_differentiable(const BeamProblem& problem) {
  if (problem.model.map()->getComm()->getSize() > 1)
    throw InputError("gradients are computed by one process alone; allowed: a run without mpirun");
}

std::vector<RecordedGradient> gradients_of(BeamProblem& problem, const State& state, double load_factor,
                                           const GradientRequest& request) {
  require_differentiable(problem);
  return Gradients(problem, state, load_factor, request).all();
}

}  // namespace mixbeam
