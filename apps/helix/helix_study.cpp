// Helix experiment: a straight rod bent and twisted into an exact helix by a moment at its tip.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/studies/vertex_places.hpp"
#include "apps/common/tables/formatted.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/constants.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

const std::string kPaper = "Humer, Steinbrecher, Pechstein, section \"Helix experiment\"";
const std::string kGoal =
    "goal of mixbeam: pure bending and twisting in one load step of 3 iterations (4 where rounding leaves more "
    "than the tolerance after the third), at any slenderness";
constexpr int kGoalIterations = 4;

/// "Exact up to the floating point accuracy": tolerance over L, set by the scene's residual tolerance of 1e-12.
constexpr double kExact = 1e-12;
/// Tolerance of angles up to two full turns, in radians.
constexpr double kExactRotation = 1e-11;

/// Tolerance of the rate between vertices, which is at most k + 1 for polynomials of degree k.
constexpr double kRateTolerance = 0.15;
/// Tolerance of the rate 2 k at vertices. High orders reach round-off on coarse meshes, where it is up to one more.
constexpr double kVertexRateTolerance = 1.0;
/// Least error for rates, well above that of Newton's method.
constexpr double kAboveRoundOff = 1e-11;
/// Largest change of the centerline's error with the slenderness, due to Newton's tolerance.
constexpr double kSameError = 1e-11;

/// A third of two coils, the longest element of the study, has sines and cosines of 4 pi / 3: 16 points integrate the
/// square of the error to round-off.
constexpr int kGaussPoints = 16;
constexpr int kSmoothSamples = 65;  // per element in order1.h5 and order3.h5, where an element is most of a coil

/// r(s) = R0 sin(a) e1 - R0 cos(a) e2 + h0 s / L e3,  a = 2 pi n s / L  (paper, section "Helix experiment").
struct ExactHelix {
  double radius, height, coils;  ///< R0, h0, n

  /// L
  double length() const { return std::hypot(2.0 * kPi * coils * radius, height); }
  /// c = h0 / (2 pi n R0), the tangent of the angle of inclination
  double slope() const { return height / (2.0 * kPi * coils * radius); }
  /// a(s)
  double angle(double s) const { return 2.0 * kPi * coils * s / length(); }
  Vec3<double> position(double s) const {
    return {{radius * std::sin(angle(s)), -radius * std::cos(angle(s)), height * s / length()}};
  }
  /// Triad of the section: exp(a e3) exp(-arctan(c) e2). The paper prints the second angle with the other sign, which
  /// does not give the tangent of r(s).
  Quaternion<double> triad(double s) const {
    return exp_quaternion(Vec3<double>{{0.0, 0.0, angle(s)}}) *
           exp_quaternion(Vec3<double>{{0.0, -std::atan(slope()), 0.0}});
  }
};

/// One computed rod and its errors. Positions are divided by L, rotations in radians.
struct HelixRun {
  double slenderness = 0.0;
  int order = 0, elements = 0, load_steps = 0, iterations = 0;
  double tip_position = 0.0, tip_rotation = 0.0;
  double vertex_position = 0.0, vertex_rotation = 0.0;  ///< largest over all vertices
  double centerline = 0.0;                              ///< sqrt(1/L int |r - r_exact|^2 ds) / L

  /// "rho=10 k=1, 3 elements"
  std::string name() const { return formatted("rho=%g k=%d, %d elements", slenderness, order, elements); }
};

/// The study: the scene with one member, which runs from s = 0 to s = L, and its slendernesses.
class HelixStudy {
 public:
  explicit HelixStudy(Application& app) : app_(app), exact_{number("Radius"), number("Height"), number("Coils")} {
    if (app.scene.members.size() != 1)
      throw InputError("the study of the helix needs a scene with one member; this one has " +
                       std::to_string(app.scene.members.size()) + " (--single runs any scene)");
    slendernesses_ = study_list<double>(app, "Slenderness");
  }

  /// Prints and checks the paper's statements, writes convergence.csv, order1.h5, order3.h5.
  void run() {
    compare_with_paper();
    app_.check_expected(app_.solve(app_.scene));
    for (const auto& [order, elements] : {std::pair{1, 5}, {3, 3}})
      app_.solve_and_record(with_mesh(app_.scene, order, elements), app_.solver, "order" + std::to_string(order),
                            kSmoothSamples);
    run_all();
    report_exact_values();
    report_convergence("Error of the centerline, sqrt(1/L int |r - r_exact|^2 ds) / L", &HelixRun::centerline, 1, 1,
                       kRateTolerance, "polynomials of degree k: rate k + 1");
    report_convergence("Largest distance of a vertex to the exact helix / L", &HelixRun::vertex_position, 2, 0,
                       kVertexRateTolerance,
                       "exact rotations, slope of the centerline by a Gauss rule of k points: rate 2 k");
    check_same_at_every_slenderness();
  }

 private:
  double number(const char* name) const { return app_.study().get<double>(name); }

  /// L / (2 r) of a circular section, for which EI / EA = r^2 / 4.
  double slenderness() const {
    const Section& section = app_.scene.sections.front();
    return exact_.length() / (4.0 * std::sqrt(section.bending_stiffness[1] / section.axial_stiffness));
  }

  /// Changes the slenderness of the rod by its radius; E and G stay, the moment is proportional to EI.
  Scene variant(double of_slenderness, int order, int elements) const {
    return with_mesh(with_side(app_.scene, slenderness() / of_slenderness), order, elements);
  }

  /// Collective.
  HelixRun measure(const Simulation& simulation, double of_slenderness) const {
    const Member& rod = simulation.scene().members.front();
    const auto whole = simulation.model().whole_mesh();
    const Mesh& mesh = *whole;
    const double length = exact_.length();
    HelixRun run = {of_slenderness, rod.order, rod.elements, simulation.result().steps,
                    simulation.result().newton_iterations};
    for (const MeshElement& element : mesh.elements) {
      const double s = length * (element.index + 1) / static_cast<double>(mesh.elements.size());
      const VertexPlace place = place_of(simulation, element.vertex[1]);
      const Quaternion<double> triad = place.rotation * mesh.members[element.member].curve.triad(s);
      run.tip_position = length_of(place.position - exact_.position(s)) / length;
      run.tip_rotation = angle_of(conjugate(exact_.triad(s)) * triad);
      run.vertex_position = std::max(run.vertex_position, run.tip_position);
      run.vertex_rotation = std::max(run.vertex_rotation, run.tip_rotation);
    }
    run.centerline = simulation.l2_norm(kGaussPoints, [this](const PointSample& sample, int) {
      return sample.position - exact_.position(sample.arc_length);
    }) / length;
    return run;
  }

  /// Solves the scene, adds it to the table and checks its tip.
  HelixRun compare_tip(const Scene& scene, double of_slenderness, TablePrinter& table, const std::string& prefix) {
    const Simulation simulation = app_.solve(scene);
    const HelixRun run = measure(simulation, of_slenderness);
    const Vector3 own = simulation.position(scene.members.front().end_point);
    const Vec3<double> tip = exact_.position(exact_.length());
    const double tolerance = kExact * exact_.length();
    std::vector<ComparedValue> values;
    for (int i = 0; i < 3; ++i)  // sin(4 pi) is not quite zero
      values.push_back({formatted("%.6f", std::abs(tip[i]) < tolerance ? 0.0 : tip[i]), own[i],
                        std::abs(own[i] - tip[i]) <= tolerance ? Agreement::agrees : Agreement::differs});
    table.add_row({std::to_string(run.order), std::to_string(run.elements), std::to_string(run.iterations)}, values);
    const std::string name = prefix + run.name();
    app_.summary.check_upper_bound(name + ": tip, distance to the exact helix / L", run.tip_position, kExact, kPaper);
    app_.summary.check_upper_bound(name + ": tip, angle to the exact rotation", run.tip_rotation, kExactRotation,
                                   kPaper);
    return run;
  }

  /// Compares the meshes of the paper at every slenderness. Then the paper's setting: the rod lies along e1, and its
  /// clamp rotates by -arctan(c) about e2 while the moment grows.
  void compare_with_paper() {
    const std::vector<std::pair<int, int>> meshes = {{1, 3}, {1, 5}, {2, 3}, {3, 3}};  // order, elements
    TablePrinter table(
        "Helix experiment: tip of the rod (paper: exact for 5 elements of order 1, and for 3 of order 2 and higher)",
        {"k", "elements", "iterations"}, {"r1(L)", "r2(L)", "r3(L)"}, "exact");
    for (double one : slendernesses_) {
      table.add_group(formatted("slenderness %g", one));
      for (const auto& [order, elements] : meshes) {
        const HelixRun run = compare_tip(variant(one, order, elements), one, table, "");
        app_.summary.check_absolute(run.name() + ": load steps", run.load_steps, 1, 0.0, kGoal);
        app_.summary.check_upper_bound(run.name() + ": Newton iterations", run.iterations, kGoalIterations, kGoal);
      }
    }
    table.add_group(
        "undeformed rod along e1, its clamp turned by -arctan(c) about e2 in the same load step (slenderness of the "
        "scene)");
    for (const auto& [order, elements] : meshes) {
      Scene scene = with_mesh(app_.scene, order, elements);
      const Member& rod = scene.members.front();
      const Vector3 start = position_of(scene, rod.start_point);
      for (Point& point : scene.points)
        if (point.name == rod.end_point) point.position = {start[0] + exact_.length(), start[1], start[2]};
      scene.supports.front().prescribed_rotation = {0.0, -std::atan(exact_.slope()), 0.0};
      compare_tip(scene, slenderness(), table, "clamp turned, ");
    }
    table.print(app_.out());
  }

  void run_all() {
    StudyTable csv(app_, "convergence.csv",
                   words("slenderness,order,elements,load_steps,iterations,l2_error,tip_position,tip_rotation,"
                         "vertex_position,vertex_rotation"));
    for (double one : slendernesses_)
      for (int order : study_list<int>(app_, "Orders"))
        for (int elements : study_list<int>(app_, "Elements")) {
          const HelixRun run = measure(app_.solve(variant(one, order, elements)), one);
          csv.add_row({run.slenderness, run.order, run.elements, run.load_steps, run.iterations, run.centerline,
                       run.tip_position, run.tip_rotation, run.vertex_position, run.vertex_rotation});
          runs_.push_back(run);
        }
  }

  /// Reports the values that are exact on every mesh: the tip, and the rotations of all vertices.
  void report_exact_values() {
    app_.out() << "\nLargest deviation from the exact helix over all meshes, and what the worst mesh took (position / "
                  "L, angles in radians)\n";
    StudyTable table(
        app_, "",
        {"slenderness", "k", "tip position", "tip rotation", "rotation of any vertex", "load steps", "iterations"}, 7);
    for (double one : slendernesses_)
      for (int order : study_list<int>(app_, "Orders")) {
        const auto worst = [&](auto HelixRun::*field) {
          std::decay_t<decltype(HelixRun{}.*field)> largest = 0;
          for (const HelixRun& run : runs_)
            if (run.order == order && run.slenderness == one) largest = std::max(largest, run.*field);
          return largest;
        };
        const double tip = worst(&HelixRun::tip_position), rotation = worst(&HelixRun::vertex_rotation);
        const int iterations = worst(&HelixRun::iterations);
        table.add_row(
            {one, order, tip, worst(&HelixRun::tip_rotation), rotation, worst(&HelixRun::load_steps), iterations});
        const std::string name = formatted("rho=%g k=%d, all meshes: ", one, order);
        app_.summary.check_upper_bound(name + "tip, distance to the exact helix / L", tip, kExact, kPaper);
        app_.summary.check_upper_bound(name + "any vertex, angle to the exact rotation", rotation, kExactRotation,
                                       kPaper);
        app_.summary.check_upper_bound(name + "Newton iterations", iterations, kGoalIterations, kGoal);
      }
  }

  /// Reports errors over the meshes of the first slenderness; expected rates are factor k + offset.
  void report_convergence(const std::string& name, double HelixRun::*error, int factor, int offset, double tolerance,
                          const std::string& reason) {
    ConvergenceTable table("\n" + name, study_list<int>(app_, "Elements"), kAboveRoundOff);
    table.add_group(formatted("slenderness %g", slendernesses_.front()));
    for (int order : study_list<int>(app_, "Orders")) {
      std::vector<double> errors;
      for (const HelixRun& run : runs_)
        if (run.order == order && run.slenderness == slendernesses_.front()) errors.push_back(run.*error);
      if (const auto rate = table.add_row(order, errors))
        app_.summary.check_absolute("k=" + std::to_string(order) + ": convergence rate, " + name, *rate,
                                    factor * order + offset, tolerance, reason);
    }
    table.print(app_.out());
  }

  /// Checks that the error of the centerline depends on the mesh only, not on the slenderness: no locking.
  void check_same_at_every_slenderness() {
    double largest = 0.0;
    for (const HelixRun& run : runs_)
      for (const HelixRun& other : runs_)
        if (run.order == other.order && run.elements == other.elements)
          largest = std::max(largest, std::abs(run.centerline - other.centerline));
    app_.out() << "\nThe error of the centerline is the same at every slenderness within " << largest << "\n";
    app_.summary.check_upper_bound("error of the centerline, largest difference between slendernesses", largest,
                                   kSameError, kPaper + ": no locking with reduced integration");
  }

  Application& app_;
  ExactHelix exact_;
  std::vector<double> slendernesses_;
  std::vector<HelixRun> runs_;
};

ListSpec helix_study_spec() {
  ListSpec spec("The exact helix, and the rods to compare with it.");
  spec.add(real("Radius").above(0.0).by_default(10.0).means("R0 of the helix that the scene's moment winds [length]."));
  spec.add(real("Height").above(0.0).by_default(50.0).means("h0, gained over all coils [length]."));
  spec.add(real("Coils").above(0.0).by_default(2.0).means("n, the number of full turns."));
  spec.add(sizes("Slenderness", {10.0, 1e3, 1e6}, kNoLimit, "L over the diameter of the circular section."));
  spec.add(counts("Orders", {1, 2, 3, 4, 5, 6}, 8, "Element orders k."));
  spec.add(counts("Elements", {3, 4, 5, 8, 16, 32, 64}, 100000,
                  "Numbers of elements, ascending; two coils need at least three.", 3));
  return spec;
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "helix", "straight rod that a moment at its tip winds to an exact helix (helix experiment).",
      mixbeam::helix_study_spec(), [](mixbeam::Application& app) { mixbeam::HelixStudy(app).run(); });
}
