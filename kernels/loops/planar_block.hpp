/// Parallel loops over the elements of a block that move in a plane, several side by side. States, interior residuals
/// and increments are spatial, with the layout of loops/block.hpp; out-of-plane components are zero. Vertex rows
/// (ElementEquations::planar_rows) and tangents are in the plane.
#pragma once

#include "kernels/element/layout.hpp"
#include "kernels/execution/pack.hpp"
#include "kernels/loops/block.hpp"

namespace mixbeam {

/// Normal n of a plane and two directions in it, p x q = n, orthonormal.
struct PlaneAxes {
  Vec p, q, n;
};

/// Material axis of an element that is normal to the plane, and directions of the others. g1 is in the plane.
struct PlanarOrientation {
  double w[4], z[4];  ///< scalar product of a triad (quaternion) with these: cosine and sine of half its angle
  double about;       ///< sign of the normal material axis against n
  double across;      ///< sign of the third axis against n x g1
  bool third_is_normal;
};

/// Sizes per element of an order in PlanarBlock: constants, and data that the tangent keeps for the recovery.
constexpr int planar_constants_size(int order) { return 6 + 3 * order; }
constexpr int planar_response_size(int order) { return 5 * (6 * order - 1); }

/// Constant data of the elements of one block, `lanes` of them side by side in a pack.
struct PlanarBlock {
  int lanes = kLanes;
  PlaneAxes axes;
  PlanarOrientation orientation[4];
  KernelView<int*> orientation_of;  ///< (element of the block)
  SharedRows constants;             ///< (pack, PlanarConstants of all lanes)
  KernelView<double**> response;    ///< (pack, row of PlanarRows, column, lane): from the last tangent

  int packs() const { return (static_cast<int>(orientation_of.extent(0)) + lanes - 1) / lanes; }
};

/// Requires plain sections, k points for both parts of the force strain, and g2 or g3 and the curvature of each element
/// normal to the plane. Line fields: dead forces in the plane, and eigenstrains that keep it in the plane.
PlanarBlock make_planar_block(const ElementBlock& block, const PlaneAxes& axes, int lanes = kLanes);

using PlanarTangents = KernelView<double* [kPlanarTangent]>;  ///< (element, TangentLayout in a plane)

/// Evaluates the residual like evaluate_residual, for states in the plane; vertex rows go to planar_rows.
void evaluate_planar_residual(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                              const StateViews& state, const ElementEquations& equations);

/// Condensed tangent and residual in the plane and the response of the interior unknowns.
void evaluate_planar_tangent(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                             const StateViews& state, const PlanarTangents& tangents,
                             const ElementEquations& equations);

/// Same as condense_right_hand_side; out-of-plane rows of `rhs_interior` are ignored.
void condense_planar_right_hand_side(const ElementBlock& block, const PlanarBlock& planar,
                                     const StructureViews& structure, const StateViews& state,
                                     const KernelView<const double*>& rhs_interior, const PlanarTangents& tangents,
                                     const ElementEquations& equations);

/// Equivalent to condense_planar_right_hand_side() for a right-hand side of zero.
void clear_planar_right_hand_side(const PlanarBlock& planar);

/// Increments of all interior unknowns from the vertex increment (vertex, 6; spatial, in the plane).
void recover_planar_interior(const ElementBlock& block, const PlanarBlock& planar,
                             const KernelView<const double* [6]>& vertex_increment,
                             const KernelView<double*>& increment);

}  // namespace mixbeam
