// Superimposed rotation of a deformed cantilever: strains and energy of a bent rod must not change in ten turns of its
// clamp.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/studies/vertex_places.hpp"
#include "discretization/text/errors.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

const std::string kPaper =
    "Humer, Steinbrecher, Pechstein, section \"Superimposed rotation of deformed cantilever\": preserved up to double "
    "precision";
/// Tolerance of invariants: round-off of some hundred operations on numbers of size one.
constexpr double kPreserved = 1e-12;
/// Tolerance after rotating back by up to 63 radians, whose sine and cosine inherit the rounding of the angle.
constexpr double kSameConfiguration = 1e-11;
constexpr int kPointsPerElement = 9;

/// Difference of a rotated configuration, rotated back, from the one before the rotation.
struct Deviation {
  double rotation = 0.0;         ///< prescribed so far [rad]
  double relative_u3 = 0.0;      ///< change of the tip displacement along the axis of rotation, over L
  double relative_energy = 0.0;  ///< relative change of the moment energy
  double position = 0.0;         ///< largest distance of a vertex, over L
  double triad = 0.0;            ///< largest angle between triads of a vertex [rad]
  int iterations = 0;            ///< Newton's, for this increment

  std::vector<CsvCell> cells(const CsvCell& first) const {
    return {first, relative_u3, relative_energy, position, triad, iterations};
  }
};

/// Follows a run: keeps the state at the start of the prescribed rotation and compares every later one with it.
class TurnedRod {
 public:
  /// Takes axis, centre and stage from the support with a prescribed rotation.
  explicit TurnedRod(const Scene& scene) {
    const auto turns = [](const Support& s) { return length_of(to_vec(s.prescribed_rotation)) > 0.0; };
    const auto support = std::find_if(scene.supports.begin(), scene.supports.end(), turns);
    if (support == scene.supports.end())
      throw InputError(
          "the scene has no support with a \"Prescribed Rotation\": nothing turns, so nothing can be compared");
    stage_ = support->stage;
    center_ = to_vec(position_of(scene, support->point));
    whole_rotation_ = length_of(to_vec(support->prescribed_rotation));
    axis_ = (1.0 / whole_rotation_) * to_vec(support->prescribed_rotation);
  }

  /// Adds a step; call after every converged one. Collective.
  void observe(const Simulation& simulation, const StepReport& report) {
    const double amplitude = report.load_factor - (stage_ - 1);
    if (amplitude < -kSameLoadFactor * stage_) return;
    const std::string& tip = simulation.scene().members.front().end_point;
    const Configuration now = {dot(to_vec(simulation.displacement(tip)), axis_), simulation.strain_energy().moment,
                               vertex_places(simulation)};
    if (deviations_.empty()) start_ = now;
    const double length = simulation.model().mesh().member_length.front();
    deviations_.push_back(compare(now, std::min(amplitude, 1.0) * whole_rotation_, length));
    if (deviations_.size() > 1) deviations_.back().iterations = report.newton_iterations;
  }
  RunObserver observer() {
    return [this](const Simulation& running, const StepReport& report) { observe(running, report); };
  }

  /// First the state before the rotation (no deviation, no iterations), then every increment.
  const std::vector<Deviation>& deviations() const { return deviations_; }

  /// Checks the largest absolute values of all increments, and returns them with the largest number of iterations.
  Deviation checked(Summary& summary, const std::string& name) const {
    Deviation largest;
    for (const Deviation& d : deviations_) {
      largest.relative_u3 = std::max(largest.relative_u3, std::abs(d.relative_u3));
      largest.relative_energy = std::max(largest.relative_energy, std::abs(d.relative_energy));
      largest.position = std::max(largest.position, d.position);
      largest.triad = std::max(largest.triad, d.triad);
      largest.iterations = std::max(largest.iterations, d.iterations);
    }
    const auto check = [&](const char* what, double value, double bound) {
      summary.check_upper_bound(name + what + ", largest of all increments", value, bound, kPaper);
    };
    check(": change of u3(L) / L", largest.relative_u3, kPreserved);
    check(": relative change of the moment energy", largest.relative_energy, kPreserved);
    check(": farthest vertex after turning back / L", largest.position, kSameConfiguration);
    check(": triad of a vertex after turning back", largest.triad, kSameConfiguration);
    return largest;
  }

 private:
  struct Configuration {
    double along_axis = 0.0;  ///< tip displacement along the axis
    double moment_energy = 0.0;
    std::vector<VertexPlace> vertices;
  };

  Deviation compare(const Configuration& turned, double rotation, double length) const {
    Deviation deviation;
    deviation.rotation = rotation;
    deviation.relative_u3 = (turned.along_axis - start_.along_axis) / length;
    deviation.relative_energy = (turned.moment_energy - start_.moment_energy) / start_.moment_energy;
    const Quaternion<double> back = exp_quaternion((-rotation) * axis_);
    for (size_t v = 0; v < turned.vertices.size(); ++v) {
      const VertexPlace &before = start_.vertices[v], &now = turned.vertices[v];
      const Vec3<double> position = center_ + rotation_matrix(back) * (now.position - center_);
      deviation.position = std::max(deviation.position, length_of(position - before.position) / length);
      deviation.triad = std::max(deviation.triad, angle_of(conjugate(before.rotation) * (back * now.rotation)));
    }
    return deviation;
  }

  int stage_ = 1;
  Vec3<double> center_{}, axis_{};
  double whole_rotation_ = 0.0;
  Configuration start_;
  std::vector<Deviation> deviations_;
};

/// Runs the scene: prints and checks the deviations of every increment, writes deviation.csv and single.h5.
void run_rotation(Application& app) {
  TurnedRod rod(app.scene);
  const Simulation simulation =
      app.solve_and_record(app.scene, app.solver, "single", kPointsPerElement, rod.observer());
  app.check_expected(simulation, [](const Simulation& at, const ExpectedValue&) { return at.strain_energy().moment; });
  StudyTable csv(app, "deviation.csv",
                 words("rotation,relative_u3,relative_energy,vertex_position,vertex_triad,iterations"), 6);
  for (const Deviation& d : rod.deviations()) csv.add_row(d.cells(d.rotation));
  rod.checked(app.summary, "scene");
}

/// Runs the scene, then the other element orders.
void run_rotation_study(Application& app) {
  app.quiet = true;  // the table of increments suffices
  run_rotation(app);
  app.out() << "\nLargest change of all increments, by order, and the most iterations of one\n";
  StudyTable table(app, "", {"k", "u3(L) / L", "moment energy", "vertices / L", "triads [rad]", "iterations"}, 6);
  for (int order : study_list<int>(app, "Orders")) {
    const Scene scene = with_mesh(app.scene, order, app.scene.members.front().elements);
    TurnedRod rod(scene);
    app.solve(scene, app.solver, "", rod.observer());
    table.add_row(rod.checked(app.summary, "k=" + std::to_string(order)).cells(order));
  }
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "superimposed_rotation";
  definition.purpose = "cantilever bent by a moment, then turned with its clamp (objectivity).";
  definition.study = mixbeam::ListSpec("Element orders to compare.");
  definition.study.add(mixbeam::counts("Orders", {1, 2, 3, 4}, 8, "Element orders k, each on the mesh of the scene."));
  definition.single = mixbeam::run_rotation;
  definition.run_study = mixbeam::run_rotation_study;
  return mixbeam::run_application(argc, argv, definition);
}
