#include "discretization/constraints/rotating_frame.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "discretization/scene/section_law.hpp"
#include "kernels/math/vector_algebra.hpp"
#include "kernels/vibration/rotating_frame.hpp"

namespace mixbeam {

namespace {

/// Smallest distance from the axis, relative to that from a point on it, in the scale of forces: a shaft on an inclined
/// axis has forces of rounding, 1e-16, which the tolerance of 1e-11 would not permit.
constexpr double kOnAxis = 1e-4;

/// Scale of the centrifugal force on a unit mass at `place`, from a point on the axis, at amplitude 1.
double size_of_force(const FrameSpin& spin, const Vec& place) {
  const Vec& full = spin.full();
  const double speed = norm(cross(full, place));
  const bool is_along_coordinate = std::count(&full[0], &full[0] + 3, 0.0) == 2;  // no rounding
  const double least = is_along_coordinate && speed == 0.0 ? 0.0 : kOnAxis * norm(full) * norm(place);
  return norm(full) * std::max(speed, least);
}

}  // namespace

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

/// Bodies with velocities along their undeformed axes and spins about the rotated ones, for which the products of
/// inertia are zero.
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
  void sizes(const State& state, double load_factor, const Act& act) const override {
    forces(state, load_factor, act);
    for (size_t i = 0; i < bodies_.size(); ++i) {
      const double force = bodies_[i].mass[0] * spin_.square(load_factor) * size_of_force(spin_, places_[i]);
      act(bodies_[i].vertex, {{{force, 0.0, 0.0}}, {}});
    }
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
  /// Calls action(mass, its axes as rows). The mass is isotropic, so the axes of inertia can be used for both parts.
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

void fill_masses(const Scene& scene, const Mesh& mesh, const Structure& structure, const ElementBlock& block,
                 const KernelView<double**>& mass) {
  const GaussPoints& rule = gauss_points(block.order + 1);
  int member = -1;
  SectionLaw law;
  std::array<double, kMassNumbers> factor{};
  for (int e = 0; e < block.count; ++e) {
    const MeshElement& element = mesh.elements[ElementView(structure, block, e).mesh_element()];
    const Member& of = scene.members[element.member];
    if (element.member != member) {
      member = element.member;
      law = SectionLaw(scene, of);
      factor = mass_factor(law.section(0.0));
    }
    const double length = mesh.members[member].curve.length;
    for (size_t q = 0; q < rule.xi.size(); ++q) {
      if (!of.end_section.empty()) factor = mass_factor(law.section(mesh.arc_length(element, rule.xi[q]) / length));
      std::copy(factor.begin(), factor.end(), &mass(e, static_cast<int>(q) * kMassNumbers));
    }
  }
}

RotatingElements::RotatingElements(const Scene& scene, const Mesh& mesh, const Structure& structure,
                                   const FrameSpin& spin)
    : spin_(spin) {
  for (const ElementBlock& block : structure.blocks) {
    FrameViews views;
    views.mass = KernelView<double**>("mixbeam::frame::mass", block.count, kMassNumbers * (block.order + 1));
    views.place = KernelView<double**>("mixbeam::frame::place", block.count, 3 * (block.order + 1));
    fill_masses(scene, mesh, structure, block, views.mass);
    const GaussPoints& rule = gauss_points(block.order + 1);
    for (int e = 0; e < block.count; ++e) {
      const MeshElement& element = mesh.elements[ElementView(structure, block, e).mesh_element()];
      const ReferenceCurve& curve = mesh.members[element.member].curve;
      for (int q = 0; q <= block.order; ++q) {
        const Vec place = curve.position(mesh.arc_length(element, rule.xi[q])) - spin_.point();
        store_vector(place, &views.place(e, 3 * q));
        const double root = views.mass(e, kMassNumbers * q);  // of the mass per length
        largest_force_ = std::max(largest_force_, root * root * size_of_force(spin_, place) * curve.length);
      }
    }
    blocks_.push_back(views);
  }
}

void RotatingElements::add_rows(const Structure& structure, const State& state, const Vec& spin, double factor,
                                const ElementEquations& to) const {
  for (size_t b = 0; b < blocks_.size(); ++b)
    add_centrifugal_rows(structure.blocks[b], frame(b, spin), state.views, factor,
                         to.scales_interior ? &to.interior_scales : nullptr, to.interior_residual, to.residual);
}

double RotatingElements::energy(const Structure& structure, const State& state, double load_factor) const {
  const KernelView<double*> energies("mixbeam::frame::energies", structure.local_elements());
  for (size_t b = 0; b < blocks_.size(); ++b)
    centrifugal_energies(structure.blocks[b], frame(b, spin_.at(load_factor)), state.views, energies);
  double sum = 0.0;
  for_each_owned_element(structure, state, [&](const ElementView& element) { sum += energies(element.local()); });
  return sum;
}

std::unique_ptr<const RotatingElements> rotating_elements(const Scene& scene, const Mesh& mesh,
                                                          const Structure& structure, const FrameSpin& spin) {
  const auto has_mass = [](const Section& section) { return section.mass > 0.0; };
  if (!spin.turns() || std::none_of(scene.sections.begin(), scene.sections.end(), has_mass)) return nullptr;
  return std::make_unique<RotatingElements>(scene, mesh, structure, spin);
}

}  // namespace mixbeam
