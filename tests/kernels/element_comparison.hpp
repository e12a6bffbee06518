/// What the tests of the element compare: rows and condensed equations of the kernels with derivatives of the energy.
#pragma once

#include "tests/kernels/element_derivatives.hpp"
#include "tests/kernels/element_samples.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <vector>

namespace mixbeam::element_test {

/// First derivatives differ by the rounding of two ways to sum some hundred terms (at most 1.2e-14 in 1920 random
/// elements).
inline constexpr double kGradientTolerance = 1e-13;

/// Tangent and recovery solve an indefinite system at a random state, so some are nearly singular (at most 1.5e-12,
/// mostly 1e-14, in 1920 random elements).
inline constexpr double kTangentTolerance = 2e-11;

/// Entries of one kind share a unit, so errors are compared with the largest entry of their kind.
enum Kind { kDisplacement, kVertexSpin, kForce, kMoment, kPsi, kSlope, kElementSpin, kKinds };

inline std::vector<Kind> kinds_of(const EnergyState<double>& state) {
  std::vector<Kind> kinds;
  const auto add = [&kinds](size_t blocks, Kind kind) { kinds.insert(kinds.end(), 3 * blocks, kind); };
  for (int end = 0; end < 2; ++end) {
    add(1, kDisplacement);
    add(1, kVertexSpin);
  }
  add(state.force.size(), kForce);
  add(state.moment.size(), kMoment);
  add(state.relative_rotation.size(), kPsi);
  add(state.slope.size(), kSlope);
  add(1, kElementSpin);
  return kinds;
}

/// Largest difference relative to the largest expected entry of its kind.
class Difference {
 public:
  void add(int kind, double found, double expected) {
    scale_[kind] = std::max(scale_[kind], std::fabs(expected));
    // a NaN is the largest error
    if (!(std::fabs(found - expected) <= error_[kind])) error_[kind] = std::fabs(found - expected);
  }
  double relative() const {
    double worst = 0.0;
    for (int kind = 0; kind < kMaximumKinds; ++kind)
      if (!(error_[kind] <= worst * scale_[kind])) worst = error_[kind] / scale_[kind];
    return worst;
  }

 private:
  static constexpr int kMaximumKinds = 8;
  double scale_[kMaximumKinds] = {}, error_[kMaximumKinds] = {};
};

inline double difference(const std::vector<double>& found, const std::vector<double>& expected,
                         const std::vector<Kind>& kinds) {
  Difference d;
  for (size_t i = 0; i < expected.size(); ++i) d.add(kinds[i], found[i], expected[i]);
  return d.relative();
}

inline std::vector<double> energy_gradient(const EnergyElement& element, const EnergyState<double>& state) {
  return gradient_at_zero(number_of_increments(state),
                          [&](const Fad* x) { return element_energy(element, perturbed(state, x)); });
}

/// Second derivatives at increment zero: spins enter through exp with its second-order term, so the Hessian is
/// symmetric.
inline Dense energy_hessian(const EnergyElement& element, const EnergyState<double>& state) {
  return hessian_at_zero(number_of_increments(state),
                         [&](const FadOfFad* x) { return element_energy(element, perturbed(state, x)); });
}

/// Quadrature weight (with ds) of each component of N, zero where the other part of the energy is integrated. The
/// kernels' rows of N are strains, those of the energy carry the weight.
inline std::vector<double> force_weights(const EnergyElement& element) {
  const int axial = axial_points(element.order, element.rule), shear = shear_points(element.order, element.rule);
  std::vector<double> result;
  const auto add = [&](int points, bool with_axial, bool with_shear) {
    std::vector<double> xi(points), weight(points);
    gauss_rule(points, xi.data(), weight.data());
    for (int q = 0; q < points; ++q)
      for (int i = 0; i < 3; ++i)
        result.push_back((i == 0 ? with_axial : with_shear) ? 0.5 * element.curve.length * weight[q] : 0.0);
  };
  add(axial, true, axial == shear);
  if (axial != shear) add(shear, false, true);
  return result;
}

/// Interior increments that exist: components of N without weight do not.
inline std::vector<int> eliminated_rows(const EnergyElement& element, int increments) {
  std::vector<int> rows;
  const std::vector<double> weights = force_weights(element);
  for (int i = kVertexIncrements; i < increments; ++i) {
    const size_t force = i - kVertexIncrements;
    if (force >= weights.size() || weights[force] > 0.0) rows.push_back(i);
  }
  return rows;
}

/// Rows (vertex | interior) as the kernels write them for element e, with the N rows weighted.
inline std::vector<double> weighted_rows(const SampleBlock& samples, int e, const EnergyElement& element) {
  std::vector<double> rows;
  for (int i = 0; i < kVertexIncrements; ++i) rows.push_back(samples.equations.residual(samples.element_row(e), i));
  const std::vector<double> weights = force_weights(element);
  for (int i = 0; i < samples.increments(); ++i) {
    const double weight = i < static_cast<int>(weights.size()) ? weights[i] : 1.0;
    rows.push_back(weight * samples.equations.interior_residual(samples.interior_row(e) + i));
  }
  return rows;
}

/// Largest relative difference of the condensed tangent, the condensed residual and the recovered interior increments.
struct CondensedDifference {
  double tangent, gradient, recovery;
  double largest() const { return std::max({tangent, gradient, recovery}); }
};

inline std::ostream& operator<<(std::ostream& out, const CondensedDifference& d) {
  return out << "differences: tangent " << d.tangent << ", residual " << d.gradient << ", recovery " << d.recovery;
}

inline double tangent_difference(const SampleBlock& samples, const SchurComplement& expected) {
  Difference d;
  for (int i = 0; i < kVertexIncrements; ++i)
    for (int j = 0; j < kVertexIncrements; ++j)
      d.add(2 * (i / 3 % 2) + j / 3 % 2, samples.equations.condensed_tangent(samples.element_row(0), 12 * i + j),
            expected.tangent[i][j]);
  return d.relative();
}

inline double condensed_residual_difference(const SampleBlock& samples, const SchurComplement& expected) {
  Difference d;
  for (int i = 0; i < kVertexIncrements; ++i)
    d.add(i / 3 % 2, samples.equations.condensed_residual(samples.element_row(0), i), expected.gradient[i]);
  return d.relative();
}

/// Recovers the interior for a random vertex increment.
inline double recovery_difference(const SampleBlock& samples, const ElementSample& sample,
                                  const SchurComplement& expected, const std::vector<int>& eliminated) {
  RandomNumbers random(sample.state.force.size());
  const KernelView<double* [6]> vertex_increment("vertex_increment", 2);
  const KernelView<double*> increment = samples.constants();
  std::vector<double> one(kVertexIncrements + 1, 1.0);  // (vertex increments, 1)
  for (int i = 0; i < kVertexIncrements; ++i)
    vertex_increment(samples.vertex(0, i / 6), i % 6) = one[i] = random.between(-1.0, 1.0);
  recover_interior(samples.block, samples.structure, samples.state, samples.equations, vertex_increment, increment);
  std::vector<double> found(number_of_increments(sample.state), 0.0), solved = found;
  for (int i = 0; i < samples.increments(); ++i) found[kVertexIncrements + i] = increment(samples.interior_row(0) + i);
  for (size_t i = 0; i < eliminated.size(); ++i)
    for (int c = 0; c <= kVertexIncrements; ++c) solved[eliminated[i]] += expected.response[i][c] * one[c];
  return difference(found, solved, kinds_of(sample.state));
}

/// What evaluate_tangent or condense_right_hand_side has left for the one element of `samples`, against the elimination
/// of the interior in a dense matrix.
inline CondensedDifference condensed_difference(const SampleBlock& samples, const ElementSample& sample,
                                                const Dense& hessian, const std::vector<double>& gradient) {
  const std::vector<int> eliminated = eliminated_rows(sample.element, hessian.size);
  const SchurComplement expected = schur_complement(hessian, gradient, kVertexIncrements, eliminated);
  return {tangent_difference(samples, expected), condensed_residual_difference(samples, expected),
          recovery_difference(samples, sample, expected, eliminated)};
}

}  // namespace mixbeam::element_test
