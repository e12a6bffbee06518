/// The energy of one element as the paper writes it (section "Mixed finite-element formulation"), templated on the
/// scalar:
///   sum over Gauss points of the force strain [N . gamma - N . C_gamma^-1 N / 2] ds,      gamma = Lambda_E^T r' - e1
/// + sum over k + 1 Gauss points [M . kappa - M . C_kappa^-1 M / 2] ds,                   kappa = T(psi)^T psi' -
/// kappa0
/// + [ log(Lambda_E^T Lambda_V Lambda_0) . M ] at the right end minus the same at the left end.
/// Nothing but rotations, Legendre polynomials and Gauss rules is shared with the element of the kernels: no element
/// frame, no eliminated unknown, no derivative by hand.
#pragma once

#include "kernels/element/force_integration.hpp"
#include "kernels/math/gauss.hpp"
#include "kernels/math/legendre.hpp"
#include "kernels/math/rotation.hpp"

#include <vector>

namespace mixbeam::element_test {

/// Reference curve with triads Lambda_0(s) = start exp(hat(turn s + bend s^2)): tangent and curvature are exact at any
/// point.
struct EnergyCurve {
  double length;
  Quaternion<double> start;
  Vec3<double> turn, bend;

  double arc_length(double xi) const { return 0.5 * length * (1.0 + xi); }
  Vec3<double> rotation_vector(double xi) const {
    const double s = arc_length(xi);
    return s * turn + (s * s) * bend;
  }
  Quaternion<double> triad(double xi) const { return start * exp_quaternion(rotation_vector(xi)); }
  /// r0' = Lambda_0 e1
  Vec3<double> tangent(double xi) const { return rotation_matrix(triad(xi)) * Vec3<double>{{1.0, 0.0, 0.0}}; }
  /// kappa0, hat(kappa0) = Lambda_0^T Lambda_0'
  Vec3<double> curvature(double xi) const {
    const Vec3<double> slope = turn + (2.0 * arc_length(xi)) * bend;
    return transpose_times(tangent_map(rotation_vector(xi)), slope);
  }
};

/// A vector that is linear along the element.
struct LinearField {
  Vec3<double> middle{}, slope{};
  LinearField() = default;
  LinearField(const Vec3<double>& constant) : middle(constant) {}  // NOLINT: a constant is a field
  LinearField(const Vec3<double>& m, const Vec3<double>& s) : middle(m), slope(s) {}
  Vec3<double> at(double xi) const { return middle + xi * slope; }
  bool is_zero() const { return dot(middle, middle) + dot(slope, slope) == 0.0; }
};

/// What an element is made of.
struct EnergyElement {
  int order;
  ForceIntegration rule;
  EnergyCurve curve;
  Vec3<double> force_compliance, moment_compliance;
  LinearField line_force{}, line_couple{};          ///< dead, per length
  LinearField follower_force{}, follower_couple{};  ///< per length, components in Lambda_E
  LinearField eigenstrain{}, eigencurvature{};      ///< material
};

/// Unknowns of one element. N: the points of the axial part, then those of the shear part unless they are the same
/// points.
template <class S>
struct EnergyState {
  Vec3<S> displacement[2];                 ///< of the vertices, spatial
  Quaternion<S> vertex_rotation[2];        ///< Lambda_V
  Quaternion<S> element_triad;             ///< Lambda_lo
  std::vector<Vec3<S>> force;              ///< N at its Gauss points, material
  std::vector<Vec3<S>> moment;             ///< M: Legendre degree 0..k, material
  std::vector<Vec3<S>> relative_rotation;  ///< psi_ho: Legendre degree 1..k-1
  std::vector<Vec3<S>> slope;              ///< u' beyond its mean: Legendre degree 1..k-1, spatial
};

constexpr int kVertexIncrements = 12;

template <class S>
int number_of_increments(const EnergyState<S>& state) {
  return kVertexIncrements + 3 * static_cast<int>(state.force.size() + state.moment.size() +
                                                  state.relative_rotation.size() + state.slope.size() + 1);
}

template <class S, class T>
Vec3<S> as_scalar(const Vec3<T>& v) {
  return {{S(v[0]), S(v[1]), S(v[2])}};
}
template <class S, class T>
Quaternion<S> as_scalar(const Quaternion<T>& q) {
  return {S(q.w), S(q.x), S(q.y), S(q.z)};
}

template <class S, class T>
EnergyState<S> converted(const EnergyState<T>& state) {
  EnergyState<S> result;
  const auto convert = [](const std::vector<Vec3<T>>& from, std::vector<Vec3<S>>& to) {
    for (const auto& v : from) to.push_back(as_scalar<S>(v));
  };
  for (int end = 0; end < 2; ++end) {
    result.displacement[end] = as_scalar<S>(state.displacement[end]);
    result.vertex_rotation[end] = as_scalar<S>(state.vertex_rotation[end]);
  }
  result.element_triad = as_scalar<S>(state.element_triad);
  convert(state.force, result.force);
  convert(state.moment, result.moment);
  convert(state.relative_rotation, result.relative_rotation);
  convert(state.slope, result.slope);
  return result;
}

/// State after the increments (u_a, theta_a, u_b, theta_b | N | M | psi | u' | w): spins of the vertices exp(hat theta)
/// Lambda_V and of the element triad Lambda_lo exp(hat w), the rest additive.
template <class S, class T>
EnergyState<S> perturbed(const EnergyState<T>& state, const S* increment) {
  EnergyState<S> result = converted<S>(state);
  const auto next = [&increment] {
    const Vec3<S> v{{increment[0], increment[1], increment[2]}};
    increment += 3;
    return v;
  };
  for (int end = 0; end < 2; ++end) {
    result.displacement[end] += next();
    result.vertex_rotation[end] = exp_quaternion(next()) * result.vertex_rotation[end];
  }
  for (auto* field : {&result.force, &result.moment, &result.relative_rotation, &result.slope})
    for (auto& coefficient : *field) coefficient += next();
  result.element_triad = result.element_triad * exp_quaternion(next());
  return result;
}

/// sum_j coefficient_j shape_j with shape functions of degree first, first + 1, ...
template <class S>
Vec3<S> legendre_sum(const std::vector<Vec3<S>>& coefficients, int first, const double* shape) {
  Vec3<S> sum{{S(0.0), S(0.0), S(0.0)}};
  for (size_t j = 0; j < coefficients.size(); ++j) sum += shape[first + j] * coefficients[j];
  return sum;
}

/// psi_ho at xi.
template <class S>
Vec3<S> relative_rotation_at(const EnergyState<S>& state, double xi) {
  double p[16];
  legendre(static_cast<int>(state.moment.size()), xi, p);
  return legendre_sum(state.relative_rotation, 1, p);
}

/// Lambda_E = Lambda_lo exp(hat psi_ho) at xi.
template <class S>
Quaternion<S> element_rotation_at(const EnergyState<S>& state, double xi) {
  return state.element_triad * exp_quaternion(relative_rotation_at(state, xi));
}

/// gamma = Lambda_E^T r' - e1 at xi.
template <class S>
Vec3<S> force_strain_at(const EnergyElement& element, const EnergyState<S>& state, double xi) {
  double p[16];
  legendre(element.order, xi, p);
  const Vec3<S> mean_slope = (1.0 / element.curve.length) * (state.displacement[1] - state.displacement[0]);
  const Vec3<S> slope = as_scalar<S>(element.curve.tangent(xi)) + mean_slope + legendre_sum(state.slope, 1, p);
  Vec3<S> strain = transpose_times(rotation_matrix(element_rotation_at(state, xi)), slope);
  strain[0] -= 1.0;
  return strain;
}

/// kappa = T(psi)^T psi' - kappa0 at xi.
template <class S>
Vec3<S> moment_strain_at(const EnergyElement& element, const EnergyState<S>& state, double xi) {
  double slope[16];
  legendre_derivatives(element.order, xi, slope);
  const Vec3<S> psi_slope = (2.0 / element.curve.length) * legendre_sum(state.relative_rotation, 1, slope);
  return transpose_times(tangent_map(relative_rotation_at(state, xi)), psi_slope) -
         as_scalar<S>(element.curve.curvature(xi));
}

/// Sum over the Gauss points of one part of the force strain (components first..last), N starting at its point
/// `offset`.
template <class S>
S force_energy(const EnergyElement& element, const EnergyState<S>& state, int points, int offset, int first, int last) {
  std::vector<double> xi(points), weight(points);
  gauss_rule(points, xi.data(), weight.data());
  S energy(0.0);
  for (int q = 0; q < points; ++q) {
    const Vec3<S> strain = force_strain_at(element, state, xi[q]) - as_scalar<S>(element.eigenstrain.at(xi[q]));
    const Vec3<S>& force = state.force[offset + q];
    for (int i = first; i <= last; ++i)
      energy += (0.5 * element.curve.length * weight[q]) *
                (force[i] * strain[i] - (0.5 * element.force_compliance[i]) * force[i] * force[i]);
  }
  return energy;
}

template <class S>
S moment_energy(const EnergyElement& element, const EnergyState<S>& state) {
  const int points = element.order + 1;
  std::vector<double> xi(points), weight(points);
  gauss_rule(points, xi.data(), weight.data());
  S energy(0.0);
  for (int q = 0; q < points; ++q) {
    double p[16];
    legendre(element.order, xi[q], p);
    const Vec3<S> moment = legendre_sum(state.moment, 0, p);
    const Vec3<S> strain = moment_strain_at(element, state, xi[q]) - as_scalar<S>(element.eigencurvature.at(xi[q]));
    for (int i = 0; i < 3; ++i)
      energy += (0.5 * element.curve.length * weight[q]) *
                (moment[i] * strain[i] - (0.5 * element.moment_compliance[i]) * moment[i] * moment[i]);
  }
  return energy;
}

/// Work of the moment on the relative rotation between element and vertices (discrete curvature).
template <class S>
S end_energy(const EnergyElement& element, const EnergyState<S>& state) {
  S energy(0.0);
  for (int end = 0; end < 2; ++end) {
    const double xi = end == 0 ? -1.0 : 1.0;
    double p[16];
    legendre(element.order, xi, p);
    const Quaternion<S> at_vertex = state.vertex_rotation[end] * as_scalar<S>(element.curve.triad(xi));
    const Vec3<S> angle = log_quaternion(conjugate(element_rotation_at(state, xi)) * at_vertex);
    energy += xi * dot(angle, legendre_sum(state.moment, 0, p));
  }
  return energy;
}

/// u = (1 - xi)/2 u_a + (1 + xi)/2 u_b + h/2 sum_j beta_j int P_j
template <class S>
Vec3<S> displacement_at(const EnergyElement& element, const EnergyState<S>& state, double xi) {
  double bubble[16];
  integrated_legendre(element.order, xi, bubble);
  return (0.5 * (1.0 - xi)) * state.displacement[0] + (0.5 * (1.0 + xi)) * state.displacement[1] +
         (0.5 * element.curve.length) * legendre_sum(state.slope, 1, bubble);
}

/// Work of the dead line force.
template <class S>
S line_force_work(const EnergyElement& element, const EnergyState<S>& state) {
  const int points = element.order + 1;
  std::vector<double> xi(points), weight(points);
  gauss_rule(points, xi.data(), weight.data());
  S work(0.0);
  for (int q = 0; q < points; ++q)
    work += (0.5 * element.curve.length * weight[q]) *
            dot(as_scalar<S>(element.line_force.at(xi[q])), displacement_at(element, state, xi[q]));
  return work;
}

/// Energy of the element minus the work of its dead line force.
template <class S>
S element_energy(const EnergyElement& element, const EnergyState<S>& state) {
  const int axial = axial_points(element.order, element.rule), shear = shear_points(element.order, element.rule);
  return force_energy(element, state, axial, 0, 0, 0) +
         force_energy(element, state, shear, axial == shear ? 0 : axial, 1, 2) + moment_energy(element, state) +
         end_energy(element, state) - line_force_work(element, state);
}

/// int c . dtheta_E + f . du ds of the loads that have no energy, for the small motion from `before` to `after`: the
/// small spatial spin dtheta_E is exact to first order (the vector part of the quaternion of a small rotation is half
/// of its rotation vector); followers have their directions of `before`.
template <class S>
S line_load_work(const EnergyElement& element, const EnergyState<S>& before, const EnergyState<S>& after) {
  const int points = element.order + 1;
  std::vector<double> xi(points), weight(points);
  gauss_rule(points, xi.data(), weight.data());
  S work(0.0);
  for (int q = 0; q < points; ++q) {
    const Quaternion<S> here = element_rotation_at(before, xi[q]);
    const Mat3<S> triad = rotation_matrix(here);
    const Quaternion<S> turn = element_rotation_at(after, xi[q]) * conjugate(here);
    const Vec3<S> spin{{S(2.0 * turn.x), S(2.0 * turn.y), S(2.0 * turn.z)}};
    const Vec3<S> couple =
        as_scalar<S>(element.line_couple.at(xi[q])) + triad * as_scalar<S>(element.follower_couple.at(xi[q]));
    const Vec3<S> force = triad * as_scalar<S>(element.follower_force.at(xi[q]));
    const Vec3<S> moved = displacement_at(element, after, xi[q]) - displacement_at(element, before, xi[q]);
    work += (0.5 * element.curve.length * weight[q]) * (dot(couple, spin) + dot(force, moved));
  }
  return work;
}

}  // namespace mixbeam::element_test
