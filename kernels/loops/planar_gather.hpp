/// Gathers and scatters for loops over planar elements: between the spatial layout of states and increments and the
/// in-plane components, several elements side by side.
#pragma once

#include "kernels/loops/planar_block.hpp"
#include "kernels/planar/recovery.hpp"

namespace mixbeam {

/// Offsets into the constants of a pack.
template <int K>
struct PlanarConstants {
  static constexpr int kLength = 0;
  static constexpr int kEndRotor = 1;                  ///< (end, w z) of the reference triads
  static constexpr int kTangent = 5;                   ///< (force point, p q): r0'
  static constexpr int kCurvature = kTangent + 2 * K;  ///< (j): int P_j kappa0 ds about n
  static constexpr int kSize = kCurvature + K + 1;
};

template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> project(const PlaneAxes& axes, const Real* v) {
  return {axes.p[0] * v[0] + axes.p[1] * v[1] + axes.p[2] * v[2],
          axes.q[0] * v[0] + axes.q[1] * v[1] + axes.q[2] * v[2]};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void expand(const PlaneAxes& axes, const Vec2<Real>& a, Real* v) {
  for (int i = 0; i < 3; ++i) v[i] = a.x * axes.p[i] + a.y * axes.q[i];
}

/// Converts between spatial and in-plane components; material vectors by the orientation of each element.
template <int K, int W>
struct PackInPlane {
  using Real = Pack<W>;
  static constexpr InteriorLayout kLayout{K, K};
  PlaneAxes axes;
  typename Real::Mask third_is_normal;
  Real about, across;
  Real w[4], z[4];

  KOKKOS_INLINE_FUNCTION PackInPlane(const PlanarBlock& block, const RowsInLanes<W>& lanes) : axes(block.axes) {
    const PlanarOrientation* of[RowsInLanes<W>::kCount];
    for (int lane = 0; lane < lanes.kCount; ++lane) {
      of[lane] = &block.orientation[block.orientation_of(lanes.row[lane])];
      third_is_normal[lane] = of[lane]->third_is_normal ? -1 : 0;
    }
    about = Real::gathered([&](int lane) { return of[lane]->about; });
    across = Real::gathered([&](int lane) { return of[lane]->across; });
    for (int i = 0; i < 4; ++i) {
      w[i] = Real::gathered([&](int lane) { return of[lane]->w[i]; });
      z[i] = Real::gathered([&](int lane) { return of[lane]->z[i]; });
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> in_plane(const Real* v) const {
    return {v[0], across * select(third_is_normal, v[1], v[2])};
  }
  KOKKOS_FORCEINLINE_FUNCTION Real normal(const Real* v) const { return about * select(third_is_normal, v[2], v[1]); }
  KOKKOS_FORCEINLINE_FUNCTION void put_in_plane(const Vec2<Real>& a, Real* v) const {
    v[0] = a.x;
    v[1] = select(third_is_normal, across * a.y, Real(0.0));
    v[2] = select(third_is_normal, Real(0.0), across * a.y);
  }
  KOKKOS_FORCEINLINE_FUNCTION void put_normal(const Real& a, Real* v) const {
    v[0] = 0.0;
    v[1] = select(third_is_normal, Real(0.0), about * a);
    v[2] = select(third_is_normal, about * a, Real(0.0));
  }
  KOKKOS_FORCEINLINE_FUNCTION PlaneRotor<Real> rotor(const Real* triad) const {
    return {triad[0] * w[0] + triad[1] * w[1] + triad[2] * w[2] + triad[3] * w[3],
            triad[0] * z[0] + triad[1] * z[1] + triad[2] * z[2] + triad[3] * z[3]};
  }

  /// Projects interior data x (InteriorLayout; without the spin) of a state or right-hand side. Slopes in the element
  /// frame.
  KOKKOS_FORCEINLINE_FUNCTION void interior_in_plane(const Real* x, const PlaneTurn<Real>& triad, Vec2<Real>* force,
                                                     Real* moment, Real* angle, Vec2<Real>* slope) const {
    for (int q = 0; q < K; ++q) force[q] = in_plane(x + kLayout.force(q));
    for (int j = 0; j <= K; ++j) moment[j] = normal(x + kLayout.moment(j));
    for (int j = 1; j < K; ++j) {
      angle[j] = normal(x + kLayout.relative_rotation(j));
      slope[j] = triad.back(project(axes, x + kLayout.bubble(j)));
    }
  }
  /// Expands increments or residuals with the spin, from functions of the index; bubble(j): components along p, q.
  template <class Force, class Moment, class Angle, class Bubble>
  KOKKOS_FORCEINLINE_FUNCTION void increments_in_space(const Force& force, const Moment& moment, const Angle& angle,
                                                       const Bubble& bubble, Real* x) const {
    for (int q = 0; q < K; ++q) put_in_plane(force(q), x + kLayout.force(q));
    for (int j = 0; j <= K; ++j) put_normal(moment(j), x + kLayout.moment(j));
    for (int j = 1; j < K; ++j) {
      put_normal(angle(j), x + kLayout.relative_rotation(j));
      expand(axes, bubble(j), x + kLayout.bubble(j));
    }
    put_normal(angle(0), x + kLayout.spin());
  }
};

/// Views of one block, gathered pack by pack.
template <int K, int W>
struct PlanarGather {
  using Real = Pack<W>;
  using Rows = RowsInLanes<W>;
  using Constants = PlanarConstants<K>;
  using InPlane = PackInPlane<K, W>;
  PlanarBlock planar;
  ElementBlock block;
  StructureViews structure;
  StateViews from;
  PlanarTables<K> tables;

  PlanarGather(const ElementBlock& elements, const PlanarBlock& elements_in_plane, const StructureViews& sections,
               const StateViews& state)
      : planar(elements_in_plane), block(elements), structure(sections), from(state) {}

  /// First number of element e in arrays of increments and of interior residuals.
  KOKKOS_INLINE_FUNCTION size_t increment_of(int e) const {
    return block.increment_offset + static_cast<size_t>(e) * InPlane::kLayout.increments();
  }

  KOKKOS_FORCEINLINE_FUNCTION void load(int number, const Rows& lanes, const InPlane& plane,
                                        PlanarState<K, Real>& s) const {
    const Real* constant = reinterpret_cast<const Real*>(&planar.constants(number, 0));
    s.length = constant[Constants::kLength];
    for (int q = 0; q < K; ++q)
      s.reference_tangent[q] = {constant[Constants::kTangent + 2 * q], constant[Constants::kTangent + 2 * q + 1]};
    for (int j = 0; j <= K; ++j) s.curvature[j] = constant[Constants::kCurvature + j];
    load_ends(lanes, plane, constant, s);
    constexpr int unknowns = InPlane::kLayout.unknowns();
    Real x[unknowns];
    const auto interior_of = [&](int e) {
      return from.interior.data() + block.interior_offset + static_cast<size_t>(e) * unknowns;
    };
    lanes.load(interior_of, unknowns, x);
    plane.interior_in_plane(x, s.triad, s.force, s.moment, s.psi, s.slope);
    load_section(lanes, plane, s.section);
  }

  KOKKOS_INLINE_FUNCTION bool has_fields() const {
    return block.field_row.extent(0) > 0 && structure.field_value.extent(0) > 0;
  }
  /// Adds line fields to the gradient, theory (19). Returns the part of the load that is the same on both ends.
  KOKKOS_FUNCTION __attribute__((noinline)) Vec2<Real> add_fields(const Rows& lanes, const InPlane& plane,
                                                                  const PlanarState<K, Real>& state,
                                                                  PlanarGradient<K, Real>& g) const {
    Real values[3 * (K + 1)], about[K + 1];
    Vec2<Real> force[K + 1], on_each_end{0.0, 0.0};
    if (load_field(lanes, LineField::dead_force, values)) {
      for (int q = 0; q <= K; ++q) force[q] = project(plane.axes, values + 3 * q);
      on_each_end = add_planar_force(force, state, tables, g);
    }
    if (load_field(lanes, LineField::eigenstrain, values))
      for (int q = 0; q < K; ++q) g.strain_error[q] = g.strain_error[q] - plane.in_plane(values + 3 * q);
    if (load_field(lanes, LineField::eigencurvature, values)) {
      for (int q = 0; q <= K; ++q) about[q] = plane.normal(values + 3 * q);
      subtract_planar_curvature(about, state.length, tables, g);
    }
    return on_each_end;
  }

 private:
  /// Loads zeros for elements without the field; returns false if none has it.
  KOKKOS_INLINE_FUNCTION bool load_field(const Rows& lanes, LineField kind, Real* values) const {
    const int column = static_cast<int>(kind);
    if ((block.kinds_of_fields >> column & 1U) == 0) return false;
    bool some_have_it = false;
    for (const int e : lanes.row) some_have_it = some_have_it || block.field_row(e, column) >= 0;
    if (!some_have_it) return false;
    const auto values_of = [&](int e) {
      const int row = block.field_row(e, column);
      return row < 0 ? kNoField : &structure.field_value(row, 0);
    };
    lanes.load(values_of, 3 * line_field_points(kind, K, K), values);
    return true;
  }

  KOKKOS_FORCEINLINE_FUNCTION void load_ends(const Rows& lanes, const InPlane& plane, const Real* constant,
                                             PlanarState<K, Real>& s) const {
    Real triad[4];
    lanes.load([&](int e) { return &from.element_triad(block.first_element + e, 0); }, 4, triad);
    Vec2<Real> displacement[2];
    PlaneRotor<Real> vertex[2], reference[2];
    for (int end = 0; end < 2; ++end) {
      Real u[3], q[4];
      lanes.load([&](int e) { return &from.vertex_displacement(block.vertices(e, end), 0); }, 3, u);
      displacement[end] = project(plane.axes, u);
      lanes.load([&](int e) { return &from.vertex_rotation(block.vertices(e, end), 0); }, 4, q);
      vertex[end] = {q[0], plane.axes.n[0] * q[1] + plane.axes.n[1] * q[2] + plane.axes.n[2] * q[3]};
      const Real* rotor = constant + Constants::kEndRotor + 2 * end;
      reference[end] = {rotor[0], rotor[1]};
    }
    set_planar_ends(plane.rotor(triad), vertex, reference, displacement, s);
  }
  KOKKOS_FORCEINLINE_FUNCTION void load_section(const Rows& lanes, const InPlane& plane, PlanarSection<Real>& s) const {
    SectionNumbers<Real> section;
    lanes.load([&](int e) { return structure.sections(block.section(e)).numbers(); }, section.kCount,
               section.numbers());
    const auto across = [&](const Real* numbers) { return select(plane.third_is_normal, numbers[1], numbers[2]); };
    const auto normal = [&](const Real* numbers) { return select(plane.third_is_normal, numbers[2], numbers[1]); };
    s.force_compliance = {section.force_compliance[0], across(section.force_compliance)};
    s.tangent_force_compliance = {1.0 / section.tangent_force_stiffness[0],
                                  1.0 / across(section.tangent_force_stiffness)};
    s.moment_compliance = normal(section.moment_compliance);
    s.moment_stiffness = normal(section.moment_stiffness);
  }
};

/// Writes the constants of all packs; the last element is repeated to fill its pack.
template <int K>
void fill_planar_constants(const ElementBlock& block, PlanarBlock& planar) {
  using Constants = PlanarConstants<K>;
  const ElementTables<K> tables(ForceIntegration::both_reduced);
  const PlaneAxes& axes = planar.axes;
  std::vector<double> row(static_cast<size_t>(Constants::kSize * planar.lanes));
  RowsWithoutRepeats rows(row.size());
  for (int slot = 0; slot < planar.packs() * planar.lanes; ++slot) {
    const int e = slot < block.count ? slot : block.count - 1;
    const PlanarOrientation& orientation = planar.orientation[planar.orientation_of(e)];
    const int lane = slot % planar.lanes;
    const auto put = [&](int entry, double value) { row[static_cast<size_t>(entry * planar.lanes + lane)] = value; };
    const double length = block.reference(e, block.reference_layout.length());
    put(Constants::kLength, length);
    for (int end = 0; end < 2; ++end) {
      const double* triad = &block.reference(e, block.reference_layout.end_triad(end));
      double w = 0.0, z = 0.0;
      for (int i = 0; i < 4; ++i) {
        w += triad[i] * orientation.w[i];
        z += triad[i] * orientation.z[i];
      }
      put(Constants::kEndRotor + 2 * end, w);
      put(Constants::kEndRotor + 2 * end + 1, z);
    }
    for (int q = 0; q < K; ++q) {
      const Vec tangent = load_vector(&block.reference(e, block.reference_layout.tangent(q)));
      put(Constants::kTangent + 2 * q, dot(axes.p, tangent));
      put(Constants::kTangent + 2 * q + 1, dot(axes.q, tangent));
    }
    for (int j = 0; j <= K; ++j) {
      double sum = 0.0;
      for (int q = 0; q <= K; ++q)
        sum += 0.5 * length * tables.moment_weight[q] * tables.moment_legendre[q][j] *
               block.reference(e, block.reference_layout.curvature(q) + (orientation.third_is_normal ? 2 : 1));
      put(Constants::kCurvature + j, orientation.about * sum);
    }
    if (lane == planar.lanes - 1) rows.add(row);
  }
  planar.constants = rows.rows("mixbeam::planar::constants");
}

}  // namespace mixbeam
