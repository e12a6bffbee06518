/// Increments of the interiors of the elements of a block, of one order and kind of section.
#pragma once

#include "kernels/condensation/recovery.hpp"
#include "kernels/loops/gather.hpp"

namespace mixbeam {

/// Index: pack of elements.
template <int K, bool General, int W>
struct RecoverLoop {
  using Real = Pack<W>;
  ElementGather<K, General, W> gather;
  KernelView<const double*> response;
  KernelView<const double* [6]> vertex_increment;
  KernelView<double*> increment;
  size_t response_offset;
  int response_size;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    using Elements = ElementPack<K, General, W>;
    const Elements pack(gather, number);
    const ElementKinematics<K, Real> kinematics(pack.in, gather.layout);
    Real ends[2][6], out[Elements::kIncrements];
    for (int end = 0; end < 2; ++end)
      pack.lanes.load([&](int e) { return &vertex_increment(gather.vertices(e, end), 0); }, 6, ends[end]);
    ReducedIncrement<K, Real> d(kinematics, ends[0], ends[1]);
    if constexpr (General) {
      for (int r = 0; r < gather.layout.increments(); ++r) {
        Real row[kResponseColumns];
        pack.lanes.load([&](int e) { return response_of(e) + r * kResponseColumns; }, kResponseColumns, row);
        out[r] = d.respond_in_row(row);
      }
    } else {
      Real kept[ResponseLayout{K, Elements::kForcePoints}.size()];
      pack.lanes.load([&](int e) { return response_of(e); }, response_size, kept);
      recover_element(pack.in, kinematics, gather.tables, gather.layout, gather.reference_layout, d, kept, out);
    }
    pack.lanes.store(out, 0, gather.layout.increments(), [&](int e) { return &increment(gather.increment_of(e)); });
  }

 private:
  KOKKOS_INLINE_FUNCTION const double* response_of(int e) const {
    return response.data() + response_offset + static_cast<size_t>(e) * response_size;
  }
};

template <int K, bool General, int W>
void recover_loop(const ElementBlock& block, const StateViews& state, const ElementEquations& equations,
                  const KernelView<const double* [6]>& vertex_increment, const KernelView<double*>& increment) {
  const RecoverLoop<K, General, W> loop{ElementGather<K, General, W>(block, StructureViews(), state),
                                        equations.response,
                                        vertex_increment,
                                        increment,
                                        block.response_offset,
                                        block.response_size()};
  Kokkos::parallel_for("mixbeam::elements::recover",
                       Kokkos::RangePolicy<ExecutionSpace>(0, RowsInLanes<W>::packs(block.count)), loop);
}

}  // namespace mixbeam
