/// Chains of elements in a plane, condensed to their ends with three unknowns per vertex, as CondensedSystem does in
/// space. The remaining system becomes spatial again, so that supports, joints and loads need not know of the plane.
#pragma once

#include "discretization/assembly/tangent.hpp"

namespace mixbeam {

class PlanarChains {
 public:
  /// For a model with a plane; both must outlive this.
  PlanarChains(const Model& model, const ChainStructure& structure);

  /// Eliminates the chains of a planar tangent, to which all that follows refers, and writes the links that remain.
  ChainCondensation<kPlanarDofs>::Pivots condense(const PlanarTangents& tangents);
  /// Spatial matrices of the links that remain; the others are not set. Motions out of the plane, at which nothing
  /// works, meet springs as stiff as the links are in the plane.
  const LinkMatrices<kSpatialDofs>& remaining() const { return remaining_; }

  /// First half of a solve; `rows` spatial (6 * local vertex + component).
  void condense_rows(const KernelView<const double*>& rows);
  /// Rows that the remaining runs add to those of their end vertices, spatial.
  const KernelView<double* [12]>& arrived() const { return arrived_; }
  /// Second half: all of x from its entries at vertices that remain.
  void expand(const KernelView<double*>& x);

  /// Measures the error as CondensedSystem::chain_error does on this rank, and as chain_residual unless `residual` has
  /// no entries. `sizes`: largest of all ranks in x; `run_forces`: spatial, at vertices that remain.
  double error(const KernelView<const double*>& rows, const KernelView<const double*>& x, const LargestParts& sizes,
               const KernelView<const double*>& run_forces, const KernelView<double*>& residual) const;

 private:
  const Model& model_;
  PlanarTangents tangents_;
  const ChainStructure& structure_;
  ChainCondensation<kPlanarDofs> chains_;
  LinkMatrices<kSpatialDofs> remaining_;
  KernelView<double**> elements_;  ///< after remaining_
  KernelView<double* [12]> arrived_;
  KernelView<double*> rows_, x_;              ///< (3 * local vertex + component): scratch
  KernelView<int* [2]> ends_;                 ///< (local element, end): local vertex
  KernelView<unsigned char*> is_eliminated_;  ///< (local vertex)
  KernelView<unsigned char*> is_condensed_;   ///< (local element): part of a condensed chain
};

}  // namespace mixbeam
