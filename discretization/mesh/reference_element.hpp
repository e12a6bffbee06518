/// Undeformed element: reference data and unknowns that satisfy its equations without any force or moment.
#pragma once

#include "discretization/mesh/mesh.hpp"
#include "kernels/element/layout.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace mixbeam {

/// Undeformed element of order k with n force points. Only the leading entries used by order and rule are set.
struct ReferenceElement {
  static constexpr int kMostForcePoints = 2 * kMaximumOrder + 1;

  Quaternion<double> triad;                                     ///< Lambda_lo
  std::array<Vec3<double>, kMaximumOrder> relative_rotation{};  ///< psi_1 .. psi_{k-1}, Legendre coefficients; [0] = 0
  std::array<Quaternion<double>, 2> end_triad{};                ///< Lambda_0 at the ends
  std::array<Vec3<double>, kMostForcePoints> tangent{};         ///< r0' at the force points, of unit length
  std::array<Vec3<double>, kMaximumOrder + 1> curvature{};      ///< kappa0 at the k + 1 moment points, material
};

/// Reference element `index` of a member, in the discrete fields of the given order.
///
/// Constant curvature: all data are exact, and Lambda_0 = Lambda_lo exp(xi h/2 kappa0) is one of the discrete fields
/// from order 2 on, or with one force point. With two (order 1, force strains not reduced in both parts) the undeformed
/// state of an arc is not stress free, as in the paper.
///
/// Any other curve: Lambda_lo and psi reproduce Lambda_0 at the k Gauss points, so with k force points the tangents are
/// exact and the force strain vanishes; other rules get the tangents of the discrete triad, which are as close to the
/// exact ones as the triads. End triads are exact. kappa0 is the curvature of the discrete fields, not of the curve,
/// jumps at the ends included: the polynomial of degree k with
///   int P_j kappa0 ds = int P_j T(psi)^T psi' ds + phi(+1) - (-1)^j phi(-1),   phi = log(exp(-psi) Lambda_lo^T
///   Lambda_0)
/// for j = 0 .. k, which are the moment equations for zero moment. The undeformed state is thus stress free to rounding
/// for every such curve, order and rule.
/// Throws std::invalid_argument if the curve rotates too far within one element.
ReferenceElement make_reference_element(const MeshMember& member, int index, int order, ForceIntegration rule);

/// psi(xi) of such an element.
Vec3<double> relative_rotation(const ReferenceElement& element, int order, double xi);

/// Gauss rule of 1 .. kMaximumOrder + 1 points, computed once.
struct GaussPoints {
  std::vector<double> xi{}, weight{};
};
const GaussPoints& gauss_points(int count);

/// Rotations Lambda_lo exp(psi) with a psi of degree k - 1 and mean zero.
struct FittedRotation {
  Quaternion<double> triad{};                     ///< Lambda_lo
  std::array<Vec3<double>, kMaximumOrder> psi{};  ///< Legendre coefficients, [0] = 0
  double mean = HUGE_VAL;                         ///< remaining mean of psi: rounding, unless rotations are too large
};
/// Fits rotations to given ones at the points `xi`, whose weights add up to 2: updates Lambda_lo, initially `start`, by
/// the mean of the logarithms until it vanishes.
FittedRotation fit_rotation(const Quaternion<double>& start, const std::vector<Quaternion<double>>& rotation,
                            const std::vector<double>& xi, const std::vector<double>& weight, int order);

}  // namespace mixbeam
