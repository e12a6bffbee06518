/// What the loops over elements read: Views become named values, of as many elements at once as there are lanes.
#pragma once

#include "kernels/condensation/condensation.hpp"
#include "kernels/loops/block.hpp"

namespace mixbeam {

/// Values of a line field that an element does not have, where one beside it has it.
inline constexpr double kNoField[3 * ElementTables<kMaximumOrder>::kMaximumForcePoints] = {};

/// Views of one block. Captured by value: inside a kernel no View is copied.
template <int K, bool General, int W>
struct ElementGather {
  KernelView<const double**> reference;
  KernelView<const int* [2]> vertices;
  KernelView<const int*> member;
  KernelView<const double* [3]> vertex_displacement;
  KernelView<const double*[4]> vertex_rotation, element_triad;
  KernelView<const double*> interior;
  KernelView<const SectionConstants*> section;
  KernelView<const double**> compliance;
  KernelView<const int* [kLineFields]> field_row;
  KernelView<const double* [3]> field_value;
  InteriorLayout layout;
  ReferenceLayout reference_layout;
  ElementTables<K> tables;
  int count, first_element;
  size_t interior_offset, increment_offset;

  /// `structure` without sections: they are not asked for.
  // always inlined, as eliminate_rows()
  KOKKOS_FORCEINLINE_FUNCTION ElementGather(const ElementBlock& block, const StructureViews& structure,
                                            const StateViews& state)
      : reference(block.reference),
        vertices(block.vertices),
        member(block.member),
        vertex_displacement(state.vertex_displacement),
        vertex_rotation(state.vertex_rotation),
        element_triad(state.element_triad),
        interior(state.interior),
        section(structure.member_section),
        compliance(block.compliance),
        field_row(block.field_row),
        field_value(block.field_value),
        layout(block.interior),
        reference_layout(block.reference_layout),
        tables(block.force_integration),
        count(block.count),
        first_element(block.first_element),
        interior_offset(block.interior_offset),
        increment_offset(block.increment_offset) {}

  KOKKOS_INLINE_FUNCTION const double* interior_of(int e) const {
    return interior.data() + interior_offset + static_cast<size_t>(e) * layout.unknowns();
  }
  /// First number of element e in arrays of increments and of interior residuals.
  KOKKOS_INLINE_FUNCTION size_t increment_of(int e) const {
    return increment_offset + static_cast<size_t>(e) * layout.increments();
  }
  KOKKOS_INLINE_FUNCTION bool has_fields() const { return field_row.extent(0) > 0; }
  KOKKOS_INLINE_FUNCTION ElementFields<> fields(int e) const {
    ElementFields<> result;
    for (int i = 0; i < kLineFields; ++i)
      if (field_row(e, i) >= 0) result.values[i] = &field_value(field_row(e, i), 0);
    return result;
  }
};

/// The numbers of the elements of one pack.
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

  KOKKOS_FORCEINLINE_FUNCTION ElementPack(const Gather& gather, int pack) : lanes(pack, gather.count) {
    Real x[4];
    for (int end = 0; end < 2; ++end) {
      const auto vertex = [&](int e) { return gather.vertices(e, end); };
      lanes.load([&](int e) { return &gather.vertex_displacement(vertex(e), 0); }, 3, x);
      in.displacement[end] = load_vector(x);
      lanes.load([&](int e) { return &gather.vertex_rotation(vertex(e), 0); }, 4, x);
      in.vertex_rotation[end] = load_quaternion(x);
    }
    lanes.load([&](int e) { return &gather.element_triad(gather.first_element + e, 0); }, 4, x);
    in.triad = load_quaternion(x);
    lanes.load([&](int e) { return gather.interior_of(e); }, gather.layout.unknowns(), interior_);
    lanes.load([&](int e) { return &gather.reference(e, 0); }, gather.reference_layout.size(), reference_);
    in.interior = interior_;
    in.reference = reference_;
    if (gather.section.extent(0) > 0) load_section(gather);
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
    const auto constants = [&](int e) -> const SectionConstants& { return gather.section(gather.member(e)); };
    if constexpr (General) {
      section.layout = {gather.layout.order, gather.layout.force_points};
      lanes.load([&](int e) { return &gather.compliance(e, 0); }, section.layout.size(), compliance_);
      section.compliance = compliance_;
      lanes.load([&](int e) { return &constants(e).force_stiffness_limit; }, 1, &section.force_stiffness_limit);
      lanes.load([&](int e) { return &constants(e).moment_stiffness_limit; }, 1, &section.moment_stiffness_limit);
    } else {
      lanes.load([&](int e) { return constants(e).numbers(); }, SectionConstants::kCount, section.numbers());
    }
  }
  // Static, so that nothing else of the pack has its address taken.
  KOKKOS_FUNCTION __attribute__((noinline)) static void load_fields(const Gather& gather, const RowsInLanes<W>& rows,
                                                                    Real (*numbers)[3 * kForcePoints],
                                                                    ElementFields<Real>& fields) {
    for (int i = 0; i < kLineFields; ++i) {
      bool some_have_it = false;
      for (const int e : rows.row) some_have_it = some_have_it || gather.field_row(e, i) >= 0;
      if (!some_have_it) continue;
      const auto values_of = [&](int e) {
        const int row = gather.field_row(e, i);
        return row < 0 ? kNoField : &gather.field_value(row, 0);
      };
      const int points = line_field_points(static_cast<LineField>(i), K, gather.layout.force_points);
      rows.load(values_of, 3 * points, numbers[i]);
      fields.values[i] = numbers[i];
    }
  }
};

}  // namespace mixbeam
