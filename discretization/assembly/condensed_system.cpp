#include "discretization/assembly/condensed_system.hpp"

#include "discretization/mesh/element_view.hpp"
#include "kernels/execution/pack.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

/// Relative pivot at which the rounding of a solve leaves six digits. The check of the residual decides; this only
/// saves the attempt.
constexpr double kSmallestPivot = 1e-10;

std::vector<std::array<int, 2>> ends_of(const Structure& structure) {
  std::vector<std::array<int, 2>> ends(structure.local_elements());
  for_each_element(structure, [&](const ElementView& element) {
    ends[element.local()] = {element.vertex(0), element.vertex(1)};
  });
  return ends;
}

/// True if any rank has elements without a potential. Collective.
bool has_unsymmetric_elements(const Model& model) {
  bool found = false;
  for_each_element(model.structure(), [&](const ElementView& element) {
    found = found || element.block().is_unsymmetric(element.index());
  });
  return maximum_over_ranks(*model.map()->getComm(), found ? 1.0 : 0.0) != 0.0;
}

/// Marks vertices that must not be eliminated for reasons other than that members meet there.
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

/// Components (p, q, theta) of six spatial ones, or the latter unchanged.
template <int N>
KOKKOS_INLINE_FUNCTION void from_space(const PlaneAxes& axes, const double* spatial, double* own) {
  const Vec moved = load_vector(spatial), turned = load_vector(spatial + 3);
  if constexpr (N == kPlanarDofs) {
    own[0] = dot(axes.p, moved);
    own[1] = dot(axes.q, moved);
    own[2] = dot(axes.n, turned);
  } else {
    store_vector(moved, own);
    store_vector(turned, own + 3);
  }
}
template <int N>
KOKKOS_INLINE_FUNCTION void to_space(const PlaneAxes& axes, const double* own, double* spatial) {
  store_vector(N == kPlanarDofs ? own[0] * axes.p + own[1] * axes.q : load_vector(own), spatial);
  store_vector(N == kPlanarDofs ? own[2] * axes.n : load_vector(own + N - 3), spatial + 3);
}

using Real = Pack<kLanes>;

/// One element at each of kLanes vertices: its tangent, the unknowns of its ends, and the end that is the vertex. Lanes
/// without an element, or with one that is in no condensed chain, are inactive.
struct ElementsAtVertices {
  const double *tangent[kLanes], *start[kLanes], *end[kLanes];
  Real::Mask active, ends_here;
};

/// Subtracts forces and moments of elements at vertices from `left`, and adds the sum of |entry| times the largest
/// unknown of its kind to `size`. Tangents are kSymmetric numbers of their layout.
template <int N>
KOKKOS_INLINE_FUNCTION void subtract_symmetric(const ElementsAtVertices& elements, const LargestParts& sizes,
                                               Real* left, Real* size) {
  using Layout = TangentLayout<N>;
  Real k[Layout::kSymmetric], a[N], b[N], change[Layout::kReduced];
  gather_lanes(elements.tangent, Layout::kSymmetric, k);
  gather_lanes(elements.start, N, a);
  gather_lanes(elements.end, N, b);
  for (int c = 0; c < Layout::kMoved; ++c) change[c] = b[c] - a[c];
  for (int c = Layout::kMoved; c < N; ++c) change[c] = a[c], change[c + Layout::kTurned] = b[c];
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
/// Same for full tangents.
template <int N>
KOKKOS_INLINE_FUNCTION void subtract_full(const ElementsAtVertices& elements, const LargestParts& sizes, Real* left,
                                          Real* size) {
  using Layout = TangentLayout<N>;
  Real k[Layout::kFull / 2], at[2 * N];
  const double* rows[kLanes];
  for (int lane = 0; lane < kLanes; ++lane)
    rows[lane] = elements.tangent[lane] + (elements.ends_here[lane] != 0 ? Layout::kFull / 2 : 0);
  gather_lanes(rows, Layout::kFull / 2, k);
  gather_lanes(elements.start, N, at);
  gather_lanes(elements.end, N, at + N);
  for (int r = 0; r < N; ++r) {
    Real force = 0.0, bound = 0.0;
    for (int c = 0; c < 2 * N; ++c) {
      const Real& entry = k[2 * N * r + c];
      force += entry * at[c];
      bound += fabs(entry) * (c % N < Layout::kMoved ? sizes.moved : sizes.turned);
    }
    left[r] -= select(elements.active, force, Real(0.0));
    size[r] += select(elements.active, bound, Real(0.0));
  }
}

/// Measures the residual of a solve in the rows of chains, over N unknowns per vertex. Index: pack of vertices.
template <int N>
struct ChainErrorLoop {
  int count;
  PlaneAxes axes;  ///< if planar
  LargestParts sizes;
  KernelView<const double**> tangents;
  Adjacency adjacency;
  KernelView<const int* [2]> ends;
  KernelView<const unsigned char*> eliminated, condensed;
  KernelView<const double*> rows, run_forces;  ///< (6 * vertex + component)
  KernelView<const double*> x;                 ///< (N * vertex + component)
  KernelView<double*> residual;                ///< (6 * vertex + component); empty: not needed

  double largest_error() const {
    double largest = 0.0;
    Kokkos::parallel_reduce("mixbeam::chains::error", Range(0, LaneRows::packs(count)), *this,
                            Kokkos::Max<double>(largest));
    return largest;
  }
  KOKKOS_INLINE_FUNCTION void operator()(int pack, double& worst) const {
    const LaneRows lanes(pack, count);
    fetch_elements(lanes);
    int most = 0;
    Real left[N], size[N];
    for (int lane = 0; lane < kLanes; ++lane) {
      const int v = lanes.row[lane];
      const int elements = adjacency.start(v + 1) - adjacency.start(v);
      most = elements > most ? elements : most;
      double given[N];
      from_space<N>(axes, eliminated(v) != 0 ? &rows(vertex_row(v, 0)) : &run_forces(vertex_row(v, 0)), given);
      for (int r = 0; r < N; ++r) left[r].set(lane, given[r]);
    }
    for (int r = 0; r < N; ++r) size[r] = fabs(left[r]);
    const bool is_full = tangents.extent(1) == TangentLayout<N>::kFull;
    for (int i = 0; i < most; ++i)
      if (is_full)
        subtract_full<N>(elements_at(lanes, i), sizes, left, size);
      else
        subtract_symmetric<N>(elements_at(lanes, i), sizes, left, size);
    for (int lane = 0; lane < lanes.active; ++lane) {
      double here[N];
      for (int r = 0; r < N; ++r) {
        raise(worst, left[r][lane] == 0.0 ? 0.0 : left[r][lane] / size[r][lane]);
        here[r] = eliminated(lanes.row[lane]) == 0 ? 0.0 : left[r][lane];
      }
      if (residual.extent(0) > 0) to_space<N>(axes, here, &residual(vertex_row(lanes.row[lane], 0)));
    }
  }
  /// Prefetches data of the next pack that this one does not use.
  KOKKOS_FORCEINLINE_FUNCTION void fetch_elements(const LaneRows& lanes) const {
    for (const int v : lanes.next) {
      const int entry = adjacency.start(v);
      if (entry < adjacency.start(v + 1))
        fetch(&tangents(adjacency.element(entry, 0), 0), static_cast<int>(tangents.extent(1)));
    }
  }
  /// The i-th element at each vertex.
  KOKKOS_INLINE_FUNCTION ElementsAtVertices elements_at(const LaneRows& lanes, int i) const {
    ElementsAtVertices found;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int entry = adjacency.start(lanes.row[lane]) + i;
      const bool exists = entry < adjacency.start(lanes.row[lane] + 1);
      const int e = exists ? adjacency.element(entry, 0) : 0;
      const bool is_active = exists && condensed(e) != 0;  // others may end at ghosts, of which x has no entries
      found.tangent[lane] = &tangents(e, 0);
      found.start[lane] = &x(static_cast<size_t>(N) * (is_active ? ends(e, 0) : lanes.row[lane]));
      found.end[lane] = &x(static_cast<size_t>(N) * (is_active ? ends(e, 1) : lanes.row[lane]));
      found.active[lane] = is_active ? -1 : 0;
      found.ends_here[lane] = exists && adjacency.element(entry, 1) == 1 ? -1 : 0;
    }
    return found;
  }
};

/// Expands a link over (u_p, u_q, theta) of both ends to six components each.
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

/// Chains of elements in a plane, with three unknowns per vertex. The remaining system is spatial again, so that
/// supports, joints and loads are independent of the plane.
class CondensedSystem::PlanarChains {
 public:
  /// Requires a model with a plane.
  PlanarChains(const Model& model, const ChainStructure& structure)
      : axes_(*model.plane()),
        vertices_(model.structure().owned_vertices),
        structure_(structure),
        chains_(structure.levels()),
        arrived_("mixbeam::planar::arrived", structure.levels().runs),
        x_("mixbeam::planar::x", static_cast<size_t>(kPlanarDofs) * model.structure().local_vertices()) {
    using Kokkos::view_alloc;
    using Kokkos::WithoutInitializing;
    // only remaining links are ever written: untouched pages cost nothing
    elements_ = KernelView<double**>(view_alloc("mixbeam::planar::elements", WithoutInitializing),
                                     structure.levels().elements, LinkMatrices<kSpatialDofs>::kFull);
    const KernelView<double* [144]> runs(view_alloc("mixbeam::planar::runs", WithoutInitializing),
                                         structure.levels().runs);
    remaining_ = {elements_, runs};
  }

  /// Eliminates the chains of a planar tangent, to which later calls refer, and writes the remaining links. With `rows`
  /// it also does condense_rows(rows, x).
  ChainCondensation<kPlanarDofs>::Pivots condense(const PlanarTangents& tangents,
                                                  const KernelView<const double*>& rows) {
    tangents_ = tangents;
    const bool has_rows = rows.extent(0) > 0;
    if (has_rows) take_from_space(rows, x_, {});
    const auto pivots =
        has_rows ? chains_.factorize(tangents_, ChainKind::symmetric, x_, x_) : chains_.factorize(tangents_);
    if (has_rows) write_arrived();
    const LinkMatrices<kPlanarDofs> links = chains_.matrices(tangents_);
    const int elements = structure_.levels().elements;
    for (const RemainingLink& remaining : structure_.remaining()) {
      const int link = remaining.link;
      double room[LinkMatrices<kPlanarDofs>::kFull];
      double* out = link < elements ? &elements_(link, 0) : &remaining_.runs(link - elements, 0);
      expand_link(axes_, links.full(link, room), out);
    }
    return pivots;
  }
  const PlanarTangents& tangents() const { return tangents_; }
  void release() {
    chains_.release();
    tangents_ = {};
  }
  const PlaneAxes& axes() const { return axes_; }
  /// Spatial matrices of the remaining links; the others are not set. Out-of-plane motions, which do no work, get
  /// springs as stiff as the links are in the plane.
  const LinkMatrices<kSpatialDofs>& remaining() const { return remaining_; }
  const KernelView<double* [12]>& arrived() const { return arrived_; }

  void condense_rows(const KernelView<const double*>& rows) {
    take_from_space(rows, x_, {});
    chains_.condense_rows(x_, x_);  // each row is read before its x is written
    write_arrived();
  }
  /// Computes all of x from its entries at vertices that are not eliminated.
  void expand(const KernelView<const unsigned char*>& eliminated, const KernelView<double*>& x) {
    take_from_space(x, x_, eliminated);
    chains_.expand(x_);
    const PlaneAxes axes = axes_;
    const KernelView<double*> planar = x_;
    Kokkos::parallel_for(
        "mixbeam::planar::expand", Range(0, vertices_),
        KOKKOS_LAMBDA(int v) { to_space<kPlanarDofs>(axes, &planar(planar_row(v)), &x(vertex_row(v, 0))); });
  }
  /// Returns x as (3 * vertex + component), in memory that is valid until the next solve.
  const KernelView<double*>& in_plane(const KernelView<const double*>& x) const {
    take_from_space(x, x_, {});
    return x_;
  }

 private:
  void write_arrived() const {
    for (const RemainingLink& remaining : structure_.remaining()) {
      const int run = remaining.link - structure_.levels().elements;
      for (int end = 0; run >= 0 && end < 2; ++end)
        to_space<kPlanarDofs>(axes_, &chains_.arrived()(run, kPlanarDofs * end), &arrived_(run, kVertexDofs * end));
    }
  }
  KOKKOS_INLINE_FUNCTION static size_t planar_row(int vertex) { return static_cast<size_t>(kPlanarDofs) * vertex; }
  /// Projects at owned vertices, except those marked in `left_out`, if it has entries.
  void take_from_space(const KernelView<const double*>& spatial, const KernelView<double*>& planar,
                       const KernelView<const unsigned char*>& left_out) const {
    const PlaneAxes axes = axes_;
    Kokkos::parallel_for(
        "mixbeam::planar::rows", Range(0, vertices_), KOKKOS_LAMBDA(int v) {
          if (left_out.extent(0) == 0 || left_out(v) == 0)
            from_space<kPlanarDofs>(axes, &spatial(vertex_row(v, 0)), &planar(planar_row(v)));
        });
  }

  PlaneAxes axes_;
  int vertices_;  ///< owned
  PlanarTangents tangents_;
  const ChainStructure& structure_;
  ChainCondensation<kPlanarDofs> chains_;
  LinkMatrices<kSpatialDofs> remaining_;
  KernelView<double**> elements_;  ///< matrices of remaining_
  KernelView<double* [12]> arrived_;
  KernelView<double*> x_;  ///< (3 * local vertex + component): rows, then solutions
};

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
  // written only at the few remaining vertices: untouched pages cost nothing
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

CondensedSystem::~CondensedSystem() = default;

const KernelView<double* [12]>& CondensedSystem::arrived() const {
  return planar_ != nullptr ? planar_->arrived() : chains_.arrived();
}

bool CondensedSystem::condense(const Tangent& tangent, bool symmetric_part,
                               const std::function<void(const MatrixRows&)>& add_more, const FirstSolve& first) {
  tangent_ = &tangent;
  first_ = first;
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
    KernelView<const double*> rows;
    KernelView<double*> half;
    if (first.b != nullptr) {
      rows = MixedVector::view_of(*first.b);
      half = MixedVector::view_of(*first.x);
    }
    const ChainKind kind = !is_unsymmetric_ ? ChainKind::symmetric
                           : symmetric_part ? ChainKind::symmetric_part
                                            : ChainKind::general;
    if (planar_ != nullptr)
      note(planar_->condense(tangent.planar_elements(), rows));
    else
      note(chains_.factorize(tangents, kind, rows, half));
  }
  PhaseTimer timer(model_.times(), "assemble");
  tangent.gather(*remaining_, link_matrices(), add_more);
  return smallest >= kSmallestPivot;
}

bool CondensedSystem::condense(const Tangent& tangent, const KernelView<const double**>& elements,
                               const std::function<void(const MatrixRows&)>& add_more) {
  tangent_ = &tangent;
  first_ = {};
  elements_ = elements;
  planar_ = nullptr;
  const auto pivots = chains_.factorize(elements, is_unsymmetric_ ? ChainKind::general : ChainKind::symmetric);
  negative_pivots_ = pivots.negative;
  tangent.gather(*remaining_, link_matrices(), add_more);
  return pivots.smallest >= kSmallestPivot;
}

void CondensedSystem::release() {
  first_ = {};
  chains_.release();
  if (planar_chains_ != nullptr) planar_chains_->release();
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
  const FirstSolve condensed = std::exchange(first_, {});
  if (condensed.b != &b || condensed.x != &x) {
    if (planar_ != nullptr)
      planar_->condense_rows(rows);
    else
      chains_.condense_rows(rows, half);
  }
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
    planar_->expand(eliminated_, to);
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
  const int vertices = model_.structure().owned_vertices;
  if (planar_ != nullptr) {
    const ChainErrorLoop<kPlanarDofs> loop{
        vertices,    planar_->axes(), sizes, planar_->tangents(), model_.adjacency(),        ends_,
        eliminated_, condensed_,      rows,  run_forces,          planar_->in_plane(values), residual};
    return maximum_over_ranks(comm, loop.largest_error());
  }
  const ChainErrorLoop<kSpatialDofs> loop{vertices, {},          sizes,      links.elements, model_.adjacency(),
                                          ends_,    eliminated_, condensed_, rows,           run_forces,
                                          values,   residual};
  return maximum_over_ranks(comm, loop.largest_error());
}

}  // namespace mixbeam
