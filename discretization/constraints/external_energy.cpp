#include "discretization/constraints/external_energy.hpp"

namespace mixbeam {

namespace {

Vec displacement_of_vertex(int vertex, const State& state) {
  return load_vector(&state.views.vertex_displacement(vertex, 0));
}

class PointLoads : public ExternalEnergy {
 public:
  explicit PointLoads(const std::vector<VertexLoad>& loads) : loads_(loads) {}

  std::vector<int> vertices() const override {
    std::vector<int> vertices;
    for (const VertexLoad& load : loads_) vertices.push_back(load.vertex);
    return vertices;
  }
  void add_rows(const State& state, double load_factor, const KernelView<double*>& rows) const override {
    for (const VertexLoad& load : loads_) subtract(load, load.amplitude(load_factor), state, rows);
  }
  void add_slopes(const State& state, double load_factor, const KernelView<double*>& rows) const override {
    for (const VertexLoad& load : loads_) subtract(load, load.amplitude.slope(load_factor), state, rows);
  }
  /// Loads whose virtual work is not that of a potential, or that follow the vertex: theory (44). The internal rows are
  /// second variations; their derivative at equilibrium holds -hat(m)/2 beside them, m the total external moment on the
  /// vertex.
  void add_tangent(const State& state, double load_factor, const MatrixRows& rows) const override {
    for (const VertexLoad& load : loads_) {
      const SpatialLoad spatial = spatial_load(load, load.amplitude(load_factor), state);
      const bool follower = load.frame == LoadFrame::follower;
      rows.add(load.vertex, kMomentPart, load.vertex, kMomentPart, (follower ? 0.5 : -0.5) * hat(spatial.moment));
      if (follower) rows.add(load.vertex, kForcePart, load.vertex, kMomentPart, hat(spatial.force));
    }
  }
  double energy(const State& state, double load_factor) const override {
    double sum = 0.0;
    for (const VertexLoad& load : loads_)
      sum -=
          dot(spatial_load(load, load.amplitude(load_factor), state).force, displacement_of_vertex(load.vertex, state));
    return sum;
  }

 private:
  static void subtract(const VertexLoad& load, double amplitude, const State& state, const KernelView<double*>& rows) {
    const SpatialLoad spatial = spatial_load(load, amplitude, state);
    for (int i = 0; i < 3; ++i) {
      rows(vertex_row(load.vertex, i)) -= spatial.force[i];
      rows(vertex_row(load.vertex, kMomentPart + i)) -= spatial.moment[i];
    }
  }

  std::vector<VertexLoad> loads_;
};

/// Springs on displacements, along the axes of their support. Those on rotations depend on how the support holds the
/// others: constraint_rows.hpp.
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
  void add_rows(const State& state, double, const KernelView<double*>& rows) const override {
    for (const Spring& spring : springs_)
      set_rows_of(
          rows, spring.vertex, kForcePart,
          rows_of(rows, spring.vertex, kForcePart) + spring.stiffness * displacement_of_vertex(spring.vertex, state));
  }
  void add_slopes(const State&, double, const KernelView<double*>&) const override {}
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

}  // namespace

ExternalEnergies external_energies(const Conditions& conditions) {
  ExternalEnergies all;
  all.push_back(std::make_unique<PointLoads>(conditions.loads));
  all.push_back(std::make_unique<SupportSprings>(conditions.supports));
  return all;
}

}  // namespace mixbeam
