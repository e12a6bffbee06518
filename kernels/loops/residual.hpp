/// The mixed residual of the elements of a block, of one order and kind of section.
#pragma once

#include "kernels/element/gradient.hpp"
#include "kernels/loops/gather.hpp"

namespace mixbeam {

/// Index: pack of elements.
template <int K, bool General, int W>
struct ResidualLoop {
  ElementGather<K, General, W> gather;
  ElementEquations to;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    using Real = Pack<W>;
    const ElementPack<K, General, W> pack(gather, number);
    const ElementKinematics<K, Real> kinematics(pack.in, gather.layout);
    ElementGradient<K, Real> gradient;
    element_gradient(pack.in, kinematics, gather.tables, gather.layout, gather.reference_layout, pack.section,
                     gradient);
    if (gather.has_fields()) add_field_gradient(pack.fields, kinematics, gather.tables, gradient);
    Real interior_row[pack.kIncrements], vertex_row[12];
    store_residual(gradient, kinematics, gather.layout, interior_row, vertex_row);
    if (to.scales_interior)
      scale_interior_rows(gather.layout, to.interior_scales, kinematics.length, false, interior_row);
    const auto interior_of = [&](int e) { return &to.interior_residual(gather.increment_of(e)); };
    pack.lanes.store(interior_row, 0, gather.layout.increments(), interior_of);
    pack.lanes.store(vertex_row, 0, 12, [&](int e) { return &to.residual(gather.first_element + e, 0); });
    for (int lane = 0; lane < pack.lanes.active; ++lane)
      to.largest_end_angle(gather.first_element + pack.lanes.row[lane]) = gradient.largest_end_angle[lane];
  }
};

template <int K, bool General, int W>
void residual_loop(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                   const ElementEquations& equations) {
  const ResidualLoop<K, General, W> loop{ElementGather<K, General, W>(block, structure, state), equations};
  Kokkos::parallel_for("mixbeam::elements::residual",
                       Kokkos::RangePolicy<ExecutionSpace>(0, RowsInLanes<W>::packs(block.count)), loop);
}

}  // namespace mixbeam
