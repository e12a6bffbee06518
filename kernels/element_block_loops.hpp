/// The loops of element_block.hpp for one order and kind of section, instantiated in element_block_k<order>.cpp and
/// element_block_general_k<order>.cpp (one translation unit each keeps the build parallel).
#pragma once

#include "kernels/element_block.hpp"
#include "kernels/element_fields_tangent.hpp"
#include "kernels/element_tangent_general.hpp"

namespace mixbeam {

/// Views of one block, gathered element by element into named values. Captured by value: inside a kernel no View is
/// copied.
template <int K, bool General>
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
  int first_element;
  size_t interior_offset;

  ElementGather(const ElementBlock& block, const StructureViews& structure, const StateViews& state)
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
        first_element(block.first_element),
        interior_offset(block.interior_offset) {}

  KOKKOS_INLINE_FUNCTION ElementInput input(int e) const {
    ElementInput in;
    for (int end = 0; end < 2; ++end) {
      const int vertex = vertices(e, end);
      in.displacement[end] = load_vector(&vertex_displacement(vertex, 0));
      in.vertex_rotation[end] = load_quaternion(&vertex_rotation(vertex, 0));
    }
    in.triad = load_quaternion(&element_triad(first_element + e, 0));
    in.interior = interior.data() + interior_offset + static_cast<size_t>(e) * layout.unknowns();
    in.reference = &reference(e, 0);
    return in;
  }
  /// SectionConstants of the member, or the compliances of this element.
  KOKKOS_INLINE_FUNCTION decltype(auto) section_of(int e) const {
    const SectionConstants& constants = section(member(e));
    if constexpr (General)
      return GeneralSection{&compliance(e, 0),
                            {layout.order, layout.force_points},
                            constants.force_stiffness_limit,
                            constants.moment_stiffness_limit};
    else
      return (constants);
  }
  KOKKOS_INLINE_FUNCTION bool has_fields() const { return field_row.extent(0) > 0; }
  KOKKOS_INLINE_FUNCTION ElementFields fields(int e) const {
    ElementFields result;
    for (int i = 0; i < kLineFields; ++i)
      if (field_row(e, i) >= 0) result.values[i] = &field_value(field_row(e, i), 0);
    return result;
  }
};

template <int K, bool General>
struct ResidualLoop {
  ElementGather<K, General> gather;
  KernelView<double* [12]> residual;
  KernelView<double*> interior_residual, largest_end_angle;
  size_t increment_offset;

  KOKKOS_INLINE_FUNCTION void operator()(int e) const {
    const ElementInput in = gather.input(e);
    const ElementKinematics<K> kinematics(in, gather.layout);
    ElementGradient<K> gradient;
    element_gradient(in, kinematics, gather.tables, gather.layout, gather.reference_layout, gather.section_of(e),
                     gradient);
    if (gather.has_fields()) add_field_gradient(gather.fields(e), kinematics, gather.tables, gradient);
    const int element = gather.first_element + e;
    store_residual(gradient, kinematics, gather.layout,
                   interior_residual.data() + increment_offset + static_cast<size_t>(e) * gather.layout.increments(),
                   &residual(element, 0));
    largest_end_angle(element) = gradient.largest_end_angle;
  }
};

/// Interior right-hand side given from outside, in place of the gradient of the state (rows as store_residual writes
/// them).
template <int K>
KOKKOS_INLINE_FUNCTION void replace_gradient(const double* rhs, const ElementKinematics<K>& kinematics,
                                             const InteriorLayout& layout, ElementGradient<K>& g) {
  clear(g);
  for (int q = 0; q < layout.force_points; ++q) g.strain_error[q] = load_vector(rhs + layout.force(q));
  for (int j = 0; j <= K; ++j) g.moment_row[j] = load_vector(rhs + layout.moment(j));
  for (int j = 1; j < K; ++j) {
    g.psi[j] = load_vector(rhs + layout.relative_rotation(j));
    g.slope[j] = transpose_times(kinematics.triad, load_vector(rhs + layout.bubble(j)));
  }
  g.spin = load_vector(rhs + layout.spin());
}

/// Builds the reduced system of one element and keeps what the recovery of N and M needs.
template <int K, bool General>
struct CondensedElement {
  ReducedSystem<K> system;
  std::conditional_t<General, GeneralMomentRows<K>, MomentRows<K>> moment_rows;
  ForceRows<std::conditional_t<General, Mat, Vec>> force_rows_[ElementTables<K>::kMaximumForcePoints];
  ElementGradient<K> gradient;
  double response[ReducedSystem<K>::kInteriorSize][kResponseColumns];
  double tangent[9][9];
  double reduced_gradient[9];
  MeanRows<K> mean_rows;  ///< under follower forces only

  KOKKOS_INLINE_FUNCTION void build(const ElementGather<K, General>& gather, int e, const ElementInput& in,
                                    const ElementKinematics<K>& kinematics, const double* given_rhs) {
    const auto& section = gather.section_of(e);
    const ElementTables<K>& tables = gather.tables;
    clear_system();
    if (given_rhs == nullptr) {
      element_gradient(in, kinematics, tables, gather.layout, gather.reference_layout, section, gradient);
      if (gather.has_fields()) add_field_gradient(gather.fields(e), kinematics, tables, gradient);
    } else {
      replace_gradient(given_rhs, kinematics, gather.layout, gradient);
    }
    for (int q = 0; q < tables.force_points; ++q) {
      ForcePoint<K> point(q, in, kinematics, tables, gather.layout, gather.reference_layout, section);
      point.strain_error = gradient.strain_error[q];
      force_rows_[q] = force_rows(point, tangent_force_stiffness(q, tables, section));
      add_force_tangent(point, force_rows_[q], tables.force_legendre[q], system);
      add_force_correction(point, force_rows_[q], tables.force_legendre[q], system);
      if constexpr (General)
        moment_rows.couple(point, force_rows_[q], section.force_moment(q), tables.force_legendre[q]);
    }
    if constexpr (K > 1)
      for (int q = 0; q <= K; ++q) {
        const MomentPoint<K> point(q, in, kinematics, tables, gather.layout, gather.reference_layout);
        add_moment_tangent(point, tables.moment_legendre[q], tables.moment_slope[q], kinematics.length, moment_rows,
                           system);
      }
    for (int end = 0; end < 2; ++end)
      add_end_tangent(end, EndRotation<K>(end, in, kinematics, gather.layout, gather.reference_layout), moment_rows,
                      system);
    if constexpr (General) moment_rows.add_compliance(section, tables, kinematics.length);
    condense_moments(moment_rows, gradient.moment_row, section, kinematics.length, system);
    add_gradient();
    system.mirror();
    if (gather.has_fields()) add_field_tangent(gather.fields(e), kinematics, tables, system, mean_rows);
    solve_interior(system, response);
    condense_interior(system, response, tangent, reduced_gradient);
    if (mean_rows.used) mean_rows.condense(response);
  }

  /// Rows of the increments: response of N (pointwise), M (by mode), psi, beta (spatial) and w.
  KOKKOS_INLINE_FUNCTION void store_response(const ElementGather<K, General>& gather, int e,
                                             const ElementKinematics<K>& kinematics, double* rows) const {
    const InteriorLayout& layout = gather.layout;
    const auto& section = gather.section_of(e);
    for (int j = 0; j <= K; ++j)
      store_moment_response(j, section, kinematics.length, rows + kResponseColumns * layout.moment(j));
    for (int q = 0; q < layout.force_points; ++q)
      store_force_response(q, section, gather.tables.force_legendre[q], rows + kResponseColumns * layout.moment(0),
                           rows + kResponseColumns * layout.force(q));
    for (int j = 1; j < K; ++j) {
      copy_rows(3 * ReducedBlocks<K>::psi(j), rows + kResponseColumns * layout.relative_rotation(j));
      const double(*slope)[kResponseColumns] = response + 3 * ReducedBlocks<K>::slope(j);
      double* bubble = rows + kResponseColumns * layout.bubble(j);
      for (int i = 0; i < 3; ++i)
        for (int c = 0; c < kResponseColumns; ++c)
          bubble[kResponseColumns * i + c] = kinematics.triad(i, 0) * slope[0][c] +
                                             kinematics.triad(i, 1) * slope[1][c] +
                                             kinematics.triad(i, 2) * slope[2][c];
    }
    copy_rows(3 * ReducedBlocks<K>::spin(), rows + kResponseColumns * layout.spin());
  }

 private:
  KOKKOS_INLINE_FUNCTION void clear_system() {
    for (int i = 0; i < ReducedSystem<K>::kSize; ++i) {
      system.rhs[i] = 0.0;
      for (int j = 0; j <= i; ++j) system.matrix[i][j] = 0.0;
    }
    // block lower triangle: the upper half of the diagonal blocks is written too
    for (int b = 0; b < ReducedBlocks<K>::kCount; ++b)
      for (int i = 0; i < 3; ++i)
        for (int j = i + 1; j < 3; ++j) system.matrix[3 * b + i][3 * b + j] = 0.0;
    moment_rows.clear();
  }
  KOKKOS_INLINE_FUNCTION void add_gradient() {
    using Blocks = ReducedBlocks<K>;
    system.add(Blocks::spin(), 1.0, gradient.spin);
    for (int j = 0; j < K; ++j) system.add(Blocks::slope(j), 1.0, gradient.slope[j]);
    for (int j = 1; j < K; ++j) system.add(Blocks::psi(j), 1.0, gradient.psi[j]);
    for (int end = 0; end < 2; ++end) system.add(Blocks::vertex(end), 1.0, gradient.vertex_spin[end]);
  }
  KOKKOS_INLINE_FUNCTION void copy_rows(int first, double* rows) const {
    for (int i = 0; i < 3; ++i)
      for (int c = 0; c < kResponseColumns; ++c) rows[kResponseColumns * i + c] = response[first + i][c];
  }
  /// dN = C (gamma - C^-1 N + d gamma); with coupling less S_NM dM, `moments` being the responses of all of M.
  template <class AnySection>
  KOKKOS_INLINE_FUNCTION void store_force_response(int q, [[maybe_unused]] const AnySection& section, const double* P,
                                                   [[maybe_unused]] const double* moments, double* rows) const {
    using Blocks = ReducedBlocks<K>;
    const auto& force = force_rows_[q];
    for (int c = 0; c < kResponseColumns; ++c) {
      Vec slope{{0.0, 0.0, 0.0}}, psi{{0.0, 0.0, 0.0}};
      if (c < 3) slope[c] = 1.0;
      for (int i = 0; i < 3; ++i)
        for (int j = 1; j < K; ++j) {
          slope[i] += P[j] * response[3 * Blocks::slope(j) + i][c];
          psi[i] += P[j] * response[3 * Blocks::psi(j) + i][c];
        }
      const Vec spin{{response[0][c], response[1][c], response[2][c]}};
      Vec strain = force.slope * slope + force.spin * spin;
      if constexpr (K > 1) strain += force.psi * psi;
      if (c == 9) strain += gradient.strain_error[q];
      if constexpr (General) {
        Vec moment{{0.0, 0.0, 0.0}};
        for (int j = 0; j < K; ++j)
          for (int i = 0; i < 3; ++i) moment[i] += P[j] * moments[kResponseColumns * (3 * j + i) + c];
        strain += -(section.force_moment(q) * moment);
        strain = force.stiffness * strain;
      } else {
        for (int i = 0; i < 3; ++i) strain[i] = force.stiffness[i] * strain[i];
      }
      for (int i = 0; i < 3; ++i) rows[kResponseColumns * i + c] = strain[i];
    }
  }
  /// dM_j = (2j + 1)/h C (row_j + d row_j)
  KOKKOS_INLINE_FUNCTION void store_moment_response(int j, const GeneralSection&, double, double* rows) const {
    for (int r = 0; r < 3; ++r) moment_rows.response_row(3 * j + r, response, rows + kResponseColumns * r);
  }
  KOKKOS_INLINE_FUNCTION void store_moment_response(int j, const SectionConstants& section, double length,
                                                    double* rows) const {
    for (int r = 0; r < 3; ++r) {
      const double* row = moment_rows.row[j][r];
      const double stiffness = (2 * j + 1) / length * section.moment_stiffness[r];
      double sum[kResponseColumns];
      for (int c = 0; c < 3; ++c) sum[c] = 0.0;
      for (int c = 3; c < 9; ++c) sum[c] = row[3 * K + c - 3];
      sum[9] = gradient.moment_row[j][r];
      for (int b = 0; b < 3 * K; ++b)
        for (int c = 0; c < kResponseColumns; ++c) sum[c] += row[b] * response[b][c];
      for (int c = 0; c < kResponseColumns; ++c) rows[kResponseColumns * r + c] = stiffness * sum[c];
    }
  }
};

template <int K, bool General>
struct TangentLoop {
  ElementGather<K, General> gather;
  KernelView<double* [12]> condensed_residual;
  KernelView<double* [144]> condensed_tangent;
  KernelView<double*> response;
  KernelView<const double*> given_rhs;  ///< empty: the residual of the state
  size_t increment_offset, response_offset;

  KOKKOS_INLINE_FUNCTION void operator()(int e) const {
    const ElementInput in = gather.input(e);
    const ElementKinematics<K> kinematics(in, gather.layout);
    const size_t increments = gather.layout.increments();
    const double* rhs = given_rhs.extent(0) == 0 ? nullptr : given_rhs.data() + increment_offset + e * increments;
    CondensedElement<K, General> element;
    element.build(gather, e, in, kinematics, rhs);
    element.store_response(gather, e, kinematics,
                           response.data() + response_offset + e * increments * kResponseColumns);
    const int index = gather.first_element + e;
    expand_tangent(element.tangent, kinematics.triad, kinematics.length, &condensed_tangent(index, 0));
    store_condensed_residual(element, kinematics, &condensed_residual(index, 0));
    if (element.mean_rows.used)
      element.mean_rows.expand(kinematics, &condensed_tangent(index, 0), &condensed_residual(index, 0));
  }

  KOKKOS_INLINE_FUNCTION static void store_condensed_residual(const CondensedElement<K, General>& element,
                                                              const ElementKinematics<K>& kinematics, double* row) {
    const Vec force = (1.0 / kinematics.length) * (kinematics.triad * load_vector(element.reduced_gradient));
    store_vector(element.gradient.vertex_force[0] - force, row);
    store_vector(kinematics.triad * load_vector(element.reduced_gradient + 3), row + 3);
    store_vector(element.gradient.vertex_force[1] + force, row + 6);
    store_vector(kinematics.triad * load_vector(element.reduced_gradient + 6), row + 9);
  }
};

template <int K, bool General>
void residual_loop(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                   const ElementEquations& equations) {
  const ResidualLoop<K, General> loop{ElementGather<K, General>(block, structure, state), equations.residual,
                                      equations.interior_residual, equations.largest_end_angle, block.increment_offset};
  Kokkos::parallel_for("mixbeam::elements::residual", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), loop);
}

template <int K, bool General>
void tangent_loop(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                  const KernelView<const double*>& given_rhs, const ElementEquations& equations) {
  const TangentLoop<K, General> loop{ElementGather<K, General>(block, structure, state),
                                     equations.condensed_residual,
                                     equations.condensed_tangent,
                                     equations.response,
                                     given_rhs,
                                     block.increment_offset,
                                     block.response_offset};
  Kokkos::parallel_for("mixbeam::elements::tangent", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), loop);
}

}  // namespace mixbeam
