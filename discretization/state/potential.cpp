#include "discretization/state/potential.hpp"

#include "discretization/assembly/residual.hpp"
#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/state/reactions.hpp"
#include "discretization/state/sampling.hpp"

#include <Teuchos_CommHelpers.hpp>

namespace mixbeam {

namespace {

double sum_over_ranks(const Model& model, double mine) {
  double sum = 0.0;
  Teuchos::reduceAll(*model.map()->getComm(), Teuchos::REDUCE_SUM, 1, &mine, &sum);
  return sum;
}

/// Of the elements that this rank answers for: action(block, first entry in states, first entry in increments, h).
template <class Action>
void for_each_own_element(const Structure& structure, const Action& action) {
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count; ++e)
      if (block.vertices(e, 0) < structure.owned_vertices)
        action(block, block.interior_offset + static_cast<size_t>(e) * block.interior.unknowns(),
               block.increment_offset + static_cast<size_t>(e) * block.interior.increments(), block.reference(e, 0));
}

/// sum_q w_q N . R_N + sum_j M_j . R_{M_j}: with the strain energy the mixed functional.
double energy_of_misfits(const Model& model, const State& state, const MixedVector& rows) {
  const KernelView<const double*> row = rows.interior(), value = state.views.interior;
  double sum = 0.0;
  for_each_own_element(model.structure(), [&](const ElementBlock& block, size_t from, size_t at, double h) {
    const InteriorLayout& layout = block.interior;
    const auto product = [&](int i) { return row(at + i) * value(from + i); };
    const auto add_force = [&](int first, int count, int begin, int end) {
      double points[kMaximumOrder + 1], weights[kMaximumOrder + 1];
      gauss_rule(count, points, weights);
      for (int q = 0; q < count; ++q)
        for (int i = begin; i < end; ++i) sum += 0.5 * h * weights[q] * product(layout.force(first + q) + i);
    };
    const int axial = axial_points(block.order, block.force_integration),
              shear = shear_points(block.order, block.force_integration);
    add_force(0, axial, 0, 1);
    add_force(axial == shear ? 0 : axial, shear, 1, 3);
    for (int i = layout.moment(0); i < layout.moment(block.order + 1); ++i) sum += product(i);
  });
  return sum;
}

/// Rows of dead loads times displacements: minus their work.
double potential_of_loads(const Model& model, const State& state, const MixedVector& loads) {
  const KernelView<const double*> row = loads.interior(), value = state.views.interior;
  double sum = 0.0;
  for (int v = 0; v < model.structure().owned_vertices; ++v)
    sum += dot(rows_of(loads.vertex(), v, kForcePart), load_vector(&state.views.vertex_displacement(v, 0)));
  for_each_own_element(model.structure(), [&](const ElementBlock& block, size_t from, size_t at, double) {
    for (int i = block.interior.bubble(1); i < block.interior.bubble(block.order); ++i)
      sum += row(at + i) * value(from + i);
  });
  return sum;
}

double stored_in_springs(const Conditions& conditions, const State& state) {
  double sum = 0.0;
  for (const VertexSupport& support : conditions.supports) sum += stored_energy(support, state);
  for (const VertexJoint& joint : conditions.joints) sum += stored_energy(joint, state);
  return sum;
}

/// Of prescribed motions, with the mean of the reactions before and after.
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
  return sum_over_ranks(model, work);
}

}  // namespace

double potential_energy(const Model& model, const State& state, double load_factor) {
  MixedVector rows = model.create_vector(), loads = rows.clone(true);
  element_rows(model, state, load_factor, true, rows);
  double sum = energy_of_misfits(model, state, rows) + stored_in_springs(model.conditions(), state);
  if (model.line_fields().has_loads()) {
    element_rows(model, state, load_factor, false, loads);
    loads.update(1.0, rows, -1.0);
  } else {
    loads.fill(0.0);
  }
  subtract_point_loads(model.conditions(), state, load_factor, false, loads.vertex());
  sum += potential_of_loads(model, state, loads);
  const StrainEnergy strain = strain_energy(model, state);
  return sum_over_ranks(model, sum) + strain.force + strain.moment;
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
