#include "discretization/planar_chains.hpp"

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

PlanarChains::PlanarChains(const Assembler& assembler, const ChainStructure& structure, FactorPrecision precision)
    : assembler_(assembler), structure_(structure), chains_(structure, precision) {
  using Kokkos::view_alloc;
  using Kokkos::WithoutInitializing;
  const Structure& mesh = assembler.structure();
  const int elements = structure.elements();
  // only what remains is ever written: untouched pages cost nothing
  elements_ = KernelView<double**>(view_alloc("mixbeam::planar::elements", WithoutInitializing), elements,
                                   LinkMatrices<kSpatialDofs>::kFull);
  const KernelView<double* [144]> runs(view_alloc("mixbeam::planar::runs", WithoutInitializing), structure.runs());
  remaining_ = {elements_, runs};
  arrived_ = KernelView<double* [12]>("mixbeam::planar::arrived", structure.runs());
  rows_ = KernelView<double*>("mixbeam::planar::rows", static_cast<size_t>(kPlanarDofs) * mesh.local_vertices());
  x_ = KernelView<double*>("mixbeam::planar::x", rows_.extent(0));
  ends_ = KernelView<int* [2]>("mixbeam::planar::ends", elements);
  for (const ElementBlock& block : mesh.blocks)
    for (int e = 0; e < block.count; ++e)
      for (int end = 0; end < 2; ++end) ends_(block.first_element + e, end) = block.vertices(e, end);
  is_eliminated_ = KernelView<unsigned char*>("mixbeam::planar::eliminated", mesh.local_vertices());
  std::copy(structure.eliminated().begin(), structure.eliminated().end(), is_eliminated_.data());
  is_condensed_ = KernelView<unsigned char*>("mixbeam::planar::condensed", elements);
  std::fill_n(is_condensed_.data(), elements, 1);
  for (const RemainingLink& link : structure.remaining())
    if (link.link < elements) is_condensed_(link.link) = 0;
}

ChainCondensation<kPlanarDofs>::Pivots PlanarChains::condense() {
  const auto pivots = chains_.factorize(assembler_.planar_tangents());
  const LinkMatrices<kPlanarDofs> links = chains_.matrices(assembler_.planar_tangents());
  const int elements = structure_.elements();
  for (const RemainingLink& remaining : structure_.remaining()) {
    const int link = remaining.link;
    double room[LinkMatrices<kPlanarDofs>::kFull];
    double* out = link < elements ? &elements_(link, 0) : &remaining_.runs(link - elements, 0);
    expand_link(*assembler_.plane(), links.full(link, room), out);
  }
  return pivots;
}

void PlanarChains::condense_rows(const KernelView<const double*>& rows) {
  const PlaneAxes axes = *assembler_.plane();
  const KernelView<double*> planar = rows_;
  Kokkos::parallel_for(
      "mixbeam::planar::rows", Range(0, assembler_.structure().owned_vertices),
      KOKKOS_LAMBDA(int v) { project(axes, &rows(vertex_row(v, 0)), &planar(planar_row(v, 0))); });
  chains_.condense_rows(planar, x_);
  for (const RemainingLink& remaining : structure_.remaining()) {
    const int run = remaining.link - structure_.elements();
    for (int end = 0; run >= 0 && end < 2; ++end)
      expand_to_space(axes, &chains_.arrived()(run, kPlanarDofs * end), &arrived_(run, kVertexDofs * end));
  }
}

void PlanarChains::expand(const KernelView<double*>& x) {
  const PlaneAxes axes = *assembler_.plane();
  const KernelView<double*> planar = x_;
  const KernelView<const unsigned char*> eliminated = is_eliminated_;
  const Range all(0, assembler_.structure().owned_vertices);
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

/// Forces (2) and moment of one end of an element taken from `left`, and the sum of |entry| times the largest unknown
/// of its kind added to `size`. `a`, `b`: unknowns of its ends.
KOKKOS_INLINE_FUNCTION void subtract_element(const double* tangent, int end, const double* a, const double* b,
                                             const LargestParts& sizes, double* left, double* size) {
  using Layout = TangentLayout<kPlanarDofs>;
  const double change[Layout::kReduced] = {b[0] - a[0], b[1] - a[1], a[2], b[2]};
  const double largest[Layout::kReduced] = {2.0 * sizes.moved, 2.0 * sizes.moved, sizes.turned, sizes.turned};
  const double sign = end == 0 ? -1.0 : 1.0;
  const int rows[kPlanarDofs] = {0, 1, 2 + end};
  for (int r = 0; r < kPlanarDofs; ++r) {
    double force = 0.0;
    for (int c = 0; c < Layout::kReduced; ++c) {
      const double k = tangent[Layout::place(rows[r], c)];
      force += k * change[c];
      size[r] += (k < 0.0 ? -k : k) * largest[c];
    }
    left[r] -= r < Layout::kMoved ? sign * force : force;
  }
}

}  // namespace

double PlanarChains::error(const KernelView<const double*>& rows, const KernelView<const double*>& x,
                           const LargestParts& sizes, const KernelView<const double*>& run_forces,
                           const KernelView<double*>& residual) const {
  const PlaneAxes axes = *assembler_.plane();
  const PlanarTangents tangents = assembler_.planar_tangents();
  const auto adjacency = assembler_.adjacency();
  const KernelView<const int* [2]> ends = ends_;
  const KernelView<const unsigned char*> eliminated = is_eliminated_, condensed = is_condensed_;
  const KernelView<double*> planar = x_;
  const Range owned(0, assembler_.structure().owned_vertices);
  Kokkos::parallel_for(
      "mixbeam::planar::x", owned,
      KOKKOS_LAMBDA(int v) { project(axes, &x(vertex_row(v, 0)), &planar(planar_row(v, 0))); });
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::planar::error", owned,
      KOKKOS_LAMBDA(int v, double& m) {
        double left[kPlanarDofs], size[kPlanarDofs];
        project(axes, eliminated(v) != 0 ? &rows(vertex_row(v, 0)) : &run_forces(vertex_row(v, 0)), left);
        for (int r = 0; r < kPlanarDofs; ++r) size[r] = left[r] < 0.0 ? -left[r] : left[r];
        for (int i = adjacency.start(v); i < adjacency.start(v + 1); ++i) {
          const int e = adjacency.element(i, 0);
          if (condensed(e) == 0) continue;
          const double *a = &planar(planar_row(ends(e, 0), 0)), *b = &planar(planar_row(ends(e, 1), 0));
          subtract_element(&tangents(e, 0), adjacency.element(i, 1), a, b, sizes, left, size);
        }
        for (int r = 0; r < kPlanarDofs; ++r) {
          const double absolute = left[r] < 0.0 ? -left[r] : left[r];
          const double error = absolute == 0.0 ? 0.0 : absolute / size[r];
          if (!(error <= m)) m = error == error ? error : HUGE_VAL;
          if (eliminated(v) == 0) left[r] = 0.0;
        }
        if (residual.extent(0) > 0) expand_to_space(axes, left, &residual(vertex_row(v, 0)));
      },
      Kokkos::Max<double>(largest));
  return largest;
}

}  // namespace mixbeam
