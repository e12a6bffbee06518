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

/// Central differences of eighth order, whose error with steps of a few percent is that of rounding, and of sixth
/// order, which tells whether the function is smooth.
constexpr int kStencil = 4;
constexpr double kEighth[kStencil] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
constexpr double kSixth[kStencil] = {3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0, 0.0};
/// Share of the sum of the sizes of all terms by which the two may differ. Kinks and jumps leave ten percent, smooth
/// functions 1e-7 at most; a step that is too large for a function is made smaller some times.
constexpr double kSmooth = 1e-6, kSmallerStep = 0.125;
/// Rounding of rows over their scales, theory (40), of which differences have that over the step.
constexpr double kRoundingOfRows = 1e-12;
constexpr int kMostSteps = 3;

/// The equations of a state in a scene as they stand: rows of elements with loads, and of constraints.
struct StateRows {
  MixedVector spatial;    ///< rows of vertices not projected; those of N are strains
  DofVector constraints;  ///< what supports and joints put into projected rows

  explicit StateRows(const Model& model) : spatial(model.create_vector()), constraints(model.map()) {
    spatial.fill(0.0);
  }
  void add(double factor, const StateRows& other) {
    spatial.update(factor, other.spatial, 1.0);
    constraints.update(factor, other.constraints, 1.0);
  }
};

StateRows rows_at(const Model& model, const State& state, double load_factor) {
  StateRows rows(model);
  element_rows(model, state, load_factor, ElementLoads::with_centrifugal, rows.spatial);
  for (const auto& energy : model.external()) energy->add_rows(state, load_factor, rows.spatial.vertex());
  model.constraints().set(state, load_factor, MixedVector::view_of(rows.constraints));
  return rows;
}

/// Derivatives by one number, by both formulas, with the state as it is.
struct NumberDerivative {
  StateRows rows[2];
  std::vector<double> values[2];  ///< of the quantities
};

/// Of each number N of an element: weight of its Gauss point times h / 2, where it is integrated there.
std::vector<double> weights_of(const ElementView& element) {
  std::vector<double> weight(static_cast<size_t>(element.layout().moment(0)), 0.0);
  for_each_force_rule(element.order(), element.block().force_integration, [&](int first, int count, int from, int to) {
    double points[kMaximumOrder + 1], gauss[kMaximumOrder + 1];
    gauss_rule(count, points, gauss);
    for (int q = 0; q < count; ++q)
      for (int i = from; i < to; ++i)
        weight[static_cast<size_t>(element.layout().force(first + q) + i)] = 0.5 * element.length() * gauss[q];
  });
  return weight;
}

class Gradients {
 public:
  Gradients(BeamProblem& problem, const State& state, double load_factor, const GradientRequest& request)
      : model_(problem.model),
        state_(in_space(state)),
        load_factor_(load_factor),
        request_(request),
        values_(values(request.quantities, model_)),
        pinned_(pin(request.quantities)),
        operator_(problem, state, load_factor) {}

  std::vector<QuantityGradient> all() {
    std::vector<QuantityGradient> found;
    for (const std::size_t column : request_.columns) found.push_back(begin(column));
    for (const SceneNumber& number : request_.numbers) add(number, found);
    return found;
  }

 private:
  static State in_space(State state) {
    state.in_plane = false;
    return state;
  }
  std::vector<double> values(const QuantitySet& quantities, const Model& model) const {
    const std::vector<Reaction> reactions = mixbeam::reactions(model, state_, load_factor_);
    return quantities.values({model, state_, load_factor_, reactions, strain_energy(model, state_)});
  }
  QuantitySet pin(const QuantitySet& quantities) const {
    const std::vector<Reaction> reactions = mixbeam::reactions(model_, state_, load_factor_);
    return quantities.pinned({model_, state_, load_factor_, reactions, strain_energy(model_, state_)}, values_);
  }

  QuantityGradient begin(std::size_t column) {
    const std::string& name = pinned_.columns()[column].name;
    const std::vector<Reaction> reactions = mixbeam::reactions(model_, state_, load_factor_);
    try {
      const StateDerivative of =
          pinned_.derivative(column, {model_, state_, load_factor_, reactions, strain_energy(model_, state_)}, values_);
      adjoints_.push_back(operator_.solve(of));
      held_.push_back(operator_.held_motion(of));
      rounding_.push_back(work_of_scales(adjoints_.back()));
      QuantityGradient gradient{name, values_[column]};
      if (request_.by_element) gradient.elements = element_gradients(operator_, of, adjoints_.back());
      return gradient;
    } catch (const std::invalid_argument& error) {
      throw InputError("the gradient of \"" + excerpt(name) + "\": " + error.what());
    }
  }

  /// Of rows as large as their scales.
  double work_of_scales(const Adjoint& adjoint) const {
    MixedVector sizes = model_.create_vector(), motion = model_.create_vector();
    sizes.fill(1.0);
    unscale_rows(model_, scales_of(model_, state_, load_factor_), sizes);
    motion.absolute_values_of(adjoint.field);
    return motion.inner_product(sizes);
  }

  void add(const SceneNumber& number, std::vector<QuantityGradient>& found) {
    double step = number.step;
    for (int attempt = 1;; ++attempt, step *= kSmallerStep) {
      const bool is_last = attempt == kMostSteps;
      try {
        const NumberDerivative by = differentiate(number, step);
        std::vector<double> derivatives;
        if (!pair(by, step, derivatives)) {
          if (!is_last) continue;
          throw InputError("the gradient with respect to \"" + excerpt(number.name) +
                           "\": the equations are no smooth function of this number");
        }
        for (std::size_t i = 0; i < found.size(); ++i) found[i].by_number.push_back(derivatives[i]);
        return;
      } catch (const InputError& error) {
        if (is_last) throw;
      }
    }
  }

  NumberDerivative differentiate(const SceneNumber& number, double step) const {
    NumberDerivative by{{StateRows(model_), StateRows(model_)}, {}};
    for (std::vector<double>& values : by.values) values.assign(values_.size(), 0.0);
    for (int k = 0; k < kStencil; ++k)
      for (const double sign : {1.0, -1.0}) {
        const double more = sign * (k + 1) * step;
        const Model moved(number.scene_with(more), model_.map()->getComm(), model_.options());
        require_alike(moved, number);
        const StateRows rows = rows_at(moved, state_, load_factor_);
        const std::vector<double> values =
            this->values(number.quantities_with ? pin(number.quantities_with(more)) : pinned_, moved);
        for (int order = 0; order < 2; ++order) {
          const double factor = sign * (order == 0 ? kEighth : kSixth)[k] / step;
          by.rows[order].add(factor, rows);
          for (std::size_t i = 0; i < values.size(); ++i) by.values[order][i] += factor * values[i];
        }
      }
    return by;
  }

  /// The numbers of a state must mean the same.
  void require_alike(const Model& moved, const SceneNumber& number) const {
    const auto refuse = [&](const std::string& what) {
      throw InputError("the gradient with respect to \"" + excerpt(number.name) + "\": " + what +
                       "; allowed: numbers that leave them as they are");
    };
    const Structure &a = model_.structure(), &b = moved.structure();
    if (a.interior_size != b.interior_size || a.local_vertex_to_global != b.local_vertex_to_global)
      refuse("it changes the mesh");
    const Conditions &before = model_.conditions(), &after = moved.conditions();
    const auto differ = [](const Mat& x, const Mat& y) {
      double largest = 0.0;
      for (int i = 0; i < 9; ++i) largest = std::max(largest, std::abs(x(i / 3, i % 3) - y(i / 3, i % 3)));
      return largest > kSameAxes;
    };
    if (before.supports.size() != after.supports.size() || before.joints.size() != after.joints.size())
      refuse("it changes supports or joints");
    for (std::size_t i = 0; i < before.supports.size(); ++i)
      if (differ(before.supports[i].axes, after.supports[i].axes)) refuse("it turns the axes of a support");
    for (std::size_t i = 0; i < before.joints.size(); ++i)
      if (differ(before.joints[i].frame, after.joints[i].frame)) refuse("it turns the axis of a joint");
  }
  static constexpr double kSameAxes = 1e-12;  ///< rounding of direction cosines

  /// dq/dp = q_p + t . R_p of every quantity; false where the two formulas do not agree.
  bool pair(const NumberDerivative& by, double step, std::vector<double>& derivatives) {
    for (std::size_t i = 0; i < adjoints_.size(); ++i) {
      double sizes = 0.0, ignored = 0.0;
      const std::size_t column = request_.columns[i];
      const double fine = work(i, by.rows[0], sizes) + by.values[0][column];
      const double coarse = work(i, by.rows[1], ignored) + by.values[1][column];
      sizes += std::abs(by.values[0][column]);
      const double rounding = kRoundingOfRows * rounding_[i] / step;
      if (!(std::abs(fine - coarse) <= kSmooth * sizes + rounding)) return false;
      derivatives.push_back(fine);
    }
    return true;
  }

  /// t . R_p, less what a reaction holds of it: that is its own derivative. `sizes`: sum of the sizes of terms.
  double work(std::size_t which, const StateRows& rows, double& sizes) {
    const Adjoint& adjoint = adjoints_[which];
    const KernelView<const double*> held_motion = MixedVector::view_of(held_[which]);
    const KernelView<const double*> vertex = rows.spatial.vertex(), motion = adjoint.field.vertex();
    double sum = 0.0;
    const auto add = [&](double term) {
      sum += term;
      sizes += std::abs(term);
    };
    for (std::size_t i = 0; i < vertex.extent(0); ++i) add((motion(i) - held_motion(i)) * vertex(i));
    for_each_element(model_.structure(), [&](const ElementView& element) {
      const double* row = element.increments_in(rows.spatial.interior());
      const double* of = element.increments_in(adjoint.field.interior());
      const int forces = element.layout().moment(0);
      const std::vector<double> weight = weights_of(element);
      for (int i = 0; i < element.layout().increments(); ++i)
        add((i < forces ? weight[static_cast<size_t>(i)] : 1.0) * of[i] * row[i]);
    });
    add(operator_.work_of_free(adjoint, rows.constraints));
    add(-work_of_held(adjoint, rows.constraints));
    return sum;
  }

  /// Of the motions that supports prescribe.
  double work_of_held(const Adjoint& adjoint, const DofVector& constraints) const {
    const KernelView<const double*> rows = MixedVector::view_of(constraints);
    double sum = 0.0;
    for (const VertexSupport& support : model_.conditions().supports)
      for (int i = 0; i < kVertexDofs; ++i) {
        if (!support.fixed[i]) continue;
        const double row = rows(vertex_row(support.vertex, i));
        if (row == 0.0) continue;
        const Vec held = load_vector(&adjoint.held[vertex_row(support.vertex, i < 3 ? 0 : 3)]);
        if (i < 3)
          sum += row * (support.axes(i, 0) * held[0] + support.axes(i, 1) * held[1] + support.axes(i, 2) * held[2]);
        else
          sum += row * held[i - 3];
      }
    return sum;
  }

  const Model& model_;
  State state_;
  double load_factor_;
  const GradientRequest& request_;
  std::vector<double> values_;
  QuantitySet pinned_;
  AdjointOperator operator_;
  std::vector<Adjoint> adjoints_{};
  std::vector<DofVector> held_{};
  std::vector<double> rounding_{};  ///< work_of_scales()
};
/// Adds dq/dS and dq/dgamma_0, dq/dkappa_0 of the products with N and M, theory (80).
void add_products(const ElementView& element, const double* adjoint, const StateDerivative& quantity,
                  ElementDerivatives& gradient) {
  const std::vector<double> weight = weights_of(element);
  for (int i = 0; i < element.layout().moment(0); ++i) {
    const double n = element.unknowns()[i], w = weight[static_cast<size_t>(i)];
    gradient.compliance[i % 3] += w * (0.5 * quantity.force_energy() * n - adjoint[i]) * n;
    gradient.natural[i % 3] -= w * adjoint[i];
  }
  for (int j = 0; j <= element.order(); ++j)
    for (int i = 0; i < 3; ++i) {
      const double m = element.moment(j)[i], of = adjoint[element.layout().moment(j) + i];
      gradient.compliance[3 + i] += element.length() / (2 * j + 1) * (0.5 * quantity.moment_energy() * m - of) * m;
      if (j == 0) gradient.natural[3 + i] -= element.length() * of;
    }
}

}  // namespace

std::vector<ElementDerivatives> element_gradients(const AdjointOperator& at, const StateDerivative& quantity,
                                                  const Adjoint& adjoint) {
  if (quantity.knows_compliance())
    throw std::invalid_argument("a strain, whose derivatives by compliances of elements are not offered, so it");
  std::vector<ElementDerivatives> gradients(at.model().structure().mesh_elements);
  for_each_element(at.model().structure(), at.state(), [&](const ElementView& element) {
    ElementDerivatives& gradient = gradients[element.mesh_element()];
    add_products(element, element.increments_in(adjoint.field.interior()), quantity, gradient);
    const SectionConstants& section = element.section();
    for (int i = 0; i < 6; ++i) {
      const double compliance = i < 3 ? section.force_compliance[i] : section.moment_compliance[i - 3];
      gradient.stiffness[i] = element.block().general_section ? std::numeric_limits<double>::quiet_NaN()
                                                              : -compliance * compliance * gradient.compliance[i];
    }
  });
  return gradients;
}

std::vector<QuantityGradient> gradients_of(BeamProblem& problem, const State& state, double load_factor,
                                           const GradientRequest& request) {
  if (problem.model.map()->getComm()->getSize() > 1)
    throw InputError("gradients are computed by one process alone; allowed: a run without mpirun");
  if (!problem.model.scene().rotating_frames.empty())
    throw InputError("gradients of structures in a rotating frame are not computed; allowed: a scene without it");
  return Gradients(problem, state, load_factor, request).all();
}

}  // namespace mixbeam
