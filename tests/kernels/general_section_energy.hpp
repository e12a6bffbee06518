/// Complementary energy of an element with a general section, as in element_energy.hpp: independent of the kernels, for
/// automatic differentiation.
///   sum over k Gauss points [N . S_NN N / 2 + N . S_NM M] ds + sum over k + 1 Gauss points [M . S_MM M / 2] ds
#pragma once

#include "tests/kernels/element_comparison.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace mixbeam::element_test {

using Compliance6 = std::array<std::array<double, 6>, 6>;

/// S along the element: at_start + (1 + xi)/2 growth, both symmetric and positive semi-definite.
struct GeneralLaw {
  Compliance6 at_start{}, growth{};
  Compliance6 at(double xi) const {
    Compliance6 s;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) s[i][j] = at_start[i][j] + 0.5 * (1.0 + xi) * growth[i][j];
    return s;
  }
};

/// Gauss rule with ds on an element.
struct Rule {
  std::vector<double> xi, weight;
  Rule(int points, double length) : xi(points), weight(points) {
    gauss_rule(points, xi.data(), weight.data());
    for (double& w : weight) w *= 0.5 * length;
  }
};

template <class S>
S quadratic(const Compliance6& s, int row, int column, const Vec3<S>& a, const Vec3<S>& b) {
  S sum(0.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += s[row + i][column + j] * a[i] * b[j];
  return sum;
}

template <class S>
Vec3<S> moment_at(const EnergyElement& element, const EnergyState<S>& state, double xi) {
  double p[16];
  legendre(element.order, xi, p);
  return legendre_sum(state.moment, 0, p);
}

template <class S>
S complementary_energy(const EnergyElement& element, const GeneralLaw& law, const EnergyState<S>& state) {
  S energy(0.0);
  const Rule force(element.order, element.curve.length), moment(element.order + 1, element.curve.length);
  for (size_t q = 0; q < force.xi.size(); ++q) {
    const Compliance6 s = law.at(force.xi[q]);
    energy += force.weight[q] * (0.5 * quadratic(s, 0, 0, state.force[q], state.force[q]) +
                                 quadratic(s, 0, 3, state.force[q], moment_at(element, state, force.xi[q])));
  }
  for (size_t q = 0; q < moment.xi.size(); ++q) {
    const Vec3<S> m = moment_at(element, state, moment.xi[q]);
    energy += (0.5 * moment.weight[q]) * quadratic(law.at(moment.xi[q]), 3, 3, m, m);
  }
  return energy;
}

/// `element` has no compliance of its own.
template <class S>
S general_energy(const EnergyElement& element, const GeneralLaw& law, const EnergyState<S>& state) {
  return element_energy(element, state) - complementary_energy(element, law, state);
}

inline std::vector<double> general_gradient(const EnergyElement& element, const GeneralLaw& law,
                                            const EnergyState<double>& state) {
  return gradient_at_zero(number_of_increments(state),
                          [&](const Fad* x) { return general_energy(element, law, perturbed(state, x)); });
}

inline Dense general_hessian(const EnergyElement& element, const GeneralLaw& law, const EnergyState<double>& state) {
  return hessian_at_zero(number_of_increments(state),
                         [&](const FadOfFad* x) { return general_energy(element, law, perturbed(state, x)); });
}

/// Symmetric and positive definite, of the size of the compliances that random_sample draws: as strongly coupled as a
/// random matrix is.
inline Compliance6 random_compliance(RandomNumbers& random, double size) {
  double factor[6][6];
  for (auto& row : factor)
    for (double& x : row) x = random.between(-1.0, 1.0);
  Compliance6 s;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      double sum = i == j ? 0.3 : 0.0;
      for (int l = 0; l < 6; ++l) sum += factor[i][l] * factor[j][l];
      s[i][j] = size * sum * std::sqrt((i < 3 ? 1.0 / 500.0 : 0.2) * (j < 3 ? 1.0 / 500.0 : 0.2));
    }
  return s;
}

/// Makes components rigid.
inline void set_rigid(GeneralLaw& law, const std::vector<int>& components) {
  for (int c : components)
    for (int i = 0; i < 6; ++i) law.at_start[i][c] = law.at_start[c][i] = law.growth[i][c] = law.growth[c][i] = 0.0;
}

/// Takes out what couples N and M.
inline void uncouple(GeneralLaw& law) {
  for (Compliance6* s : {&law.at_start, &law.growth})
    for (int i = 0; i < 3; ++i)
      for (int j = 3; j < 6; ++j) (*s)[i][j] = (*s)[j][i] = 0.0;
}

/// The law as the tangent takes it: S_NN and S_MM with no entry of the diagonal below 1/limit. For laws whose diagonal
/// is zero or far above that.
inline GeneralLaw capped_law(GeneralLaw law, double force_limit, double moment_limit) {
  for (int i = 0; i < 6; ++i)
    if (law.at_start[i][i] == 0.0) law.at_start[i][i] = 1.0 / (i < 3 ? force_limit : moment_limit);
  return law;
}

/// Writes the compliances of one block's row, as GeneralSectionLayout has them.
inline void fill_compliance(const EnergyElement& element, const GeneralLaw& law, double* row) {
  const GeneralSectionLayout layout{element.order, element.order};
  const auto block = [row](int offset, const Compliance6& s, int first_row, int first_column) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) row[offset + 3 * i + j] = s[first_row + i][first_column + j];
  };
  const Rule force(element.order, element.curve.length), moment(element.order + 1, element.curve.length);
  for (int q = 0; q < element.order; ++q) {
    block(layout.force_force(q), law.at(force.xi[q]), 0, 0);
    block(layout.force_moment(q), law.at(force.xi[q]), 0, 3);
  }
  for (int q = 0; q <= element.order; ++q) block(layout.moment_moment(q), law.at(moment.xi[q]), 3, 3);
}

/// A random element and its law.
struct GeneralSample {
  ElementSample sample;
  GeneralLaw law;
};

inline GeneralSample general_sample(int order, std::uint64_t seed) {
  GeneralSample general;
  general.sample = random_sample({order, ForceIntegration::both_reduced, seed});
  for (int i = 0; i < 3; ++i)
    general.sample.element.force_compliance[i] = general.sample.element.moment_compliance[i] = 0.0;
  RandomNumbers random(seed + 1000);
  general.law = {random_compliance(random, 1.0), random_compliance(random, 1.0)};
  return general;
}

/// Block of elements with general sections.
inline SampleBlock general_block(const std::vector<GeneralSample>& general, double force_limit, double moment_limit,
                                 bool with_loads = false) {
  std::vector<ElementSample> plain;
  for (const GeneralSample& one : general) plain.push_back(one.sample);
  SampleBlock samples(plain, with_loads);
  const int k = samples.block.order, count = samples.block.count;
  samples.block.general_section = true;
  samples.equations.response =
      KernelView<double*>("response", samples.block.response_offset + count * samples.block.response_size());
  samples.block.compliance = KernelView<double**>("compliance", count, GeneralSectionLayout{k, k}.size());
  for (int e = 0; e < count; ++e) {
    fill_compliance(general[e].sample.element, general[e].law, &samples.block.compliance(e, 0));
    SectionConstants& constants = samples.structure.sections(samples.block.section(e));
    constants = {};
    constants.force_stiffness_limit = force_limit;
    constants.moment_stiffness_limit = moment_limit;
  }
  return samples;
}
inline SampleBlock general_block(const GeneralSample& general, double force_limit, double moment_limit) {
  return general_block(std::vector<GeneralSample>{general}, force_limit, moment_limit);
}

}  // namespace mixbeam::element_test
