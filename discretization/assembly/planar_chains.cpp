#include "discretization/assembly/planar_chains.hpp"

#include "discretization/mesh/element_view.hpp"
#include "kernels/execution/pack.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

size_t planar_row(int vertex, int component) { return static_cast<size_t>(kPlanarDofs) * vertex + component; }

/// (p, q, theta) of six spatial components.
KOKKOS_INLINE_FUNCTION void project(const PlaneAxes& axes, const double* spatial, double* planar) {
  const Vec moved = load_vector(spatial), turned = load_vector(spatial + 3);
  planar[0] = dot(axes.p, moved);
  planar[1] = dot(axes.q, moved);
  planar[2] = dot(axes.n, turned);
}
KOKKOS_INLINE_FUNCTION void expand_to_space(const PlaneAxes& axes, const double* planar, double* spatial) {
  store_vector(planar[0] * axes.p + planar[1] * axes.q, spatial);
  store_vector(planar[2] * axes.n, spatial + 3);
}

/// A link over (u_p, u_q, theta) of both ends becomes one over six components each.
void expand_link(const PlaneAxes& axes, const double* planar, double* spatial) {
  const Vec directions[kPlanarDofs] = {axes.p, axes.q, axes.n};
  std::fill_n(spatial, 144, 0.0);
  const auto first = [](int i) { return 6 * (i / 3) + (i % 3 == 2 ? 3 : 0); };
  for (int i = 0; i < 2 * kPlanarDofs; ++i)
    for (int j = 0; j < 2 * kPlanarDofs; ++j)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          spatial[12 * (first(i) + r) + first(j) + c] +=
              directions[i % 3][r] * planar[6 * i + j] * directions[j % 3][c];
  for (int end = 0; end < 2; ++end) {
    const auto diagonal = [&](int i) { return std::abs(planar[7 * (3 * end + i)]); };
    const double force = std::max(diagonal(0), diagonal(1)), moment = diagonal(2);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        spatial[12 * (6 * end + r) + 6 * end + c] += force * axes.n[r] * axes.n[c];
        spatial[12 * (6 * end + 3 + r) + 6 * end + 3 + c] += moment * (axes.p[r] * axes.p[c] + axes.q[r] * axes.q[c]);
      }
  }
}

}  // namespace

PlanarChains::PlanarChains(const Model& model, const ChainStructure& structure)
    : model_(model), structure_(structure), chains_(structure.levels()) {
  using Kokkos::view_alloc;
  using Kokkos::WithoutInitializing;
  const Structure& mesh = model.structure();
  const int elements = structure.levels().elements;
  // only what remains is ever written: untouched pages cost nothing
  elements_ = KernelView<double**>(view_alloc("mixbeam::planar::elements", WithoutInitializing), elements,
                                   LinkMatrices<kSpatialDofs>::kFull);
  const KernelView<double* [144]> runs(view_alloc("mixbeam::planar::runs", WithoutInitializing),
                                       structure.levels().runs);
  remaining_ = {elements_, runs};
  arrived_ = KernelView<double* [12]>("mixbeam::planar::arrived", structure.levels().runs);
  rows_ = KernelView<double*>("mixbeam::planar::rows", static_cast<size_t>(kPlanarDofs) * mesh.local_vertices());
  x_ = KernelView<double*>("mixbeam::planar::x", rows_.extent(0));
  ends_ = KernelView<int* [2]>("mixbeam::planar::ends", elements);
  for_each_element(mesh, [&](const ElementView& element) {
    for (int end = 0; end < 2; ++end) ends_(element.local(), end) = element.vertex(end);
  });
  is_eliminated_ = KernelView<unsigned char*>("mixbeam::planar::eliminated", mesh.local_vertices());
  std::copy(structure.eliminated().begin(), structure.eliminated().end(), is_eliminated_.data());
  is_condensed_ = KernelView<unsigned char*>("mixbeam::planar::condensed", elements);
  std::fill_n(is_condensed_.data(), elements, 1);
  for (const RemainingLink& link : structure.remaining())
    if (link.link < elements) is_condensed_(link.link) = 0;
}

ChainCondensation<kPlanarDofs>::Pivots PlanarChains::condense(const PlanarTangents& tangents) {
  tangents_ = tangents;
  const auto pivots = chains_.factorize(tangents_);
  const LinkMatrices<kPlanarDofs> links = chains_.matrices(tangents_);
  const int elements = structure_.levels().elements;
  for (const RemainingLink& remaining : structure_.remaining()) {
    const int link = remaining.link;
    double room[LinkMatrices<kPlanarDofs>::kFull];
    double* out = link < elements ? &elements_(link, 0) : &remaining_.runs(link - elements, 0);
    expand_link(*model_.plane(), links.full(link, room), out);
  }
  return pivots;
}

void PlanarChains::condense_rows(const KernelView<const double*>& rows) {
  const PlaneAxes axes = *model_.plane();
  const KernelView<double*> planar = rows_;
  Kokkos::parallel_for(
      "mixbeam::planar::rows", Range(0, model_.structure().owned_vertices),
      KOKKOS_LAMBDA(int v) { project(axes, &rows(vertex_row(v, 0)), &planar(planar_row(v, 0))); });
  chains_.condense_rows(planar, x_);
  for (const RemainingLink& remaining : structure_.remaining()) {
    const int run = remaining.link - structure_.levels().elements;
    for (int end = 0; run >= 0 && end < 2; ++end)
      expand_to_space(axes, &chains_.arrived()(run, kPlanarDofs * end), &arrived_(run, kVertexDofs * end));
  }
}

void PlanarChains::expand(const KernelView<double*>& x) {
  const PlaneAxes axes = *model_.plane();
  const KernelView<double*> planar = x_;
  const KernelView<const unsigned char*> eliminated = is_eliminated_;
  const Range all(0, model_.structure().owned_vertices);
  Kokkos::parallel_for(
      "mixbeam::planar::ends", all, KOKKOS_LAMBDA(int v) {
        if (eliminated(v) == 0) project(axes, &x(vertex_row(v, 0)), &planar(planar_row(v, 0)));
      });
  chains_.expand(planar);
  Kokkos::parallel_for(
      "mixbeam::planar::expand", all,
      KOKKOS_LAMBDA(int v) { expand_to_space(axes, &planar(planar_row(v, 0)), &x(vertex_row(v, 0))); });
}

namespace {

using Real = Pack<kLanes>;

/// Some of the elements at kLanes vertices: the tangent of each, its ends and which of them the vertex is. Lanes
/// without an element, or with one that is in no condensed chain, are not active.
struct ElementsAtVertices {
  const double *tangent[kLanes], *start[kLanes], *end[kLanes];
  Real::Mask active, ends_here;
};

/// Forces (2) and moment of elements at vertices taken from `left`, and the sum of |entry| times the largest unknown of
/// its kind added to `size`.
KOKKOS_INLINE_FUNCTION void subtract_elements(const ElementsAtVertices& elements, const LargestParts& sizes, Real* left,
                                              Real* size) {
  using Layout = TangentLayout<kPlanarDofs>;
  Real k[kPlanarTangent], a[kPlanarDofs], b[kPlanarDofs];
  gather_lanes(elements.tangent, kPlanarTangent, k);
  gather_lanes(elements.start, kPlanarDofs, a);
  gather_lanes(elements.end, kPlanarDofs, b);
  const Real change[Layout::kReduced] = {b[0] - a[0], b[1] - a[1], a[2], b[2]};
  const double largest[Layout::kReduced] = {2.0 * sizes.moved, 2.0 * sizes.moved, sizes.turned, sizes.turned};
  for (int r = 0; r < kPlanarDofs; ++r) {
    Real force = 0.0, bound = 0.0;
    for (int c = 0; c < Layout::kReduced; ++c) {
      Real entry = k[Layout::place(r, c)];
      if (r == 2) entry = select(elements.ends_here, k[Layout::place(3, c)], entry);
      force += entry * change[c];
      bound += fabs(entry) * largest[c];
    }
    if (r < Layout::kMoved) force = select(elements.ends_here, force, -force);
    left[r] -= select(elements.active, force, Real(0.0));
    size[r] += select(elements.active, bound, Real(0.0));
  }
}

/// Index: pack of vertices.
struct PlanarErrorLoop {
  int count;
  PlaneAxes axes;
  LargestParts sizes;
  PlanarTangents tangents;
  Adjacency adjacency;
  KernelView<const int* [2]> ends;
  KernelView<const unsigned char*> eliminated, condensed;
  KernelView<const double*> rows, run_forces, x;
  KernelView<double*> residual;  ///< empty: not wanted

  KOKKOS_INLINE_FUNCTION void operator()(int pack, double& worst) const {
    const LaneRows lanes(pack, count);
    int most = 0;
    Real left[kPlanarDofs], size[kPlanarDofs];
    for (int lane = 0; lane < kLanes; ++lane) {
      const int v = lanes.row[lane];
      const int elements = adjacency.start(v + 1) - adjacency.start(v);
      most = elements > most ? elements : most;
      double given[kPlanarDofs];
      project(axes, eliminated(v) != 0 ? &rows(vertex_row(v, 0)) : &run_forces(vertex_row(v, 0)), given);
      for (int r = 0; r < kPlanarDofs; ++r) left[r].set(lane, given[r]);
    }
    for (int r = 0; r < kPlanarDofs; ++r) size[r] = fabs(left[r]);
    for (int i = 0; i < most; ++i) subtract_elements(elements_at(lanes, i), sizes, left, size);
    for (int lane = 0; lane < lanes.active; ++lane) {
      double here[kPlanarDofs];
      for (int r = 0; r < kPlanarDofs; ++r) {
        const double absolute = left[r][lane] < 0.0 ? -left[r][lane] : left[r][lane];
        const double error = absolute == 0.0 ? 0.0 : absolute / size[r][lane];
        if (!(error <= worst)) worst = error == error ? error : HUGE_VAL;
        here[r] = eliminated(lanes.row[lane]) == 0 ? 0.0 : left[r][lane];
      }
      if (residual.extent(0) > 0) expand_to_space(axes, here, &residual(vertex_row(lanes.row[lane], 0)));
    }
  }
  /// The i-th element at each vertex.
  KOKKOS_INLINE_FUNCTION ElementsAtVertices elements_at(const LaneRows& lanes, int i) const {
    ElementsAtVertices found;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int entry = adjacency.start(lanes.row[lane]) + i;
      const bool exists = entry < adjacency.start(lanes.row[lane] + 1);
      const int e = exists ? adjacency.element(entry, 0) : 0;
      found.tangent[lane] = &tangents(e, 0);
      found.start[lane] = &x(planar_row(ends(e, 0), 0));
      found.end[lane] = &x(planar_row(ends(e, 1), 0));
      found.active[lane] = exists && condensed(e) != 0 ? -1 : 0;
      found.ends_here[lane] = exists && adjacency.element(entry, 1) == 1 ? -1 : 0;
    }
    return found;
  }
};

}  // namespace

double PlanarChains::error(const KernelView<const double*>& rows, const KernelView<const double*>& x,
                           const LargestParts& sizes, const KernelView<const double*>& run_forces,
                           const KernelView<double*>& residual) const {
  const PlaneAxes axes = *model_.plane();
  const KernelView<double*> planar = x_;
  const int vertices = model_.structure().owned_vertices;
  Kokkos::parallel_for(
      "mixbeam::planar::x", Range(0, vertices),
      KOKKOS_LAMBDA(int v) { project(axes, &x(vertex_row(v, 0)), &planar(planar_row(v, 0))); });
  const PlanarErrorLoop loop{vertices, axes,           sizes,         tangents_, model_.adjacency(),
                             ends_,    is_eliminated_, is_condensed_, rows,      run_forces,
                             planar,   residual};
  double largest = 0.0;
  Kokkos::parallel_reduce("mixbeam::planar::error", Range(0, LaneRows::packs(vertices)), loop,
                          Kokkos::Max<double>(largest));
  return largest;
}

}  // namespace mixbeam
