/// Strain energy of a state and of its parts: see sampling.hpp and structure_parts.hpp.
#include "discretization/state/structure_parts.hpp"
#include "kernels/element/section.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <vector>

namespace mixbeam {

namespace {

/// Half the work of N on its strain and of M on its strain, where a general section couples them.
StrainEnergy general_element_energy(const ElementBlock& block, int e, const double* interior) {
  const int k = block.order, n = block.interior.force_points;
  const GeneralSection<> section{&block.compliance(e, 0), {k, n}, 0.0, 0.0};
  StrainEnergy energy;
  double points[kMaximumOrder + 1], weights[kMaximumOrder + 1];
  const auto moment_at = [&](double xi) {
    double P[kMaximumOrder + 1];
    legendre(k, xi, P);
    Vec moment{{0.0, 0.0, 0.0}};
    for (int j = 0; j <= k; ++j) moment += P[j] * load_vector(interior + block.interior.moment(j));
    return moment;
  };
  const double quarter = 0.25 * block.reference(e, 0);  // half of ds = h/2 dxi
  gauss_rule(n, points, weights);
  for (int q = 0; q < n; ++q) {
    const Vec force = load_vector(interior + block.interior.force(q));
    const double mixed = dot(force, section.force_moment(q) * moment_at(points[q]));
    energy.force += quarter * weights[q] * (dot(force, section.force_force(q) * force) + mixed);
    energy.moment += quarter * weights[q] * mixed;
  }
  gauss_rule(k + 1, points, weights);
  for (int q = 0; q <= k; ++q) {
    const Vec moment = moment_at(points[q]);
    energy.moment += quarter * weights[q] * dot(moment, section.moment_moment(q) * moment);
  }
  return energy;
}

StrainEnergy element_energy(const ElementBlock& block, const double* interior, double h,
                            const SectionConstants& section) {
  StrainEnergy energy;
  const int axial = axial_points(block.order, block.force_integration),
            shear = shear_points(block.order, block.force_integration);
  const auto add_force = [&](int first, int count, int begin, int end) {
    double points[kMaximumOrder + 1], weights[kMaximumOrder + 1];
    gauss_rule(count, points, weights);
    for (int q = 0; q < count; ++q)
      for (int i = begin; i < end; ++i) {
        const double n = interior[block.interior.force(first + q) + i];
        energy.force += 0.25 * h * weights[q] * section.force_compliance[i] * n * n;
      }
  };
  add_force(0, axial, 0, 1);
  add_force(axial == shear ? 0 : axial, shear, 1, 3);
  for (int j = 0; j <= block.order; ++j)
    for (int i = 0; i < 3; ++i) {
      const double m = interior[block.interior.moment(j) + i];
      energy.moment += 0.5 * h / (2 * j + 1) * section.moment_compliance[i] * m * m;
    }
  return energy;
}

StrainEnergy element_energy(const Structure& structure, const ElementBlock& block, const State& state, int e) {
  const double* interior =
      state.views.interior.data() + block.interior_offset + static_cast<size_t>(e) * block.interior.unknowns();
  if (block.general_section) return general_element_energy(block, e, interior);
  return element_energy(block, interior, block.reference(e, 0), structure.views.sections(block.section(e)));
}

}  // namespace

std::vector<StrainEnergy> strain_energy_of_parts(const Model& model, const State& state, const StructureParts& parts) {
  const Structure& structure = model.structure();
  std::vector<StrainEnergy> sums(parts.count);
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count; ++e) {
      const StrainEnergy energy = element_energy(structure, block, state, e);
      StrainEnergy& sum = sums[parts.of_element[block.first_element + e]];
      sum.force += energy.force;
      sum.moment += energy.moment;
    }
  return sums;
}

StrainEnergy strain_energy(const Model& model, const State& state) {
  const Structure& structure = model.structure();
  double sum[2] = {0.0, 0.0}, total[2];
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count; ++e) {
      if (block.vertices(e, 0) >= structure.owned_vertices) continue;  // another rank answers for it
      const StrainEnergy energy = element_energy(structure, block, state, e);
      sum[0] += energy.force;
      sum[1] += energy.moment;
    }
  Teuchos::reduceAll(*model.map()->getComm(), Teuchos::REDUCE_SUM, 2, sum, total);
  return {total[0], total[1]};
}

}  // namespace mixbeam
