#include "kernels/loops/planar_block.hpp"

#include "kernels/loops/dispatch.hpp"
#include "kernels/planar/condensation.hpp"

#include <cmath>

namespace mixbeam {

template <int K>
void allocate_planar_block(const ElementBlock&, PlanarBlock&);
template <int K>
void planar_residual_loop(const ElementBlock&, const PlanarBlock&, const StructureViews&, const StateViews&,
                          const ElementEquations&);
template <int K>
void planar_tangent_loop(const ElementBlock&, const PlanarBlock&, const StructureViews&, const StateViews&,
                         const KernelView<const double*>&, const PlanarTangents&, const ElementEquations&);
template <int K>
void planar_recover_loop(const ElementBlock&, const PlanarBlock&, const KernelView<const double* [6]>&,
                         const KernelView<double*>&);

namespace {

/// Orientation of triads with g1 = p and g2 or g3 along or against n.
PlanarOrientation make_orientation(const PlaneAxes& axes, bool third_is_normal, double about) {
  PlanarOrientation result{};
  result.third_is_normal = third_is_normal;
  result.about = about;
  result.across = third_is_normal ? about : -about;
  const Vec normal = about * axes.n, other = third_is_normal ? cross(normal, axes.p) : cross(axes.p, normal);
  Mat triad;
  for (int i = 0; i < 3; ++i) {
    triad(i, 0) = axes.p[i];
    triad(i, 1) = third_is_normal ? other[i] : normal[i];
    triad(i, 2) = third_is_normal ? normal[i] : other[i];
  }
  const Quat start = quaternion_of(triad);
  const Quat turned = Quat{0.0, axes.n[0], axes.n[1], axes.n[2]} * start;  // rotated by pi about n
  store_quaternion(start, result.w);
  store_quaternion(turned, result.z);
  return result;
}

}  // namespace

PlanarBlock make_planar_block(const ElementBlock& block, const PlaneAxes& axes, int lanes) {
  PlanarBlock planar;
  planar.lanes = lanes;
  planar.axes = axes;
  for (int kind = 0; kind < 4; ++kind)
    planar.orientation[kind] = make_orientation(axes, kind >= 2, kind % 2 == 1 ? 1.0 : -1.0);
  planar.orientation_of = KernelView<int*>("mixbeam::planar::orientation", block.count);
  for (int e = 0; e < block.count; ++e) {
    const Mat triad = rotation_matrix(load_quaternion(&block.reference(e, block.reference_layout.end_triad(0))));
    const double second = dot(axes.n, Vec{{triad(0, 1), triad(1, 1), triad(2, 1)}});
    const double third = dot(axes.n, Vec{{triad(0, 2), triad(1, 2), triad(2, 2)}});
    const bool third_is_normal = std::fabs(third) > std::fabs(second);
    planar.orientation_of(e) = (third_is_normal ? 2 : 0) + ((third_is_normal ? third : second) > 0.0 ? 1 : 0);
  }
  for_order(block.order, [&](auto order) { allocate_planar_block<order.value>(block, planar); });
  return planar;
}

void evaluate_planar_residual(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                              const StateViews& state, const ElementEquations& equations) {
  for_order(block.order,
            [&](auto order) { planar_residual_loop<order.value>(block, planar, structure, state, equations); });
}

void evaluate_planar_tangent(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                             const StateViews& state, const PlanarTangents& tangents,
                             const ElementEquations& equations) {
  condense_planar_right_hand_side(block, planar, structure, state, KernelView<const double*>(), tangents, equations);
}

void condense_planar_right_hand_side(const ElementBlock& block, const PlanarBlock& planar,
                                     const StructureViews& structure, const StateViews& state,
                                     const KernelView<const double*>& rhs_interior, const PlanarTangents& tangents,
                                     const ElementEquations& equations) {
  for_order(block.order, [&](auto order) {
    planar_tangent_loop<order.value>(block, planar, structure, state, rhs_interior, tangents, equations);
  });
}

void clear_planar_right_hand_side(const PlanarBlock& planar) {
  const KernelView<double**> response = planar.response;
  const int lanes = planar.lanes, rows = static_cast<int>(response.extent(1)) / (kPlanarColumns * lanes);
  Kokkos::parallel_for("mixbeam::planar::clear", Kokkos::RangePolicy<ExecutionSpace>(0, planar.packs()), [=](int pack) {
    for (int r = 0; r < rows; ++r)
      for (int lane = 0; lane < lanes; ++lane) response(pack, lanes * (kPlanarColumns * (r + 1) - 1) + lane) = 0.0;
  });
}

void recover_planar_interior(const ElementBlock& block, const PlanarBlock& planar,
                             const KernelView<const double* [6]>& vertex_increment,
                             const KernelView<double*>& increment) {
  for_order(block.order,
            [&](auto order) { planar_recover_loop<order.value>(block, planar, vertex_increment, increment); });
}

}  // namespace mixbeam
