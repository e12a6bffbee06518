#include "discretization/state/sampling.hpp"

#include "discretization/state/element_polynomials.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace mixbeam {

namespace {

/// (gamma, kappa) = S (N, M)
void set_strains(const Matrix6& compliance, PointSample& sample) {
  sample.force_strain = sample.moment_strain = Vec{{0.0, 0.0, 0.0}};
  for (int i = 0; i < 6; ++i) {
    double& strain = i < 3 ? sample.force_strain[i] : sample.moment_strain[i - 3];
    for (int j = 0; j < 3; ++j) strain += compliance[i][j] * sample.force[j] + compliance[i][3 + j] * sample.moment[j];
  }
}

static_assert(sizeof(PointSample) == 26 * sizeof(double), "PointSample is sent as an array of doubles");

/// Each sample is nonzero on one rank only.
void sum_samples_over_ranks(const Teuchos::Comm<int>& comm, PointSample* samples, size_t count) {
  sum_over_ranks(comm, reinterpret_cast<double*>(samples), sizeof(PointSample) / sizeof(double) * count);
}

}  // namespace

bool answers_for(const Structure& structure, int mesh_element) {
  const int local = structure.local_element(mesh_element);
  if (local < 0) return false;
  const ElementBlock& block = structure.block_of(local);
  return ElementView(structure, block, local - block.first_element).is_owned();
}

namespace {

/// Displacement by theory (8), from the displacements of both vertices and the bubbles of degree 1 and higher.
Vec displacement_at(const ElementView& view, double xi, const Vec& first, const Vec& second, const double* bubbles) {
  Vec displacement = (0.5 * (1.0 - xi)) * first + (0.5 * (1.0 + xi)) * second;
  double B[kMaximumOrder + 1];
  integrated_legendre(view.order(), xi, B);
  for (int j = 1; j < view.order(); ++j)
    displacement += (0.5 * view.length() * B[j]) * load_vector(bubbles + 3 * (j - 1));
  return displacement;
}

}  // namespace

PointSample sample_element(const Structure& structure, const Mesh& mesh, const State& state, int local_element,
                           double xi, ForceComponents components) {
  const ElementView view(structure, state, local_element);
  const int k = view.order();
  const MeshElement& element = mesh.elements[view.mesh_element()];
  const MeshMember& member = mesh.members[element.member];
  PointSample sample;
  sample.arc_length = mesh.arc_length(element, xi);
  sample.reference_position = member.curve.position(sample.arc_length);
  sample.displacement =
      displacement_at(view, xi, view.displacement(0), view.displacement(1), view.unknowns() + view.layout().bubble(1));
  double P[kMaximumOrder + 1];
  legendre(k, xi, P);
  sample.position = sample.reference_position + sample.displacement;
  sample.triad = view.triad() * exp_quaternion(view.relative_rotation_at(P));
  sample.force = components == ForceComponents::material ? force_at(view, xi) : force_through_space_at(view, xi);
  sample.moment = view.moment_at(P);
  set_strains(structure, mesh, local_element, sample);
  return sample;
}

void set_strains(const Structure& structure, const Mesh& mesh, int local_element, PointSample& sample) {
  const ElementView view(structure, State{}, local_element);
  if (view.block().general_section) {
    const int member = structure.member_of(mesh, local_element);
    const double x = sample.arc_length / mesh.members[member].curve.length;
    set_strains(structure.member_laws[member]->compliance(x), sample);
    return;
  }
  const SectionConstants& section = view.section();
  for (int i = 0; i < 3; ++i) {
    sample.force_strain[i] = section.force_compliance[i] * sample.force[i];
    sample.moment_strain[i] = section.moment_compliance[i] * sample.moment[i];
  }
}

namespace {

/// Share of a member within which a place counts as a vertex: positions are written with few digits.
constexpr double kAtVertex = 1e-9;

/// Element of a member that contains a place; at a vertex the one behind it, or the one before it.
int element_at(const MeshMember& member, double s, bool before_vertex) {
  return member.element_behind(s + kAtVertex * member.curve.length * (before_vertex ? -1.0 : 1.0));
}

}  // namespace

bool answers_for(const Model& model, int member, double position, bool before_vertex) {
  const Mesh& mesh = model.mesh();
  if (!mesh.members.keeps(member)) return false;
  const MeshMember& m = mesh.members[member];
  return answers_for(model.structure(), m.first_element + element_at(m, position * m.curve.length, before_vertex));
}

std::optional<PlaceInElement> place_in_element(const Model& model, int member, double position, bool before_vertex) {
  if (!answers_for(model, member, position, before_vertex)) return {};
  const MeshMember& m = model.mesh().members[member];
  const double s = position * m.curve.length;
  const int index = element_at(m, s, before_vertex);
  const double xi = std::clamp(-1.0 + 2.0 * (s - m.vertex_arc_length(index)) / m.element_length(index), -1.0, 1.0);
  return PlaceInElement{model.structure().local_element(m.first_element + index), xi};
}

PointSample sample_member(const Model& model, const State& state, int member, double position, bool before_vertex,
                          ForceComponents components) {
  PointSample sample{};
  if (const auto place = place_in_element(model, member, position, before_vertex))
    sample = sample_element(model.structure(), model.mesh(), state, place->local_element, place->xi, components);
  sum_samples_over_ranks(*model.map()->getComm(), &sample, 1);
  return sample;
}

double deformed_length(const Model& model, const State& state, int member) {
  const Structure& structure = model.structure();
  const Mesh& mesh = model.mesh();
  double xi[kPointsOfLength], weight[kPointsOfLength], mine = 0.0;
  gauss_rule(kPointsOfLength, xi, weight);
  for (int e = 0; e < mesh.elements_of(member) && mesh.members.keeps(member); ++e) {
    const MeshMember& m = mesh.members[member];
    if (!answers_for(structure, m.first_element + e)) continue;
    const ElementView view(structure, state, structure.local_element(m.first_element + e));
    const double h = view.length();
    for (int q = 0; q < kPointsOfLength; ++q) {
      double P[kMaximumOrder + 1];
      legendre(view.order(), xi[q], P);
      Vec slope = m.curve.tangent(m.arc_length(e, xi[q])) + (1.0 / h) * (view.displacement(1) - view.displacement(0));
      for (int j = 1; j < view.order(); ++j) slope += P[j] * view.bubble(j);
      mine += 0.5 * h * weight[q] * std::sqrt(dot(slope, slope));
    }
  }
  return sum_over_ranks(*model.map()->getComm(), mine);
}

int smooth_points(int order) {
  constexpr int kFewestPoints = 5;  // a quarter of a radian per chord if an element rotates by one radian
  return std::max(kFewestPoints, 2 * order + 1);
}

int recorded_points(int order, int elements) {
  constexpr int kChordsOfMember = 1000;  // 50 per turn of a coil of twenty: chords within 2e-3 of its radius
  return std::clamp(1 + (kChordsOfMember + elements - 1) / elements, 2, smooth_points(order));
}

namespace {

/// Number of samples per element of each member.
class SamplePlan {
 public:
  SamplePlan(const Scene& scene, const Mesh& mesh, int points_per_element)
      : scene_(scene), mesh_(mesh), of_each_(points_per_element) {
    if (of_each_ != kPointsByOrder) return;
    size_t smooth = 0;
    for (size_t m = 0; m < scene.members.size(); ++m) smooth += samples(static_cast<int>(m));
    if (smooth > kMostSmoothSamples) of_each_ = 2;
  }
  int points(int member) const {
    return of_each_ != kPointsByOrder ? of_each_
                                      : recorded_points(scene_.members[member].order, mesh_.elements_of(member));
  }
  size_t samples(int member) const { return static_cast<size_t>(points(member)) * mesh_.elements_of(member); }
  SampledMember description(int member) const {
    SampledMember described;
    described.name = scene_.members[member].name;
    described.order = scene_.members[member].order;
    described.elements = mesh_.elements_of(member);
    described.points_per_element = points(member);
    described.share.rows = samples(member);
    return described;
  }

 private:
  const Scene& scene_;
  const Mesh& mesh_;
  int of_each_;
};

void put(const PointSample& sample, int element, size_t place, MemberSamples& member) {
  member.arc_length[place] = sample.arc_length;
  member.element[place] = element;
  member.reference_position[place] = vector_algebra::to_array(sample.reference_position);
  member.position[place] = vector_algebra::to_array(sample.position);
  member.displacement[place] = vector_algebra::to_array(sample.displacement);
  member.triad[place] = {sample.triad.w, sample.triad.x, sample.triad.y, sample.triad.z};
  member.force_strain[place] = vector_algebra::to_array(sample.force_strain);
  member.moment_strain[place] = vector_algebra::to_array(sample.moment_strain);
  member.material_force[place] = vector_algebra::to_array(sample.force);
  member.material_moment[place] = vector_algebra::to_array(sample.moment);
}

/// Coordinate xi of one of `points` equidistant points along an element.
double sample_point(size_t point, size_t points) {
  return -1.0 + 2.0 * static_cast<double>(point) / static_cast<double>(points - 1);
}

/// Samples of the elements of one member, `first` the number of its first element in the mesh.
MemberSamples sampled(const Model& model, const State& state, const SampledMember& described, int first,
                      const std::vector<int>& local_elements) {
  const Structure& structure = model.structure();
  const size_t points = described.points_per_element;
  MemberSamples member;
  static_cast<SampledMember&>(member) = described;
  RowShare share{described.share.rows};
  for (const int local : local_elements) share.hold(points * (structure.local_element_to_mesh[local] - first), points);
  member.hold(share);
  size_t place = 0;
  for (const int local : local_elements)
    for (size_t i = 0; i < points; ++i, ++place)
      put(sample_element(structure, model.mesh(), state, local, sample_point(i, points)),
          structure.local_element_to_mesh[local] - first, place, member);
  return member;
}

}  // namespace

SampledMembers sample_own_elements(const Scene& scene, const Model& model, const State& state, int points_per_element) {
  const Structure& structure = model.structure();
  const Mesh& mesh = model.mesh();
  const SamplePlan plan(scene, mesh, points_per_element);
  const Teuchos::Comm<int>& comm = *model.map()->getComm();
  const bool is_described = comm.getSize() > 1 && comm.getRank() == 0;
  SampledMembers members;
  auto next = structure.elements_in_order.begin();
  std::vector<int> local_elements;  // of a member
  for (int m = 0; m < static_cast<int>(scene.members.size()); ++m) {
    local_elements.clear();
    for (; next != structure.elements_in_order.end() &&
           structure.local_element_to_mesh[*next] < mesh.first_element[m + 1];
         ++next)
      if (ElementView(structure, state, *next).is_owned()) local_elements.push_back(*next);
    if (local_elements.empty() && !is_described)
      members.add_absent(plan.samples(m), mesh.elements_of(m));
    else if (local_elements.empty())
      members.add_absent(plan.description(m));
    else
      members.add(sampled(model, state, plan.description(m), mesh.first_element[m], local_elements));
  }
  return members;
}

std::vector<Vector3> sample_own_motion(const Scene& scene, const Model& model, const MixedVector& motion,
                                       int points_per_element) {
  const Structure& structure = model.structure();
  const SamplePlan plan(scene, model.mesh(), points_per_element);
  const KernelView<const double* [6]> vertex = model.local_increment(motion);
  std::vector<Vector3> displacements;
  for (const int local : structure.elements_in_order) {
    const ElementView view(structure, State{}, local);
    if (!view.is_owned()) continue;
    const int points = plan.points(structure.member_of(model.mesh(), local));
    const double* bubbles = view.increments_in(motion.interior()) + view.layout().bubble(1);
    for (int i = 0; i < points; ++i)
      displacements.push_back(vector_algebra::to_array(
          displacement_at(view, sample_point(i, points), load_vector(&vertex(view.vertex(0), 0)),
                          load_vector(&vertex(view.vertex(1), 0)), bubbles)));
  }
  return displacements;
}

std::vector<MemberSamples> sample_members(const Scene& scene, const Model& model, const State& state,
                                          int points_per_element) {
  const auto& comm = *model.map()->getComm();
  const Structure& structure = model.structure();
  const Mesh& mesh = model.mesh();
  const SamplePlan plan(scene, mesh, points_per_element);
  std::vector<MemberSamples> members(scene.members.size());
  for (int m = 0; m < static_cast<int>(members.size()); ++m) {
    const int begin = mesh.first_element[m], points = plan.points(m);
    std::vector<PointSample> samples(plan.samples(m));
    for (int e = 0; e < mesh.elements_of(m); ++e)
      for (int i = 0; i < points && answers_for(structure, begin + e); ++i)
        samples[static_cast<size_t>(points) * e + i] =
            sample_element(structure, mesh, state, structure.local_element(begin + e), sample_point(i, points));
    if (comm.getSize() > 1) sum_samples_over_ranks(comm, samples.data(), samples.size());
    static_cast<SampledMember&>(members[m]) = plan.description(m);
    members[m].number = m;
    if (comm.getRank() != 0) continue;
    members[m].resize(samples.size());
    for (size_t i = 0; i < samples.size(); ++i) put(samples[i], static_cast<int>(i) / points, i, members[m]);
  }
  return members;
}

double l2_norm(const Model& model, const State& state, int points,
               const std::function<Vec3<double>(const PointSample&, int member)>& field) {
  const Structure& structure = model.structure();
  std::vector<double> xi(points), weight(points);
  gauss_rule(points, xi.data(), weight.data());
  double sum[2] = {0.0, 0.0};
  for_each_owned_element(structure, state, [&](const ElementView& element) {
    const int member = structure.member_of(model.mesh(), element.local());
    sum[1] += element.length();
    for (int q = 0; q < points; ++q) {
      const Vec value = field(sample_element(structure, model.mesh(), state, element.local(), xi[q]), member);
      sum[0] += 0.5 * element.length() * weight[q] * dot(value, value);
    }
  });
  sum_over_ranks(*model.map()->getComm(), sum, 2);
  return std::sqrt(sum[0] / sum[1]);
}

std::array<double, 6> vertex_motion(const Model& model, const State& state, int vertex) {
  std::array<double, 6> motion{};
  if (const int local = model.structure().partition.place(vertex); local >= 0) {
    const Vec rotation = log_quaternion(load_quaternion(&state.views.vertex_rotation(local, 0)));
    for (int i = 0; i < 3; ++i) {
      motion[i] = state.views.vertex_displacement(local, i);
      motion[3 + i] = rotation[i];
    }
  }
  sum_over_ranks(*model.map()->getComm(), motion.data(), motion.size());
  return motion;
}

Vector3 reference_position(const Model& model, int vertex) {
  Vector3 position{};
  if (model.structure().partition.owns(vertex)) position = model.mesh().vertex_position[vertex];
  sum_over_ranks(*model.map()->getComm(), position.data(), position.size());
  return position;
}

double largest_displacement(const Model& model, const State& state) {
  double largest = 0.0;
  for (int v = 0; v < model.structure().owned_vertices; ++v) {
    const double* u = &state.views.vertex_displacement(v, 0);
    largest = std::max(largest, std::hypot(u[0], u[1], u[2]));
  }
  return maximum_over_ranks(*model.map()->getComm(), largest);
}

}  // namespace mixbeam
