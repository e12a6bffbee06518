#include "discretization/assembly/planar_chains.hpp"

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

PlanarChains::PlanarChains(const Model& model, const ChainStructure& structure, const ChainPlaces& places)
    : model_(model), structure_(structure), places_(places), chains_(structure.levels()) {
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
  const KernelView<const unsigned char*> eliminated = places_.eliminated;
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

double PlanarChains::error(const KernelView<const double*>& rows, const KernelView<const double*>& x,
                           const LargestParts& sizes, const KernelView<const double*>& run_forces,
                           const KernelView<double*>& residual) const {
  const PlaneAxes axes = *model_.plane();
  const KernelView<double*> planar = x_;
  const auto eliminated = places_.eliminated;
  Kokkos::parallel_for(
      "mixbeam::planar::x", Range(0, model_.structure().owned_vertices),
      KOKKOS_LAMBDA(int v) { project(axes, &x(vertex_row(v, 0)), &planar(planar_row(v, 0))); });
  const auto given = KOKKOS_LAMBDA(int v, double* row) {
    project(axes, eliminated(v) != 0 ? &rows(vertex_row(v, 0)) : &run_forces(vertex_row(v, 0)), row);
  };
  const auto store = KOKKOS_LAMBDA(int v, const double* left) {
    if (residual.extent(0) > 0) expand_to_space(axes, left, &residual(vertex_row(v, 0)));
  };
  return error_of_chains<kPlanarDofs>(model_, places_, tangents_, planar, sizes, given, store);
}

}  // namespace mixbeam
