/// Memory layout of the data of one element, and the tables of its shape functions.
#pragma once

#include "kernels/element/force_integration.hpp"
#include "kernels/math/gauss.hpp"
#include "kernels/math/legendre.hpp"
#include "kernels/math/rotation.hpp"

namespace mixbeam {

constexpr int kMaximumOrder = 8;

/// Number of Gauss points that carry a material force N. If the axial and shear parts use different rules, the element
/// carries both sets of points, each with the other part masked out.
constexpr int force_point_count(int order, ForceIntegration rule) {
  const int axial = axial_points(order, rule), shear = shear_points(order, rule);
  return axial == shear ? axial : axial + shear;
}

/// Offsets into the interior unknowns of one element of order k with n force points, theory (8):
///   N (n, 3) material | M (k + 1, 3) material, Legendre coefficients | psi (k - 1, 3) relative rotation, Legendre
///   degree 1..k-1 | beta (k - 1, 3) spatial, u' = (u_b - u_a)/h + sum_j beta_j P_j.
/// An increment and a residual have the same layout with three more entries at the end: the spin w of the element
/// triad, Lambda_lo <- Lambda_lo exp(hat w), and its moment equation. The triad itself is stored separately as a
/// quaternion.
struct InteriorLayout {
  int order = 0, force_points = 0;
  KOKKOS_INLINE_FUNCTION constexpr int force(int q) const { return 3 * q; }
  KOKKOS_INLINE_FUNCTION constexpr int moment(int j) const { return 3 * (force_points + j); }
  KOKKOS_INLINE_FUNCTION constexpr int relative_rotation(int j) const {
    return 3 * (force_points + order + j);
  }  // j = 1..k-1
  KOKKOS_INLINE_FUNCTION constexpr int bubble(int j) const {
    return 3 * (force_points + 2 * order - 1 + j);
  }  // j = 1..k-1
  KOKKOS_INLINE_FUNCTION constexpr int unknowns() const { return 3 * (force_points + 3 * order - 1); }
  KOKKOS_INLINE_FUNCTION constexpr int spin() const { return unknowns(); }
  KOKKOS_INLINE_FUNCTION constexpr int increments() const { return unknowns() + 3; }
};

/// Offsets into the reference data of one element: length h | reference triads at both ends (quaternions, relative to
/// this element) | unit tangent r0' at the force points | material curvature kappa0 at the k + 1 moment points.
struct ReferenceLayout {
  int order = 0, force_points = 0;
  KOKKOS_INLINE_FUNCTION constexpr int length() const { return 0; }
  KOKKOS_INLINE_FUNCTION constexpr int end_triad(int end) const { return 1 + 4 * end; }
  KOKKOS_INLINE_FUNCTION constexpr int tangent(int q) const { return 9 + 3 * q; }
  KOKKOS_INLINE_FUNCTION constexpr int curvature(int q) const { return 9 + 3 * (force_points + q); }
  KOKKOS_INLINE_FUNCTION constexpr int size() const { return 9 + 3 * (force_points + order + 1); }
};

/// Offsets into the compliances of one element with a general section (coupled, or varying along the element), 3 x 3
/// row-major blocks of the 6 x 6 compliance S: S_NN and S_NM at the force points, S_MM at the k + 1 moment points.
struct GeneralSectionLayout {
  int order = 0, force_points = 0;
  KOKKOS_INLINE_FUNCTION int force_force(int q) const { return 18 * q; }
  KOKKOS_INLINE_FUNCTION int force_moment(int q) const { return 18 * q + 9; }
  KOKKOS_INLINE_FUNCTION int moment_moment(int q) const { return 18 * force_points + 9 * q; }
  KOKKOS_INLINE_FUNCTION constexpr int size() const { return 18 * force_points + 9 * (order + 1); }
};

/// Quadrature points of the element and its shape functions there, for one order and integration rule.
template <int K>
struct ElementTables {
  static constexpr int kMaximumForcePoints = 2 * K + 1;
  int force_points = 0;
  double force_xi[kMaximumForcePoints];
  double force_weight[kMaximumForcePoints];
  double axial[kMaximumForcePoints];  ///< 1 where the axial part is integrated, else 0
  double shear[kMaximumForcePoints];
  double force_legendre[kMaximumForcePoints][K];  ///< P_0 .. P_{k-1}
  double moment_xi[K + 1];
  double moment_weight[K + 1];
  double moment_legendre[K + 1][K + 1];  ///< P_0 .. P_k
  double moment_slope[K + 1][K];         ///< dP_0/dxi .. dP_{k-1}/dxi
  double moment_bubble[K + 1][K];        ///< B_0 .. B_{k-1}: B_0 = xi, B_j = int P_j

  explicit ElementTables(ForceIntegration rule) {
    const int axial_count = axial_points(K, rule), shear_count = shear_points(K, rule);
    const bool together = axial_count == shear_count;
    add_force_points(axial_count, 1.0, together ? 1.0 : 0.0);
    if (!together) add_force_points(shear_count, 0.0, 1.0);
    gauss_rule(K + 1, moment_xi, moment_weight);
    for (int q = 0; q <= K; ++q) {
      legendre(K, moment_xi[q], moment_legendre[q]);
      double slope[K + 1];
      legendre_derivatives(K, moment_xi[q], slope);
      for (int j = 0; j < K; ++j) moment_slope[q][j] = slope[j];
      double bubble[K + 1];
      integrated_legendre(K - 1, moment_xi[q], bubble);
      moment_bubble[q][0] = moment_xi[q];
      for (int j = 1; j < K; ++j) moment_bubble[q][j] = bubble[j];
    }
  }

 private:
  void add_force_points(int count, double axial_mask, double shear_mask) {
    gauss_rule(count, force_xi + force_points, force_weight + force_points);
    for (int i = 0; i < count; ++i, ++force_points) {
      axial[force_points] = axial_mask;
      shear[force_points] = shear_mask;
      double value[K + 1];
      legendre(K, force_xi[force_points], value);
      for (int j = 0; j < K; ++j) force_legendre[force_points][j] = value[j];
    }
  }
};

// Instantiated once, in element/layout.cpp: the linker might otherwise keep a copy from a file that is not optimised.
extern template struct ElementTables<1>;
extern template struct ElementTables<2>;
extern template struct ElementTables<3>;
extern template struct ElementTables<4>;
extern template struct ElementTables<5>;
extern template struct ElementTables<6>;
extern template struct ElementTables<7>;
extern template struct ElementTables<8>;

/// Constants of a section as the element uses them. A rigid component has compliance zero.
template <class Real>
struct SectionNumbers {
  Real force_compliance[3];         ///< 1/EA, 1/GA2, 1/GA3: the residual
  Real tangent_force_stiffness[3];  ///< EA, GA2, GA3 capped: the tangent only
  Real moment_stiffness[3];         ///< GIt, EI2, EI3 capped: the tangent only
  Real moment_compliance[3];        ///< 1/GIt, 1/EI2, 1/EI3: the residual

  static constexpr int kCount = 12;  ///< all of these as one array
  KOKKOS_INLINE_FUNCTION Real* numbers() { return force_compliance; }
  KOKKOS_INLINE_FUNCTION const Real* numbers() const { return force_compliance; }
};
static_assert(sizeof(SectionNumbers<double>) == SectionNumbers<double>::kCount * sizeof(double));

/// Constants of a section, including those of the cap.
struct SectionConstants : SectionNumbers<double> {
  double force_cap_compliance[3];  ///< tangent compliance minus the true one: zero unless capped
  double moment_cap_compliance[3];
  /// General sections, tangent only: diagonal compliances of S_NN and S_MM are raised to at least the inverse of these.
  double force_stiffness_limit, moment_stiffness_limit;
};

/// Vector fields along an element: loads per unit reference length, and eigenstrains.
enum class LineField {
  dead_force,       ///< at the k + 1 moment points, spatial
  dead_couple,      ///< same points, spatial
  follower_force,   ///< at the k + 1 moment points, components in Lambda_E there
  follower_couple,  ///< likewise
  eigenstrain,      ///< of gamma at the force points, material
  eigencurvature    ///< of kappa at the moment points, material
};
constexpr int kLineFields = 6;

/// Number of points of an element at which a line field has values.
constexpr int line_field_points(LineField field, int order, int force_points) {
  return field == LineField::eigenstrain ? force_points : order + 1;
}

/// Line fields of one element at the current load factor, (point, 3) each; null if absent.
template <class Real = double>
struct ElementFields {
  const Real* values[kLineFields] = {};
  KOKKOS_INLINE_FUNCTION const Real* operator[](LineField field) const { return values[static_cast<int>(field)]; }
  /// True if a field that has no potential acts.
  KOKKOS_INLINE_FUNCTION bool have_no_potential() const {
    return values[static_cast<int>(LineField::dead_couple)] != nullptr ||
           values[static_cast<int>(LineField::follower_force)] != nullptr ||
           values[static_cast<int>(LineField::follower_couple)] != nullptr;
  }
};

using Vec = Vec3<double>;
using Mat = Mat3<double>;
using Quat = Quaternion<double>;

template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec3<Real> load_vector(const Real* x) {
  return {{x[0], x[1], x[2]}};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void store_vector(const Vec3<Real>& v, Real* x) {
  x[0] = v[0];
  x[1] = v[1];
  x[2] = v[2];
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Quaternion<Real> load_quaternion(const Real* x) {
  return {x[0], x[1], x[2], x[3]};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void store_quaternion(const Quaternion<Real>& q, Real* x) {
  x[0] = q.w;
  x[1] = q.x;
  x[2] = q.y;
  x[3] = q.z;
}

}  // namespace mixbeam
