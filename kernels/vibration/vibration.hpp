/// Elements vibrating about a state: their linearised equations with inertia, condensed to two vertices each, the
/// velocities of motions, and the recovery. Loops over the elements of a block.
///
/// Rows of G are velocities at the k + 1 moment points times roots of weight and mass, so that T = 1/2 |G dx|^2, theory
/// (71) ("momenta": their unit is sqrt(mass) * velocity). The equations are
///   stresses:  D dx - S dN = -r,     motions:  D^T dN + (H + B + shift G^T G) dx = f,
/// D, H, S as in element_matrices.hpp, B of line loads without a potential. S is the capped compliance; excess_rows()
/// gives the error of the cap.
#pragma once

#include "kernels/loops/block.hpp"
#include "kernels/vibration/rotating_frame.hpp"

namespace mixbeam {

/// Elements of a block and the matrices that evaluate() stores for them: each view is (element of the block, numbers).
struct VibratingBlock {
  ElementBlock block;
  KernelView<double**> mass{};                         ///< (point, kMassNumbers)
  KernelView<double**> strain{}, momentum{};           ///< D and G
  KernelView<double**> geometric{};                    ///< H
  KernelView<double**> compliance{}, own{}, excess{};  ///< inverse of the capped S; the true one; their difference
  KernelView<double**> factors{}, response{};          ///< L U of the interior; its motion due to those of the vertices
  KernelView<double**> left{};                         ///< response of the transpose; empty if all are symmetric
  KernelView<int**> pivots{};                          ///< rows exchanged
  KernelView<int*> negative{};                         ///< negative pivots of the interior, or kUncertainCount
  bool has_spins = true;                               ///< some mass resists spins, which then have rows of G
  bool transposed = false;                             ///< use the transpose of loads without a potential
  KernelView<int*> capped{};                           ///< stresses with a compliance that the cap may change
  /// Columns need rows() rows, those of G, then those of D of `capped`: the response to such rows with fixed vertices,
  /// and to motions of the vertices; `left_by_ends` corresponds to `left`.
  KernelView<double**> passed{}, by_ends{}, left_by_ends{};
  VibrationLayout layout() const { return {block.order, block.interior.force_points}; }
  int velocities_of_point() const { return has_spins ? 6 : 3; }
  int momenta() const { return velocities_of_point() * (block.order + 1); }
  int rows() const { return momenta() + static_cast<int>(capped.extent(0)); }
};

/// Operations on the matrices of an element: store only, condense, condense and count the pivots of the interior, or
/// condense and prepare columns.
enum class VibrationUse { matrices, condensed, counted, columns };

/// Several right-hand sides of momenta only, in one pass over the matrices of the elements. Arrays of local elements
/// store the columns one after the other.
struct MomentumColumns {
  int columns = 0;
  size_t momenta_of_column = 0;
  int of_element = 0;                    ///< most momenta of an element; missing ones are set to zero
  KernelView<const int*> place{};        ///< (local element): offset of its first momentum in a column
  const double* forces = nullptr;        ///< momenta as forces; null: rows of stresses instead
  double* momenta = nullptr;             ///< of the motions; may be the same array as `forces`
  KernelView<double**> ends{};           ///< (local element, 12 * column): rows of both vertices
  const double* const* moved = nullptr;  ///< (column): motions (6 * local vertex + component)
  int stresses = 0;                      ///< most stresses of an element
  KernelView<double**> excess{};         ///< (local element, stresses * column): rows of excess_rows(); empty: no cap
};

/// Allocates the data of the elements of a block. `has_spins` false: `mass` resists no spins, which have no rows of G.
VibratingBlock allocate_vibrating_block(const ElementBlock& block, const KernelView<double**>& mass,
                                        bool has_spins = true);
/// Returns a range of consecutive elements of a block.
ElementBlock part_of(const ElementBlock& block, int first, int count);
/// Allocates `count` elements of a block without mass and momenta, for the stiffness only (shift zero): H includes B.
/// `condenses` false: for VibrationUse::matrices, only D, H and S, which suffice for add_equations().
VibratingBlock allocate_static_block(const ElementBlock& block, int count, bool condenses);

/// Allocates the data of VibrationUse::columns, for sections with a cap.
void allocate_columns(VibratingBlock& vibrating, const StructureViews& structure);

/// Condenses K + shift M at a state. `structure`: sections with the cap, line fields. `tangent`: (local element,
/// kFullTangent). Counts are those of theory (47); VibratingBlock::negative is unchanged unless counted. `frame`: of
/// the block; its centrifugal stiffness is part of H.
void evaluate_vibration(const VibratingBlock& vibrating, const StructureViews& structure, const StateViews& state,
                        double shift, VibrationUse use, const KernelView<double**>& tangent,
                        const FrameViews& frame = {});

/// Turns residuals into right-hand sides of the equations above, in place: of interiors (rows as stored by
/// evaluate_residual()) and of both vertices of each local element.
void take_residual(const VibratingBlock& vibrating, const KernelView<double*>& interior,
                   const KernelView<double* [12]>& vertex);

/// Adds the centrifugal rows of the elements of a block times a factor, theory (75), to interior residuals, which are
/// divided by `scales` (null: not), and to the rows of both vertices.
void add_centrifugal_rows(const ElementBlock& block, const FrameViews& frame, const StateViews& state, double factor,
                          const ResidualScales* scales, const KernelView<double*>& interior,
                          const KernelView<double* [12]>& vertex);
/// Centrifugal energy of each local element.
void centrifugal_energies(const ElementBlock& block, const FrameViews& frame, const StateViews& state,
                          const KernelView<double*>& energy);
/// Coriolis forces on momenta, theory (76): a 6 x 6 matrix W at each point of each element of the block.
void coriolis_matrices(const ElementBlock& block, const FrameViews& frame, const StateViews& state,
                       const KernelView<double**>& matrices);

/// G dx, VibratingBlock::momenta() per element, or D dx, VibrationLayout::stresses(), for motions of vertices (vertex,
/// 6) and interiors (increments): (local element, at least as many).
enum class MotionRow { momentum, strain };
void rows_of_motion(const VibratingBlock& vibrating, MotionRow row, const KernelView<const double* [6]>& vertex,
                    const KernelView<const double*>& interior, const KernelView<double**>& to);
/// Rows G^T times momenta: of interiors, and of both vertices of each local element (element, 12).
void rows_of_momenta(const VibratingBlock& vibrating, const KernelView<double**>& momenta,
                     const KernelView<double*>& interior, const KernelView<double* [12]>& vertex);
/// Condenses interior rows into those of both vertices: `vertex` is changed in place.
void condense_rows(const VibratingBlock& vibrating, const KernelView<const double*>& interior,
                   const KernelView<double* [12]>& vertex);
/// Recovers motions of the interior and stresses from the motions of the vertices, for the same interior rows.
void recover_motion(const VibratingBlock& vibrating, const KernelView<const double*>& interior_rows,
                    const KernelView<const double* [6]>& vertex, const KernelView<double*>& increment);
/// Rows of both vertices of each element after elimination of the interior, from forces or excess rows.
void condense_columns(const VibratingBlock& vibrating, const MomentumColumns& of);
/// Recovers momenta from the motions of the vertices, and the excess rows of their stresses if there is a cap.
void recover_columns(const VibratingBlock& vibrating, const MomentumColumns& of);
/// 2 dN . D dx - dN . S dN + dx . H dx of each local element, S the true compliance: stationary at a mode.
void stiffness_forms(const VibratingBlock& vibrating, const KernelView<const double* [6]>& vertex,
                     const KernelView<const double*>& increment, const KernelView<double*>& forms);
/// Adds the linearised equations of a static block, S the true compliance: D dx - S dN to interior rows as stored by
/// evaluate_residual() (those of N are strains), and D^T dN + (H + B) dx, whose vertex part is (local element, 12).
void add_equations(const VibratingBlock& vibrating, const KernelView<const double* [6]>& vertex,
                   const KernelView<const double*>& increment, const KernelView<double*>& rows,
                   const KernelView<double* [12]>& vertex_rows);
/// Rows of the stresses due to the excess of the capped compliance, zero in all others.
void excess_rows(const VibratingBlock& vibrating, const KernelView<const double*>& increment,
                 const KernelView<double*>& rows);

}  // namespace mixbeam
