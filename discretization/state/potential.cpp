#include "discretization/state/potential.hpp"

#include "discretization/assembly/residual.hpp"
#include "discretization/mesh/element_view.hpp"
#include "discretization/state/reactions.hpp"
#include "discretization/state/sampling.hpp"
#include "kernels/math/vector_algebra.hpp"

namespace mixbeam {

namespace {

/// sum_q w_q N . R_N + sum_j M_j . R_{M_j}; plus the strain energy it is the mixed functional.
double energy_of_misfits(const Model& model, const State& state, const MixedVector& rows) {
  double sum = 0.0;
  for_each_owned_element(model.structure(), state, [&](const ElementView& element) {
    const InteriorLayout& layout = element.layout();
    const double *row = element.increments_in(rows.interior()), *value = element.unknowns();
    const auto add_force = [&](int first, int count, int begin, int end) {
      double points[kMaximumOrder + 1], weights[kMaximumOrder + 1];
      gauss_rule(count, points, weights);
      for (int q = 0; q < count; ++q)
        for (int i = layout.force(first + q) + begin; i < layout.force(first + q) + end; ++i)
          sum += 0.5 * element.length() * weights[q] * (row[i] * value[i]);
    };
    for_each_force_rule(element.order(), element.block().force_integration, add_force);
    for (int i = layout.moment(0); i < layout.moment(element.order() + 1); ++i) sum += row[i] * value[i];
  });
  return sum;
}

/// Rows of line loads times displacements: the negative of their work.
double potential_of_line_loads(const Model& model, const State& state, const MixedVector& loads) {
  double sum = 0.0;
  for (int v = 0; v < model.structure().owned_vertices; ++v)
    sum += dot(rows_of(loads.vertex(), v, kForcePart), load_vector(&state.views.vertex_displacement(v, 0)));
  for_each_owned_element(model.structure(), state, [&](const ElementView& element) {
    const double *row = element.increments_in(loads.interior()), *value = element.unknowns();
    for (int i = element.layout().bubble(1); i < element.layout().bubble(element.order()); ++i)
      sum += row[i] * value[i];
  });
  return sum;
}

double stored_in_springs(const Conditions& conditions, const State& state) {
  double sum = 0.0;
  for (const VertexSupport& support : conditions.supports) sum += stored_energy(support, state);
  for (const VertexJoint& joint : conditions.joints) sum += stored_energy(joint, state);
  return sum;
}

/// Work of prescribed motions, by the mean of the reactions before and after.
double work_of_supports(const Model& model, const State& first, double from, const State& second, double to) {
  const std::vector<Reaction> before = reactions(model, first, from), after = reactions(model, second, to);
  double work = 0.0;
  for (const VertexSupport& support : model.conditions().supports) {
    const double growth = support.amplitude(to) - support.amplitude(from);
    const auto mean = [&](Vector3 RecordedReaction::*part) {
      const Vector3 sum = vector_algebra::sum(before[support.index].*part, after[support.index].*part);
      return 0.5 * growth * load_vector(sum.data());
    };
    Vec displacement{};
    for (int i = 0; i < 3; ++i) displacement[i] = support.fixed[i] ? support.displacement[i] : 0.0;
    work += dot(mean(&RecordedReaction::force), transpose_times(support.axes, displacement));
    if (support.rotation_kind == SupportRotation::fixed) work += dot(mean(&RecordedReaction::moment), support.rotation);
  }
  return sum_over_ranks(*model.map()->getComm(), work);
}

}  // namespace

double potential_energy(const Model& model, const State& state, double load_factor) {
  MixedVector rows = model.create_vector(), loads = rows.clone(true);
  element_rows(model, state, load_factor, ElementLoads::line_loads, rows);
  double sum = energy_of_misfits(model, state, rows) + stored_in_springs(model.conditions(), state);
  for (const auto& energy : model.external()) sum += energy->energy(state, load_factor);
  if (model.rotating() != nullptr) sum += model.rotating()->energy(model.structure(), state, load_factor);
  if (model.line_fields().has_loads()) {
    element_rows(model, state, load_factor, ElementLoads::none, loads);
    loads.update(1.0, rows, -1.0);
    sum += potential_of_line_loads(model, state, loads);
  }
  const StrainEnergy strain = strain_energy(model, state);
  return sum_over_ranks(*model.map()->getComm(), sum) + strain.force + strain.moment;
}

double released_energy(const Model& model, const State& first, double first_load_factor, const State& second,
                       double second_load_factor) {
  const auto fall = [&](double load_factor) {
    return potential_energy(model, first, load_factor) - potential_energy(model, second, load_factor);
  };
  return 0.5 * (fall(first_load_factor) + fall(second_load_factor)) +
         work_of_supports(model, first, first_load_factor, second, second_load_factor);
}

}  // namespace mixbeam
