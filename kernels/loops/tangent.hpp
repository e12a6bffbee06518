/// The condensed tangents of the elements of a block, of one order and kind of section.
#pragma once

#include "kernels/condensation/interior_factor.hpp"
#include "kernels/condensation/line_fields_tangent.hpp"
#include "kernels/loops/gather.hpp"

namespace mixbeam {

/// Index: pack of elements.
template <int K, bool General, int W>
struct TangentLoop {
  using Real = Pack<W>;
  using Elements = ElementPack<K, General, W>;
  using Kinematics = ElementKinematics<K, Real>;
  using Condensed = CondensedElement<K, General, Real>;
  static constexpr int kCount = RowsInLanes<W>::kCount;

  ElementGather<K, General, W> gather;
  ElementEquations to;
  KernelView<const double*> given_rhs;  ///< empty: the residual of the state
  size_t response_offset;
  int response_size;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    const Elements pack(gather, number);
    const Kinematics kinematics(pack.in, gather.layout);
    Condensed element;
    clear(element.gradient);
    if (!own_gradient())
      load_given_gradient(pack.lanes, kinematics, element.gradient);
    else if (gather.has_fields())
      add_field_gradient(pack.fields, kinematics, gather.tables, element.gradient);
    element.build(gather.tables, gather.layout, gather.reference_layout, pack.in, kinematics, pack.section,
                  own_gradient());
    InteriorSigns signs[kCount];
    MeanRows<K> mean_rows[kCount];
    solve_in_lanes(element.system, element.response, element.condensed, counts() ? signs : nullptr);
    const bool has_potential = !pack.fields.have_no_potential();
    if (!has_potential) {
      const Kinematics copy = kinematics;  // only this one has its address taken
      solve_with_fields(pack.lanes, copy, element, mean_rows, signs);
    }
    for (int lane = 0; counts() && lane < pack.lanes.active; ++lane) store_signs(pack.lanes.row[lane], signs[lane]);
    const auto response_of = [&](int e) { return to.response.data() + response_offset + first_response(e); };
    const auto store = [&](int first, int count, const Real* numbers) {
      pack.lanes.store(numbers, first, count, response_of);
    };
    element.store_response(gather.tables, gather.layout, kinematics, pack.section, store);
    store_condensed(pack.lanes, kinematics, element);
    if (!has_potential) {
      const Kinematics copy = kinematics;
      add_mean_rows(pack.lanes, copy, element, mean_rows);
    }
  }

 private:
  KOKKOS_INLINE_FUNCTION bool own_gradient() const { return given_rhs.extent(0) == 0; }
  KOKKOS_INLINE_FUNCTION bool counts() const { return to.interior_negative.extent(0) > 0; }
  KOKKOS_INLINE_FUNCTION size_t first_response(int e) const { return static_cast<size_t>(e) * response_size; }
  KOKKOS_INLINE_FUNCTION double* tangent_of(int e) const { return &to.condensed_tangent(gather.first_element + e, 0); }
  KOKKOS_INLINE_FUNCTION double* residual_of(int e) const {
    return &to.condensed_residual(gather.first_element + e, 0);
  }
  KOKKOS_INLINE_FUNCTION bool has_no_potential(int e) const {
    return gather.has_fields() && gather.fields(e).have_no_potential();
  }

  KOKKOS_FORCEINLINE_FUNCTION void load_given_gradient(const RowsInLanes<W>& lanes, const Kinematics& kinematics,
                                                       ElementGradient<K, Real>& gradient) const {
    Real rhs[Elements::kIncrements];
    lanes.load([&](int e) { return &given_rhs(gather.increment_of(e)); }, gather.layout.increments(), rhs);
    add_given_gradient(rhs, kinematics, gather.layout, gradient);
  }
  KOKKOS_INLINE_FUNCTION void store_signs(int e, const InteriorSigns& signs) const {
    to.interior_negative(gather.first_element + e) = signs.uncertain ? kUncertainCount : signs.negative;
  }
  KOKKOS_FORCEINLINE_FUNCTION void store_condensed(const RowsInLanes<W>& lanes, const Kinematics& kinematics,
                                                   const Condensed& element) const {
    Real tangent[kSymmetricTangent], residual[12];
    symmetric_tangent(element.condensed.matrix, kinematics.triad, kinematics.length, tangent);
    if (to.condensed_tangent.extent(1) == kSymmetricTangent)
      lanes.store(tangent, 0, kSymmetricTangent, [&](int e) { return tangent_of(e); });
    else
      store_full(lanes, Kinematics(kinematics), element.condensed, tangent);
    const Vec3<Real>* gradient = element.condensed.gradient;
    store_vertex_rows(gradient[0], gradient[1], gradient[2], element.gradient, kinematics, residual);
    lanes.store(residual, 0, 12, [&](int e) { return residual_of(e); });
  }
  /// For a structure of which some element has no potential.
  KOKKOS_FUNCTION __attribute__((noinline)) void store_full(const RowsInLanes<W>& lanes, const Kinematics& kinematics,
                                                            const VertexSystem<Real>& condensed,
                                                            const Real* symmetric) const {
    for (int lane = 0; lane < lanes.active; ++lane) {
      double* out = tangent_of(lanes.row[lane]);
      if (has_no_potential(lanes.row[lane])) {
        Mat matrix[3][3];
        for (int I = 0; I < 3; ++I)
          for (int J = 0; J < 3; ++J) matrix[I][J] = in_lane(condensed.matrix[I][J], lane);
        full_tangent(matrix, in_lane(kinematics.triad, lane), kinematics.length[lane], out);
      } else {
        double numbers[kSymmetricTangent];
        for (int i = 0; i < kSymmetricTangent; ++i) numbers[i] = symmetric[i][lane];
        expand_symmetric_tangent<kSpatialDofs>(numbers, out);
      }
    }
  }
  /// Elements with line fields that have no potential: each is solved by itself, with its unsymmetric part.
  KOKKOS_FUNCTION __attribute__((noinline)) void solve_with_fields(const RowsInLanes<W>& lanes,
                                                                   const Kinematics& kinematics, Condensed& element,
                                                                   MeanRows<K>* mean_rows, InteriorSigns* signs) const {
    for (int lane = 0; lane < lanes.active; ++lane) {
      const int e = lanes.row[lane];
      mean_rows[lane].used = false;
      if (!has_no_potential(e)) continue;
      FullSystem<K> system(element.system, lane);
      add_field_tangent(gather.fields(e), kinematics.in_lane(lane), gather.tables, system, mean_rows[lane]);
      solve_one_lane(system, lane, element.response, element.condensed);
      if (counts()) signs[lane] = interior_signs(system, false);
    }
  }
  KOKKOS_FUNCTION __attribute__((noinline)) void add_mean_rows(const RowsInLanes<W>& lanes,
                                                               const Kinematics& kinematics, const Condensed& element,
                                                               MeanRows<K>* mean_rows) const {
    for (int lane = 0; lane < lanes.active; ++lane) {
      if (!mean_rows[lane].used) continue;
      mean_rows[lane].condense(element.response, lane);
      mean_rows[lane].expand(kinematics.in_lane(lane), tangent_of(lanes.row[lane]), residual_of(lanes.row[lane]));
    }
  }
};

template <int K, bool General, int W>
void tangent_loop(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                  const KernelView<const double*>& given_rhs, const ElementEquations& equations) {
  const TangentLoop<K, General, W> loop{ElementGather<K, General, W>(block, structure, state), equations, given_rhs,
                                        block.response_offset, block.response_size()};
  Kokkos::parallel_for("mixbeam::elements::tangent",
                       Kokkos::RangePolicy<ExecutionSpace>(0, RowsInLanes<W>::packs(block.count)), loop);
}

}  // namespace mixbeam
