#include "discretization/assembly/condensed_system.hpp"

#include "discretization/mesh/element_view.hpp"

#include <cmath>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

/// Rounding of a solve with a pivot this small, relative to what it was computed from, leaves six digits; the check of
/// the residual decides, this only saves the attempt.
constexpr double kSmallestPivot = 1e-10;

std::vector<std::array<int, 2>> ends_of(const Structure& structure) {
  std::vector<std::array<int, 2>> ends(structure.local_elements());
  for_each_element(structure, [&](const ElementView& element) {
    ends[element.local()] = {element.vertex(0), element.vertex(1)};
  });
  return ends;
}

/// On any rank. Collective.
bool has_unsymmetric_elements(const Model& model) {
  bool found = false;
  for_each_element(model.structure(), [&](const ElementView& element) {
    found = found || element.block().is_unsymmetric(element.index());
  });
  return maximum_over_ranks(*model.map()->getComm(), found ? 1.0 : 0.0) != 0.0;
}

/// Vertices that must not be eliminated for another reason than that members meet there.
std::vector<unsigned char> kept_vertices(const Model& model, const std::vector<int>& more) {
  const Structure& structure = model.structure();
  std::vector<unsigned char> kept(structure.local_vertices(), 0);
  const int owned = structure.owned_vertices;
  for (size_t v = owned; v < kept.size(); ++v) kept[v] = 1;
  for (const int vertex : more) kept[vertex] = 1;
  for (const auto& energy : model.external())
    for (const int vertex : energy->vertices()) kept[vertex] = 1;
  for (const VertexSupport& support : model.conditions().supports) kept[support.vertex] = 1;
  for (const VertexJoint& joint : model.conditions().joints) kept[joint.master] = kept[joint.slave] = 1;
  for_each_element(structure, [&](const ElementView& element) {
    const int a = element.vertex(0), b = element.vertex(1);
    if (a >= owned || b >= owned) kept[a] = kept[b] = 1;
  });
  return kept;
}

/// Forces and moments of one end of an element taken from `left`, and the sum of |entry| times the largest unknown of
/// its kind added to `size`. `at`: unknowns of both ends.
KOKKOS_INLINE_FUNCTION void subtract_full(const double* tangent, int end, const double* const* at,
                                          const LargestParts& sizes, double* left, double* size) {
  const double* matrix = tangent + 12 * kVertexDofs * end;
  for (int side = 0; side < 2; ++side)
    for (int r = 0; r < kVertexDofs; ++r)
      for (int c = 0; c < kVertexDofs; ++c) {
        const double k = matrix[12 * r + kVertexDofs * side + c];
        left[r] -= k * at[side][c];
        size[r] += (k < 0.0 ? -k : k) * (c < 3 ? sizes.moved : sizes.turned);
      }
}
/// Subtracts a tangent of kSymmetricTangent numbers.
KOKKOS_INLINE_FUNCTION void subtract_symmetric(const double* tangent, int end, const double* const* at,
                                               const LargestParts& sizes, double* left, double* size) {
  double change[9];
  for (int c = 0; c < 3; ++c) {
    change[c] = at[1][c] - at[0][c];
    change[3 + c] = at[0][3 + c];
    change[6 + c] = at[1][3 + c];
  }
  const double sign = end == 0 ? -1.0 : 1.0;
  const int moments = end == 0 ? 3 : 6;
  for (int r = 0; r < 3; ++r) {
    double force = 0.0, moment = 0.0, force_size = 0.0, moment_size = 0.0;
    for (int c = 0; c < 9; ++c) {
      const int m = moments + r;
      const double f = tangent[r > c ? triangle(r, c) : triangle(c, r)];
      const double k = tangent[m > c ? triangle(m, c) : triangle(c, m)];
      const double largest = c < 3 ? 2.0 * sizes.moved : sizes.turned;
      force += f * change[c];
      force_size += (f < 0.0 ? -f : f) * largest;
      moment += k * change[c];
      moment_size += (k < 0.0 ? -k : k) * largest;
    }
    left[r] -= sign * force;
    size[r] += force_size;
    left[3 + r] -= moment;
    size[3 + r] += moment_size;
  }
}

}  // namespace

CondensedSystem::CondensedSystem(const Model& model, const std::vector<int>& kept)
    : model_(model),
      is_unsymmetric_(has_unsymmetric_elements(model)),
      structure_(ends_of(model.structure()), kept_vertices(model, kept)),
      chains_(structure_.levels(), is_unsymmetric_) {
  if (model.plane()) planar_chains_ = std::make_unique<PlanarChains>(model, structure_);
  const Structure& structure = model.structure();
  std::vector<unsigned char> present = structure_.eliminated();
  for (unsigned char& p : present) p = p == 0 ? 1 : 0;
  remaining_ = std::make_unique<VertexMatrix>(structure, model.vertex_maps(), present, structure_.remaining(),
                                              model.conditions().joints);
  eliminated_ = KernelView<unsigned char*>("mixbeam::eliminated", present.size());
  for (size_t v = 0; v < present.size(); ++v) eliminated_(v) = structure_.eliminated()[v];
  condensed_ = KernelView<unsigned char*>("mixbeam::condensed", structure.local_elements());
  // written at the few vertices that remain: untouched pages cost nothing
  run_forces_ = KernelView<double*>(Kokkos::view_alloc("mixbeam::run_forces", Kokkos::WithoutInitializing),
                                    static_cast<size_t>(kVertexDofs) * structure.owned_vertices);
  ends_ = KernelView<int* [2]>("mixbeam::ends", structure.local_elements());
  for_each_element(structure, [&](const ElementView& element) {
    for (int end = 0; end < 2; ++end) ends_(element.local(), end) = element.vertex(end);
  });
  for (size_t e = 0; e < condensed_.extent(0); ++e) condensed_(e) = 1;
  for (const RemainingLink& link : structure_.remaining())
    if (link.link < structure.local_elements()) condensed_(link.link) = 0;
}

bool CondensedSystem::condense(const Tangent& tangent, bool symmetric_part,
                               const std::function<void(const MatrixRows&)>& add_more) {
  tangent_ = &tangent;
  elements_ = {};
  const auto& tangents = tangent.elements().condensed_tangent;
  planar_ = tangent.is_planar() ? planar_chains_.get() : nullptr;
  double smallest = 0.0;
  const auto note = [&](const auto& pivots) {
    negative_pivots_ = pivots.negative;
    smallest = pivots.smallest;
  };
  {
    PhaseTimer timer(model_.times(), "condense chains");
    if (planar_ != nullptr)
      note(planar_->condense(tangent.planar_elements()));
    else
      note(chains_.factorize(tangents, !is_unsymmetric_ ? ChainKind::symmetric
                                       : symmetric_part ? ChainKind::symmetric_part
                                                        : ChainKind::general));
  }
  PhaseTimer timer(model_.times(), "assemble");
  tangent.gather(*remaining_, link_matrices(), add_more);
  return smallest >= kSmallestPivot;
}

bool CondensedSystem::condense(const Tangent& tangent, const KernelView<const double**>& elements,
                               const std::function<void(const MatrixRows&)>& add_more) {
  tangent_ = &tangent;
  elements_ = elements;
  planar_ = nullptr;
  const auto pivots = chains_.factorize(elements, is_unsymmetric_ ? ChainKind::general : ChainKind::symmetric);
  negative_pivots_ = pivots.negative;
  tangent.gather(*remaining_, link_matrices(), add_more);
  return pivots.smallest >= kSmallestPivot;
}

void CondensedSystem::gather_outside(const Tangent& tangent, const KernelView<const double**>& zeros,
                                     const std::function<void(const MatrixRows&)>& add_more) const {
  const KernelView<double* [kFullTangent]> of_runs("mixbeam::chains::zeros", chains_.arrived().extent(0));
  tangent.gather(*remaining_, LinkMatrices<kSpatialDofs>{zeros, of_runs}, add_more);
}

LinkMatrices<kSpatialDofs> CondensedSystem::link_matrices() const {
  if (planar_ != nullptr) return planar_->remaining();
  if (elements_.extent(0) > 0) return chains_.matrices(elements_);
  return chains_.matrices(tangent_->elements().condensed_tangent);
}

void CondensedSystem::condense_rows(const DofVector& b, DofVector& remaining_b, DofVector& x) {
  PhaseTimer timer(model_.times(), "solve");
  const KernelView<const double*> rows = MixedVector::view_of(b);
  const KernelView<double*> half = MixedVector::view_of(x), out = MixedVector::view_of(remaining_b);
  if (planar_ != nullptr)
    planar_->condense_rows(rows);
  else
    chains_.condense_rows(rows, half);
  remaining_->sum_at_ends(arrived(), model_.structure().local_elements(), half);
  tangent_->project_on_free_motions(half);
  const KernelView<int*> vertices = remaining_->vertices();
  Kokkos::parallel_for(
      "mixbeam::chains::remaining_rows", Range(0, vertices.extent(0)), KOKKOS_LAMBDA(int r) {
        for (int c = 0; c < kVertexDofs; ++c) {
          const size_t row = vertex_row(vertices(r), c);
          out(vertex_row(r, c)) = rows(row) + half(row);
        }
      });
}

void CondensedSystem::expand(const DofVector& remaining_x, DofVector& x) const {
  PhaseTimer timer(model_.times(), "solve");
  const KernelView<const double*> from = MixedVector::view_of(remaining_x);
  const KernelView<double*> to = MixedVector::view_of(x);
  const KernelView<int*> vertices = remaining_->vertices();
  Kokkos::parallel_for(
      "mixbeam::chains::remaining_values", Range(0, vertices.extent(0)), KOKKOS_LAMBDA(int r) {
        for (int c = 0; c < kVertexDofs; ++c) to(vertex_row(vertices(r), c)) = from(vertex_row(r, c));
      });
  if (planar_ != nullptr)
    planar_->expand(to);
  else
    chains_.expand(to);
}

void CondensedSystem::remaining_values(const DofVector& x, DofVector& remaining_x) const {
  const KernelView<const double*> from = MixedVector::view_of(x);
  const KernelView<double*> to = MixedVector::view_of(remaining_x);
  const KernelView<int*> vertices = remaining_->vertices();
  for (size_t r = 0; r < vertices.extent(0); ++r)
    for (int c = 0; c < kVertexDofs; ++c) to(vertex_row(r, c)) = from(vertex_row(vertices(r), c));
}

double CondensedSystem::measure(const DofVector& b, const DofVector& x, const KernelView<double*>& residual) const {
  PhaseTimer timer(model_.times(), "check of the solve");
  const KernelView<const double*> rows = MixedVector::view_of(b), values = MixedVector::view_of(x);
  const KernelView<double*> run_forces = run_forces_;
  const LinkMatrices<kSpatialDofs> links = link_matrices();
  remaining_->run_forces(links, arrived(), model_.structure().local_elements(), values, run_forces);
  const Teuchos::Comm<int>& comm = *model_.map()->getComm();
  const LargestParts sizes = largest_parts(comm, values);
  if (planar_ != nullptr) return maximum_over_ranks(comm, planar_->error(rows, values, sizes, run_forces, residual));
  const auto adjacency = model_.adjacency();
  const auto ends = ends_;
  const auto eliminated = eliminated_;
  const auto condensed = condensed_;
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::chains::error", Range(0, rows.extent(0) / kVertexDofs),
      KOKKOS_LAMBDA(int v, double& m) {
        double left[kVertexDofs], size[kVertexDofs];
        for (int r = 0; r < kVertexDofs; ++r) {
          left[r] = eliminated(v) != 0 ? rows(vertex_row(v, r)) : run_forces(vertex_row(v, r));
          size[r] = left[r] < 0.0 ? -left[r] : left[r];
        }
        for (int a = adjacency.start(v); a < adjacency.start(v + 1); ++a) {
          const int e = adjacency.element(a, 0), end = adjacency.element(a, 1);
          if (condensed(e) == 0) continue;
          const double* at[2] = {&values(vertex_row(ends(e, 0), 0)), &values(vertex_row(ends(e, 1), 0))};
          if (links.keeps_symmetric_elements())
            subtract_symmetric(&links.elements(e, 0), end, at, sizes, left, size);
          else
            subtract_full(&links.elements(e, 0), end, at, sizes, left, size);
        }
        for (int r = 0; r < kVertexDofs; ++r) {
          const double absolute = left[r] < 0.0 ? -left[r] : left[r];
          const double error = absolute == 0.0 ? 0.0 : absolute / size[r];
          if (!(error <= m)) m = error == error ? error : HUGE_VAL;
          if (residual.extent(0) > 0) residual(vertex_row(v, r)) = eliminated(v) != 0 ? left[r] : 0.0;
        }
      },
      Kokkos::Max<double>(largest));
  return maximum_over_ranks(comm, largest);
}

}  // namespace mixbeam
