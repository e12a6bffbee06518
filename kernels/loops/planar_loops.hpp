/// Loops of planar_block.hpp for one order. Index: pack of elements.
#pragma once

#include "kernels/loops/planar_gather.hpp"

namespace mixbeam {

/// Stores the line loads that act equally on both ends.
template <int W>
KOKKOS_FORCEINLINE_FUNCTION void store_loads(const RowsInLanes<W>& lanes, int first, const Vec2<Pack<W>>& on_each_end,
                                             const KernelView<double* [2]>& loads) {
  const Pack<W> numbers[2] = {on_each_end.x, on_each_end.y};
  lanes.store(numbers, 0, 2, [&](int e) { return &loads(first + e, 0); });
}

template <int K, int W>
struct PlanarResidualLoop {
  using Real = Pack<W>;
  PlanarGather<K, W> gather;
  ElementEquations to;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    const RowsInLanes<W> lanes(number, gather.block.count);
    const PackInPlane<K, W> plane(gather.planar, lanes);
    PlanarState<K, Real> state;
    gather.load(number, lanes, plane, state);
    PlanarGradient<K, Real> g{};
    if (!to.fields_alone) planar_gradient(state, gather.tables, g);
    const int first = gather.block.first_element;
    if (gather.has_fields()) store_loads(lanes, first, gather.add_fields(lanes, plane, state, g), to.planar_loads);
    const Vec2<Real> force = (1.0 / state.length) * (state.triad * g.slope[0]);
    const Real vertex[4] = {force.x, force.y, g.end_moment[0], g.end_moment[1]};
    lanes.store(vertex, 0, 4, [&](int e) { return &to.planar_rows(first + e, 0); });
    Real x[plane.kLayout.increments()];
    plane.increments_in_space([&](int q) { return g.strain_error[q]; }, [&](int j) { return g.moment_row[j]; },
                              [&](int j) { return g.angle[j]; }, [&](int j) { return state.triad * g.slope[j]; }, x);
    if (to.scales_interior) scale_interior_rows(plane.kLayout, to.interior_scales, state.length, false, x);
    const auto interior_of = [&](int e) { return &to.interior_residual(gather.increment_of(e)); };
    lanes.store(x, 0, plane.kLayout.increments(), interior_of);
    for (int lane = 0; lane < lanes.active; ++lane)
      to.largest_end_angle(first + lanes.row[lane]) = g.largest_end_angle[lane];
  }
};

/// Solves lanes with too small pivots one by one, with row pivoting.
template <int K, int W>
__attribute__((noinline)) void redo_planar_lanes(const Pack<W>& least, const Pack<W>& length,
                                                 const PlanarSystem<K, Pack<W>>& system,
                                                 PlanarSolution<K, Pack<W>>& solution) {
  for (int lane = 0; lane < W; ++lane) {
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

template <int K, int W>
struct PlanarTangentLoop {
  using Real = Pack<W>;
  PlanarGather<K, W> gather;
  PlanarTangents tangents;
  KernelView<double* [4]> vertex_rows;
  KernelView<double* [2]> loads;
  KernelView<const double*> given_rhs;  ///< empty: use the residual of the state

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    const RowsInLanes<W> lanes(number, gather.block.count);
    const PackInPlane<K, W> plane(gather.planar, lanes);
    PlanarState<K, Real> state;
    gather.load(number, lanes, plane, state);
    const bool own = given_rhs.extent(0) == 0;
    const bool loaded = own && gather.has_fields();
    PlanarRightHandSide<K, Real> rhs;
    Vec2<Real> end_force{0.0, 0.0};  // of the state, if not in `rhs`
    if (!own) load_right_hand_side(lanes, plane, state, rhs);
    if (loaded) end_force = own_right_hand_side(lanes, plane, state, rhs);
    PlanarSystem<K, Real> system;
    PlanarPoints<K, Real> points;
    Real moment_row[K + 1];
    planar_system(state, gather.tables, own && !loaded ? nullptr : &rhs, moment_row, points, system);
    PlanarSolution<K, Real> solution;
    const Real least = solve_planar(state.length, system, solution);
    if (any<W>(~(least >= Real(1.0)))) redo_planar_lanes<K, W>(least, state.length, system, solution);
    columns_to_plane(state, solution);
    auto* rows = reinterpret_cast<Real(*)[kPlanarColumns]>(&gather.planar.response(number, 0));
    planar_response(state, gather.tables, points, moment_row, solution, rows);
    store_condensed(lanes, state, solution, own, end_force);
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION void store_condensed(const RowsInLanes<W>& lanes, const PlanarState<K, Real>& state,
                                                   const PlanarSolution<K, Real>& solution, bool own,
                                                   const Vec2<Real>& end_force) const {
    Real tangent[kPlanarTangent], gradient[4], end_moment[2], unused[K];
    planar_moment_gradient<K>(state.moment, unused, end_moment);
    planar_condensed(state, solution, own ? end_moment : nullptr, tangent, gradient);
    gradient[0] += end_force.x;
    gradient[1] += end_force.y;
    const int first = gather.block.first_element;
    lanes.store(tangent, 0, kPlanarTangent, [&](int e) { return &tangents(first + e, 0); });
    lanes.store(gradient, 0, 4, [&](int e) { return &vertex_rows(first + e, 0); });
  }
  /// Fills `rhs` with the gradient of the state and its line fields; returns its force at the end of the element.
  KOKKOS_FUNCTION __attribute__((noinline)) Vec2<Real> own_right_hand_side(const RowsInLanes<W>& lanes,
                                                                           const PackInPlane<K, W>& plane,
                                                                           const PlanarState<K, Real>& state,
                                                                           PlanarRightHandSide<K, Real>& rhs) const {
    PlanarGradient<K, Real> g;
    planar_gradient(state, gather.tables, g);
    store_loads(lanes, gather.block.first_element, gather.add_fields(lanes, plane, state, g), loads);
    for (int q = 0; q < K; ++q) rhs.strain_error[q] = g.strain_error[q];
    for (int j = 0; j <= K; ++j) rhs.moment_row[j] = g.moment_row[j];
    for (int j = 0; j < K; ++j) {
      rhs.angle[j] = g.angle[j];
      rhs.slope[j] = g.slope[j];
    }
    rhs.slope[0] = {0.0, 0.0};
    return (1.0 / state.length) * (state.triad * g.slope[0]);
  }
  KOKKOS_FORCEINLINE_FUNCTION void load_right_hand_side(const RowsInLanes<W>& lanes, const PackInPlane<K, W>& plane,
                                                        const PlanarState<K, Real>& state,
                                                        PlanarRightHandSide<K, Real>& rhs) const {
    Real x[plane.kLayout.increments()];
    lanes.load([&](int e) { return &given_rhs(gather.increment_of(e)); }, plane.kLayout.increments(), x);
    plane.interior_in_plane(x, state.triad, rhs.strain_error, rhs.moment_row, rhs.angle, rhs.slope);
    rhs.angle[0] = plane.normal(x + plane.kLayout.spin());
    rhs.slope[0] = {0.0, 0.0};
  }
};

template <int K, int W>
struct PlanarRecoverLoop {
  using Real = Pack<W>;
  using Rows = PlanarRows<K>;
  PlanarBlock planar;
  ElementBlock block;
  KernelView<const double* [6]> vertex_increment;
  KernelView<double*> increment;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const {
    const RowsInLanes<W> lanes(number, block.count);
    const PackInPlane<K, W> plane(planar, lanes);
    Real by[kPlanarColumns - 1];
    load_vertices(lanes, plane.axes, by);
    const auto* rows = reinterpret_cast<const Real(*)[kPlanarColumns]>(&planar.response(number, 0));
    const auto value = [&](int row) {
      Real sum = rows[row][kPlanarColumns - 1];
      for (int c = 0; c + 1 < kPlanarColumns; ++c) sum += rows[row][c] * by[c];
      return sum;
    };
    const auto vector = [&](int row) { return Vec2<Real>{value(row), value(row + 1)}; };
    constexpr int increments = PackInPlane<K, W>::kLayout.increments();
    Real x[increments];
    plane.increments_in_space(
        [&](int q) { return vector(Rows::force(q)); }, [&](int j) { return value(Rows::moment(j)); },
        [&](int j) { return value(Rows::angle(j)); }, [&](int j) { return vector(Rows::bubble(j)); }, x);
    const auto increment_of = [&](int e) { return &increment(block.increment_offset + size_t(e) * increments); };
    lanes.store(x, 0, increments, increment_of);
  }

  /// u_b - u_a and both spins in the plane.
  KOKKOS_FORCEINLINE_FUNCTION void load_vertices(const RowsInLanes<W>& lanes, const PlaneAxes& axes, Real* by) const {
    Vec2<Real> displacement[2];
    for (int end = 0; end < 2; ++end) {
      Real d[6];
      lanes.load([&](int e) { return &vertex_increment(block.vertices(e, end), 0); }, 6, d);
      displacement[end] = project(axes, d);
      by[2 + end] = axes.n[0] * d[3] + axes.n[1] * d[4] + axes.n[2] * d[5];
    }
    by[0] = displacement[1].x - displacement[0].x;
    by[1] = displacement[1].y - displacement[0].y;
  }
};

template <int K>
void allocate_planar_block(const ElementBlock& block, PlanarBlock& planar) {
  static_assert(PlanarConstants<K>::kSize == planar_constants_size(K), "size of the constants");
  static_assert(PlanarRows<K>::kCount * kPlanarColumns == planar_response_size(K), "size of the response");
  planar.response = KernelView<double**>(Kokkos::view_alloc("mixbeam::planar::response", Kokkos::WithoutInitializing),
                                         planar.packs(), planar_response_size(K) * planar.lanes);
  fill_planar_constants<K>(block, planar);
}

template <int K>
void planar_residual_loop(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                          const StateViews& state, const ElementEquations& equations) {
  const PlanarResidualLoop<K, kLanes> loop{PlanarGather<K, kLanes>(block, planar, structure, state), equations};
  Kokkos::parallel_for("mixbeam::planar::residual", Kokkos::RangePolicy<ExecutionSpace>(0, planar.packs()), loop);
}

template <int K>
void planar_tangent_loop(const ElementBlock& block, const PlanarBlock& planar, const StructureViews& structure,
                         const StateViews& state, const KernelView<const double*>& given_rhs,
                         const PlanarTangents& tangents, const ElementEquations& equations) {
  const PlanarTangentLoop<K, kLanes> loop{PlanarGather<K, kLanes>(block, planar, structure, state), tangents,
                                          equations.planar_rows, equations.planar_loads, given_rhs};
  Kokkos::parallel_for("mixbeam::planar::tangent", Kokkos::RangePolicy<ExecutionSpace>(0, planar.packs()), loop);
}

template <int K>
void planar_recover_loop(const ElementBlock& block, const PlanarBlock& planar,
                         const KernelView<const double* [6]>& vertex_increment, const KernelView<double*>& increment) {
  const PlanarRecoverLoop<K, kLanes> loop{planar, block, vertex_increment, increment};
  Kokkos::parallel_for("mixbeam::planar::recover", Kokkos::RangePolicy<ExecutionSpace>(0, planar.packs()), loop);
}

}  // namespace mixbeam
