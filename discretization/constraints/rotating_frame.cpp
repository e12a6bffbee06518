#include "discretization/constraints/rotating_frame.hpp"

#include "kernels/math/vector_algebra.hpp"
#include "kernels/vibration/rotating_frame.hpp"

namespace mixbeam {

FrameSpin::FrameSpin(const Scene& scene, const std::shared_ptr<const LoadClock>& clock) {
  if (scene.rotating_frames.empty()) return;
  const RotatingFrame& frame = scene.rotating_frames.front();
  point_ = vector_algebra::to_vec3(frame.point);
  full_ = vector_algebra::to_vec3(frame.velocity);
  amplitude_ = Amplitude(frame.stage, scene.stages, frame.amplitude);
  square_ = Amplitude(frame.stage, scene.stages, centrifugal_growth(frame, scene.stages));
  amplitude_.follow(clock);
  square_.follow(clock);
}

std::vector<VertexBody> vertex_bodies(const Scene& scene, const Mesh& mesh, const Structure& structure) {
  std::vector<VertexBody> bodies;
  const std::vector<PointMass>& all = scene.point_masses;
  for (size_t i = 0; i < all.size(); ++i) {
    const int local = structure.partition.place(vertex_of(mesh, all[i].point));
    if (local < 0) continue;
    const double m = all[i].mass;
    bodies.push_back(
        {local, {{m, m, m}}, vector_algebra::to_vec3(all[i].inertia), matrix_of(all[i].axes), static_cast<int>(i)});
  }
  return bodies;
}

namespace {

/// Velocities along the axes of the undeformed body, spins about those that turn with it: their products of inertia
/// are zero.
class BodiesInFrame : public ExternalEnergy {
 public:
  BodiesInFrame(const Mesh& mesh, const Structure& structure, std::vector<VertexBody> bodies, const FrameSpin& spin)
      : bodies_(std::move(bodies)), spin_(spin) {
    for (const VertexBody& body : bodies_)
      places_.push_back(vector_algebra::to_vec3(mesh.vertex_position[structure.local_vertex_to_global[body.vertex]]) -
                        spin.point());
  }

  std::vector<int> vertices() const override {
    std::vector<int> vertices;
    for (const VertexBody& body : bodies_) vertices.push_back(body.vertex);
    return vertices;
  }
  void forces(const State& state, double load_factor, const Act& act) const override {
    act_times(1.0, spin_.at(load_factor), state, act);
  }
  void slopes(const State& state, double load_factor, const Act& act) const override {
    act_times(spin_.square_slope(load_factor), spin_.full(), state, act);
  }
  void add_tangent(const State& state, double load_factor, const MatrixRows& rows) const override {
    for (size_t i = 0; i < bodies_.size(); ++i)
      with_mass(i, spin_.at(load_factor), state, [&](const CarriedMass& mass, const Mat& axes) {
        const MotionForm form = mass.second_variation();
        const int vertex = bodies_[i].vertex;
        const auto spatial = [&axes](const Mat& m) { return transpose(axes) * m * axes; };
        rows.add(vertex, kForcePart, vertex, kForcePart, spatial(form.moved));
        rows.add(vertex, kMomentPart, vertex, kMomentPart, spatial(form.turned));
      });
  }
  double energy(const State& state, double load_factor) const override {
    double sum = 0.0;
    for (size_t i = 0; i < bodies_.size(); ++i)
      with_mass(i, spin_.at(load_factor), state, [&sum](const CarriedMass& mass, const Mat&) { sum += mass.energy(); });
    return sum;
  }

 private:
  std::vector<VertexBody> bodies_;
  std::vector<Vec> places_;
  FrameSpin spin_;

  void act_times(double factor, const Vec& spin, const State& state, const Act& act) const {
    for (size_t i = 0; i < bodies_.size(); ++i)
      with_mass(i, spin, state, [&](const CarriedMass& mass, const Mat& axes) {
        act(bodies_[i].vertex,
            {-factor * transpose_times(axes, mass.force_row()), -factor * transpose_times(axes, mass.moment_row())});
      });
  }
  /// Calls action(mass, its axes as rows): with one mass for all directions those of its inertia serve both.
  template <class Action>
  void with_mass(size_t i, const Vec& spin, const State& state, const Action& action) const {
    const VertexBody& body = bodies_[i];
    const Mat axes = body.turned_axes(state);
    MotionForm mass{};
    for (int k = 0; k < 3; ++k) {
      mass.moved(k, k) = body.mass[k];
      mass.turned(k, k) = body.inertia[k];
    }
    const Vec place = places_[i] + load_vector(&state.views.vertex_displacement(body.vertex, 0));
    action(CarriedMass(mass, axes * cross(spin, place), axes * spin), axes);
  }
};

}  // namespace

std::unique_ptr<const ExternalEnergy> bodies_in_frame(const Scene& scene, const Mesh& mesh, const Structure& structure,
                                                      const std::shared_ptr<const LoadClock>& clock) {
  const FrameSpin spin(scene, clock);
  if (!spin.turns() || scene.point_masses.empty()) return nullptr;
  return std::make_unique<BodiesInFrame>(mesh, structure, vertex_bodies(scene, mesh, structure), spin);
}

}  // namespace mixbeam
