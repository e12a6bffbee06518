// Helix experiment: a straight rod bent and twisted into an exact helix by a moment at its tip.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/studies/vertex_places.hpp"
#include "apps/common/tables/convergence_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/common/tables/table_printer.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/constants.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <ostream>

namespace mixbeam {

namespace {

/// r(s) = R0 sin(a) e1 - R0 cos(a) e2 + h0 s / L e3,  a = 2 pi n s / L  (paper, section "Helix experiment").
struct ExactHelix {
  double radius = 0.0;  ///< R0
  double height = 0.0;  ///< h0
  double coils = 0.0;   ///< n

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

/// Errors of one computed rod. Positions are divided by L, rotations in radians.
struct HelixErrors {
  double tip_position = 0.0, tip_rotation = 0.0;
  double vertex_position = 0.0, vertex_rotation = 0.0;  ///< largest of all vertices
  double centerline = 0.0;                              ///< sqrt(1/L int |r - r_exact|^2 ds) / L, vertices and between
};

/// A third of two coils, the longest element of the study, has sines and cosines of 4 pi / 3: 16 points integrate the
/// square of the error to round-off.
constexpr int kGaussPoints = 16;

/// Of a scene with one member, which runs from s = 0 to s = L. Collective.
HelixErrors compare(const Simulation& simulation, const ExactHelix& exact) {
  const auto whole = simulation.model().whole_mesh();
  const Mesh& mesh = *whole;
  const double length = exact.length();
  HelixErrors errors;
  for (const MeshElement& element : mesh.elements) {
    const double s = length * (element.index + 1) / static_cast<double>(mesh.elements.size());
    const VertexPlace place = place_of(simulation, element.vertex[1]);
    const Quaternion<double> triad = place.rotation * mesh.members[element.member].curve.triad(s);
    errors.tip_position = length_of(place.position - exact.position(s)) / length;
    errors.tip_rotation = angle_of(conjugate(exact.triad(s)) * triad);
    errors.vertex_position = std::max(errors.vertex_position, errors.tip_position);
    errors.vertex_rotation = std::max(errors.vertex_rotation, errors.tip_rotation);
  }
  errors.centerline = simulation.l2_norm(kGaussPoints, [&exact](const PointSample& sample, int) {
    return sample.position - exact.position(sample.arc_length);
  }) / length;
  return errors;
}

const std::string kPaper = "Humer, Steinbrecher, Pechstein, section \"Helix experiment\"";
const std::string kGoal =
    "goal of mixbeam: pure bending and twisting in one load step of 3 iterations (4 where rounding leaves more "
    "than the tolerance after the third), at any slenderness";

/// "Exact up to the floating point accuracy": what the scene's residual tolerance of 1e-12 leaves, as a share of L.
constexpr double kExact = 1e-12;

/// The same for angles up to two full turns, in radians.
constexpr double kExactRotation = 1e-11;

/// Between vertices no polynomial of degree k can do better than k + 1.
constexpr double kRateTolerance = 0.15;

/// At vertices the rate is 2 k. High orders reach round-off on meshes of few elements for each coil, where it is up to
/// one more.
constexpr double kVertexRateTolerance = 1.0;

/// Rates are judged where the finer mesh's error stands well above what Newton leaves.
constexpr double kAboveRoundOff = 1e-11;

/// Newton may leave this much of the centerline's error to the slenderness.
constexpr double kSameError = 1e-11;

constexpr int kGoalIterations = 4;
constexpr int kStudyIterations =
    4;  // ill-conditioned meshes (high order, slender) may need one more to reach the tolerance
constexpr int kSmoothSamples = 65;  // of each element in order1.h5 and order3.h5, where an element is most of a coil

struct RodMesh {
  int order = 0, elements = 0;
};

/// L / (2 r) of a rod of circular section, for which EI / EA = r^2 / 4.
double slenderness_of(const Scene& scene, const ExactHelix& exact) {
  const Section& section = scene.sections.front();
  return exact.length() / (4.0 * std::sqrt(section.bending_stiffness[1] / section.axial_stiffness));
}

/// The same rod of another slenderness: its radius changes, E and G stay, and the moment that winds it grows with EI.
Scene with_slenderness(const Scene& scene, double slenderness, const ExactHelix& exact) {
  return with_side(scene, slenderness_of(scene, exact) / slenderness);
}

/// As the paper has it: the rod lies along e1 and its clamp turns by -arctan(c) about e2 while the moment grows.
Scene with_turned_clamp(Scene scene, const ExactHelix& exact) {
  const Member& rod = scene.members.front();
  const Vector3 start = position_of(scene, rod.start_point);
  for (Point& point : scene.points)
    if (point.name == rod.end_point) point.position = {start[0] + exact.length(), start[1], start[2]};
  scene.supports.front().prescribed_rotation = {0.0, -std::atan(exact.slope()), 0.0};
  return scene;
}

/// One row of the study.
struct HelixRun {
  double slenderness = 0.0;
  int order = 0, elements = 0, load_steps = 0, iterations = 0;
  HelixErrors errors;
};

ExactHelix exact_helix(Application& app) {
  if (app.scene.members.size() != 1)
    throw InputError("the study of the helix needs a scene with one member; this one has " +
                     std::to_string(app.scene.members.size()) + " (--single runs any scene)");
  const Teuchos::ParameterList& study = app.study();
  return {study.get<double>("Radius"), study.get<double>("Height"), study.get<double>("Coils")};
}

HelixRun measure(const Simulation& simulation, double slenderness, const ExactHelix& exact) {
  const Member& rod = simulation.scene().members.front();
  return {slenderness,
          rod.order,
          rod.elements,
          simulation.result().steps,
          simulation.result().newton_iterations,
          compare(simulation, exact)};
}

/// "rho=10 k=1, 3 elements"
std::string name_of(const HelixRun& run) {
  return formatted("rho=%g k=%d, %d elements", run.slenderness, run.order, run.elements);
}

ComparedValue exact_coordinate(double own, double exact, double length) {
  const std::string text =
      formatted("%.6f", std::abs(exact) < kExact * length ? 0.0 : exact);  // sin(4 pi) is not quite zero
  return {text, own, std::abs(own - exact) <= kExact * length ? Agreement::agrees : Agreement::differs};
}

/// Solves the scene, adds it to the table and checks its tip.
HelixRun compare_tip(Application& app, const Scene& scene, double slenderness, const ExactHelix& exact,
                     TablePrinter& table, const std::string& prefix) {
  const Simulation simulation = app.solve(scene);
  const HelixRun run = measure(simulation, slenderness, exact);
  const Vector3 own = simulation.position(scene.members.front().end_point);
  const Vec3<double> tip = exact.position(exact.length());
  std::vector<ComparedValue> values;
  for (int i = 0; i < 3; ++i) values.push_back(exact_coordinate(own[i], tip[i], exact.length()));
  table.add_row({std::to_string(run.order), std::to_string(run.elements), std::to_string(run.iterations)}, values);
  const std::string name = prefix + name_of(run);
  app.summary.check_upper_bound(name + ": tip, distance to the exact helix / L", run.errors.tip_position, kExact,
                                kPaper);
  app.summary.check_upper_bound(name + ": tip, angle to the exact rotation", run.errors.tip_rotation, kExactRotation,
                                kPaper);
  return run;
}

/// The meshes that the paper names, at every slenderness, then the scene with its clamp turned.
void compare_with_paper(Application& app, const ExactHelix& exact, const std::vector<double>& slendernesses) {
  const std::vector<RodMesh> meshes = {{1, 3}, {1, 5}, {2, 3}, {3, 3}};
  TablePrinter table(
      "Helix experiment: tip of the rod (paper: exact for 5 elements of order 1, and for 3 of order 2 and higher)",
      {"k", "elements", "iterations"}, {"r1(L)", "r2(L)", "r3(L)"}, "exact");
  for (double slenderness : slendernesses) {
    table.add_group(formatted("slenderness %g", slenderness));
    for (const RodMesh& mesh : meshes) {
      const Scene scene = with_mesh(with_slenderness(app.scene, slenderness, exact), mesh.order, mesh.elements);
      const HelixRun run = compare_tip(app, scene, slenderness, exact, table, "");
      app.summary.check_absolute(name_of(run) + ": load steps", run.load_steps, 1, 0.0, kGoal);
      app.summary.check_upper_bound(name_of(run) + ": Newton iterations", run.iterations, kGoalIterations, kGoal);
    }
  }
  table.add_group(
      "undeformed rod along e1, its clamp turned by -arctan(c) about e2 in the same load step (slenderness of the "
      "scene)");
  for (const RodMesh& mesh : meshes) {
    const Scene scene = with_turned_clamp(with_mesh(app.scene, mesh.order, mesh.elements), exact);
    compare_tip(app, scene, slenderness_of(app.scene, exact), exact, table, "clamp turned, ");
  }
  table.print(app.out());
}

std::vector<HelixRun> run_all(Application& app, const ExactHelix& exact, const std::vector<double>& slendernesses) {
  std::vector<HelixRun> runs;
  for (double slenderness : slendernesses)
    for (int order : study_list<int>(app, "Orders"))
      for (int elements : study_list<int>(app, "Elements")) {
        const Simulation simulation =
            app.solve(with_mesh(with_slenderness(app.scene, slenderness, exact), order, elements));
        runs.push_back(measure(simulation, slenderness, exact));
      }
  return runs;
}

void write_convergence(const Application& app, const std::vector<HelixRun>& runs) {
  StudyTable csv(app, "convergence.csv",
                 {"slenderness", "order", "elements", "load_steps", "iterations", "l2_error", "tip_position",
                  "tip_rotation", "vertex_position", "vertex_rotation"});
  for (const HelixRun& run : runs)
    csv.add_row({run.slenderness, run.order, run.elements, run.load_steps, run.iterations, run.errors.centerline,
                 run.errors.tip_position, run.errors.tip_rotation, run.errors.vertex_position,
                 run.errors.vertex_rotation});
}

/// Largest errors and costs over all meshes of one slenderness and order.
HelixRun worst_of(const std::vector<HelixRun>& runs, double slenderness, int order) {
  HelixRun worst;
  worst.slenderness = slenderness;
  worst.order = order;
  for (const HelixRun& run : runs) {
    if (run.order != order || run.slenderness != slenderness) continue;
    worst.load_steps = std::max(worst.load_steps, run.load_steps);
    worst.iterations = std::max(worst.iterations, run.iterations);
    worst.errors.tip_position = std::max(worst.errors.tip_position, run.errors.tip_position);
    worst.errors.tip_rotation = std::max(worst.errors.tip_rotation, run.errors.tip_rotation);
    worst.errors.vertex_rotation = std::max(worst.errors.vertex_rotation, run.errors.vertex_rotation);
  }
  return worst;
}

/// What is exact on every mesh: the tip, and the rotations of all vertices.
void report_exact_values(Application& app, const std::vector<HelixRun>& runs,
                         const std::vector<double>& slendernesses) {
  app.out() << "\nLargest deviation from the exact helix over all meshes, and what the worst mesh took (position / L, "
               "angles in radians)\n";
  StudyTable table(
      app, "",
      {"slenderness", "k", "tip position", "tip rotation", "rotation of any vertex", "load steps", "iterations"}, 7);
  for (double slenderness : slendernesses)
    for (int order : study_list<int>(app, "Orders")) {
      const HelixRun worst = worst_of(runs, slenderness, order);
      table.add_row({slenderness, order, worst.errors.tip_position, worst.errors.tip_rotation,
                     worst.errors.vertex_rotation, worst.load_steps, worst.iterations});
      const std::string name = formatted("rho=%g k=%d, all meshes: ", slenderness, order);
      app.summary.check_upper_bound(name + "tip, distance to the exact helix / L", worst.errors.tip_position, kExact,
                                    kPaper);
      app.summary.check_upper_bound(name + "any vertex, angle to the exact rotation", worst.errors.vertex_rotation,
                                    kExactRotation, kPaper);
      app.summary.check_upper_bound(name + "Newton iterations", worst.iterations, kStudyIterations, kGoal);
    }
}

/// A kind of error, and how fast it should fall.
struct ErrorKind {
  std::string name;
  double HelixErrors::*error;
  std::function<int(int)> rate;  ///< of an order
  double tolerance;              ///< of the rate
  std::string reason;
};

/// Errors over the meshes of one slenderness; the rates are checked.
void report_convergence(Application& app, const std::vector<HelixRun>& runs, double slenderness,
                        const ErrorKind& kind) {
  ConvergenceTable table("\n" + kind.name, study_list<int>(app, "Elements"), kAboveRoundOff);
  table.add_group(formatted("slenderness %g", slenderness));
  for (int order : study_list<int>(app, "Orders")) {
    std::vector<double> errors;
    for (const HelixRun& run : runs)
      if (run.order == order && run.slenderness == slenderness) errors.push_back(run.errors.*kind.error);
    const std::optional<double> rate = table.add_row(order, errors);
    if (!rate) continue;
    app.summary.check_absolute("k=" + std::to_string(order) + ": convergence rate, " + kind.name, *rate,
                               kind.rate(order), kind.tolerance, kind.reason);
  }
  table.print(app.out());
}

/// The centerline's error belongs to the mesh, not to the slenderness: nothing locks.
void check_same_at_every_slenderness(Application& app, const std::vector<HelixRun>& runs) {
  double largest = 0.0;
  for (const HelixRun& run : runs)
    for (const HelixRun& other : runs)
      if (run.order == other.order && run.elements == other.elements)
        largest = std::max(largest, std::abs(run.errors.centerline - other.errors.centerline));
  app.out() << "\nThe error of the centerline is the same at every slenderness within " << largest << "\n";
  app.summary.check_upper_bound("error of the centerline, largest difference between slendernesses", largest,
                                kSameError, kPaper + ": no locking with reduced integration");
}

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

/// Prints and checks the paper's statements, writes convergence.csv, order1.h5, order3.h5.
void run_helix_study(Application& app) {
  const ExactHelix exact = exact_helix(app);
  const auto slendernesses = study_list<double>(app, "Slenderness");
  compare_with_paper(app, exact, slendernesses);
  app.check_expected(app.solve(app.scene));
  for (const RodMesh& mesh : {RodMesh{1, 5}, RodMesh{3, 3}})
    app.solve_and_record(with_mesh(app.scene, mesh.order, mesh.elements), app.solver,
                         "order" + std::to_string(mesh.order), kSmoothSamples);
  const std::vector<HelixRun> runs = run_all(app, exact, slendernesses);
  write_convergence(app, runs);
  report_exact_values(app, runs, slendernesses);
  report_convergence(app, runs, slendernesses.front(),
                     {"Error of the centerline, sqrt(1/L int |r - r_exact|^2 ds) / L", &HelixErrors::centerline,
                      [](int k) { return k + 1; }, kRateTolerance, "polynomials of degree k: rate k + 1"});
  report_convergence(app, runs, slendernesses.front(),
                     {"Largest distance of a vertex to the exact helix / L", &HelixErrors::vertex_position,
                      [](int k) { return 2 * k; }, kVertexRateTolerance,
                      "exact rotations, slope of the centerline by a Gauss rule of k points: rate 2 k"});
  check_same_at_every_slenderness(app, runs);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(argc, argv, "helix",
                            "straight rod that a moment at its tip winds to an exact helix (helix experiment).",
                            mixbeam::helix_study_spec(), mixbeam::run_helix_study);
}
