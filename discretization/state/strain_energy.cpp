/// Strain energy of a state and of its parts: see sampling.hpp and structure_parts.hpp.
#include "discretization/mesh/element_view.hpp"
#include "discretization/state/element_polynomials.hpp"
#include "discretization/state/structure_parts.hpp"
#include "kernels/element/section.hpp"

#include <vector>

namespace mixbeam {

namespace {

/// Half the work of N and of M on their strains, which a general section couples.
StrainEnergy general_element_energy(const ElementView& element) {
  const int k = element.order(), n = element.layout().force_points;
  const GeneralSection<> section{&element.block().compliance(element.index(), 0), {k, n}, 0.0, 0.0};
  StrainEnergy energy;
  double points[kMaximumOrder + 1], weights[kMaximumOrder + 1];
  const auto moment_at = [&](double xi) {
    double P[kMaximumOrder + 1];
    legendre(k, xi, P);
    return element.moment_at(P);
  };
  const double quarter = 0.25 * element.length();  // half of ds = h/2 dxi
  gauss_rule(n, points, weights);
  for (int q = 0; q < n; ++q) {
    const Vec force = element.force(q);
    const double coupled = dot(force, section.force_moment(q) * moment_at(points[q]));
    energy.force += quarter * weights[q] * (dot(force, section.force_force(q) * force) + coupled);
    energy.moment += quarter * weights[q] * coupled;
  }
  gauss_rule(k + 1, points, weights);
  for (int q = 0; q <= k; ++q) {
    const Vec moment = moment_at(points[q]);
    energy.moment += quarter * weights[q] * dot(moment, section.moment_moment(q) * moment);
  }
  return energy;
}

}  // namespace

StrainEnergy element_energy(const ElementView& element) {
  if (element.block().general_section) return general_element_energy(element);
  const SectionConstants& section = element.section();
  const double h = element.length();
  StrainEnergy energy;
  const auto add_force = [&](int first, int count, int begin, int end) {
    double points[kMaximumOrder + 1], weights[kMaximumOrder + 1];
    gauss_rule(count, points, weights);
    for (int q = 0; q < count; ++q)
      for (int i = begin; i < end; ++i) {
        const double n = element.force(first + q)[i];
        energy.force += 0.25 * h * weights[q] * section.force_compliance[i] * n * n;
      }
  };
  for_each_force_rule(element.order(), element.block().force_integration, add_force);
  for (int j = 0; j <= element.order(); ++j)
    for (int i = 0; i < 3; ++i) {
      const double m = element.moment(j)[i];
      energy.moment += 0.5 * h / (2 * j + 1) * section.moment_compliance[i] * m * m;
    }
  return energy;
}

std::vector<StrainEnergy> strain_energy_of_parts(const Model& model, const State& state, const StructureParts& parts) {
  std::vector<StrainEnergy> sums(parts.count);
  for_each_element(model.structure(), state, [&](const ElementView& element) {
    const StrainEnergy energy = element_energy(element);
    StrainEnergy& sum = sums[parts.of_element[element.local()]];
    sum.force += energy.force;
    sum.moment += energy.moment;
  });
  return sums;
}

StrainEnergy strain_energy(const Model& model, const State& state) {
  double sum[2] = {0.0, 0.0};
  for_each_owned_element(model.structure(), state, [&](const ElementView& element) {
    const StrainEnergy energy = element_energy(element);
    sum[0] += energy.force;
    sum[1] += energy.moment;
  });
  sum_over_ranks(*model.map()->getComm(), sum, 2);
  return {sum[0], sum[1]};
}

}  // namespace mixbeam
