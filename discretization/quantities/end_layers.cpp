#include "discretization/quantities/end_layers.hpp"

#include "kernels/math/vector_algebra.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

namespace mixbeam {

namespace {

/// A moment below this share of that of the layer is that of a hinge.
constexpr double kHinge = 1e-6;
/// Beyond this angle the formula 2 sin(theta / 2) is no longer that of a layer that ends in the chord. [radian]
constexpr double kLargestTurn = 2.0;

/// Bending stiffness about axes 2 and 3; infinite where the section is rigid.
struct Bending {
  std::array<double, 2> stiffness{HUGE_VAL, HUGE_VAL};
  double stretching = 0.0;  ///< EA of the tangent
  bool is_coupled = false;  ///< bending is coupled with anything

  Bending(const Structure& structure, const Mesh& mesh, int local, double arc_length) {
    const ElementBlock& block = structure.block_of(local);
    if (!block.general_section) {
      const SectionConstants& section = structure.views.sections(block.section(local - block.first_element));
      for (int i = 0; i < 2; ++i) stiffness[i] = 1.0 / section.moment_compliance[i + 1];
      stretching = section.tangent_force_stiffness[0];
      return;
    }
    const int member = structure.member_of(mesh, local);
    const Matrix6 compliance =
        structure.member_laws[member]->compliance(arc_length / mesh.members[member].curve.length);
    if (compliance[0][0] > 0.0) stretching = 1.0 / compliance[0][0];
    for (int i = 4; i < 6; ++i) {
      stiffness[i - 4] = 1.0 / compliance[i][i];
      for (int j = 0; j < 6; ++j) is_coupled = is_coupled || (j != i && compliance[i][j] != 0.0);
    }
  }
};

/// Vertices where a member ends or something is attached to it: only these have layers.
std::vector<unsigned char> points_of(const Mesh& mesh) {
  std::vector<unsigned char> is_point(static_cast<size_t>(mesh.vertices()), 0);
  for (const auto& [name, vertex] : mesh.vertex_of_point) is_point[static_cast<size_t>(vertex)] = 1;
  for (const MeshJoint& joint : mesh.joints) is_point[static_cast<size_t>(joint.slave)] = 1;
  return is_point;
}

/// Search for layers in one element of a state.
class LayerSearch {
 public:
  LayerSearch(const Model& model, const State& state, int local, const Scene* coarse)
      : structure_(model.structure()),
        mesh_(model.mesh()),
        state_(state),
        local_(local),
        element_(mesh_.elements[structure_.local_element_to_mesh[local]]),
        order_(structure_.block_of(local).order),
        length_(mesh_.element_length(element_)) {
    if (coarse != nullptr) order_ = std::min(order_, coarse->members[element_.member].order + 1);
  }

  void add(const std::vector<unsigned char>& is_point, std::vector<EndLayer>& layers) const {
    if (!is_point[element_.vertex[0]] && !is_point[element_.vertex[1]]) return;
    const PointSample start = at(-1.0), middle = at(0.0), end = at(1.0);
    const double tension = norm(middle.force);
    const Bending bending(structure_, mesh_, local_, middle.arc_length);
    const double softer = std::min(bending.stiffness[0], bending.stiffness[1]);
    const double bound = length_ / (kLayersPerOrder * (order_ + 1));
    if (!(softer < tension * bound * bound)) return;
    const Vec3<double> first = spatial_force(start), last = spatial_force(end);
    for (const int side : {1, -1}) {
      if (!is_point[element_.vertex[side > 0 ? 0 : 1]]) continue;
      EndLayer layer{element_.member, element_.index, side, element_.vertex[side > 0 ? 0 : 1],
                     element_.vertex[side > 0 ? 1 : 0]};
      layer.thickness = std::sqrt(softer / tension);
      layer.length = length_;
      layer.sample = side > 0 ? start : end;
      const Vec3<double> turn = (1.0 / (length_ * tension * tension)) * cross(first, last);
      layer.is_known = middle.force[0] > 0.0 && !bending.is_coupled;
      if (!close(layer, bending, turn)) continue;
      layers.push_back(layer);
    }
  }

 private:
  PointSample at(double xi) const { return sample_element(structure_, mesh_, state_, local_, xi); }
  static Vec3<double> spatial_force(const PointSample& sample) { return rotation_matrix(sample.triad) * sample.force; }

  /// Replaces the polynomial by the closed form; false at a hinge. `turn`: rotation of the force along the element,
  /// spatial [1/length].
  bool close(EndLayer& layer, const Bending& bending, const Vec3<double>& turn) const {
    const std::array<double, 2>& stiffness = bending.stiffness;
    PointSample& sample = layer.sample;
    const Vec3<double> force = spatial_force(sample);
    const MeshMember& member = mesh_.members[element_.member];
    const int vertex = structure_.block_of(local_).vertices(local_ - structure_.block_of(local_).first_element,
                                                            layer.side > 0 ? 0 : 1);
    const Quaternion<double> rotation = load_quaternion(&state_.views.vertex_rotation(vertex, 0));
    const double in_mesh = std::hypot(sample.moment[1], sample.moment[2]);
    const Vec3<double> moment = rotation_matrix(sample.triad) * sample.moment;
    sample.triad = rotation * member.curve.triad(sample.arc_length);
    const auto axes = transpose(rotation_matrix(sample.triad));
    sample.force = axes * force;
    const double size = norm(force);
    const double angle = std::acos(std::clamp(sample.force[0] / size, -1.0, 1.0));
    if (!(angle <= kLargestTurn)) layer.is_known = false;
    const Vec3<double> outer = axes * turn - member.curve.curvature(sample.arc_length);
    const double share = layer.side / (std::cos(0.5 * std::min(angle, kLargestTurn)) * size);
    double layer_moment[2] = {};
    for (int i = 0; i < 2; ++i)
      if (std::isfinite(stiffness[i]))
        layer_moment[i] =
            (i == 0 ? -share * sample.force[2] : share * sample.force[1]) * std::sqrt(stiffness[i] * size);
    if (in_mesh <= kHinge * std::hypot(layer_moment[0], layer_moment[1])) return false;
    for (int i = 0; i < 2; ++i) {
      if (!std::isfinite(stiffness[i])) continue;
      sample.moment[i + 1] = layer_moment[i] + stiffness[i] * outer[i + 1];
      sample.moment_strain[i + 1] = sample.moment[i + 1] / stiffness[i];
    }
    layer.surplus = transpose(axes) * sample.moment - moment;
    layer.push = push_of(layer, force, angle, bending.stretching, length_ * std::sqrt(dot(turn, turn)));
    return true;
  }

  /// Push on the vertex if the element were attached to it off-centre by the moment's arm, and shorter by the length of
  /// the layer: a string under tension, softer along its chord where it sags by the angle `sag`.
  Vec3<double> push_of(const EndLayer& layer, const Vec3<double>& force, double angle, double stretching,
                       double sag) const {
    const double tension = norm(force);
    const Vec3<double> aside = (-1.0 / (tension * tension)) * cross(layer.surplus, force);
    const Vec3<double> gap = aside - (0.25 * layer.side * angle * norm(aside) / tension) * force;
    const Vec3<double> chord = at(1.0).position - at(-1.0).position;
    const double along = dot(gap, chord) / dot(chord, chord);
    const double taut = stretching / (1.0 + stretching / tension * sag * sag / 12.0);
    return (tension / length_) * (gap - along * chord) + (taut / length_ * along) * chord;
  }

  const Structure& structure_;
  const Mesh& mesh_;
  const State& state_;
  int local_;
  const MeshElement& element_;
  int order_;
  double length_;
};

static_assert(std::is_trivially_copyable_v<EndLayer>, "EndLayer is sent as bytes");

/// Gathers the layers of all ranks, one rank after the other.
std::vector<EndLayer> of_all_ranks(const Teuchos::Comm<int>& comm, std::vector<EndLayer> mine) {
  if (comm.getSize() == 1) return mine;
  const int own = static_cast<int>(mine.size());
  int most = 0;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, own, Teuchos::outArg(most));
  if (most == 0) return mine;
  EndLayer none;
  none.member = -1;
  mine.resize(static_cast<size_t>(most), none);
  std::vector<EndLayer> all(static_cast<size_t>(most) * comm.getSize());
  const int bytes = static_cast<int>(mine.size() * sizeof(EndLayer));
  Teuchos::gatherAll(comm, bytes, reinterpret_cast<const char*>(mine.data()), bytes * comm.getSize(),
                     reinterpret_cast<char*>(all.data()));
  all.erase(std::remove_if(all.begin(), all.end(), [](const EndLayer& layer) { return layer.member < 0; }), all.end());
  return all;
}

}  // namespace

std::vector<EndLayer> end_layers(const Model& model, const State& state, const Scene* coarse) {
  std::vector<EndLayer> layers;
  const std::vector<unsigned char> is_point = points_of(model.mesh());
  for (const int local : model.structure().elements_in_order)
    if (answers_for(model.structure(), model.structure().local_element_to_mesh[local]))
      LayerSearch(model, state, local, coarse).add(is_point, layers);
  return of_all_ranks(*model.map()->getComm(), std::move(layers));
}

}  // namespace mixbeam
