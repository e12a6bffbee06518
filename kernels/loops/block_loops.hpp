/// The loops of loops/block.hpp for one order and kind of section, instantiated in element_block_k<order>.cpp and
/// element_block_general_k<order>.cpp (one translation unit each keeps the build parallel).
#pragma once

#include "kernels/element/line_fields_tangent.hpp"
#include "kernels/element/moment_elimination.hpp"
#include "kernels/loops/block.hpp"

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
        first_element(block.first_element),
        interior_offset(block.interior_offset) {}

  KOKKOS_INLINE_FUNCTION ElementInput<> input(int e) const {
    ElementInput<> in;
    for (int end = 0; end < 2; ++end) {
      const int vertex = vertices(e, end);
      in.displacement[end] = load_vector(&vertex_displacement(vertex, 0));
      in.vertex_rotation[end] = load_quaternion(&vertex_rotation(vertex, 0));
    }
    in.triad = load_quaternion(&element_triad(first_element + e, 0));
    in.interior = interior_of(e);
    in.reference = &reference(e, 0);
    return in;
  }
  KOKKOS_INLINE_FUNCTION const double* interior_of(int e) const {
    return interior.data() + interior_offset + static_cast<size_t>(e) * layout.unknowns();
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

/// Rows of numbers of one element in memory, or of the elements in all lanes. `at(e)`: first number of element e.
template <class Real>
struct ElementRows;
template <>
struct ElementRows<double> {
  double* row;
  template <class At>
  KOKKOS_INLINE_FUNCTION ElementRows(int e, const At& at) : row(at(e)) {}
  KOKKOS_INLINE_FUNCTION void store(int first, int count, const double* numbers) const {
    for (int i = 0; i < count; ++i) row[first + i] = numbers[i];
  }
};
template <>
struct ElementRows<Pack<kLanes>> {
  double* row[kLanes];
  int active;
  template <class At>
  ElementRows(const LaneRows& lanes, const At& at) : active(lanes.active) {
    for (int lane = 0; lane < kLanes; ++lane) row[lane] = at(lanes.row[lane]);
  }
  void store(int first, int count, const Pack<kLanes>* numbers) const {
    scatter_lanes(numbers, count, first, active, row);
  }
};

/// The inputs of ElementGather for elements side by side.
template <int K>
struct LaneInput {
  using Real = Pack<kLanes>;
  static constexpr int kForcePoints = ElementTables<K>::kMaximumForcePoints;
  Real interior[InteriorLayout{K, kForcePoints}.unknowns()];
  Real reference[ReferenceLayout{K, kForcePoints}.size()];
  SectionNumbers<Real> section;
  ElementInput<Real> in;

  inline __attribute__((always_inline)) LaneInput(const ElementGather<K, false>& gather, const LaneRows& lanes) {
    load(
        lanes, gather.layout.unknowns(), [&](int e) { return gather.interior_of(e); }, interior);
    load(
        lanes, gather.reference_layout.size(), [&](int e) { return &gather.reference(e, 0); }, reference);
    Real x[4];
    for (int end = 0; end < 2; ++end) {
      const auto vertex = [&](int e) { return gather.vertices(e, end); };
      load(
          lanes, 3, [&](int e) { return &gather.vertex_displacement(vertex(e), 0); }, x);
      in.displacement[end] = load_vector(x);
      load(
          lanes, 4, [&](int e) { return &gather.vertex_rotation(vertex(e), 0); }, x);
      in.vertex_rotation[end] = load_quaternion(x);
    }
    load(
        lanes, 4, [&](int e) { return &gather.element_triad(gather.first_element + e, 0); }, x);
    in.triad = load_quaternion(x);
    in.interior = interior;
    in.reference = reference;
    if (gather.section.extent(0) == 0) return;  // recovery has what it needs of them
    const auto constants = [&](int e) -> const SectionConstants& { return gather.section(gather.member(e)); };
    load(
        lanes, 3, [&](int e) { return constants(e).force_compliance; }, section.force_compliance);
    load(
        lanes, 3, [&](int e) { return constants(e).tangent_force_stiffness; }, section.tangent_force_stiffness);
    load(
        lanes, 3, [&](int e) { return constants(e).moment_stiffness; }, section.moment_stiffness);
    load(
        lanes, 3, [&](int e) { return constants(e).moment_compliance; }, section.moment_compliance);
  }
  template <class At>
  static inline __attribute__((always_inline)) void load(const LaneRows& lanes, int count, const At& at,
                                                         Real* numbers) {
    const double* rows[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) rows[lane] = at(lanes.row[lane]);
    gather_lanes(rows, count, numbers);
  }
};

template <int K, bool General>
struct ResidualLoop {
  ElementGather<K, General> gather;
  KernelView<double* [12]> residual;
  KernelView<double*> interior_residual, largest_end_angle;
  ResidualScales scales;
  bool scales_interior;
  size_t increment_offset;

  KOKKOS_INLINE_FUNCTION void operator()(int e) const {
    const ElementInput<> in = gather.input(e);
    const ElementKinematics<K> kinematics(in, gather.layout);
    ElementGradient<K> gradient;
    element_gradient(in, kinematics, gather.tables, gather.layout, gather.reference_layout, gather.section_of(e),
                     gradient);
    if (gather.has_fields()) add_field_gradient(gather.fields(e), kinematics, gather.tables, gradient);
    store_residual(gradient, kinematics, gather.layout, interior_row(e), &residual(gather.first_element + e, 0));
    if (scales_interior) scale_interior_rows(gather.layout, scales, kinematics.length, false, interior_row(e));
    largest_end_angle(gather.first_element + e) = gradient.largest_end_angle;
  }
  KOKKOS_INLINE_FUNCTION double* interior_row(int e) const {
    return interior_residual.data() + increment_offset + static_cast<size_t>(e) * gather.layout.increments();
  }
};

/// ResidualLoop for elements side by side; index: pack of the block.
template <int K>
struct ResidualLaneLoop {
  using Real = Pack<kLanes>;
  ResidualLoop<K, false> loop;
  int count;

  void operator()(int pack) const {
    const ElementGather<K, false>& gather = loop.gather;
    const LaneRows lanes(pack, count);
    const LaneInput<K> data(gather, lanes);
    const ElementKinematics<K, Real> kinematics(data.in, gather.layout);
    ElementGradient<K, Real> gradient;
    element_gradient(data.in, kinematics, gather.tables, gather.layout, gather.reference_layout, data.section,
                     gradient);
    Real interior_row[InteriorLayout{K, LaneInput<K>::kForcePoints}.increments()], vertex_row[12];
    store_residual(gradient, kinematics, gather.layout, interior_row, vertex_row);
    if (loop.scales_interior) scale_interior_rows(gather.layout, loop.scales, kinematics.length, false, interior_row);
    const auto row_of = [&](int e) { return loop.interior_row(e); };
    ElementRows<Real>(lanes, row_of).store(0, gather.layout.increments(), interior_row);
    const auto vertex_row_of = [&](int e) { return &loop.residual(gather.first_element + e, 0); };
    ElementRows<Real>(lanes, vertex_row_of).store(0, 12, vertex_row);
    for (int lane = 0; lane < lanes.active; ++lane)
      loop.largest_end_angle(gather.first_element + lanes.row[lane]) = gradient.largest_end_angle[lane];
  }
};

/// Interior right-hand side given from outside, in place of the gradient of the state (rows as store_residual writes
/// them).
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_given_gradient(const Real* rhs, const ElementKinematics<K, Real>& kinematics,
                                                    const InteriorLayout& layout, ElementGradient<K, Real>& g) {
  for (int q = 0; q < layout.force_points; ++q) g.strain_error[q] = load_vector(rhs + layout.force(q));
  for (int j = 0; j <= K; ++j) g.moment_row[j] = load_vector(rhs + layout.moment(j));
  for (int j = 1; j < K; ++j) {
    g.psi[j] = load_vector(rhs + layout.relative_rotation(j));
    g.slope[j] = transpose_times(kinematics.triad, load_vector(rhs + layout.bubble(j)));
  }
  g.spin = load_vector(rhs + layout.spin());
}

/// Builds the reduced system of one element, or of elements side by side, and keeps what the recovery of N and M needs.
template <int K, bool General, class Real = double>
struct CondensedElement {
  using Blocks = ReducedBlocks<K>;
  using Stiffness = std::conditional_t<General, Mat, Vec3<Real>>;
  ReducedSystem<K, Real> system;
  std::conditional_t<General, GeneralMomentRows<K>, MomentRows<K, Real>> moment_rows;
  ForceRows<Real, Stiffness> force_rows_[General ? ElementTables<K>::kMaximumForcePoints : 1];  ///< general only
  ElementGradient<K, Real> gradient;
  InteriorResponse<K, Real> response;
  VertexSystem<Real> condensed;

  /// `gradient` holds on entry what does not follow from the state: the given right-hand side, or the line fields.
  template <class Section>
  KOKKOS_FORCEINLINE_FUNCTION void build(const ElementGather<K, General>& gather, const ElementInput<Real>& in,
                                         const ElementKinematics<K, Real>& kinematics, const Section& section,
                                         bool own_gradient) {
    const ElementTables<K>& tables = gather.tables;
    const InteriorLayout& layout = gather.layout;
    system.clear();
    moment_rows.clear();
    for (int q = 0; q < tables.force_points; ++q) {
      const ForcePoint<K, Real> point(q, in, kinematics, tables, layout, gather.reference_layout, section);
      add_force_point(q, point, tables.force_legendre[q], tangent_force_stiffness(q, tables, section), own_gradient);
      if constexpr (General)
        moment_rows.couple(point, gradient.strain_error[q], force_rows_[q], section.force_moment(q),
                           tables.force_legendre[q]);
    }
    for (int q = 0; q <= K; ++q) {
      const MomentPoint<K, Real> point(q, in, kinematics, tables, layout, gather.reference_layout);
      const double *P = tables.moment_legendre[q], *slope = tables.moment_slope[q];
      if (own_gradient) add_moment_gradient(point, P, slope, kinematics.length, gradient);
      add_moment_tangent(point, P, slope, kinematics.length, moment_rows, system);
    }
    if (own_gradient) add_moment_compliance(in, kinematics, tables, layout, section, gradient);
    for (int end = 0; end < 2; ++end) {
      const EndRotation<K, Real> joint(end, in, kinematics, layout, gather.reference_layout);
      if (own_gradient) add_end_gradient(end, joint, gradient);
      add_end_tangent(end, joint, moment_rows, system);
    }
    if constexpr (General) moment_rows.add_compliance(section, tables, kinematics.length);
    condense_moments(moment_rows, gradient.moment_row, section, kinematics.length, system);
    add_gradient();
  }

  /// General: rows of all increments, response of N (pointwise), M (by mode), psi, beta (spatial) and w. Plain:
  /// ResponseLayout.
  template <class Section>
  KOKKOS_FORCEINLINE_FUNCTION void store_response(const ElementGather<K, General>& gather,
                                                  const ElementKinematics<K, Real>& kinematics, const Section& section,
                                                  const ElementRows<Real>& rows) const {
    if constexpr (General) {
      store_moment_response(gather.layout, rows);
      for (int q = 0; q < gather.layout.force_points; ++q)
        store_force_response(q, section, gather.tables.force_legendre[q], gather.layout, rows);
      store_reduced_response(gather.layout, kinematics, rows);
    } else {
      const ResponseLayout layout{K, gather.layout.force_points};
      for (int b = 0; b < Blocks::kInterior; ++b) store_rows(response.by[b], response.constant[b], 3 * b, rows);
      Real numbers[3 * (ElementTables<K>::kMaximumForcePoints + K + 3)];
      const int first = layout.strain_error(0);
      for (int q = 0; q < layout.force_points; ++q)
        store_vector(gradient.strain_error[q], numbers + layout.strain_error(q) - first);
      for (int m = 0; m <= K; ++m) store_vector(gradient.moment_row[m], numbers + layout.moment_row(m) - first);
      store_vector(load_vector(section.tangent_force_stiffness), numbers + layout.force_stiffness() - first);
      store_vector(load_vector(section.moment_stiffness), numbers + layout.moment_stiffness() - first);
      rows.store(first, layout.size() - first, numbers);
    }
  }

 private:
  /// N eliminated: the corrected force N + C error works in place of N, or C error alone for a given right-hand side.
  KOKKOS_FORCEINLINE_FUNCTION void add_force_point(int q, const ForcePoint<K, Real>& point, const double* P,
                                                   const Stiffness& stiffness, bool own_gradient) {
    if (own_gradient) gradient.strain_error[q] += point.strain_error;
    Vec3<Real> force = stress(stiffness, gradient.strain_error[q]);
    if (own_gradient) force += point.force;
    add_force_gradient(point, force, P, gradient);
    if constexpr (General) force_rows_[q] = force_rows(point, stiffness);
    add_force_tangent(point, stiffness, P, system);
  }
  KOKKOS_FORCEINLINE_FUNCTION void add_gradient() {
    system.rhs[Blocks::spin()] += gradient.spin;
    for (int j = 0; j < K; ++j) system.rhs[Blocks::slope(j)] += gradient.slope[j];
    for (int j = 1; j < K; ++j) system.rhs[Blocks::psi(j)] += gradient.psi[j];
    for (int end = 0; end < 2; ++end) system.rhs[Blocks::vertex(end)] += gradient.vertex_spin[end];
  }
  /// Three rows of the response from their blocks by slope_0, spin a, spin b, and the constant.
  KOKKOS_FORCEINLINE_FUNCTION static void store_rows(const Mat3<Real>* by, const Vec3<Real>& constant, int first_row,
                                                     const ElementRows<Real>& rows) {
    Real numbers[3 * kResponseColumns];
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 3; ++c)
        for (int j = 0; j < 3; ++j) numbers[kResponseColumns * i + 3 * c + j] = by[c](i, j);
      numbers[kResponseColumns * i + 9] = constant[i];
    }
    rows.store(kResponseColumns * first_row, 3 * kResponseColumns, numbers);
  }
  KOKKOS_INLINE_FUNCTION void store_reduced_response(const InteriorLayout& layout,
                                                     const ElementKinematics<K>& kinematics,
                                                     const ElementRows<double>& rows) const {
    for (int j = 1; j < K; ++j) {
      store_rows(response.by[Blocks::psi(j)], response.constant[Blocks::psi(j)], layout.relative_rotation(j), rows);
      Mat by[3];
      for (int c = 0; c < 3; ++c) by[c] = kinematics.triad * response.by[Blocks::slope(j)][c];
      store_rows(by, kinematics.triad * response.constant[Blocks::slope(j)], layout.bubble(j), rows);
    }
    store_rows(response.by[Blocks::spin()], response.constant[Blocks::spin()], layout.spin(), rows);
  }
  /// dN = C (gamma error + d gamma - S_NM dM); the response of all of M is in `rows` already.
  KOKKOS_INLINE_FUNCTION void store_force_response(int q, const GeneralSection& section, const double* P,
                                                   const InteriorLayout& layout,
                                                   const ElementRows<double>& rows) const {
    const ForceRows<double, Mat>& force = force_rows_[q];
    const double* moments = rows.row + kResponseColumns * layout.moment(0);
    double* out = rows.row + kResponseColumns * layout.force(q);
    for (int c = 0; c < kResponseColumns; ++c) {
      Vec slope{{0.0, 0.0, 0.0}}, psi = slope, moment = slope;
      if (c < 3) slope[c] = 1.0;
      for (int i = 0; i < 3; ++i) {
        for (int j = 1; j < K; ++j) {
          slope[i] += P[j] * response(3 * Blocks::slope(j) + i, c);
          psi[i] += P[j] * response(3 * Blocks::psi(j) + i, c);
        }
        for (int j = 0; j < K; ++j) moment[i] += P[j] * moments[kResponseColumns * (3 * j + i) + c];
      }
      const Vec spin{{response(0, c), response(1, c), response(2, c)}};
      Vec strain = strain_change<K>(force.exp, force.tangent, force.p, force.pulled_back, slope, spin, psi) -
                   section.force_moment(q) * moment;
      if (c == 9) strain += gradient.strain_error[q];
      const Vec change = force.stiffness * strain;
      for (int i = 0; i < 3; ++i) out[kResponseColumns * i + c] = change[i];
    }
  }
  KOKKOS_INLINE_FUNCTION void store_moment_response(const InteriorLayout& layout,
                                                    const ElementRows<double>& rows) const {
    for (int r = 0; r < 3 * (K + 1); ++r)
      moment_rows.response_row(r, response, rows.row + kResponseColumns * (layout.moment(0) + r));
  }
};

template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void store_condensed_residual(const VertexSystem<Real>& condensed,
                                                          const ElementGradient<K, Real>& gradient,
                                                          const ElementKinematics<K, Real>& kinematics, Real* row) {
  const Vec3<Real> force = Real(1.0 / kinematics.length) * (kinematics.triad * condensed.gradient[0]);
  store_vector(gradient.vertex_force[0] - force, row);
  store_vector(kinematics.triad * condensed.gradient[1], row + 3);
  store_vector(gradient.vertex_force[1] + force, row + 6);
  store_vector(kinematics.triad * condensed.gradient[2], row + 9);
}

template <int K, bool General>
struct TangentLoop {
  ElementGather<K, General> gather;
  KernelView<double* [12]> condensed_residual;
  KernelView<double**> condensed_tangent;
  KernelView<double*> response;
  KernelView<const double*> given_rhs;  ///< empty: the residual of the state
  KernelView<int*> interior_negative;   ///< empty: not counted
  size_t increment_offset, response_offset;
  int response_size;

  KOKKOS_INLINE_FUNCTION void operator()(int e) const {
    const ElementInput<> in = gather.input(e);
    const ElementKinematics<K> kinematics(in, gather.layout);
    const auto& section = gather.section_of(e);
    CondensedElement<K, General> element;
    clear(element.gradient);
    if (own_gradient()) {
      if (gather.has_fields()) add_field_gradient(gather.fields(e), kinematics, gather.tables, element.gradient);
    } else {
      add_given_gradient(rhs_row(e), kinematics, gather.layout, element.gradient);
    }
    element.build(gather, in, kinematics, section, own_gradient());
    FullSystem<K> system(element.system);
    MeanRows<K> mean_rows;
    if (gather.has_fields()) add_field_tangent(gather.fields(e), kinematics, gather.tables, system, mean_rows);
    solve_with_row_pivoting(system, element.response, element.condensed);
    if (counts()) store_signs(e, interior_signs(system, !gather.has_fields() || !gather.fields(e).have_no_potential()));
    const auto row_of = [&](int i) { return response_row(i); };
    element.store_response(gather, kinematics, section, ElementRows<double>(e, row_of));
    const int index = gather.first_element + e;
    if (keeps_symmetric_tangents())
      symmetric_tangent(element.condensed.matrix, kinematics.triad, kinematics.length, &condensed_tangent(index, 0));
    else
      full_tangent(element.condensed.matrix, kinematics.triad, kinematics.length, &condensed_tangent(index, 0));
    store_condensed_residual(element.condensed, element.gradient, kinematics, &condensed_residual(index, 0));
    if (mean_rows.used) {
      mean_rows.condense(element.response);
      mean_rows.expand(kinematics, &condensed_tangent(index, 0), &condensed_residual(index, 0));
    }
  }
  KOKKOS_INLINE_FUNCTION bool counts() const { return interior_negative.extent(0) > 0; }
  KOKKOS_INLINE_FUNCTION void store_signs(int e, const InteriorSigns& signs) const {
    interior_negative(gather.first_element + e) = signs.uncertain ? kUncertainCount : signs.negative;
  }
  KOKKOS_INLINE_FUNCTION bool keeps_symmetric_tangents() const {
    return condensed_tangent.extent(1) == kSymmetricTangent;
  }
  KOKKOS_INLINE_FUNCTION bool own_gradient() const { return given_rhs.extent(0) == 0; }
  KOKKOS_INLINE_FUNCTION const double* rhs_row(int e) const {
    return given_rhs.data() + increment_offset + static_cast<size_t>(e) * gather.layout.increments();
  }
  KOKKOS_INLINE_FUNCTION double* response_row(int e) const {
    return response.data() + response_offset + static_cast<size_t>(e) * response_size;
  }
};

/// TangentLoop for elements side by side; index: pack of the block.
template <int K>
struct TangentLaneLoop {
  using Real = Pack<kLanes>;
  TangentLoop<K, false> loop;
  int count;

  void operator()(int pack) const {
    const ElementGather<K, false>& gather = loop.gather;
    const LaneRows lanes(pack, count);
    const LaneInput<K> data(gather, lanes);
    const ElementKinematics<K, Real> kinematics(data.in, gather.layout);
    CondensedElement<K, false, Real> element;
    clear(element.gradient);
    if (!loop.own_gradient()) {
      Real rhs[InteriorLayout{K, LaneInput<K>::kForcePoints}.increments()];
      const auto rhs_of = [&](int e) { return loop.rhs_row(e); };
      LaneInput<K>::load(lanes, gather.layout.increments(), rhs_of, rhs);
      add_given_gradient(rhs, kinematics, gather.layout, element.gradient);
    }
    element.build(gather, data.in, kinematics, data.section, loop.own_gradient());
    InteriorSigns signs[kLanes];
    solve_in_lanes(element.system, element.response, element.condensed, loop.counts() ? signs : nullptr);
    for (int lane = 0; loop.counts() && lane < lanes.active; ++lane) loop.store_signs(lanes.row[lane], signs[lane]);
    const auto response_of = [&](int e) { return loop.response_row(e); };
    element.store_response(gather, kinematics, data.section, ElementRows<Real>(lanes, response_of));
    store_condensed(element, kinematics, lanes);
  }

 private:
  inline __attribute__((always_inline)) void store_condensed(const CondensedElement<K, false, Real>& element,
                                                             const ElementKinematics<K, Real>& kinematics,
                                                             const LaneRows& lanes) const {
    Real tangent[kSymmetricTangent], residual[12];
    symmetric_tangent(element.condensed.matrix, kinematics.triad, kinematics.length, tangent);
    const auto tangent_of = [&](int e) { return &loop.condensed_tangent(loop.gather.first_element + e, 0); };
    if (loop.keeps_symmetric_tangents())
      ElementRows<Real>(lanes, tangent_of).store(0, kSymmetricTangent, tangent);
    else
      store_full(tangent, lanes, tangent_of);
    store_condensed_residual(element.condensed, element.gradient, kinematics, residual);
    const auto residual_of = [&](int e) { return &loop.condensed_residual(loop.gather.first_element + e, 0); };
    ElementRows<Real>(lanes, residual_of).store(0, 12, residual);
  }
  /// For a structure of which another element has no potential.
  template <class TangentOf>
  static __attribute__((noinline)) void store_full(const Real* tangent, const LaneRows& lanes,
                                                   const TangentOf& tangent_of) {
    for (int lane = 0; lane < lanes.active; ++lane) {
      double numbers[kSymmetricTangent];
      for (int i = 0; i < kSymmetricTangent; ++i) numbers[i] = tangent[i][lane];
      expand_symmetric_tangent<kSpatialDofs>(numbers, tangent_of(lanes.row[lane]));
    }
  }
};

/// Elements run side by side where the processor has lanes, and where neither compliances along the element nor line
/// fields call for branches of their own.
template <int K, bool General>
bool runs_in_lanes(const ElementGather<K, General>& gather) {
  return !General && kLanes > 1 && !gather.has_fields();
}

template <int K, bool General>
void residual_loop(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                   const ElementEquations& equations) {
  const ResidualLoop<K, General> loop{ElementGather<K, General>(block, structure, state),
                                      equations.residual,
                                      equations.interior_residual,
                                      equations.largest_end_angle,
                                      equations.interior_scales,
                                      equations.scales_interior,
                                      block.increment_offset};
  using Range = Kokkos::RangePolicy<ExecutionSpace>;
  if constexpr (!General)
    if (runs_in_lanes(loop.gather)) {
      const ResidualLaneLoop<K> lanes{loop, block.count};
      return Kokkos::parallel_for("mixbeam::elements::residual", Range(0, LaneRows::packs(block.count)), lanes);
    }
  Kokkos::parallel_for("mixbeam::elements::residual", Range(0, block.count), loop);
}

template <int K, bool General>
void tangent_loop(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                  const KernelView<const double*>& given_rhs, const ElementEquations& equations) {
  const TangentLoop<K, General> loop{ElementGather<K, General>(block, structure, state),
                                     equations.condensed_residual,
                                     equations.condensed_tangent,
                                     equations.response,
                                     given_rhs,
                                     equations.interior_negative,
                                     block.increment_offset,
                                     block.response_offset,
                                     block.response_size()};
  using Range = Kokkos::RangePolicy<ExecutionSpace>;
  if constexpr (!General)
    if (runs_in_lanes(loop.gather)) {
      const TangentLaneLoop<K> lanes{loop, block.count};
      return Kokkos::parallel_for("mixbeam::elements::tangent", Range(0, LaneRows::packs(block.count)), lanes);
    }
  Kokkos::parallel_for("mixbeam::elements::tangent", Range(0, block.count), loop);
}

}  // namespace mixbeam
