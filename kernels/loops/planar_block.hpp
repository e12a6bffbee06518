/// The parallel loops over the elements of a block that move in a plane, several side by side. States, interior
/// residuals and increments have the layout of loops/block.hpp and are spatial; what leaves the plane is zero. Rows
/// of vertices (ElementEquations::planar_rows) and tangents are in the plane.
#pragma once

#include "kernels/element/layout.hpp"
#include "kernels/execution/pack.hpp"
#include "kernels/loops/block.hpp"

namespace mixbeam {

/// Normal n of a plane and two directions in it, p x q = n, orthonormal.
struct PlaneAxes {
  Vec p, q, n;
};

/// Which material axis of an element is normal to the plane, and where the others lie. g1 is in the plane.
struct PlanarOrientation {
  double w[4], z[4];  ///< a triad (quaternion) times these: cosine and sine of half of its angle
  double about;       ///< sign of the normal material axis against n
  double across;      ///< sign of the third axis against n x g1
  bool third_is_normal;
};

/// Numbers of each element of an order in PlanarBlock: constants, and numbers that the tangent keeps for the recovery.
constexpr int planar_constants_size(int order) { return 6 + 3 * order; }
constexpr int planar_response_size(int order) { return 5 * (6 * order - 1); }

/// Constant data of the elements of one block, `lanes` of them side by side in a pack.
struct PlanarBlock {
  int lanes = kLanes;
  PlaneAxes axes;
  PlanarOrientation orientation[4];
  KernelView<int*> orientation_of;  ///< (element of the block)
  SharedRows constants;             ///< (pack, PlanarConstants of all lanes)
  KernelView<double**> response;    ///< (pack, row of PlanarRows, column, lane): of the last tangent

  int packs() const { return (static_cast<int>(orientation_of.extent(0)) + lanes - 1) / lanes; }
};

/// `block` has plain sections, k points for both parts of the force strain; g2 or g3 of every element is normal to the
/// plane, and so is its curvature. Line fields are dead forces in the plane and eigenstrains that leave it in it.
PlanarBlock make_planar_block(const ElementBlock& block, const PlaneAxes& axes, int lanes = kLanes);

using PlanarTangents = KernelView<double* [kPlanarTangent]>;  ///< (element, TangentLayout in a plane)

/// Evaluates the residual as evaluate_residual does, for states in the plane; vertex rows to planar_rows.
void evaluate_planar_residual(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                              const StateViews& state, const ElementEquations& equations);

/// Condensed tangent and residual in the plane and the response of the interior unknowns.
void evaluate_planar_tangent(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                             const StateViews& state, const PlanarTangents& tangents,
                             const ElementEquations& equations);

/// Condenses as condense_right_hand_side does; rows of `rhs_interior` out of the plane are ignored.
void condense_planar_right_hand_side(const ElementBlock& block, const PlanarBlock& planar,
                                     const StructureViews& structure, const StateViews& state,
                                     const KernelView<const double*>& rhs_interior, const PlanarTangents& tangents,
                                     const ElementEquations& equations);

/// Leaves what condense_planar_right_hand_side() leaves of a right-hand side of zero.
void clear_planar_right_hand_side(const PlanarBlock& planar);

/// Increments of all interior unknowns that belong to the vertex increment (vertex, 6; spatial, in the plane).
void recover_planar_interior(const ElementBlock& block, const PlanarBlock& planar,
                             const KernelView<const double* [6]>& vertex_increment,
                             const KernelView<double*>& increment);

}  // namespace mixbeam
