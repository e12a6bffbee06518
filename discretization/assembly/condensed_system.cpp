#include "discretization/assembly/condensed_system.hpp"

#include "discretization/mesh/element_view.hpp"

#include <algorithm>

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

ChainPlaces places_of(const Structure& structure, const ChainStructure& chains) {
  const int elements = structure.local_elements(), vertices = structure.local_vertices();
  ChainPlaces places{KernelView<int* [2]>("mixbeam::ends", elements),
                     KernelView<unsigned char*>("mixbeam::eliminated", vertices),
                     KernelView<unsigned char*>("mixbeam::condensed", elements)};
  for_each_element(structure, [&](const ElementView& element) {
    for (int end = 0; end < 2; ++end) places.ends(element.local(), end) = element.vertex(end);
  });
  std::copy(chains.eliminated().begin(), chains.eliminated().end(), places.eliminated.data());
  std::fill_n(places.condensed.data(), elements, 1);
  for (const RemainingLink& link : chains.remaining())
    if (link.link < elements) places.condensed(link.link) = 0;
  return places;
}

/// Vertices that must not be eliminated for another reason than that members meet there.
std::vector<unsigned char> kept_vertices(const Model& model) {
  const Structure& structure = model.structure();
  std::vector<unsigned char> kept(structure.local_vertices(), 0);
  const int owned = structure.owned_vertices;
  for (size_t v = owned; v < kept.size(); ++v) kept[v] = 1;
  for (const auto& energy : model.external())
    for (const int vertex : energy->vertices()) kept[vertex] = 1;
  for (const VertexSupport& support : model.conditions().supports) kept[support.vertex] = 1;
  for (const VertexJoint& joint : model.conditions().joints) kept[joint.master] = kept[joint.slave] = 1;
  for_each_element(structure, [&](const ElementView& element) {
    const int a = element.vertex(0), b = element.vertex(1);
    if (a >= owned || b >= owned || element.block().is_unsymmetric(element.index())) kept[a] = kept[b] = 1;
  });
  return kept;
}

}  // namespace

CondensedSystem::CondensedSystem(const Model& model)
    : model_(model),
      structure_(ends_of(model.structure()), kept_vertices(model)),
      places_(places_of(model.structure(), structure_)),
      chains_(structure_.levels()) {
  if (model.plane()) planar_chains_ = std::make_unique<PlanarChains>(model, structure_, places_);
  const Structure& structure = model.structure();
  std::vector<unsigned char> present = structure_.eliminated();
  for (unsigned char& p : present) p = p == 0 ? 1 : 0;
  remaining_ = std::make_unique<VertexMatrix>(structure, model.vertex_maps(), present, structure_.remaining(),
                                              model.conditions().joints);
  // written at the few vertices that remain: untouched pages cost nothing
  run_forces_ = KernelView<double*>(Kokkos::view_alloc("mixbeam::run_forces", Kokkos::WithoutInitializing),
                                    static_cast<size_t>(kVertexDofs) * structure.owned_vertices);
}

bool CondensedSystem::condense(const Tangent& tangent) {
  tangent_ = &tangent;
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
      note(chains_.factorize(tangents));
  }
  PhaseTimer timer(model_.times(), "assemble");
  tangent.gather(*remaining_, link_matrices());
  return smallest >= kSmallestPivot;
}

LinkMatrices<kSpatialDofs> CondensedSystem::link_matrices() const {
  return planar_ != nullptr ? planar_->remaining() : chains_.matrices(tangent_->elements().condensed_tangent);
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
  const auto eliminated = places_.eliminated;
  const auto given = KOKKOS_LAMBDA(int v, double* row) {
    const double* from = eliminated(v) != 0 ? &rows(vertex_row(v, 0)) : &run_forces(vertex_row(v, 0));
    for (int r = 0; r < kVertexDofs; ++r) row[r] = from[r];
  };
  const auto store = KOKKOS_LAMBDA(int v, const double* left) {
    for (int r = 0; r < kVertexDofs && residual.extent(0) > 0; ++r) residual(vertex_row(v, r)) = left[r];
  };
  return maximum_over_ranks(
      comm, error_of_chains<kSpatialDofs>(model_, places_, links.elements, values, sizes, given, store));
}

}  // namespace mixbeam
