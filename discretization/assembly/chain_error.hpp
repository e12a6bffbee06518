/// How well a solution fulfils the rows of condensed chains, with any number of unknowns for each vertex. For
/// condensed_system.cpp and planar_chains.cpp alone.
#pragma once

#include "discretization/assembly/model.hpp"
#include "kernels/chains/level.hpp"
#include "kernels/execution/pack.hpp"

#include <cmath>

namespace mixbeam {

/// What of a structure is condensed in chains.
struct ChainPlaces {
  KernelView<int* [2]> ends;              ///< (local element, end): local vertex
  KernelView<unsigned char*> eliminated;  ///< (local vertex)
  KernelView<unsigned char*> condensed;   ///< (local element): 1 where it is part of a condensed chain
};

/// Some of the elements at kLanes vertices: the tangent of each, the unknowns of its ends and which of them the vertex
/// is. Lanes without an element, or with one that is in no condensed chain, are not active.
struct ElementsAtVertices {
  const double *tangent[kLanes], *start[kLanes], *end[kLanes];
  Pack<kLanes>::Mask active, ends_here;
};

/// Forces and moments of elements at vertices taken from `left`, and the sum of |entry| times the largest unknown of
/// its kind added to `size`. Tangents of kSymmetric numbers.
template <int N>
KOKKOS_INLINE_FUNCTION void subtract_symmetric(const ElementsAtVertices& elements, const LargestParts& sizes,
                                               Pack<kLanes>* left, Pack<kLanes>* size) {
  using Layout = TangentLayout<N>;
  using Real = Pack<kLanes>;
  Real k[Layout::kSymmetric], a[N], b[N], change[Layout::kReduced];
  gather_lanes(elements.tangent, Layout::kSymmetric, k);
  gather_lanes(elements.start, N, a);
  gather_lanes(elements.end, N, b);
  for (int c = 0; c < Layout::kReduced; ++c)
    change[c] = c < Layout::kMoved ? b[c] - a[c] : c < N ? a[c] : b[c - Layout::kTurned];
  for (int r = 0; r < N; ++r) {
    Real force = 0.0, bound = 0.0;
    for (int c = 0; c < Layout::kReduced; ++c) {
      Real entry = k[Layout::place(r, c)];
      if (r >= Layout::kMoved) entry = select(elements.ends_here, k[Layout::place(r + Layout::kTurned, c)], entry);
      force += entry * change[c];
      bound += fabs(entry) * (c < Layout::kMoved ? 2.0 * sizes.moved : sizes.turned);
    }
    if (r < Layout::kMoved) force = select(elements.ends_here, force, -force);
    left[r] -= select(elements.active, force, Real(0.0));
    size[r] += select(elements.active, bound, Real(0.0));
  }
}
/// The same of kFull numbers, of which `tangent` points to the rows of the vertex.
template <int N>
KOKKOS_INLINE_FUNCTION void subtract_full(const ElementsAtVertices& elements, const LargestParts& sizes,
                                          Pack<kLanes>* left, Pack<kLanes>* size) {
  using Real = Pack<kLanes>;
  Real k[2 * N * N], at[2 * N];
  gather_lanes(elements.tangent, 2 * N * N, k);
  gather_lanes(elements.start, N, at);
  gather_lanes(elements.end, N, at + N);
  for (int r = 0; r < N; ++r)
    for (int c = 0; c < 2 * N; ++c) {
      const Real entry = k[2 * N * r + c];
      left[r] -= select(elements.active, entry * at[c], Real(0.0));
      size[r] += select(elements.active, fabs(entry) * (c % N < TangentLayout<N>::kMoved ? sizes.moved : sizes.turned),
                        Real(0.0));
    }
}

/// Index: pack of vertices. given(vertex, its N rows) yields what elements of chains have to hold; store(vertex, what
/// they leave of it).
template <int N, class Given, class Store>
struct ChainErrorLoop {
  int count;
  LargestParts sizes;
  KernelView<const double**> tangents;
  Adjacency adjacency;
  ChainPlaces places;
  KernelView<const double*> x;  ///< (N * local vertex + component)
  Given given;
  Store store;

  KOKKOS_INLINE_FUNCTION void operator()(int pack, double& worst) const {
    using Real = Pack<kLanes>;
    const LaneRows lanes(pack, count);
    int most = 0;
    Real left[N], size[N];
    for (int lane = 0; lane < kLanes; ++lane) {
      const int v = lanes.row[lane];
      const int elements = adjacency.start(v + 1) - adjacency.start(v);
      most = elements > most ? elements : most;
      double rows[N];
      given(v, rows);
      for (int r = 0; r < N; ++r) left[r].set(lane, rows[r]);
    }
    for (int r = 0; r < N; ++r) size[r] = fabs(left[r]);
    const bool is_full = tangents.extent(1) == TangentLayout<N>::kFull;
    for (int i = 0; i < most; ++i)
      if (is_full)
        subtract_full<N>(elements_at(lanes, i, 2 * N * N), sizes, left, size);
      else
        subtract_symmetric<N>(elements_at(lanes, i, 0), sizes, left, size);
    for (int lane = 0; lane < lanes.active; ++lane) {
      double here[N];
      for (int r = 0; r < N; ++r) {
        here[r] = left[r][lane];
        const double absolute = here[r] < 0.0 ? -here[r] : here[r];
        const double error = absolute == 0.0 ? 0.0 : absolute / size[r][lane];
        if (!(error <= worst)) worst = error == error ? error : HUGE_VAL;
        if (places.eliminated(lanes.row[lane]) == 0) here[r] = 0.0;
      }
      store(lanes.row[lane], here);
    }
  }
  /// The i-th element at each vertex; the rows of its second end begin `second_end` numbers behind the first one's.
  KOKKOS_INLINE_FUNCTION ElementsAtVertices elements_at(const LaneRows& lanes, int i, int second_end) const {
    ElementsAtVertices found;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int entry = adjacency.start(lanes.row[lane]) + i;
      const bool exists = entry < adjacency.start(lanes.row[lane] + 1);
      const int e = exists ? adjacency.element(entry, 0) : 0, end = exists ? adjacency.element(entry, 1) : 0;
      found.tangent[lane] = &tangents(e, 0) + second_end * end;
      found.start[lane] = &x(static_cast<size_t>(N) * places.ends(e, 0));
      found.end[lane] = &x(static_cast<size_t>(N) * places.ends(e, 1));
      found.active[lane] = exists && places.condensed(e) != 0 ? -1 : 0;
      found.ends_here[lane] = end == 1 ? -1 : 0;
    }
    return found;
  }
};

/// max |left| / size over all rows of this rank.
template <int N, class Given, class Store>
double error_of_chains(const Model& model, const ChainPlaces& places, const KernelView<const double**>& tangents,
                       const KernelView<const double*>& x, const LargestParts& sizes, const Given& given,
                       const Store& store) {
  const int vertices = model.structure().owned_vertices;
  const ChainErrorLoop<N, Given, Store> loop{vertices, sizes, tangents, model.adjacency(), places, x, given, store};
  double largest = 0.0;
  Kokkos::parallel_reduce("mixbeam::chains::error", Kokkos::RangePolicy<ExecutionSpace>(0, LaneRows::packs(vertices)),
                          loop, Kokkos::Max<double>(largest));
  return largest;
}

}  // namespace mixbeam
