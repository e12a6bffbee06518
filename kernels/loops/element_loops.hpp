/// Loops over the elements of a block, of one order and kind of section: residual, condensed tangent, recovery of the
/// interiors. Views become named values for as many elements as there are lanes; each index is one such pack.
#pragma once

#include "kernels/condensation/condensation.hpp"
#include "kernels/condensation/interior_factor.hpp"
#include "kernels/condensation/line_fields_tangent.hpp"
#include "kernels/loops/block.hpp"

namespace mixbeam {

/// Views of one block. Captured by value: no View is copied inside a kernel.
template <int K, bool General, int W>
struct ElementGather {
  ElementBlock block;
  StructureViews structure;  ///< without line fields if they are not needed
  StateViews state;
  ElementTables<K> tables;
  int response_size;

  // always inlined, like eliminate_rows()
  KOKKOS_FORCEINLINE_FUNCTION ElementGather(const ElementBlock& elements, const StructureViews& constants,
                                            const StateViews& values)
      : block(elements),
        structure(constants),
        state(values),
        tables(elements.force_integration),
        response_size(elements.response_size()) {}

  /// First number of element e in arrays of increments and of interior residuals.
  KOKKOS_INLINE_FUNCTION size_t increment_of(int e) const { return block.increments_at()(e); }
  /// Offset of the element in the response.
  KOKKOS_INLINE_FUNCTION size_t response_of(int e) const {
    return block.response_offset + static_cast<size_t>(e) * response_size;
  }
  KOKKOS_INLINE_FUNCTION bool has_fields() const {
    return block.field_row.extent(0) > 0 && structure.field_value.extent(0) > 0;
  }
  KOKKOS_INLINE_FUNCTION ElementFields<> fields(int e) const {
    ElementFields<> result;
    for (int i = 0; i < kLineFields; ++i)
      if (block.field_row(e, i) >= 0) result.values[i] = &structure.field_value(block.field_row(e, i), 0);
    return result;
  }
};

/// Data of the elements of one pack.
template <int K, bool General, int W>
struct ElementPack {
  using Real = Pack<W>;
  using Gather = ElementGather<K, General, W>;
  static constexpr int kForcePoints = ElementTables<K>::kMaximumForcePoints;
  static constexpr int kIncrements = InteriorLayout{K, kForcePoints}.increments();
  RowsInLanes<W> lanes;
  ElementInput<Real> in;
  SectionOf<General, Real> section;
  ElementFields<Real> fields;

  KOKKOS_FORCEINLINE_FUNCTION ElementPack(const Gather& gather, int pack) : lanes(pack, gather.block.count) {
    Real x[4];
    for (int end = 0; end < 2; ++end) {
      const auto vertex = [&](int e) { return gather.block.vertices(e, end); };
      lanes.load([&](int e) { return &gather.state.vertex_displacement(vertex(e), 0); }, 3, x);
      in.displacement[end] = load_vector(x);
      lanes.load([&](int e) { return &gather.state.vertex_rotation(vertex(e), 0); }, 4, x);
      in.vertex_rotation[end] = load_quaternion(x);
    }
    lanes.load([&](int e) { return &gather.state.element_triad(gather.block.first_element + e, 0); }, 4, x);
    in.triad = load_quaternion(x);
    lanes.load([&](int e) { return gather.state.interior.data() + gather.block.unknowns_at()(e); },
               gather.block.interior.unknowns(), interior_);
    lanes.load([&](int e) { return &gather.block.reference(e, 0); }, gather.block.reference_layout.size(), reference_);
    in.interior = interior_;
    in.reference = reference_;
    load_section(gather);
    if (gather.has_fields()) {
      const RowsInLanes<W> rows = lanes;
      load_fields(gather, rows, field_, fields);
    }
  }

 private:
  Real interior_[InteriorLayout{K, kForcePoints}.unknowns()], reference_[ReferenceLayout{K, kForcePoints}.size()];
  Real compliance_[General ? GeneralSectionLayout{K, kForcePoints}.size() : 1];
  Real field_[kLineFields][3 * kForcePoints];

  KOKKOS_FORCEINLINE_FUNCTION void load_section(const Gather& gather) {
    const auto constants = [&](int e) -> const SectionConstants& {
      return gather.structure.sections(gather.block.section(e));
    };
    if constexpr (General) {
      section.layout = {gather.block.interior.order, gather.block.interior.force_points};
      lanes.load([&](int e) { return &gather.block.compliance(e, 0); }, section.layout.size(), compliance_);
      section.compliance = compliance_;
      section.is_coupled = false;  // uncoupled sections skip the coupling terms
      for (int q = 0; q < section.layout.force_points; ++q)
        for (int i = 0; i < 9; ++i)
          section.is_coupled =
              section.is_coupled || any<W>(fabs(compliance_[section.layout.force_moment(q) + i]) > Real(0.0));
      lanes.load([&](int e) { return &constants(e).force_stiffness_limit; }, 1, &section.force_stiffness_limit);
      lanes.load([&](int e) { return &constants(e).moment_stiffness_limit; }, 1, &section.moment_stiffness_limit);
    } else {
      lanes.load([&](int e) { return constants(e).numbers(); }, SectionConstants::kCount, section.numbers());
    }
  }
  // Static, so that no other member of the pack has its address taken.
  KOKKOS_FUNCTION __attribute__((noinline)) static void load_fields(const Gather& gather, const RowsInLanes<W>& rows,
                                                                    Real (*numbers)[3 * kForcePoints],
                                                                    ElementFields<Real>& fields) {
    for (int i = 0; i < kLineFields; ++i) {
      if ((gather.block.kinds_of_fields >> i & 1U) == 0) continue;
      bool some_have_it = false;
      for (const int e : rows.row) some_have_it = some_have_it || gather.block.field_row(e, i) >= 0;
      if (!some_have_it) continue;
      const auto values_of = [&](int e) {
        const int row = gather.block.field_row(e, i);
        return row < 0 ? kNoField : &gather.structure.field_value(row, 0);
      };
      const int points = line_field_points(static_cast<LineField>(i), K, gather.block.interior.force_points);
      rows.load(values_of, 3 * points, numbers[i]);
      fields.values[i] = numbers[i];
    }
  }
};

template <int K, bool General, int W>
struct ResidualLoop {
  ElementGather<K, General, W> gather;
  ElementEquations to;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    using Real = Pack<W>;
    const ElementPack<K, General, W> pack(gather, number);
    const ElementKinematics<K, Real> kinematics(pack.in, gather.block.interior);
    ElementGradient<K, Real> gradient;
    if (to.fields_alone)
      clear(gradient);
    else
      element_gradient(pack.in, kinematics, gather.tables, gather.block.interior, gather.block.reference_layout,
                       pack.section, gradient);
    if (gather.has_fields()) add_field_gradient(pack.fields, kinematics, gather.tables, gradient);
    Real interior_row[pack.kIncrements], vertex_row[12];
    store_residual(gradient, kinematics, gather.block.interior, interior_row, vertex_row);
    if (to.scales_interior)
      scale_interior_rows(gather.block.interior, to.interior_scales, kinematics.length, false, interior_row);
    const auto interior_of = [&](int e) { return &to.interior_residual(gather.increment_of(e)); };
    pack.lanes.store(interior_row, 0, gather.block.interior.increments(), interior_of);
    pack.lanes.store(vertex_row, 0, 12, [&](int e) { return &to.residual(gather.block.first_element + e, 0); });
    for (int lane = 0; lane < pack.lanes.active; ++lane)
      to.largest_end_angle(gather.block.first_element + pack.lanes.row[lane]) = gradient.largest_end_angle[lane];
  }
};

template <int K, bool General, int W>
void residual_loop(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                   const ElementEquations& equations) {
  const ResidualLoop<K, General, W> loop{ElementGather<K, General, W>(block, structure, state), equations};
  Kokkos::parallel_for("mixbeam::elements::residual",
                       Kokkos::RangePolicy<ExecutionSpace>(0, RowsInLanes<W>::packs(block.count)), loop);
}

template <int K, bool General, int W>
struct TangentLoop {
  using Real = Pack<W>;
  using Elements = ElementPack<K, General, W>;
  using Kinematics = ElementKinematics<K, Real>;
  using Condensed = CondensedElement<K, General, Real>;
  static constexpr int kCount = RowsInLanes<W>::kCount;

  ElementGather<K, General, W> gather;
  ElementEquations to;
  KernelView<const double*> given_rhs;  ///< empty: use the residual of the state

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    const Elements pack(gather, number);
    const Kinematics kinematics(pack.in, gather.block.interior);
    Condensed element;
    clear(element.gradient);
    if (!own_gradient())
      load_given_gradient(pack.lanes, kinematics, element.gradient);
    else if (gather.has_fields())
      add_field_gradient(pack.fields, kinematics, gather.tables, element.gradient);
    element.build(gather.tables, gather.block.interior, gather.block.reference_layout, pack.in, kinematics,
                  pack.section, own_gradient());
    InteriorSigns signs[kCount];
    MeanRows<K, Real> mean_rows;
    const bool has_potential = !pack.fields.have_no_potential();
    const typename Real::Mask unsymmetric = without_potential(pack.lanes, !has_potential);
    if (has_potential || any<W>(~unsymmetric))
      solve_in_lanes(element.system, element.response, element.condensed, counts() ? signs : nullptr);
    if (!has_potential) {
      const Kinematics copy = kinematics;  // only this copy has its address taken
      solve_with_fields(unsymmetric, pack.fields, copy, element, mean_rows, counts() ? signs : nullptr);
    }
    for (int lane = 0; counts() && lane < pack.lanes.active; ++lane) store_signs(pack.lanes.row[lane], signs[lane]);
    const auto response_of = [&](int e) { return to.response.data() + gather.response_of(e); };
    const auto store = [&](int first, int count, const Real* numbers) {
      pack.lanes.store(numbers, first, count, response_of);
    };
    element.store_response(store);
    Real constants[Elements::kIncrements];
    element.constants(gather.block.interior, constants);
    const auto constants_of = [&](int e) { return &to.constants(gather.increment_of(e)); };
    pack.lanes.store(constants, 0, gather.block.interior.increments(), constants_of);
    store_condensed(pack.lanes, kinematics, element, unsymmetric, has_potential ? nullptr : &mean_rows);
  }

 private:
  KOKKOS_INLINE_FUNCTION bool own_gradient() const { return given_rhs.extent(0) == 0; }
  KOKKOS_INLINE_FUNCTION bool counts() const { return to.interior_negative.extent(0) > 0; }
  KOKKOS_INLINE_FUNCTION double* tangent_of(int e) const {
    return &to.condensed_tangent(gather.block.first_element + e, 0);
  }
  KOKKOS_INLINE_FUNCTION double* residual_of(int e) const {
    return &to.condensed_residual(gather.block.first_element + e, 0);
  }

  KOKKOS_FORCEINLINE_FUNCTION void load_given_gradient(const RowsInLanes<W>& lanes, const Kinematics& kinematics,
                                                       ElementGradient<K, Real>& gradient) const {
    Real rhs[Elements::kIncrements];
    lanes.load([&](int e) { return &given_rhs(gather.increment_of(e)); }, gather.block.interior.increments(), rhs);
    add_given_gradient(rhs, kinematics, gather.block.interior, gradient);
  }
  KOKKOS_INLINE_FUNCTION void store_signs(int e, const InteriorSigns& signs) const {
    to.interior_negative(gather.block.first_element + e) = signs.uncertain ? kUncertainCount : signs.negative;
  }
  KOKKOS_FORCEINLINE_FUNCTION void store_condensed(const RowsInLanes<W>& lanes, const Kinematics& kinematics,
                                                   const Condensed& element, const typename Real::Mask& unsymmetric,
                                                   const MeanRows<K, Real>* mean_rows) const {
    Real residual[12];
    const Vec3<Real>* gradient = element.condensed.gradient;
    store_vertex_rows(gradient[0], gradient[1], gradient[2], element.gradient, kinematics, residual);
    if (to.condensed_tangent.extent(1) == kSymmetricTangent) {
      Real tangent[kSymmetricTangent];
      symmetric_tangent(element.condensed.matrix, kinematics.triad, kinematics.length, tangent);
      lanes.store(tangent, 0, kSymmetricTangent, [&](int e) { return tangent_of(e); });
    } else {
      store_full(lanes, Kinematics(kinematics), element, ~unsymmetric, mean_rows, residual);
    }
    lanes.store(residual, 0, 12, [&](int e) { return residual_of(e); });
  }
  /// For structures with elements without potential. `mean_rows`: null if this pack has none.
  KOKKOS_FUNCTION __attribute__((noinline)) void store_full(const RowsInLanes<W>& lanes, const Kinematics& kinematics,
                                                            const Condensed& element,
                                                            const typename Real::Mask& symmetric,
                                                            const MeanRows<K, Real>* mean_rows, Real* residual) const {
    Real tangent[kFullTangent];
    if (mean_rows != nullptr) {
      full_tangent(element.condensed.matrix, kinematics.triad, kinematics.length, tangent);
      if (mean_rows->used) mean_rows->expand(element.response, kinematics, tangent, residual);
    }
    if (any<W>(symmetric)) {
      Real packed[kSymmetricTangent], expanded[kFullTangent];
      symmetric_tangent(element.condensed.matrix, kinematics.triad, kinematics.length, packed);
      expand_symmetric_tangent<kSpatialDofs>(packed, expanded);
      for (int i = 0; i < kFullTangent; ++i)
        tangent[i] = mean_rows == nullptr ? expanded[i] : select(symmetric, expanded[i], tangent[i]);
    }
    lanes.store(tangent, 0, kFullTangent, [&](int e) { return tangent_of(e); });
  }
  /// Lanes whose element has no potential; none if not `some`.
  KOKKOS_FORCEINLINE_FUNCTION typename Real::Mask without_potential(const RowsInLanes<W>& lanes, bool some) const {
    typename Real::Mask mask = Real(0.0) > Real(0.0);
    for (int lane = 0; lane < kCount && some; ++lane)
      mask[lane] = gather.fields(lanes.row[lane]).have_no_potential() ? -1 : 0;
    return mask;
  }
  /// Solves elements that have line fields without potential, including their unsymmetric part.
  KOKKOS_FUNCTION __attribute__((noinline)) void solve_with_fields(const typename Real::Mask& wanted,
                                                                   const ElementFields<Real>& fields,
                                                                   const Kinematics& kinematics, Condensed& element,
                                                                   MeanRows<K, Real>& mean_rows,
                                                                   InteriorSigns* signs) const {
    const auto system = [&] {
      FullSystem<K, Real> full(element.system, [](const Real& x) { return x; });
      add_field_tangent(fields, kinematics, gather.tables, full, mean_rows);
      return full;
    };
    solve_general_in_lanes<K, W>(system, wanted, element.response, element.condensed, signs);
  }
};

template <int K, bool General, int W>
void tangent_loop(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                  const KernelView<const double*>& given_rhs, const ElementEquations& equations) {
  const TangentLoop<K, General, W> loop{ElementGather<K, General, W>(block, structure, state), equations, given_rhs};
  Kokkos::parallel_for("mixbeam::elements::tangent",
                       Kokkos::RangePolicy<ExecutionSpace>(0, RowsInLanes<W>::packs(block.count)), loop);
}

template <int K, bool General, int W>
struct RecoverLoop {
  using Real = Pack<W>;
  ElementGather<K, General, W> gather;
  KernelView<const double*> response;
  KernelView<const double* [6]> vertex_increment;
  KernelView<double*> increment;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    using Elements = ElementPack<K, General, W>;
    const Elements pack(gather, number);
    const ElementKinematics<K, Real> kinematics(pack.in, gather.block.interior);
    Real ends[2][6], out[Elements::kIncrements];
    for (int end = 0; end < 2; ++end)
      pack.lanes.load([&](int e) { return &vertex_increment(gather.block.vertices(e, end), 0); }, 6, ends[end]);
    ReducedIncrement<K, Real> d(kinematics, ends[0], ends[1]);
    const auto response_of = [&](int e) { return response.data() + gather.response_of(e); };
    Real kept[ResponseLayout{K}.size()];
    pack.lanes.load(response_of, gather.response_size, kept);
    const auto increment_of = [&](int e) { return &increment(gather.increment_of(e)); };
    pack.lanes.load(increment_of, gather.block.interior.increments(), out);
    recover_element(pack.in, kinematics, gather.tables, gather.block.interior, gather.block.reference_layout,
                    pack.section, d, kept, out);
    pack.lanes.store(out, 0, gather.block.interior.increments(), increment_of);
  }
};

template <int K, bool General, int W>
void recover_loop(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                  const ElementEquations& equations, const KernelView<const double* [6]>& vertex_increment,
                  const KernelView<double*>& increment) {
  const RecoverLoop<K, General, W> loop{ElementGather<K, General, W>(block, {structure.sections}, state),
                                        equations.response, vertex_increment, increment};
  Kokkos::parallel_for("mixbeam::elements::recover",
                       Kokkos::RangePolicy<ExecutionSpace>(0, RowsInLanes<W>::packs(block.count)), loop);
}

}  // namespace mixbeam
