/// All elements of one order and integration rule, and the parallel loops over them. Data layout is defined here; the
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

/// State of a structure: total displacements and rotations from the reference to the current configuration.
struct StateViews {
  KernelView<double* [3]> vertex_displacement;  ///< (vertex, 3) spatial
  KernelView<double* [4]> vertex_rotation;      ///< (vertex, w x y z): Lambda_V
  KernelView<double* [4]> element_triad;        ///< (element, w x y z): Lambda_lo
  KernelView<double*> interior;                 ///< InteriorLayout of each element, block after block
};

/// Arrays written by the kernels and gathered by the assembler.
struct ElementEquations {
  KernelView<double* [12]> residual;  ///< (element, u_a theta_a u_b theta_b): gradient, spatial
  /// (element, in-plane force at its end (opposite at its start), moments of start and end): gradient of planar
  /// elements, before or after elimination of the interior
  KernelView<double* [4]> planar_rows;
  KernelView<double* [2]> planar_loads;         ///< (element): line load on each of its ends (equal); empty if none
  KernelView<double*> interior_residual;        ///< increments layout of each element, block after block
  ResidualScales interior_scales;               ///< scales that divide interior_residual ...
  bool scales_interior = false;                 ///< ... if set
  bool fields_alone = false;                    ///< residual of the line fields only; they enter linearly
  KernelView<double* [12]> condensed_residual;  ///< (element, 12): gradient after elimination of the interior
  KernelView<double**> condensed_tangent;       ///< (element, kFullTangent or kSymmetricTangent), spatial
  KernelView<double*> response;                 ///< ElementBlock::response_size() of each element, block after block
  /// Increments of the interior for fixed vertices, in increments layout; may be the right-hand side itself.
  KernelView<double*> constants;
  KernelView<double*> largest_end_angle;  ///< (element): relative rotation between element and vertex, radians
  /// (element): number of negative eigenvalues of the interior for fixed vertices, only its parity if the element has
  /// no potential; kUncertainCount if a pivot is zero. Not counted if the view is empty.
  KernelView<int*> interior_negative;
};

/// Data shared by the elements of all blocks.
struct StructureViews {
  KernelView<SectionConstants*> sections;  ///< (section in use)
  KernelView<double* [3]> field_value {};  ///< (row, ElementBlock::field_row): line fields at the current load factor
};

/// Zero values of a line field, for elements without it in a pack where another element has it.
inline constexpr double kNoField[3 * ElementTables<kMaximumOrder>::kMaximumForcePoints] = {};

/// Offsets of the elements of a block in an array that stores one element after the other.
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
  /// (element of the block, LineField): first row of that field in StructureViews::field_value, -1 if absent; empty if
  /// no element of the block has any
  KernelView<int* [kLineFields]> field_row;
  unsigned kinds_of_fields = 0;  ///< bit of each LineField that occurs in the block

  ElementPlaces unknowns_at() const { return {interior_offset, static_cast<size_t>(interior.unknowns())}; }
  ElementPlaces increments_at() const { return {increment_offset, static_cast<size_t>(interior.increments())}; }
  /// True if the tangent of an element has a part without potential.
  bool is_unsymmetric(int e) const {
    if (field_row.extent(0) == 0) return false;
    for (LineField field : {LineField::dead_couple, LineField::follower_force, LineField::follower_couple})
      if (field_row(e, static_cast<int>(field)) >= 0) return true;
    return false;
  }
  /// Number of values per element that the tangent keeps for recover_interior.
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

/// Computes the rows of the linearised equations omitted by the capped stiffness of the tangent: J d - J_capped d for
/// an interior increment d. (S_capped - S) dN in the N rows, its integral with dM in the M rows, zero in all others.
void cap_compliance_rows(const ElementBlock& block, const StructureViews& structure,
                         const KernelView<const double*>& increment, const KernelView<double*>& rows);

/// Largest of these rows, each divided by its scale; NaN counts as infinity.
double largest_cap_row(const ElementBlock& block, const StructureViews& structure,
                       const KernelView<const double*>& increment, const ResidualScales& scales);

/// Adds the response to the vertex increment (vertex, 6: du, dtheta; spatial) to the constants of the interior, which
/// become its increments. `structure`, `state`: those of the tangent.
void recover_interior(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                      const ElementEquations& equations, const KernelView<const double* [6]>& vertex_increment,
                      const KernelView<double*>& increment);

/// Moves the first `count` vertices, theory (34): displacement + scale * increment, rotations multiplied from the left
/// by exp(scale * dtheta).
void apply_vertex_increment(int count, const StateViews& from, const KernelView<const double* [6]>& increment,
                            double scale, const StateViews& to);

/// Updates the interior, theory (34): interior + scale * increment, triads multiplied from the right by exp(scale * w).
void apply_interior_increment(const ElementBlock& block, const StateViews& from,
                              const KernelView<const double*>& increment, double scale, const StateViews& to);

}  // namespace mixbeam
