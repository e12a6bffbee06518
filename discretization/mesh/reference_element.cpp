#include "discretization/mesh/reference_element.hpp"

#include "kernels/math/gauss.hpp"
#include "kernels/math/legendre.hpp"

#include <stdexcept>

namespace mixbeam {
namespace {

constexpr Vec kZero{{0.0, 0.0, 0.0}};
// Largest remaining mean of the relative rotation: rounding. [radian]
constexpr double kMeanTolerance = 1e-15;
constexpr double kAcceptedMean = 1e-13;  // for an undeformed element, if rounding keeps it above
constexpr int kMostIterations = 100;     // the error shrinks by |psi|^2 / 12 or faster
// Rotations from the triad of the element to its ends stay below pi, where the logarithm jumps. [radian]
constexpr double kLargestRotation = 3.0;
constexpr int kTurningSamples = 8;  // of the curvature, per element

double arc_length(const MeshMember& member, int index, double xi) {
  return member.vertex_arc_length(index) + 0.5 * member.element_length(index) * (1.0 + xi);
}

std::invalid_argument turns_too_far() {
  return std::invalid_argument(
      "the undeformed member turns too far in it: by about a full turn, more elements are needed");
}

/// Rejects rotations that comparing triads cannot detect: a full turn between two of them.
void check_turning(const MeshMember& member, int index) {
  double turning = 0.0;  // integral of |kappa0|
  for (int i = 0; i < kTurningSamples; ++i) {
    const double xi = (2 * i + 1.0) / kTurningSamples - 1.0;
    turning +=
        member.element_length(index) / kTurningSamples * norm(member.curve.curvature(arc_length(member, index, xi)));
  }
  if (!(turning <= 2.0 * kLargestRotation)) throw turns_too_far();
}

/// Determines Lambda_lo and psi from the k Gauss points.
void fit_triad(const MeshMember& member, int index, int order, ReferenceElement& element) {
  const GaussPoints& gauss = gauss_points(order);
  std::vector<Quat> exact;
  for (const double xi : gauss.xi) exact.push_back(member.curve.triad(arc_length(member, index, xi)));
  const FittedRotation fit =
      fit_rotation(member.curve.triad(arc_length(member, index, 0.0)), exact, gauss.xi, gauss.weight, order);
  if (!(fit.mean <= kAcceptedMean)) throw turns_too_far();
  element.triad = fit.triad;
  element.relative_rotation = fit.psi;
}

/// Jump log(exp(-psi) Lambda_lo^T Lambda_0) at an end, see EndRotation.
Vec end_jump(const ReferenceElement& element, int order, int end) {
  const Vec psi = relative_rotation(element, order, end == 0 ? -1.0 : 1.0);
  const Vec phi = log_quaternion(conjugate(exp_quaternion(psi)) * (conjugate(element.triad) * element.end_triad[end]));
  if (!(norm(phi) <= kLargestRotation)) throw turns_too_far();
  return phi;
}

/// Sets kappa0 of the discrete fields. Its first part already is a polynomial through the k + 1 moment points.
void fit_curvature(double length, int order, ReferenceElement& element) {
  const GaussPoints& gauss = gauss_points(order + 1);
  const Vec jump[2] = {end_jump(element, order, 0), end_jump(element, order, 1)};
  for (int q = 0; q <= order; ++q) {
    double P[kMaximumOrder + 1], slope[kMaximumOrder + 1];
    legendre(order, gauss.xi[q], P);
    legendre_derivatives(order, gauss.xi[q], slope);
    Vec psi_slope = kZero, jumps = kZero;
    for (int j = 1; j < order; ++j) psi_slope += (2.0 / length * slope[j]) * element.relative_rotation[j];
    for (int j = 0; j <= order; ++j)
      jumps += ((2 * j + 1) / length * P[j]) * (jump[1] - (j % 2 == 0 ? 1.0 : -1.0) * jump[0]);
    const Vec psi = relative_rotation(element, order, gauss.xi[q]);
    element.curvature[q] = transpose_times(tangent_map(psi), psi_slope) + jumps;
  }
}

/// Tangents at the force points, in the order of ElementTables.
void set_tangents(const MeshMember& member, int index, int order, ForceIntegration rule, ReferenceElement& element) {
  const bool is_exact = member.curve.has_constant_curvature() || force_point_count(order, rule) == order;
  const int counts[2] = {axial_points(order, rule), shear_points(order, rule)};
  int point = 0;
  for (int set = 0; set < (counts[0] == counts[1] ? 1 : 2); ++set)
    for (const double xi : gauss_points(counts[set]).xi) {
      Vec& tangent = element.tangent[point++];
      if (is_exact)
        tangent = member.curve.tangent(arc_length(member, index, xi));
      else
        tangent = rotation_matrix(normalized(element.triad * exp_quaternion(relative_rotation(element, order, xi)))) *
                  Vec{{1.0, 0.0, 0.0}};
    }
}

}  // namespace

const GaussPoints& gauss_points(int count) {
  static const std::array<GaussPoints, kMaximumOrder + 2> rules = [] {
    std::array<GaussPoints, kMaximumOrder + 2> all;
    for (int n = 1; n <= kMaximumOrder + 1; ++n) {
      all[n] = {std::vector<double>(n), std::vector<double>(n)};
      gauss_rule(n, all[n].xi.data(), all[n].weight.data());
    }
    return all;
  }();
  return rules[count];
}

FittedRotation fit_rotation(const Quat& start, const std::vector<Quat>& rotation, const std::vector<double>& xi,
                            const std::vector<double>& weight, int order) {
  FittedRotation fit{start};
  for (int i = 0; i < kMostIterations && fit.mean > kMeanTolerance; ++i) {
    fit.psi = {};
    for (size_t q = 0; q < rotation.size(); ++q) {
      const Vec psi = log_quaternion(conjugate(fit.triad) * rotation[q]);
      if (!(norm(psi) <= kLargestRotation)) return {};
      double P[kMaximumOrder + 1];
      legendre(order, xi[q], P);
      for (int j = 0; j < order; ++j) fit.psi[j] += (0.5 * (2 * j + 1) * weight[q] * P[j]) * psi;
    }
    fit.mean = norm(fit.psi[0]);
    if (fit.mean > kMeanTolerance) fit.triad = normalized(fit.triad * exp_quaternion(fit.psi[0]));
  }
  fit.psi[0] = kZero;
  return fit;
}

Vec relative_rotation(const ReferenceElement& element, int order, double xi) {
  double P[kMaximumOrder + 1];
  legendre(order, xi, P);
  Vec psi = kZero;
  for (int j = 1; j < order; ++j) psi += P[j] * element.relative_rotation[j];
  return psi;
}

ReferenceElement make_reference_element(const MeshMember& member, int index, int order, ForceIntegration rule) {
  ReferenceElement element;
  const double start = member.vertex_arc_length(index), length = member.element_length(index);
  for (int end = 0; end < 2; ++end) element.end_triad[end] = member.curve.triad(start + end * length);
  if (member.curve.has_constant_curvature()) {
    element.triad = member.curve.triad(member.arc_length(index, 0.0));
    if (order > 1) element.relative_rotation[1] = (0.5 * length) * member.curve.start_curvature;
    element.curvature.fill(member.curve.start_curvature);
  } else {
    check_turning(member, index);
    fit_triad(member, index, order, element);
    fit_curvature(length, order, element);
  }
  set_tangents(member, index, order, rule, element);
  return element;
}

}  // namespace mixbeam
