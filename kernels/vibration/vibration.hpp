/// Elements that vibrate about a state: their linearised equations with inertia, condensed to two vertices each, the
/// velocities that motions make, and the way back. Loops over the elements of a block.
///
/// Rows of G are velocities at the k + 1 moment points times roots of weight and mass, so that T = 1/2 |G dx|^2, theory
/// (71) ("momenta": both sides of G have the unit sqrt(mass) * velocity). The equations are
///   stresses:  D dx - S dN = -r,     motions:  D^T dN + (H + B + shift G^T G) dx = f,
/// D, H, S as in element_matrices.hpp, B of loads along the element without a potential. S is the capped compliance;
/// excess_rows() tells what it is too large by.
#pragma once

#include "kernels/loops/block.hpp"
#include "kernels/vibration/rotating_frame.hpp"

namespace mixbeam {

/// The elements of a block, with what evaluate() keeps of them: each view is (element of the block, numbers).
struct VibratingBlock {
  ElementBlock block;
  KernelView<double**> mass{};                         ///< (point, kMassNumbers)
  KernelView<double**> strain{}, momentum{};           ///< D and G
  KernelView<double**> geometric{};                    ///< H
  KernelView<double**> compliance{}, own{}, excess{};  ///< inverse of the capped S; the true one; their difference
  KernelView<double**> factors{}, response{};          ///< L U of the interior; its motion by those of the vertices
  KernelView<double**> left{};                         ///< as response, of the transpose; empty: all are symmetric
  KernelView<int**> pivots{};                          ///< rows exchanged
  KernelView<int*> negative{};                         ///< pivots below zero of the interior; kUncertainCount
  bool has_spins = true;                               ///< some mass resists spins: rows of G
  bool transposed = false;                             ///< loads without a potential enter by their transpose
  KernelView<int*> capped{};                           ///< stresses whose compliance the cap may change
  /// Columns ask for rows() rows, those of G, then those of D of `capped`: their response to such rows while the
  /// vertices are held, and to motions of the vertices; `left_by_ends` as `left`.
  KernelView<double**> passed{}, by_ends{}, left_by_ends{};
  VibrationLayout layout() const { return {block.order, block.interior.force_points}; }
  int velocities_of_point() const { return has_spins ? 6 : 3; }
  int momenta() const { return velocities_of_point() * (block.order + 1); }
  int rows() const { return momenta() + static_cast<int>(capped.extent(0)); }
};

/// Use of the matrices of an element: as they are, condensed, with the pivots of the interior counted, or with what
/// columns need.
enum class VibrationUse { matrices, condensed, counted, columns };

/// Several right-hand sides of momenta alone, which share one pass over the matrices of the elements; arrays of local
/// elements have the numbers of one column after those of the other.
struct MomentumColumns {
  int columns = 0;
  size_t momenta_of_column = 0;
  int of_element = 0;              ///< momenta of an element, at most: those that it does not have are set to zero
  KernelView<const int*> place{};  ///< (local element): its first momentum in a column
  const double* forces = nullptr;  ///< momenta as forces; null: rows of stresses in their place
  double* momenta = nullptr;       ///< of the motions, which may take the place of the forces
  KernelView<double**> ends{};     ///< (local element, 12 * column): rows of both vertices
  const double* const* moved = nullptr;  ///< (column): motions (6 * local vertex + component)
  int stresses = 0;                      ///< of an element, at most
  KernelView<double**> excess{};         ///< (local element, stresses * column): rows of excess_rows(); empty: no cap
};

/// Room for the elements of a block. `has_spins` false: `mass` resists none, and spins have no rows of G.
VibratingBlock allocate_vibrating_block(const ElementBlock& block, const KernelView<double**>& mass,
                                        bool has_spins = true);
/// Some elements of a block that follow each other.
ElementBlock part_of(const ElementBlock& block, int first, int count);
/// Room for `count` elements of a block without mass and momenta, for the stiffness alone (shift zero): H has B in it.
/// `condenses` false: for VibrationUse::matrices, D, H and S, which is all that add_equations() needs.
VibratingBlock allocate_static_block(const ElementBlock& block, int count, bool condenses);

/// Room for VibrationUse::columns with the sections of a cap.
void allocate_columns(VibratingBlock& vibrating, const StructureViews& structure);

/// Condenses K + shift M at a state. `structure`: sections with the cap, line fields. `tangent`: (local element,
/// kFullTangent). Counts are those of theory (47); without them VibratingBlock::negative stays as it is.
/// `frame`: of the block, whose centrifugal stiffness is part of H.
void evaluate_vibration(const VibratingBlock& vibrating, const StructureViews& structure, const StateViews& state,
                        double shift, VibrationUse use, const KernelView<double**>& tangent,
                        const FrameViews& frame = {});

/// Right-hand sides of the equations above from residuals: of interiors (rows as evaluate_residual() stores them) and
/// of both vertices of each local element, in place.
void take_residual(const VibratingBlock& vibrating, const KernelView<double*>& interior,
                   const KernelView<double* [12]>& vertex);

/// Centrifugal rows of the elements of a block times a factor, theory (75): added to interior residuals, which are
/// divided by `scales` (null: not), and to those of both vertices.
void add_centrifugal_rows(const ElementBlock& block, const FrameViews& frame, const StateViews& state, double factor,
                          const ResidualScales* scales, const KernelView<double*>& interior,
                          const KernelView<double* [12]>& vertex);
/// Their energy, of each local element.
void centrifugal_energies(const ElementBlock& block, const FrameViews& frame, const StateViews& state,
                          const KernelView<double*>& energy);
/// Coriolis forces on momenta, theory (76): W of 6 x 6 at each point of each element of the block.
void coriolis_matrices(const ElementBlock& block, const FrameViews& frame, const StateViews& state,
                       const KernelView<double**>& matrices);

/// G dx, VibratingBlock::momenta() of an element, or D dx, VibrationLayout::stresses(), of motions of vertices
/// (vertex, 6) and interiors (increments): (local element, as many at least).
enum class MotionRow { momentum, strain };
void rows_of_motion(const VibratingBlock& vibrating, MotionRow row, const KernelView<const double* [6]>& vertex,
                    const KernelView<const double*>& interior, const KernelView<double**>& to);
/// Rows G^T times momenta: of interiors, and of both vertices of each local element (element, 12).
void rows_of_momenta(const VibratingBlock& vibrating, const KernelView<double**>& momenta,
                     const KernelView<double*>& interior, const KernelView<double* [12]>& vertex);
/// Rows of both vertices after elimination of the interior: `vertex` is changed in place.
void condense_rows(const VibratingBlock& vibrating, const KernelView<const double*>& interior,
                   const KernelView<double* [12]>& vertex);
/// Motions of the interior and stresses that belong to those of the vertices, under the same interior rows.
void recover_motion(const VibratingBlock& vibrating, const KernelView<const double*>& interior_rows,
                    const KernelView<const double* [6]>& vertex, const KernelView<double*>& increment);
/// Rows of both vertices of each element after elimination of the interior, from forces or excess rows.
void condense_columns(const VibratingBlock& vibrating, const MomentumColumns& of);
/// Momenta of the motions that belong to those of the vertices, and the excess rows of their stresses where there is a
/// cap.
void recover_columns(const VibratingBlock& vibrating, const MomentumColumns& of);
/// 2 dN . D dx - dN . S dN + dx . H dx of each local element, S the true compliance: stationary at a mode.
void stiffness_forms(const VibratingBlock& vibrating, const KernelView<const double* [6]>& vertex,
                     const KernelView<const double*>& increment, const KernelView<double*>& forms);
/// Adds the linearised equations of a static block to interior rows as evaluate_residual() stores them (those of N are
/// strains): D dx - S dN and D^T dN + (H + B) dx, S the true compliance; the latter of both vertices as (local element,
/// 12).
void add_equations(const VibratingBlock& vibrating, const KernelView<const double* [6]>& vertex,
                   const KernelView<const double*>& increment, const KernelView<double*>& rows,
                   const KernelView<double* [12]>& vertex_rows);
/// Rows of the stresses that the excess of the capped compliance makes of their increment, zero in all others.
void excess_rows(const VibratingBlock& vibrating, const KernelView<const double*>& increment,
                 const KernelView<double*>& rows);

}  // namespace mixbeam
