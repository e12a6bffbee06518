#include "discretization/assembly/model.hpp"

#include "discretization/assembly/workspace.hpp"
#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "discretization/mesh/row_lists.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace mixbeam {

namespace {

Conditions following(const std::shared_ptr<const LoadClock>& clock, Conditions conditions) {
  if (!clock->have_formulas()) return conditions;
  for (VertexSupport& support : conditions.supports) support.amplitude.follow(clock);
  return conditions;
}

}  // namespace

Model::Model(std::shared_ptr<const Scene> scene, const Communicator& comm, const ModelOptions& options)
    : scene_(std::move(scene)),
      mesh_(build_mesh(*scene_)),
      structure_(build_structure(*scene_, mesh_, comm->getRank(), comm->getSize())),
      clock_(std::make_shared<LoadClock>(*scene_)),
      line_fields_(*scene_, mesh_, structure_),
      conditions_(following(clock_, build_conditions(*scene_, mesh_, structure_))),
      constraints_(conditions_),
      external_(external_energies(*scene_, mesh_, structure_, conditions_, clock_)),
      frame_(*scene_, clock_),
      rotating_(rotating_elements(*scene_, mesh_, structure_, frame_)),
      options_(options),
      workspace_(std::make_unique<Workspace>()) {
  PhaseTimer timer(times_, "setup");
  if (clock_->have_formulas()) line_fields_.follow(clock_);
  std::vector<double>& least = structure_.least_compliance;
  const std::vector<double> mine = least;
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_MIN, static_cast<int>(mine.size()), mine.data(), least.data());
  workspace_->rows = allocate_rows(structure_);
  build_maps(comm);
  fixed_ = KernelView<unsigned char*>("mixbeam::fixed", static_cast<size_t>(kVertexDofs) * structure_.owned_vertices);
  constraints_.mark_fixed(fixed_);
  mark_owned_interior();
  build_adjacency();
  build_plane();
  keep_own_mesh();
}

Model::~Model() = default;

namespace {

/// Numbers of the local vertices in the order of the ranks; ghosts get theirs from their owners. Collective.
std::vector<GlobalOrdinal> numbers_through_ranks(const Structure& structure, const Communicator& comm) {
  const auto unknown = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  const std::vector<GlobalOrdinal> in_mesh(structure.local_vertex_to_global.begin(),
                                           structure.local_vertex_to_global.end());
  if (structure.partition.is_contiguous()) return in_mesh;
  const auto all = Teuchos::arrayViewFromVector(in_mesh);
  const auto owned = Teuchos::rcp(new DofMap(unknown, all.view(0, structure.owned_vertices), 0, comm));
  const auto local = Teuchos::rcp(new DofMap(unknown, all, 0, comm));
  const DofMap ranks(unknown, static_cast<size_t>(structure.owned_vertices), 0, comm);
  DofVector mine(owned), known(local);
  const KernelView<double*> numbers = MixedVector::view_of(mine);
  for (size_t v = 0; v < numbers.extent(0); ++v)
    numbers(v) = static_cast<double>(ranks.getGlobalElement(static_cast<LocalOrdinal>(v)));
  known.doImport(mine, DofImport(owned, local), Tpetra::REPLACE);
  const KernelView<const double*> found = MixedVector::view_of(std::as_const(known));
  std::vector<GlobalOrdinal> result(found.extent(0));
  for (size_t v = 0; v < result.size(); ++v) result[v] = static_cast<GlobalOrdinal>(found(v));
  return result;
}

}  // namespace

// Tpetra stores few bytes for consecutive numbers, and 80 for each other one: those of a rank are consecutive.
void Model::build_maps(const Communicator& comm) {
  const size_t owned = static_cast<size_t>(kVertexDofs) * structure_.owned_vertices;
  const auto all = static_cast<Tpetra::global_size_t>(kVertexDofs) * mesh_.vertices();
  maps_.rows = Teuchos::rcp(new DofMap(all, owned, 0, comm));
  maps_.columns = maps_.rows;
  if (comm->getSize() == 1) return;
  std::vector<GlobalOrdinal> dofs;
  for (const GlobalOrdinal vertex : numbers_through_ranks(structure_, comm))
    for (int c = 0; c < kVertexDofs; ++c) dofs.push_back(kVertexDofs * vertex + c);
  const auto unknown = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  maps_.columns = Teuchos::rcp(new DofMap(unknown, Teuchos::arrayViewFromVector(dofs), 0, comm));
  maps_.import = Teuchos::rcp(new DofImport(maps_.rows, maps_.columns));
  workspace_->ghosted_increment = Teuchos::rcp(new DofVector(maps_.columns));
}

std::shared_ptr<const Mesh> Model::whole_mesh() const {
  if (mesh_.elements.is_whole()) return {std::shared_ptr<const Mesh>(), &mesh_};
  return std::make_shared<const Mesh>(build_mesh(*scene_));
}

void Model::keep_own_mesh() {
  if (maps_.import.is_null()) return;
  std::vector<int> vertices = structure_.local_vertex_to_global, elements = structure_.local_element_to_mesh;
  std::sort(vertices.begin(), vertices.end());
  std::sort(elements.begin(), elements.end());
  mesh_.keep(std::move(vertices), std::move(elements));
}

void Model::mark_owned_interior() {
  if (maps_.import.is_null()) return;  // one rank owns everything
  owned_interior_ = KernelView<unsigned char*>("mixbeam::owned_interior", structure_.increment_size);
  for_each_element(structure_, [&](const ElementView& element) {
    std::fill_n(element.increments_in(owned_interior_), element.layout().increments(), element.is_owned());
  });
}

void Model::build_adjacency() {
  using ElementEnd = std::array<int, 2>;
  const RowLists<ElementEnd> lists = row_lists<ElementEnd>(structure_.owned_vertices, [&](const auto& add) {
    const ElementBlock* block = structure_.blocks.data();  // a rank may have none
    for (int element : structure_.elements_in_order) {
      if (element < block->first_element || element >= block->first_element + block->count)
        block = &structure_.block_of(element);
      for (int end = 0; end < 2; ++end) {
        const int vertex = block->vertices(element - block->first_element, end);
        if (vertex < structure_.owned_vertices) add(vertex, {element, end});
      }
    }
  });
  adjacency_.start = KernelView<int*>("mixbeam::adjacency_start", lists.start.size());
  std::copy(lists.start.begin(), lists.start.end(), adjacency_.start.data());
  adjacency_.element = KernelView<int* [2]>("mixbeam::adjacency", lists.entries.size());
  for (size_t i = 0; i < lists.entries.size(); ++i) std::copy_n(lists.entries[i].data(), 2, &adjacency_.element(i, 0));
}

MixedVector Model::create_vector() const {
  return MixedVector(maps_.rows, structure_.increment_size, owned_interior_, vectors_);
}

KernelView<const double* [6]> Model::local_increment(const MixedVector& increment) const {
  const DofVector* source = &increment.vertex_dofs();
  if (!maps_.import.is_null()) {
    workspace_->ghosted_increment->doImport(*source, *maps_.import, Tpetra::REPLACE);
    source = workspace_->ghosted_increment.get();
  }
  const KernelView<const double*> flat = MixedVector::view_of(*source);
  return KernelView<const double* [6]>(flat.data(), flat.extent(0) / kVertexDofs);
}

State Model::apply(const State& from, const MixedVector& increment, double step) const {
  PhaseTimer timer(times_, "update");
  State to = allocate_state(structure_);
  const KernelView<const double* [6]> d = local_increment(increment);
  apply_vertex_increment(structure_.local_vertices(), from.views, d, step, to.views);
  for (const ElementBlock& block : structure_.blocks)
    apply_interior_increment(block, from.views, increment.interior(), step, to.views);
  to.in_plane = from.in_plane && is_in_plane(increment);
  constraints_.follow(from, to);
  return to;
}

VertexMatrix whole_matrix(const Model& model) {
  std::vector<RemainingLink> elements;
  for_each_element(model.structure(), [&](const ElementView& element) {
    elements.push_back({element.local(), element.local(), {element.vertex(0), element.vertex(1)}});
  });
  const std::vector<unsigned char> all(model.structure().local_vertices(), 1);
  return VertexMatrix(model.structure(), model.vertex_maps(), all, std::move(elements), model.conditions().joints);
}

State Model::reference_state() const {
  State state = mixbeam::reference_state(structure_, mesh_);
  state.in_plane = plane_.has_value();
  state.turns.assign(constraints_.counted_angles(), 0);
  return state;
}

namespace {

/// Relative to the length of the structure, to the load or to one: rounding of positions and triads computed from
/// curves, with some margin. Larger distances from the plane are intended.
constexpr double kInPlane = 1e-12;
/// Components of a normal below this are rounding: coordinate planes then have exact zeros.
constexpr double kNoComponent = 1e-15;

Vec without_rounding(Vec v) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(v[i]) < kNoComponent) v[i] = 0.0;
  return (1.0 / norm(v)) * v;
}

Vec column(const Mat& m, int j) { return {{m(0, j), m(1, j), m(2, j)}}; }
Vec row(const Mat& m, int i) { return {{m(i, 0), m(i, 1), m(i, 2)}}; }

/// Chooses p as the projection of the coordinate axis closest to the plane.
PlaneAxes axes_of(const Vec& normal) {
  PlaneAxes axes;
  axes.n = without_rounding(normal);
  int most = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(axes.n[i]) < std::abs(axes.n[most])) most = i;
  Vec p{{0.0, 0.0, 0.0}};
  p[most] = 1.0;
  axes.p = without_rounding(p - axes.n[most] * axes.n);
  axes.q = cross(axes.n, axes.p);
  return axes;
}

class PlaneCheck {
 public:
  explicit PlaneCheck(const Vec& normal) : n_(normal) {}

  bool holds(const Mesh& mesh, double length) const {
    const Vec origin = position(mesh, 0);
    for (int v = 0; v < mesh.vertices(); ++v)
      if (!is_small(dot(position(mesh, v) - origin, n_), length)) return false;
    return true;
  }
  bool holds(const ElementBlock& block) const {
    if (block.general_section || block.force_integration != ForceIntegration::both_reduced) return false;
    for (int e = 0; e < block.count; ++e)
      if (!holds(block, e)) return false;
    return true;
  }
  bool holds(const std::unique_ptr<const ExternalEnergy>& energy) const { return energy->keeps_in_plane(n_, kInPlane); }
  bool holds(const VertexSupport& support) const {
    const bool* fixed = support.fixed;
    Vec displacement{{0.0, 0.0, 0.0}};
    for (int i = 0; i < 3; ++i)
      if (fixed[i]) displacement += support.displacement[i] * row(support.axes, i);
    if (!in_plane(displacement) || !along_normal(support.rotation)) return false;
    return aligned(support.axes) ||
           (uniform(fixed, support.displacement_stiffness) && uniform(fixed + 3, support.rotation_stiffness));
  }
  bool holds(const VertexJoint& joint) const {
    const Vec axis = row(joint.frame, 2);
    return joint.kind == JointKind::ball || in_plane(axis) || along_normal(axis);
  }

 private:
  Vec n_;

  static bool is_small(double x, double against) { return std::abs(x) <= kInPlane * against; }
  bool in_plane(const Vec& v) const { return is_small(dot(v, n_), norm(v)); }
  bool along_normal(const Vec& v) const { return is_small(norm(cross(v, n_)), norm(v)); }
  /// One of the axes is normal to the plane.
  bool aligned(const Mat& axes) const {
    return along_normal(row(axes, 0)) || along_normal(row(axes, 1)) || along_normal(row(axes, 2));
  }
  /// True if all directions have the same condition and stiffness.
  static bool uniform(const bool* fixed, const Vec& stiffness) {
    return fixed[0] == fixed[1] && fixed[1] == fixed[2] && stiffness[0] == stiffness[1] && stiffness[1] == stiffness[2];
  }
  static Vec position(const Mesh& mesh, int v) { return vector_algebra::to_vec3(mesh.vertex_position[v]); }
  /// Checks triads and tangents; curvatures, as angles, must be along the normal one of g2 and g3.
  bool holds(const ElementBlock& block, int e) const {
    const double* reference = &block.reference(e, 0);
    const ReferenceLayout& layout = block.reference_layout;
    int normal = 0;
    for (int end = 0; end < 2; ++end) {
      const Mat triad = rotation_matrix(load_quaternion(reference + layout.end_triad(end)));
      const int found = along_normal(column(triad, 1)) ? 1 : along_normal(column(triad, 2)) ? 2 : 0;
      if (found == 0 || (end == 1 && found != normal)) return false;
      normal = found;
    }
    for (int q = 0; q < layout.force_points; ++q)
      if (!in_plane(load_vector(reference + layout.tangent(q)))) return false;
    for (int q = 0; q <= layout.order; ++q) {
      const double* curvature = reference + layout.curvature(q);
      for (int other : {0, 3 - normal})
        if (!is_small(reference[layout.length()] * curvature[other], 1.0)) return false;
    }
    return true;
  }
};

bool keeps_to(const Vec& normal, const Mesh& mesh, const Structure& structure, const LineFields& line_fields,
              const Conditions& conditions, const ExternalEnergies& external) {
  const PlaneCheck check(normal);
  const auto all = [&](const auto& list) {
    return std::all_of(list.begin(), list.end(), [&](const auto& one) { return check.holds(one); });
  };
  return all(external) && all(conditions.supports) && all(conditions.joints) && all(structure.blocks) &&
         line_fields.keep_in_plane(structure, normal, kInPlane) && check.holds(mesh, structure.length);
}

/// Plane of the whole scene, with the normal along g2 or g3 of the first element, or none. Members lie in it and have
/// g2 or g3 along its normal; forces and prescribed displacements are in it, moments and prescribed rotations about its
/// normal, axes of supports and joints in it or along its normal; line loads and eigenstrains keep members in it.
/// Sections are plain and constant, force strains integrated with k points. Collective.
std::optional<PlaneAxes> plane_of(const Teuchos::Comm<int>& comm, const Mesh& mesh, const Structure& structure,
                                  const LineFields& line_fields, const Conditions& conditions,
                                  const ExternalEnergies& external) {
  const MeshElement& first = mesh.elements[0];
  const Mat triad = rotation_matrix(
      make_reference_element(mesh.member_of(first), first.index, 1, ForceIntegration::both_reduced).end_triad[0]);
  for (int axis : {2, 1}) {
    const PlaneAxes axes = axes_of(column(triad, axis));
    const int mine = keeps_to(axes.n, mesh, structure, line_fields, conditions, external) ? 1 : 0;
    int everywhere = mine;
    Teuchos::reduceAll(comm, Teuchos::REDUCE_MIN, mine, Teuchos::outArg(everywhere));
    if (everywhere != 0) return axes;
  }
  return std::nullopt;
}

/// Relative to the largest entry: rounding of directions in a plane other than the coordinate planes.
constexpr double kPlaneRounding = 1e-13;

}  // namespace

void Model::build_plane() {
  if (!scene_->rotating_frames.empty()) return;  // rotating frames have no planar tangent
  plane_of_scene_ = plane_of(*maps_.rows->getComm(), mesh_, structure_, line_fields_, conditions_, external_);
  if (!options_.planar || !plane_of_scene_ || !line_fields_.have_planar_equations()) return;
  plane_ = plane_of_scene_;
  for (const ElementBlock& block : structure_.blocks) planar_blocks_.push_back(make_planar_block(block, *plane_));
  workspace_->rows.planar_rows = KernelView<double* [4]>(
      Kokkos::view_alloc("mixbeam::planar::rows", Kokkos::WithoutInitializing), structure_.local_elements());
  if (!line_fields_.empty())
    workspace_->rows.planar_loads = KernelView<double* [2]>("mixbeam::planar::loads", structure_.local_elements());
}

void Model::release_idle_arrays(bool tangents) const {
  vectors_->vertex.release_idle();
  vectors_->interior.release_idle();
  const auto is_idle = [](const auto& arrays) { return arrays.use_count() == 1; };
  auto& all = workspace_->tangents;
  if (tangents) all.erase(std::remove_if(all.begin(), all.end(), is_idle), all.end());
}

/// Checks vertices only: an element that leaves the plane takes a vertex with it, unless all are held.
bool Model::is_in_plane(const MixedVector& v) const {
  const PlaneAxes axes = *plane_;
  const KernelView<const double*> entries = v.vertex();
  // largest displacement and rotation, and their out-of-plane parts
  Largest<4> parts = largest_of<4>(
      "mixbeam::plane::parts", structure_.owned_vertices, KOKKOS_LAMBDA(int vertex, Largest<4>& largest) {
        const Vec moved = load_vector(&entries(vertex_row(vertex, kForcePart)));
        const Vec turned = load_vector(&entries(vertex_row(vertex, kMomentPart)));
        for (int i = 0; i < 3; ++i) {
          raise(largest.of[0], moved[i]);
          raise(largest.of[1], turned[i]);
        }
        raise(largest.of[2], dot(axes.n, moved));
        raise(largest.of[3], dot(axes.p, turned));
        raise(largest.of[3], dot(axes.q, turned));
      });
  maxima_over_ranks(*maps_.rows->getComm(), parts.of, 4);
  const double* all = parts.of;
  return all[2] <= kPlaneRounding * all[0] && all[3] <= kPlaneRounding * all[1] && std::isfinite(all[2] + all[3]);
}

}  // namespace mixbeam
