/// The loops of planar_block.hpp for one order, instantiated in planar_block_k<order>.cpp (one translation unit each
/// keeps the build parallel).
#pragma once

#include "kernels/loops/planar_block.hpp"
#include "kernels/planar/element.hpp"

namespace mixbeam {

namespace planar_loops {

using Real = Pack<kLanes>;
using Range = Kokkos::RangePolicy<ExecutionSpace>;

/// Offsets into the constants of a pack.
template <int K>
struct PlanarConstants {
  static constexpr int kLength = 0;
  static constexpr int kEndRotor = 1;                  ///< (end, w z) of the reference triads
  static constexpr int kTangent = 5;                   ///< (force point, p q): r0'
  static constexpr int kCurvature = kTangent + 2 * K;  ///< (j): int P_j kappa0 ds about n
  static constexpr int kSize = kCurvature + K + 1;
};

/// Material vectors of three components, in lanes, and what they are in the plane.
struct PackOrientation {
  Real::Mask third_is_normal;
  Real about, across;
  Real w[4], z[4];

  KOKKOS_INLINE_FUNCTION PackOrientation(const PlanarOrientation* kinds, const int* kind) {
    for (int lane = 0; lane < kLanes; ++lane) third_is_normal[lane] = kinds[kind[lane]].third_is_normal ? -1 : 0;
    about = Real::gathered([&](int lane) { return kinds[kind[lane]].about; });
    across = Real::gathered([&](int lane) { return kinds[kind[lane]].across; });
    for (int i = 0; i < 4; ++i) {
      w[i] = Real::gathered([&](int lane) { return kinds[kind[lane]].w[i]; });
      z[i] = Real::gathered([&](int lane) { return kinds[kind[lane]].z[i]; });
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
};

KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> project(const PlaneAxes& axes, const Real* v) {
  return {axes.p[0] * v[0] + axes.p[1] * v[1] + axes.p[2] * v[2],
          axes.q[0] * v[0] + axes.q[1] * v[1] + axes.q[2] * v[2]};
}
KOKKOS_FORCEINLINE_FUNCTION void expand(const PlaneAxes& axes, const Vec2<Real>& a, Real* v) {
  for (int i = 0; i < 3; ++i) v[i] = a.x * axes.p[i] + a.y * axes.q[i];
}

/// Views of one block, gathered pack by pack.
template <int K>
struct PlanarGather {
  using Constants = PlanarConstants<K>;
  static constexpr InteriorLayout layout{K, K};
  KernelView<const double**> constants;
  KernelView<const int*> orientation_of;
  KernelView<const int* [2]> vertices;
  KernelView<const int*> member;
  KernelView<const double* [3]> vertex_displacement;
  KernelView<const double*[4]> vertex_rotation, element_triad;
  KernelView<const double*> interior;
  KernelView<const SectionConstants*> section;
  PlaneAxes axes;
  PlanarOrientation orientation[4];
  PlanarTables<K> tables;
  int count, first_element;
  size_t interior_offset, increment_offset;

  PlanarGather(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
               const StateViews& state)
      : constants(planar.constants),
        orientation_of(planar.orientation_of),
        vertices(block.vertices),
        member(block.member),
        vertex_displacement(state.vertex_displacement),
        vertex_rotation(state.vertex_rotation),
        element_triad(state.element_triad),
        interior(state.interior),
        section(structure.member_section),
        axes(planar.axes),
        count(block.count),
        first_element(block.first_element),
        interior_offset(block.interior_offset),
        increment_offset(block.increment_offset) {
    for (int i = 0; i < 4; ++i) orientation[i] = planar.orientation[i];
  }

  KOKKOS_FORCEINLINE_FUNCTION PackOrientation orientation_of_pack(const LaneRows& pack) const {
    int kind[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) kind[lane] = orientation_of(pack.row[lane]);
    return PackOrientation(orientation, kind);
  }

  KOKKOS_FORCEINLINE_FUNCTION void state(int number, const LaneRows& pack, const PackOrientation& material,
                                         PlanarState<K, Real>& s) const {
    const Real* constant = reinterpret_cast<const Real*>(&constants(number, 0));
    s.length = constant[Constants::kLength];
    for (int q = 0; q < K; ++q)
      s.reference_tangent[q] = {constant[Constants::kTangent + 2 * q], constant[Constants::kTangent + 2 * q + 1]};
    for (int j = 0; j <= K; ++j) s.curvature[j] = constant[Constants::kCurvature + j];
    load_ends(pack, material, constant, s);
    load_interior(pack, material, s);
    load_section(pack, material, s.section);
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION void load_ends(const LaneRows& pack, const PackOrientation& material,
                                             const Real* constant, PlanarState<K, Real>& s) const {
    const double* rows[kLanes];
    Real triad[4];
    for (int lane = 0; lane < kLanes; ++lane) rows[lane] = &element_triad(first_element + pack.row[lane], 0);
    gather_lanes(rows, 4, triad);
    Vec2<Real> displacement[2];
    PlaneRotor<Real> vertex[2], reference[2];
    for (int end = 0; end < 2; ++end) {
      Real u[3], q[4];
      for (int lane = 0; lane < kLanes; ++lane) rows[lane] = &vertex_displacement(vertices(pack.row[lane], end), 0);
      gather_lanes(rows, 3, u);
      displacement[end] = project(axes, u);
      for (int lane = 0; lane < kLanes; ++lane) rows[lane] = &vertex_rotation(vertices(pack.row[lane], end), 0);
      gather_lanes(rows, 4, q);
      vertex[end] = {q[0], axes.n[0] * q[1] + axes.n[1] * q[2] + axes.n[2] * q[3]};
      const Real* rotor = constant + Constants::kEndRotor + 2 * end;
      reference[end] = {rotor[0], rotor[1]};
    }
    set_planar_ends(material.rotor(triad), vertex, reference, displacement, s);
  }
  KOKKOS_FORCEINLINE_FUNCTION void load_interior(const LaneRows& pack, const PackOrientation& material,
                                                 PlanarState<K, Real>& s) const {
    constexpr int unknowns = 3 * (4 * K - 1);
    const double* rows[kLanes];
    Real x[unknowns];
    for (int lane = 0; lane < kLanes; ++lane)
      rows[lane] = interior.data() + interior_offset + static_cast<size_t>(pack.row[lane]) * unknowns;
    gather_lanes(rows, unknowns, x);
    for (int q = 0; q < K; ++q) s.force[q] = material.in_plane(x + layout.force(q));
    for (int j = 0; j <= K; ++j) s.moment[j] = material.normal(x + layout.moment(j));
    for (int j = 1; j < K; ++j) {
      s.psi[j] = material.normal(x + layout.relative_rotation(j));
      s.slope[j] = s.triad.back(project(axes, x + layout.bubble(j)));
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION void load_section(const LaneRows& pack, const PackOrientation& material,
                                                PlanarSection<Real>& s) const {
    const SectionConstants* constants_of[kLanes];
    int other[kLanes], normal[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      constants_of[lane] = &section(member(pack.row[lane]));
      normal[lane] = material.third_is_normal[lane] != 0 ? 2 : 1;
      other[lane] = 3 - normal[lane];
    }
    const auto gathered = [&](double(SectionConstants::*field)[3], const int* component) {
      return Real::gathered([&](int lane) { return (constants_of[lane]->*field)[component[lane]]; });
    };
    const int axial[kLanes] = {};
    s.force_compliance = {gathered(&SectionConstants::force_compliance, axial),
                          gathered(&SectionConstants::force_compliance, other)};
    s.tangent_force_compliance = {1.0 / gathered(&SectionConstants::tangent_force_stiffness, axial),
                                  1.0 / gathered(&SectionConstants::tangent_force_stiffness, other)};
    s.moment_compliance = gathered(&SectionConstants::moment_compliance, normal);
    s.moment_stiffness = gathered(&SectionConstants::moment_stiffness, normal);
  }
};

KOKKOS_INLINE_FUNCTION void scatter_vertex_rows(const Real* row, const LaneRows& pack,
                                                const KernelView<double* [4]>& out, int first_element) {
  double* rows[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) rows[lane] = &out(first_element + pack.row[lane], 0);
  scatter_lanes(row, 4, 0, pack.active, rows);
}

template <int K>
struct PlanarResidualLoop {
  PlanarGather<K> gather;
  KernelView<double* [4]> vertex_rows;
  KernelView<double*> interior_residual, largest_end_angle;
  ResidualScales scales;
  bool scales_interior;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    const LaneRows pack(number, gather.count);
    const PackOrientation material = gather.orientation_of_pack(pack);
    PlanarState<K, Real> state;
    gather.state(number, pack, material, state);
    PlanarGradient<K, Real> g;
    planar_gradient(state, gather.tables, g);
    const Vec2<Real> force = (1.0 / state.length) * (state.triad * g.slope[0]);
    const Real vertex[4] = {force.x, force.y, g.end_moment[0], g.end_moment[1]};
    scatter_vertex_rows(vertex, pack, vertex_rows, gather.first_element);
    store_interior(pack, material, state, g);
    for (int lane = 0; lane < pack.active; ++lane)
      largest_end_angle(gather.first_element + pack.row[lane]) = g.largest_end_angle[lane];
  }

  KOKKOS_FORCEINLINE_FUNCTION void store_interior(const LaneRows& pack, const PackOrientation& material,
                                                  const PlanarState<K, Real>& state,
                                                  const PlanarGradient<K, Real>& g) const {
    constexpr int increments = 12 * K;
    constexpr InteriorLayout layout = PlanarGather<K>::layout;
    Real x[increments];
    for (int q = 0; q < K; ++q) material.put_in_plane(g.strain_error[q], x + layout.force(q));
    for (int j = 0; j <= K; ++j) material.put_normal(g.moment_row[j], x + layout.moment(j));
    for (int j = 1; j < K; ++j) {
      material.put_normal(g.angle[j], x + layout.relative_rotation(j));
      expand(gather.axes, state.triad * g.slope[j], x + layout.bubble(j));
    }
    material.put_normal(g.angle[0], x + layout.spin());
    if (scales_interior) scale_interior_rows(layout, scales, state.length, false, x);
    double* rows[kLanes];
    for (int lane = 0; lane < kLanes; ++lane)
      rows[lane] =
          interior_residual.data() + gather.increment_offset + static_cast<size_t>(pack.row[lane]) * increments;
    scatter_lanes(x, increments, 0, pack.active, rows);
  }
};

/// Lanes whose pivots are too small, one by one with exchange of rows.
template <int K>
__attribute__((noinline)) void redo_planar_lanes(const Real& least, const Real& length,
                                                 const PlanarSystem<K, Real>& system,
                                                 PlanarSolution<K, Real>& solution) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (least[lane] >= 1.0) continue;
    PlanarSystem<K, double> one;
    for (int i = 0; i < triangle_size(K); ++i) one.matrix[i] = system.matrix[i][lane];
    for (int i = 0; i < K; ++i)
      for (int c = 0; c < kPlanarColumns; ++c) one.columns[i][c] = system.columns[i][c][lane];
    for (int i = 0; i < 3; ++i) one.compliance[i] = system.compliance[i][lane];
    one.shift = {system.shift.x[lane], system.shift.y[lane]};
    PlanarSolution<K, double> solved;
    solve_planar_with_pivoting(length[lane], one, solved);
    for (int c = 0; c < kPlanarColumns; ++c) {
      for (int i = 0; i < K; ++i) solution.angle[i][c].set(lane, solved.angle[i][c]);
      for (int r = 0; r < 2; ++r) solution.force[r][c].set(lane, solved.force[r][c]);
    }
  }
}

template <int K>
struct PlanarTangentLoop {
  PlanarGather<K> gather;
  KernelView<double**> response;
  PlanarTangents tangents;
  KernelView<double* [4]> vertex_rows;
  KernelView<const double*> given_rhs;  ///< empty: the residual of the state

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    const LaneRows pack(number, gather.count);
    const PackOrientation material = gather.orientation_of_pack(pack);
    PlanarState<K, Real> state;
    gather.state(number, pack, material, state);
    const bool own = given_rhs.extent(0) == 0;
    PlanarRightHandSide<K, Real> rhs;
    if (!own) load_right_hand_side(pack, material, state, rhs);
    PlanarSystem<K, Real> system;
    PlanarPoints<K, Real> points;
    Real moment_row[K + 1];
    planar_system(state, gather.tables, own ? nullptr : &rhs, moment_row, points, system);
    PlanarSolution<K, Real> solution;
    const Real least = solve_planar(state.length, system, solution);
    if (any<kLanes>(~(least >= Real(1.0)))) redo_planar_lanes<K>(least, state.length, system, solution);
    columns_to_plane(state, solution);
    auto* rows = reinterpret_cast<Real(*)[kPlanarColumns]>(&response(number, 0));
    planar_response(state, gather.tables, points, moment_row, solution, rows);
    store_condensed(pack, state, solution, own);
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION void store_condensed(const LaneRows& pack, const PlanarState<K, Real>& state,
                                                   const PlanarSolution<K, Real>& solution, bool own) const {
    Real tangent[kPlanarTangent], gradient[4], end_moment[2], unused[K];
    planar_moment_gradient<K>(state.moment, unused, end_moment);
    planar_condensed(state, solution, own ? end_moment : nullptr, tangent, gradient);
    double* rows[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) rows[lane] = &tangents(gather.first_element + pack.row[lane], 0);
    scatter_lanes(tangent, kPlanarTangent, 0, pack.active, rows);
    scatter_vertex_rows(gradient, pack, vertex_rows, gather.first_element);
  }
  KOKKOS_FORCEINLINE_FUNCTION void load_right_hand_side(const LaneRows& pack, const PackOrientation& material,
                                                        const PlanarState<K, Real>& state,
                                                        PlanarRightHandSide<K, Real>& rhs) const {
    constexpr int increments = 12 * K;
    constexpr InteriorLayout layout = PlanarGather<K>::layout;
    const double* rows[kLanes];
    Real x[increments];
    for (int lane = 0; lane < kLanes; ++lane)
      rows[lane] = given_rhs.data() + gather.increment_offset + static_cast<size_t>(pack.row[lane]) * increments;
    gather_lanes(rows, increments, x);
    for (int q = 0; q < K; ++q) rhs.strain_error[q] = material.in_plane(x + layout.force(q));
    for (int j = 0; j <= K; ++j) rhs.moment_row[j] = material.normal(x + layout.moment(j));
    rhs.angle[0] = material.normal(x + layout.spin());
    rhs.slope[0] = {0.0, 0.0};
    for (int j = 1; j < K; ++j) {
      rhs.angle[j] = material.normal(x + layout.relative_rotation(j));
      rhs.slope[j] = state.triad.back(project(gather.axes, x + layout.bubble(j)));
    }
  }
};

template <int K>
struct PlanarRecoverLoop {
  KernelView<const int*> orientation_of;
  KernelView<const int* [2]> vertices;
  KernelView<const double**> response;
  KernelView<const double* [6]> vertex_increment;
  KernelView<double*> increment;
  PlaneAxes axes;
  PlanarOrientation orientation[4];
  int count;
  size_t increment_offset;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    const LaneRows pack(number, count);
    int kind[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) kind[lane] = orientation_of(pack.row[lane]);
    const PackOrientation material(orientation, kind);
    Real by[kPlanarColumns - 1];
    load_vertices(pack, by);
    const auto* rows = reinterpret_cast<const Real(*)[kPlanarColumns]>(&response(number, 0));
    const auto value = [&](int row) {
      Real sum = rows[row][kPlanarColumns - 1];
      for (int c = 0; c + 1 < kPlanarColumns; ++c) sum += rows[row][c] * by[c];
      return sum;
    };
    using Rows = PlanarRows<K>;
    constexpr InteriorLayout layout = PlanarGather<K>::layout;
    constexpr int increments = 12 * K;
    Real x[increments];
    for (int q = 0; q < K; ++q)
      material.put_in_plane({value(Rows::force(q)), value(Rows::force(q) + 1)}, x + layout.force(q));
    for (int j = 0; j <= K; ++j) material.put_normal(value(Rows::moment(j)), x + layout.moment(j));
    for (int j = 1; j < K; ++j) {
      material.put_normal(value(Rows::angle(j)), x + layout.relative_rotation(j));
      expand(axes, {value(Rows::bubble(j)), value(Rows::bubble(j) + 1)}, x + layout.bubble(j));
    }
    material.put_normal(value(Rows::angle(0)), x + layout.spin());
    double* out[kLanes];
    for (int lane = 0; lane < kLanes; ++lane)
      out[lane] = increment.data() + increment_offset + static_cast<size_t>(pack.row[lane]) * increments;
    scatter_lanes(x, increments, 0, pack.active, out);
  }

  /// u_b - u_a and both spins in the plane.
  KOKKOS_FORCEINLINE_FUNCTION void load_vertices(const LaneRows& pack, Real* by) const {
    Vec2<Real> displacement[2];
    for (int end = 0; end < 2; ++end) {
      const double* rows[kLanes];
      Real d[6];
      for (int lane = 0; lane < kLanes; ++lane) rows[lane] = &vertex_increment(vertices(pack.row[lane], end), 0);
      gather_lanes(rows, 6, d);
      displacement[end] = project(axes, d);
      by[2 + end] = axes.n[0] * d[3] + axes.n[1] * d[4] + axes.n[2] * d[5];
    }
    by[0] = displacement[1].x - displacement[0].x;
    by[1] = displacement[1].y - displacement[0].y;
  }
};

template <int K>
void fill_constants(const ElementBlock& block, const PlanarBlock& planar) {
  using Constants = PlanarConstants<K>;
  const ElementTables<K> tables(ForceIntegration::both_reduced);
  const PlaneAxes& axes = planar.axes;
  for (int slot = 0; slot < planar.packs() * kLanes; ++slot) {
    const int e = slot < block.count ? slot : block.count - 1;
    const PlanarOrientation& orientation = planar.orientation[planar.orientation_of(e)];
    double* out = &planar.constants(slot / kLanes, slot % kLanes);
    const auto put = [&](int entry, double value) { out[entry * kLanes] = value; };
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
  }
}

}  // namespace planar_loops

template <int K>
void allocate_planar_block(const ElementBlock& block, PlanarBlock& planar) {
  static_assert(planar_loops::PlanarConstants<K>::kSize == planar_constants_size(K), "size of the constants");
  static_assert(PlanarRows<K>::kCount * kPlanarColumns == planar_response_size(K), "size of the response");
  const int packs = LaneRows::packs(block.count);
  planar.constants = KernelView<double**>("mixbeam::planar::constants", packs, planar_constants_size(K) * kLanes);
  planar.response = KernelView<double**>(Kokkos::view_alloc("mixbeam::planar::response", Kokkos::WithoutInitializing),
                                         packs, planar_response_size(K) * kLanes);
  planar_loops::fill_constants<K>(block, planar);
}

template <int K>
void planar_residual_loop(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                          const StateViews& state, const ElementEquations& equations) {
  const planar_loops::PlanarResidualLoop<K> loop{planar_loops::PlanarGather<K>(block, planar, structure, state),
                                                 equations.planar_rows,
                                                 equations.interior_residual,
                                                 equations.largest_end_angle,
                                                 equations.interior_scales,
                                                 equations.scales_interior};
  Kokkos::parallel_for("mixbeam::planar::residual", planar_loops::Range(0, planar.packs()), loop);
}

template <int K>
void planar_tangent_loop(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                         const StateViews& state, const KernelView<const double*>& given_rhs,
                         const PlanarTangents& tangents, const ElementEquations& equations) {
  const planar_loops::PlanarTangentLoop<K> loop{planar_loops::PlanarGather<K>(block, planar, structure, state),
                                                planar.response, tangents, equations.planar_rows, given_rhs};
  Kokkos::parallel_for("mixbeam::planar::tangent", planar_loops::Range(0, planar.packs()), loop);
}

template <int K>
void planar_recover_loop(const ElementBlock& block, const PlanarBlock& planar,
                         const KernelView<const double* [6]>& vertex_increment, const KernelView<double*>& increment) {
  planar_loops::PlanarRecoverLoop<K> loop{
      planar.orientation_of, block.vertices,        planar.response, vertex_increment, increment, planar.axes, {},
      block.count,           block.increment_offset};
  for (int i = 0; i < 4; ++i) loop.orientation[i] = planar.orientation[i];
  Kokkos::parallel_for("mixbeam::planar::recover", planar_loops::Range(0, planar.packs()), loop);
}

}  // namespace mixbeam
