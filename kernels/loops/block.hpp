/// All elements of one order and integration rule, and the parallel loops over them. Data layout lives here; the
/// mathematics is in element/element.hpp and condensation/tangent.hpp.
#pragma once

#include "kernels/condensation/condensed_layout.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/element/row_scales.hpp"
#include "kernels/execution/execution_space.hpp"
#include "kernels/loops/shared_rows.hpp"

#include <Kokkos_Core.hpp>

namespace mixbeam {

using MemorySpace = ExecutionSpace::memory_space;
template <class Data>
using KernelView = Kokkos::View<Data, Kokkos::LayoutRight, MemorySpace>;

/// State of a structure: total, from the reference to the current configuration.
struct StateViews {
  KernelView<double* [3]> vertex_displacement;  ///< (vertex, 3) spatial
  KernelView<double* [4]> vertex_rotation;      ///< (vertex, w x y z): Lambda_V
  KernelView<double* [4]> element_triad;        ///< (element, w x y z): Lambda_lo
  KernelView<double*> interior;                 ///< InteriorLayout of each element, block after block
};

/// Arrays that the kernels write and the assembler gathers.
struct ElementEquations {
  KernelView<double* [12]> residual;  ///< (element, u_a theta_a u_b theta_b): gradient, spatial
  /// (element, force in the plane on its end, minus that on its start; moments of start and end): gradient of elements
  /// that move in a plane, before or after elimination of the interior
  KernelView<double* [4]> planar_rows;
  KernelView<double* [2]> planar_loads;         ///< (element): line loads on each of its ends alike; empty without any
  KernelView<double*> interior_residual;        ///< increments layout of each element, block after block
  ResidualScales interior_scales;               ///< what interior_residual is divided by ...
  bool scales_interior = false;                 ///< ... if it is
  bool fields_alone = false;                    ///< of line fields alone, which enter linearly
  KernelView<double* [12]> condensed_residual;  ///< (element, 12): gradient after elimination of the interior
  KernelView<double**> condensed_tangent;       ///< (element, kFullTangent or kSymmetricTangent), spatial
  KernelView<double*> response;                 ///< ElementBlock::response_size() of each element, block after block
  /// Increments of the interior while the vertices stand still, in their layout; may be the right-hand side.
  KernelView<double*> constants;
  KernelView<double*> largest_end_angle;  ///< (element): relative rotation between element and vertex, radians
  /// (element): eigenvalues below zero of the interior while the vertices stand still, their parity alone where the
  /// element has no potential; kUncertainCount where a pivot is zero. Not counted where the view is empty.
  KernelView<int*> interior_negative;
};

/// Data that elements of all blocks share.
struct StructureViews {
  KernelView<SectionConstants*> sections;  ///< (section in use)
  KernelView<double* [3]> field_value {};  ///< (row, ElementBlock::field_row): line fields at a load factor
};

/// Values of a line field that an element does not have, where one beside it has it.
inline constexpr double kNoField[3 * ElementTables<kMaximumOrder>::kMaximumForcePoints] = {};

/// Places of the numbers of each element of a block in an array that holds one element after the other.
struct ElementPlaces {
  size_t first = 0, stride = 0;
  KOKKOS_INLINE_FUNCTION size_t operator()(int e) const { return first + static_cast<size_t>(e) * stride; }
};

struct ElementBlock {
  int order = 0;
  ForceIntegration force_integration = ForceIntegration::both_reduced;
  int first_element = 0;  ///< elements of a block are numbered consecutively
  int count = 0;
  size_t interior_offset = 0;   ///< of the first element in StateViews::interior
  size_t increment_offset = 0;  ///< of the first element in increments and interior residuals
  size_t response_offset = 0;
  InteriorLayout interior;
  ReferenceLayout reference_layout;
  SharedRows reference;             ///< (element of the block, ReferenceLayout)
  KernelView<int* [2]> vertices;    ///< (element of the block, end): local vertex
  KernelView<int*> section;         ///< (element of the block): among StructureViews::sections
  bool general_section = false;     ///< sections of this block are coupled or vary along the element
  KernelView<double**> compliance;  ///< (element of the block, GeneralSectionLayout); empty for plain sections
  /// (element of the block, LineField): first row of that field in StructureViews::field_value, -1 where there is none;
  /// empty when no element of the block has any
  KernelView<int* [kLineFields]> field_row;
  unsigned kinds_of_fields = 0;  ///< bit of each LineField that some element of the block has

  ElementPlaces unknowns_at() const { return {interior_offset, static_cast<size_t>(interior.unknowns())}; }
  ElementPlaces increments_at() const { return {increment_offset, static_cast<size_t>(interior.increments())}; }
  /// Whether the tangent of an element has a part without potential.
  bool is_unsymmetric(int e) const {
    if (field_row.extent(0) == 0) return false;
    for (LineField field : {LineField::dead_couple, LineField::follower_force, LineField::follower_couple})
      if (field_row(e, static_cast<int>(field)) >= 0) return true;
    return false;
  }
  /// Numbers that the tangent keeps of each element for recover_interior.
  int response_size() const { return ResponseLayout{order}.size(); }
};

/// Mixed residual: vertex and interior rows, largest relative end rotation.
void evaluate_residual(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                       const ElementEquations& equations);

/// Condensed tangent, condensed residual, response of the interior unknowns and their constants.
void evaluate_tangent(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                      const ElementEquations& equations);

/// Condensed residual and constants for a given right-hand side in place of the block's own residual:
/// `rhs_interior` has the layout of increments (N rows are strains, not weighted). Everything else as evaluate_tangent.
void condense_right_hand_side(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                              const KernelView<const double*>& rhs_interior, const ElementEquations& equations);

/// Computes the rows of the linearised equations that the capped stiffness of the tangent leaves out: J d - J_capped d
/// for an interior increment d, (S_capped - S) dN in the N rows and its integral with dM in the M rows, zero in all
/// others.
void cap_compliance_rows(const ElementBlock& block, const StructureViews& structure,
                         const KernelView<const double*>& increment, const KernelView<double*>& rows);

/// The largest of these rows, each divided by its scale; not-a-number counts as infinity.
double largest_cap_row(const ElementBlock& block, const StructureViews& structure,
                       const KernelView<const double*>& increment, const ResidualScales& scales);

/// Adds to the constants of the interior what belongs to the vertex increment (vertex, 6: du, dtheta; spatial), which
/// makes them its increments. `structure`, `state`: those of the tangent.
void recover_interior(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                      const ElementEquations& equations, const KernelView<const double* [6]>& vertex_increment,
                      const KernelView<double*>& increment);

/// Moves the first `count` vertices, theory (34): displacement + scale * increment, rotations multiplied from the left
/// by exp(scale * dtheta).
void apply_vertex_increment(int count, const StateViews& from, const KernelView<const double* [6]>& increment,
                            double scale, const StateViews& to);

/// Theory (34): interior + scale * increment, triads multiplied from the right by exp(scale * w).
void apply_interior_increment(const ElementBlock& block, const StateViews& from,
                              const KernelView<const double*>& increment, double scale, const StateViews& to);

}  // namespace mixbeam
