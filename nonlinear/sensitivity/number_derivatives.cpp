#include "nonlinear/sensitivity/number_derivatives.hpp"

#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Points of evaluation, in steps, and factors of central differences of fourth and of second order.
constexpr int kReadings = 4;
constexpr double kReadingAt[kReadings] = {1.0, -1.0, 2.0, -2.0};
constexpr double kFactorOfReading[2][kReadings] = {{2.0 / 3.0, -2.0 / 3.0, -1.0 / 12.0, 1.0 / 12.0},
                                                   {0.5, -0.5, 0.0, 0.0}};
/// Difference of both over the sum of the magnitudes of all terms for smooth functions; the error of the better one is
/// about its square. Kinks and jumps leave 10 %; a step that is too large for a function is reduced some times.
constexpr double kSmooth = 1e-4, kSmallerStep = 0.125;
constexpr int kMostStepsOfDifference = 3;
/// Rounding of rows over their scales, theory (40), and of values over their sizes; that of differences is divided by
/// the step.
constexpr double kRounding = 1e-12;
constexpr double kSameAxes = 1e-12;  ///< rounding of direction cosines
/// Error of a sum that is zero, over the magnitudes of all terms, due to states, which are accurate to ten digits, and
/// to differences.
constexpr double kNoise = 1e-7;

}  // namespace

StateRows rows_at(const Model& model, const State& state, double load_factor) {
  StateRows rows(model);
  element_rows(model, state, load_factor, ElementLoads::with_centrifugal, rows.spatial);
  weigh_force_rows(model.structure(), false, rows.spatial);
  for (const auto& energy : model.external()) energy->add_rows(state, load_factor, rows.spatial.vertex());
  model.constraints().set(state, load_factor, MixedVector::view_of(rows.constraints));
  return rows;
}

/// Differences by both formulas, at a fixed state.
struct NumberDerivatives::Differences {
  StateRows rows[2];
  std::vector<double> values[2];  ///< of the quantities
};

void NumberDerivatives::add(Adjoint adjoint, DofVector held) {
  rounding_.push_back(kRounding * work_of_scales(adjoint));
  adjoints_.push_back(std::move(adjoint));
  held_.push_back(std::move(held));
}

void NumberDerivatives::add(double size) { rounding_.push_back(kRounding * size); }

/// Work of rows as large as their scales.
double NumberDerivatives::work_of_scales(const Adjoint& adjoint) const {
  MixedVector sizes = model_.create_vector(), motion = model_.create_vector();
  sizes.fill(1.0);
  unscale_rows(model_, scales_of(model_, state_, operator_.load_factor()), sizes);
  motion.absolute_values_of(adjoint.field);
  return motion.inner_product(sizes);
}

StateDerivative derivative_of(const Model& model, const State& state, const StateRows& rows) {
  StateDerivative derivative(model, state);
  derivative.add_rows(rows.spatial);
  return derivative;
}

std::vector<NumberDerivatives::Derivative> NumberDerivatives::by(const SceneNumber& number) const {
  return by(number.name, number.step, [&](double more) {
    auto moved = std::make_shared<const Model>(number.scene_with(more), model_.map()->getComm(), model_.options());
    require_alike(*moved, number.name);
    return Moved{std::move(moved), operator_.load_factor(), &number, more, &state_};
  });
}

std::vector<NumberDerivatives::Derivative> NumberDerivatives::by_load_factor(double step) const {
  const std::shared_ptr<const Model> same(std::shared_ptr<void>{}, &model_);
  return by("load factor", step, [&](double more) {
    return Moved{same, operator_.load_factor() + more, nullptr, more, &state_};
  });
}

std::vector<NumberDerivatives::Derivative> NumberDerivatives::by(const std::string& name, double step,
                                                                 const Move& move) const {
  for (int attempt = 1;; ++attempt, step *= kSmallerStep) {
    try {
      std::vector<Derivative> derivatives;
      if (pair(differentiate(step, move), step, derivatives)) return derivatives;
      throw InputError("the gradient with respect to \"" + excerpt(name) +
                       "\": the equations are no smooth function of this number");
    } catch (const InputError&) {
      if (attempt == kMostStepsOfDifference) throw;
    }
  }
}

/// Computes x_p = -R_x^-1 R_p, including motions prescribed by supports.
Adjoint NumberDerivatives::motion_under(const StateRows& rows) const {
  DofVector imposed(model_.map());
  const KernelView<double*> motion = MixedVector::view_of(imposed);
  const KernelView<const double*> given = MixedVector::view_of(rows.constraints);
  for (const VertexSupport& support : model_.conditions().supports)
    for (int i = 0; i < kVertexDofs; ++i) {
      const double row = support.fixed[i] ? given(vertex_row(support.vertex, i)) : 0.0;
      for (int j = 0; j < 3 && i < 3; ++j) motion(vertex_row(support.vertex, j)) -= row * support.axes(i, j);
      if (i >= 3) motion(vertex_row(support.vertex, i)) -= row;
    }
  return operator_.solve(derivative_of(model_, state_, rows), &rows.constraints, &imposed);
}

NumberDerivatives::Differences NumberDerivatives::differentiate(double step, const Move& move) const {
  const bool is_direct = adjoints_.size() < rounding_.size();
  Differences by{{StateRows(model_), StateRows(model_)}, {}};
  for (std::vector<double>& values : by.values) values.assign(rounding_.size(), 0.0);
  const auto take_values = [&](const Moved& moved, int i) {
    const std::vector<double> values = values_ ? values_(moved) : std::vector<double>{};
    for (int order = 0; order < 2; ++order)
      for (std::size_t k = 0; k < values.size(); ++k)
        by.values[order][k] += kFactorOfReading[order][i] / step * values[k];
  };
  std::vector<Moved> kept;
  for (int i = 0; i < kReadings; ++i) {
    Moved moved = move(kReadingAt[i] * step);
    const StateRows rows = rows_at(*moved.model, state_, moved.load_factor);
    for (int order = 0; order < 2; ++order) by.rows[order].add(kFactorOfReading[order][i] / step, rows);
    if (is_direct)
      kept.push_back(std::move(moved));
    else
      take_values(moved, i);
  }
  if (!is_direct) return by;
  const Adjoint motion = motion_under(by.rows[0]);
  for (int i = 0; i < kReadings; ++i) {
    const State there = in_space(model_.apply(state_, motion.field, kept[i].more));
    kept[i].state = &there;
    take_values(kept[i], i);
  }
  return by;
}

/// Throws if the unknowns of a state have another meaning in the other model.
void NumberDerivatives::require_alike(const Model& moved, const std::string& number) const {
  const auto refuse = [&](const std::string& what) {
    throw InputError("the gradient with respect to \"" + excerpt(number) + "\": " + what +
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

/// Computes dq/dp = q_p + t . R_p of every quantity; false if the two formulas do not agree.
bool NumberDerivatives::pair(const Differences& by, double step, std::vector<Derivative>& derivatives) const {
  for (std::size_t i = 0; i < rounding_.size(); ++i) {
    double sizes = 0.0, ignored = 0.0;
    // Less the part in held rows, which is contained in the derivative of a reaction itself.
    const auto part = [&](int order, double& size) {
      const double value = by.values[order][i];
      size += std::abs(value);
      if (i >= adjoints_.size()) return value;
      const double held = held_[i].dot(by.rows[order].spatial.vertex_dofs());
      size += std::abs(held);
      return work(adjoints_[i], by.rows[order], size) + value - held;
    };
    const double fine = part(0, sizes), coarse = part(1, ignored), rounding = rounding_[i] / step;
    if (!(std::abs(fine - coarse) <= kSmooth * sizes + rounding)) return false;
    derivatives.push_back({fine, kNoise * sizes + rounding});
  }
  return true;
}

double NumberDerivatives::work(const Adjoint& adjoint, const StateRows& rows, double& sizes) const {
  MixedVector motion = adjoint.field.clone(false), forces = adjoint.field.clone(false);
  motion.absolute_values_of(adjoint.field);
  forces.absolute_values_of(rows.spatial);
  const double of_free = operator_.work_of_free(adjoint, rows.constraints),
               of_held = work_of_held(adjoint, rows.constraints);
  sizes += motion.inner_product(forces) + std::abs(of_free) + std::abs(of_held);
  return adjoint.field.inner_product(rows.spatial) + of_free - of_held;
}

/// Work of the motions prescribed by supports.
double NumberDerivatives::work_of_held(const Adjoint& adjoint, const DofVector& constraints) const {
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

}  // namespace mixbeam
