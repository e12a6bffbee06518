/// Floating-point operations of the element kernels.
#pragma once

namespace mixbeam {

/// Of one element with a plain section, all force parts reduced, and without line fields.
struct ElementOperations {
  double residual = 0.0, tangent = 0.0, recovery = 0.0;
};

/// Counted by running the kernels of that order on CountedNumber.
ElementOperations element_operations(int order);
/// The same in a plane, without the projection of displacements, triads and stresses on its axes, which is done by
/// element and not by order.
ElementOperations planar_operations(int order);

}  // namespace mixbeam
