/// Selective integration of the force-strain energy (the paper's locking study).
#pragma once

namespace mixbeam {

/// Parts of the force-strain energy, theory (13), that are integrated with k ("reduced") instead of k + 1 Gauss points.
enum class ForceIntegration { full, axial_reduced, shear_reduced, both_reduced };

/// Gauss points of the axial part of the force-strain energy for elements of order k.
constexpr int axial_points(int order, ForceIntegration rule) {
  return (rule == ForceIntegration::axial_reduced || rule == ForceIntegration::both_reduced) ? order : order + 1;
}

/// Gauss points of the shear part of the force-strain energy for elements of order k.
constexpr int shear_points(int order, ForceIntegration rule) {
  return (rule == ForceIntegration::shear_reduced || rule == ForceIntegration::both_reduced) ? order : order + 1;
}

}  // namespace mixbeam
