#include "apps/superimposed_rotation/turned_rod.hpp"

#include "discretization/text/errors.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

Vec3<double> to_vec(const Vector3& v) { return {{v[0], v[1], v[2]}}; }

double length_of(const Vec3<double>& v) { return std::hypot(v[0], v[1], v[2]); }

}  // namespace

TurnedRod::TurnedRod(const Scene& scene, const std::string& tip) : tip_(tip) {
  const auto turns = [](const Support& s) { return length_of(to_vec(s.prescribed_rotation)) > 0.0; };
  const auto support = std::find_if(scene.supports.begin(), scene.supports.end(), turns);
  if (support == scene.supports.end())
    throw InputError(
        "the scene has no support with a \"Prescribed Rotation\": nothing turns, so nothing can be compared");
  support_ = *support;
  const auto point =
      std::find_if(scene.points.begin(), scene.points.end(), [&](const Point& p) { return p.name == support_.point; });
  center_ = to_vec(point->position);
  whole_rotation_ = length_of(to_vec(support_.prescribed_rotation));
  axis_ = (1.0 / whole_rotation_) * to_vec(support_.prescribed_rotation);
}

TurnedRod::Configuration TurnedRod::configuration_of(const Simulation& simulation) const {
  Configuration configuration;
  configuration.along_axis = dot(to_vec(simulation.displacement(tip_)), axis_);
  configuration.moment_energy = simulation.strain_energy().moment;
  const Mesh& mesh = simulation.model().mesh();
  for (int vertex = 0; vertex < mesh.vertices(); ++vertex) {
    const auto motion = vertex_motion(simulation.model(), simulation.state(), vertex);
    configuration.positions.push_back(to_vec(mesh.vertex_position[vertex]) +
                                      Vec3<double>{{motion[0], motion[1], motion[2]}});
    configuration.rotations.push_back(exp_quaternion(Vec3<double>{{motion[3], motion[4], motion[5]}}));
  }
  return configuration;
}

Deviation TurnedRod::compare(const Configuration& turned, double rotation, double length) const {
  Deviation deviation;
  deviation.rotation = rotation;
  deviation.relative_u3 = (turned.along_axis - start_.along_axis) / length;
  deviation.relative_energy = (turned.moment_energy - start_.moment_energy) / start_.moment_energy;
  const Quaternion<double> back = exp_quaternion((-rotation) * axis_);
  for (size_t v = 0; v < turned.positions.size(); ++v) {
    const Vec3<double> position = center_ + rotation_matrix(back) * (turned.positions[v] - center_);
    const Vec3<double> angle = log_quaternion(conjugate(start_.rotations[v]) * (back * turned.rotations[v]));
    deviation.position = std::max(deviation.position, length_of(position - start_.positions[v]) / length);
    deviation.triad = std::max(deviation.triad, length_of(angle));
  }
  return deviation;
}

void TurnedRod::observe(const Simulation& simulation, const StepReport& report) {
  const double amplitude = report.load_factor - (support_.stage - 1);
  if (amplitude < -kSameLoadFactor * support_.stage) return;
  const Configuration now = configuration_of(simulation);
  if (deviations_.empty()) start_ = now;
  const double length = simulation.model().mesh().members.front().curve.length;
  deviations_.push_back(compare(now, std::min(amplitude, 1.0) * whole_rotation_, length));
  if (deviations_.size() > 1) deviations_.back().iterations = report.newton_iterations;
}

Deviation TurnedRod::largest() const {
  Deviation largest;
  for (const Deviation& d : deviations_) {
    largest.rotation = std::max(largest.rotation, d.rotation);
    largest.relative_u3 = std::max(largest.relative_u3, std::abs(d.relative_u3));
    largest.relative_energy = std::max(largest.relative_energy, std::abs(d.relative_energy));
    largest.position = std::max(largest.position, d.position);
    largest.triad = std::max(largest.triad, d.triad);
    largest.iterations = std::max(largest.iterations, d.iterations);
  }
  return largest;
}

}  // namespace mixbeam
