#include "discretization/constraints/external_energy.hpp"

#include "discretization/constraints/rotating_frame.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

using vector_algebra::to_vec3;

Vec displacement_of_vertex(int vertex, const State& state) {
  return load_vector(&state.views.vertex_displacement(vertex, 0));
}

/// Force and moment on one vertex; follower components are stored in the vertex frame (rotated back by Lambda_V).
struct VertexLoad {
  int vertex = 0;  ///< owned local vertex
  SpatialLoad full{};
  LoadFrame frame = LoadFrame::dead;
  Amplitude amplitude{};

  SpatialLoad scaled(double factor) const { return {factor * full.force, factor * full.moment}; }
  SpatialLoad spatial(double factor, const State& state) const {
    const SpatialLoad load = scaled(factor);
    if (frame == LoadFrame::dead) return load;
    const Mat turn = rotation_matrix(load_quaternion(&state.views.vertex_rotation(vertex, 0)));
    return {turn * load.force, turn * load.moment};
  }
};

class PointLoads : public ExternalEnergy {
 public:
  PointLoads(const Scene& scene, const Mesh& mesh, const Structure& structure,
             const std::shared_ptr<const LoadClock>& clock) {
    for (const PointLoad& load : scene.point_loads) {
      const int global = vertex_of(mesh, load.point), local = structure.partition.place(global);
      if (local < 0) continue;
      VertexLoad one{local,
                     {to_vec3(load.force), to_vec3(load.moment)},
                     load.frame,
                     Amplitude(load.stage, scene.stages, load.amplitude)};
      if (load.frame == LoadFrame::follower) {
        const int member = member_index(scene, load.member);
        const Mat triad = rotation_matrix(mesh.members[member].curve.triad(arc_length_of_vertex(mesh, member, global)));
        one.full = {triad * one.full.force, triad * one.full.moment};
      }
      if (clock->have_formulas()) one.amplitude.follow(clock);
      loads_.push_back(one);
    }
  }

  std::vector<int> vertices() const override {
    std::vector<int> vertices;
    for (const VertexLoad& load : loads_)
      if (has_tangent(load)) vertices.push_back(load.vertex);
    return vertices;
  }
  void forces(const State& state, double load_factor, const Act& act) const override {
    for (const VertexLoad& load : loads_) act(load.vertex, load.spatial(load.amplitude(load_factor), state));
  }
  void slopes(const State& state, double load_factor, const Act& act) const override {
    for (const VertexLoad& load : loads_) act(load.vertex, load.spatial(load.amplitude.slope(load_factor), state));
  }
  void sizes(const State&, double load_factor, const Act& act) const override {
    for (const VertexLoad& load : loads_) act(load.vertex, load.scaled(load.amplitude(load_factor)));
  }
  /// Tangent of loads that follow the vertex or whose virtual work has no potential: theory (44). The internal rows are
  /// second variations; their derivative at equilibrium also contains -hat(m)/2, m the total external moment on the
  /// vertex.
  void add_tangent(const State& state, double load_factor, const MatrixRows& rows) const override {
    for (const VertexLoad& load : loads_) {
      if (!has_tangent(load)) continue;
      const SpatialLoad spatial = load.spatial(load.amplitude(load_factor), state);
      const bool follower = load.frame == LoadFrame::follower;
      rows.add(load.vertex, kMomentPart, load.vertex, kMomentPart, (follower ? 0.5 : -0.5) * hat(spatial.moment));
      if (follower) rows.add(load.vertex, kForcePart, load.vertex, kMomentPart, hat(spatial.force));
    }
  }
  double energy(const State& state, double load_factor) const override {
    double sum = 0.0;
    forces(state, load_factor,
           [&](int vertex, const SpatialLoad& load) { sum -= dot(load.force, displacement_of_vertex(vertex, state)); });
    return sum;
  }
  bool keeps_in_plane(const Vec& normal, double tolerance) const override {
    return std::all_of(loads_.begin(), loads_.end(), [&](const VertexLoad& load) {
      const auto& [force, moment] = load.full;
      return std::abs(dot(force, normal)) <= tolerance * norm(force) &&
             norm(cross(moment, normal)) <= tolerance * norm(moment);
    });
  }

 private:
  /// A dead force has none: its vertex is eliminated with its chain. Other loads make the tangent unsymmetric, and one
  /// more remaining vertex costs less than unsymmetric chains.
  static bool has_tangent(const VertexLoad& load) {
    return load.frame == LoadFrame::follower || norm(load.full.moment) > 0.0;
  }
  std::vector<VertexLoad> loads_;
};

/// Springs on displacements, along the axes of their support. Those on rotations depend on which rotations the support
/// fixes: constraint_rows.hpp.
class SupportSprings : public ExternalEnergy {
 public:
  explicit SupportSprings(const std::vector<VertexSupport>& supports) {
    for (const VertexSupport& support : supports)
      if (norm(support.displacement_stiffness) > 0.0) springs_.push_back({support.vertex, stiffness_of(support)});
  }

  std::vector<int> vertices() const override {
    std::vector<int> vertices;
    for (const Spring& spring : springs_) vertices.push_back(spring.vertex);
    return vertices;
  }
  bool is_support() const override { return true; }
  void forces(const State& state, double, const Act& act) const override {
    for (const Spring& spring : springs_)
      act(spring.vertex, {-(spring.stiffness * displacement_of_vertex(spring.vertex, state)), {}});
  }
  void add_tangent(const State&, double, const MatrixRows& rows) const override {
    for (const Spring& spring : springs_)
      rows.add(spring.vertex, kForcePart, spring.vertex, kForcePart, spring.stiffness);
  }
  double energy(const State& state, double) const override {
    double sum = 0.0;
    for (const Spring& spring : springs_) {
      const Vec u = displacement_of_vertex(spring.vertex, state);
      sum += 0.5 * dot(u, spring.stiffness * u);
    }
    return sum;
  }
  /// Always true: the axes and stiffnesses of supports are checked for it.
  bool keeps_in_plane(const Vec&, double) const override { return true; }

 private:
  struct Spring {
    int vertex = 0;
    Mat stiffness{};  ///< spatial
  };
  static Mat stiffness_of(const VertexSupport& support) {
    Mat stiffness{};
    for (int i = 0; i < 3; ++i)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          stiffness(r, c) += support.displacement_stiffness[i] * support.axes(i, r) * support.axes(i, c);
    return stiffness;
  }

  std::vector<Spring> springs_;
};

/// Subtracts a load from the rows.
struct Subtract {
  const KernelView<double*>& rows;
  void operator()(int vertex, const SpatialLoad& load) const {
    for (int i = 0; i < 3; ++i) {
      rows(vertex_row(vertex, i)) -= load.force[i];
      rows(vertex_row(vertex, kMomentPart + i)) -= load.moment[i];
    }
  }
};

}  // namespace

void ExternalEnergy::add_rows(const State& state, double load_factor, const KernelView<double*>& rows) const {
  forces(state, load_factor, Subtract{rows});
}

void ExternalEnergy::add_slopes(const State& state, double load_factor, const KernelView<double*>& rows) const {
  slopes(state, load_factor, Subtract{rows});
}

ExternalEnergies external_energies(const Scene& scene, const Mesh& mesh, const Structure& structure,
                                   const Conditions& conditions, const std::shared_ptr<const LoadClock>& clock) {
  ExternalEnergies all;
  all.push_back(std::make_unique<PointLoads>(scene, mesh, structure, clock));
  all.push_back(std::make_unique<SupportSprings>(conditions.supports));
  if (auto bodies = bodies_in_frame(scene, mesh, structure, clock)) all.push_back(std::move(bodies));
  return all;
}

}  // namespace mixbeam
