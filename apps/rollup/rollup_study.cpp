// The paper's first example: a rod bent to a double circle by a moment at its tip.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/studies/vertex_places.hpp"
#include "apps/common/tables/formatted.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/gauss.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

const std::string kPaper = "Humer, Steinbrecher, Pechstein, section \"Rod bent to circle\"";
const std::string kClosedForm = "closed form: constant curvature M/EI, no force strains";
const std::string kGoal = "goal of mixbeam: pure bending in 3 iterations of one load step, at any slenderness";
constexpr int kGoalIterations = 3;

/// Tolerance of exact values: rounding of some hundred operations; positions divided by L, rotations in radians.
constexpr double kExact = 1e-12;
/// The figures show errors down to round-off; the default of 1e-11 would be visible on fine meshes.
constexpr double kResidualTolerance = 1e-13;
/// Stiffer rods have larger round-off: strains of 1e-16 times a stiffness far above that of bending.
constexpr double kStiff = 1e2, kResidualToleranceOfStiff = 3e-12;
constexpr double kRoundOff = 1e-12;  // of the centerline's error at slenderness 1000, set by Newton's tolerance
constexpr double kRateTolerance = 0.15;

/// An element locks if its error is this many times that with both parts reduced. At slenderness 1000 and 16 elements
/// the ratios are below 1.1 or above 100, so any number between separates them.
constexpr double kLocked = 10.0;
constexpr int kLockingElements = 16;
constexpr double kLockingSlenderness = 1000.0;

constexpr int kSmoothSamples = 33;   // per element in single.h5, where an element is a quarter of a circle
constexpr int kMoreGaussPoints = 3;  // beyond the k + 1 of polynomials of degree k: the exact circle is none

constexpr int kPrototypeElements = 32;
const std::vector<const char*> kPrototypeErrors = {"8.59e-04", "2.77e-05", "6.28e-07",
                                                   "1.19e-08", "1.90e-10", "2.63e-12"};

struct NamedIntegration {
  ForceIntegration integration;
  const char* name;
  std::vector<int> locking_orders;  ///< orders k = 1..4 that lock in the paper's figures, slenderness 1000
};
const std::vector<NamedIntegration> kIntegrations = {{ForceIntegration::full, "full", {2, 3, 4}},
                                                     {ForceIntegration::axial_reduced, "axial reduced", {3}},
                                                     {ForceIntegration::shear_reduced, "shear reduced", {2, 4}},
                                                     {ForceIntegration::both_reduced, "both reduced", {}}};
const NamedIntegration& kBothReduced = kIntegrations.back();

/// One computed rod and its errors; positions divided by L, rotations in radians.
struct RollupRun {
  const NamedIntegration* how = nullptr;
  double slenderness = 0.0;  ///< L/a, square section of side a
  int order = 1, elements = 1;
  int load_steps = 0, iterations = 0;
  double l2_error = 0.0;    ///< as in the paper: 1/L sqrt(1/L int |r - r_exact|^2 ds)
  double tip = 0.0;         ///< distance of the last vertex from the end of the circle
  double circle = 0.0;      ///< largest distance of a vertex from its exact place
  double quadrature = 0.0;  ///< largest distance from quadrature_positions()
  double rotation = 0.0;    ///< largest angle between a vertex rotation and the exact one

  bool is(const NamedIntegration& integration, double of_slenderness, int k, int count) const {
    return how == &integration && slenderness == of_slenderness && order == k && elements == count;
  }
};

std::string name_of(const char* integration, double slenderness, int order) {
  return formatted("%s, rho=%g k=%d", integration, slenderness, order);
}

/// The scene and its exact solution: a circle of radius EI/M, without force strains.
class RollupStudy {
 public:
  /// Throws InputError unless the scene is one straight member from the origin along x, clamped at its start, with a
  /// dead moment about z at its end and nothing else.
  explicit RollupStudy(Application& app) : app_(app) {
    const Scene& scene = app.scene;
    const PointLoad load = is_straight_cantilever(scene) ? scene.point_loads.front() : PointLoad{};
    if (load.force != Vector3{} || load.moment[0] != 0.0 || load.moment[1] != 0.0 || load.moment[2] == 0.0)
      throw InputError(
          "the study needs a scene of one straight member from the origin along x, clamped at its start, with a dead "
          "moment about z at its end and nothing else; other scenes: --single");
    length_ = position_of(scene, scene.members.front().end_point)[0];
    bending_stiffness_ = section_of(scene, scene.members.front()).bending_stiffness[1];
    curvature_ = load.moment[2] / bending_stiffness_;
  }

  /// Records the scene as it stands (single.h5); checks the values that are exact in pure bending, and the iterations;
  /// writes convergence.csv, prints the errors of the centerline, checks their rates and which elements lock.
  void run() {
    app_.check_expected(app_.solve_and_record(app_.scene, app_.solver, "single", kSmoothSamples));
    check_exact_values();
    compute_all();
    report_errors();
    report_locking();
    compare_with_prototype();
  }

 private:
  Vec3<double> exact_position(double arc_length) const {
    const double angle = curvature_ * arc_length, half_sine = std::sin(0.5 * angle);
    return {{std::sin(angle) / curvature_, 2.0 * half_sine * half_sine / curvature_, 0.0}};  // 1 - cos, no cancellation
  }

  /// Vertex positions of the discrete solution if both parts of the force-strain energy are reduced: rotations are
  /// exact and force strains vanish at k Gauss points per element, so r' is the exact tangent there, and the Gauss rule
  /// for its integral gives the vertices. They are on the circle up to O(h^2k), and exactly after each full turn, such
  /// as at the tip.
  std::vector<Vec3<double>> quadrature_positions(int order, int elements) const {
    std::vector<double> points(order), weights(order);
    gauss_rule(order, points.data(), weights.data());
    const double h = length_ / elements;
    std::vector<Vec3<double>> positions = {{{0.0, 0.0, 0.0}}};
    for (int e = 0; e < elements; ++e) {
      Vec3<double> end = positions.back();
      for (int q = 0; q < order; ++q) {
        const double angle = curvature_ * h * (e + 0.5 * (1.0 + points[q]));
        end += 0.5 * h * weights[q] * Vec3<double>{{std::cos(angle), std::sin(angle), 0.0}};
      }
      positions.push_back(end);
    }
    return positions;
  }

  /// Solves with the force stiffness of a square section: EA = 12 slenderness^2 EI/L^2, GA = EA/2. Collective.
  RollupRun compute(const NamedIntegration& how, double slenderness, int order, int elements,
                    const SolverParameters& solver) {
    Scene scene = with_mesh(app_.scene, order, elements);
    scene.members.front().force_integration = how.integration;
    const double axial = 12.0 * std::pow(slenderness / length_, 2) * bending_stiffness_;
    for (Section& section : scene.sections) {
      section.axial_stiffness = axial;
      section.shear_stiffness = {0.5 * axial, 0.5 * axial};
    }
    const Simulation simulation = app_.solve(scene, solver, "");
    const LoadPathResult& result = simulation.result();
    RollupRun run = {&how, slenderness, order, elements, result.steps, result.newton_iterations};
    run.l2_error = simulation.l2_norm(order + kMoreGaussPoints, [this](const PointSample& sample, int) {
      return sample.position - exact_position(sample.arc_length);
    }) / length_;
    const auto whole = simulation.model().whole_mesh();
    const auto quadrature = quadrature_positions(order, whole->elements_of(0));
    for (const MeshElement& element : whole->elements) {
      const int vertex = element.vertex[1];
      const VertexPlace place = place_of(simulation, vertex);
      const double s = whole->vertex_position[vertex][0];
      const Quaternion<double> back = exp_quaternion(Vec3<double>{{0.0, 0.0, -curvature_ * s}});
      run.tip = length_of(place.position - exact_position(s)) / length_;
      run.circle = std::max(run.circle, run.tip);
      run.quadrature = std::max(run.quadrature, length_of(place.position - quadrature[element.index + 1]) / length_);
      run.rotation = std::max(run.rotation, angle_of(back * place.rotation));
    }
    return run;
  }

  /// Checks that the tip closes the circle, rotations are exact, and vertices follow from exact tangents, on any mesh.
  void check_exact_values() {
    const int elements = study_number(app_, "Exact Elements");
    app_.out() << "\nWhat is exact on every mesh, and what is not: " << elements
               << " elements, one load step (positions / L, angles in radians)\n";
    StudyTable table(app_, "",
                     {"slenderness", "k", "iterations", "tip position", "rotation of any vertex",
                      "vertex from k-point Gauss rule", "vertex from the circle"},
                     7);
    for (double slenderness : study_list<double>(app_, "Exact Slenderness"))
      for (int order : study_list<int>(app_, "Exact Orders")) {
        SolverParameters solver = with_fixed_steps(app_.solver, 1);
        solver.newton.residual_tolerance = slenderness < kStiff ? kResidualTolerance : kResidualToleranceOfStiff;
        const RollupRun run = compute(kBothReduced, slenderness, order, elements, solver);
        table.add_row({slenderness, order, run.iterations, run.tip, run.rotation, run.quadrature, run.circle});
        const auto check = [&](const char* what, double value, double bound, const std::string& source) {
          app_.summary.check_upper_bound(name_of("exact values", slenderness, order) + what, value, bound, source);
        };
        check(": tip, distance from the circle / L", run.tip, kExact, kClosedForm);
        check(": vertices, distance from Gauss rule of the exact tangent / L", run.quadrature, kExact, kClosedForm);
        check(": vertices, angle to the exact rotation", run.rotation, kExact, kClosedForm);
        check(": Newton iterations in one load step", run.iterations, kGoalIterations, kGoal);
      }
  }

  void compute_all() {
    StudyTable csv(
        app_, "convergence.csv",
        words("integration,order,slenderness,elements,l2_error,tip_error,vertex_error,iterations,load_steps"));
    SolverParameters solver = app_.solver;
    solver.newton.residual_tolerance = std::min(solver.newton.residual_tolerance, kResidualTolerance);
    for (const NamedIntegration& how : kIntegrations) {
      const bool is_whole = how.integration == ForceIntegration::full || &how == &kBothReduced;
      const auto slendernesses =
          study_list<double>(app_, is_whole ? "Slenderness" : "Slenderness of Selective Reduction");
      for (double slenderness : slendernesses)
        for (int order : study_list<int>(app_, &how == &kBothReduced ? "Orders Both Reduced" : "Orders"))
          for (int elements : study_list<int>(app_, "Elements")) {
            const RollupRun run = compute(how, slenderness, order, elements, solver);
            csv.add_row({how.name, order, slenderness, elements, run.l2_error, run.tip, run.circle, run.iterations,
                         run.load_steps});
            runs_.push_back(run);
          }
    }
  }

  /// Prints errors; runs that differ only in the mesh are consecutive. Checks the rates of elements that cannot lock.
  void report_errors() {
    const auto elements = study_list<int>(app_, "Elements");
    ConvergenceTable table("\nError of the centerline, 1/L sqrt(1/L int |r - r_exact|^2 ds)", elements, kRoundOff);
    std::string group;
    for (std::size_t first = 0; first + elements.size() <= runs_.size(); first += elements.size()) {
      const RollupRun& run = runs_[first];
      const bool full = run.how->integration == ForceIntegration::full;
      const std::string heading =
          formatted("%s%s, slenderness %g", run.how->name, full ? " integration" : "", run.slenderness);
      if (heading != group) table.add_group(group = heading);
      std::vector<double> errors;
      for (std::size_t i = 0; i < elements.size(); ++i) errors.push_back(runs_[first + i].l2_error);
      const auto rate = table.add_row(run.order, errors);
      if (run.how == &kBothReduced && rate)
        app_.summary.check_absolute(name_of(run.how->name, run.slenderness, run.order) + ": convergence rate", *rate,
                                    run.order + 1, kRateTolerance, kPaper + ": optimal rate k + 1");
    }
    table.print(app_.out());
  }

  /// Finds a run; null if the user's lists do not contain it.
  const RollupRun* find(const NamedIntegration& how, double slenderness, int order, int elements) const {
    for (const RollupRun& run : runs_)
      if (run.is(how, slenderness, order, elements)) return &run;
    return nullptr;
  }

  /// Prints the errors relative to those with both parts reduced, and checks them against the paper's figures.
  void report_locking() {
    app_.out() << "\nLocking at slenderness " << kLockingSlenderness << " with " << kLockingElements
               << " elements: more than " << kLocked << " times the error with both parts reduced";
    StudyTable table(app_, "", {"integration", "k", "ratio", "locks"}, 4);
    for (int order : study_list<int>(app_, "Orders"))
      for (const NamedIntegration& how : kIntegrations) {
        const RollupRun* run = find(how, kLockingSlenderness, order, kLockingElements);
        const RollupRun* best = find(kBothReduced, kLockingSlenderness, order, kLockingElements);
        if (run == nullptr || best == nullptr || run == best) continue;
        const double ratio = run->l2_error / best->l2_error;
        table.add_row({how.name, order, ratio, ratio > kLocked ? "yes" : "no"});
        const std::string name = name_of(how.name, kLockingSlenderness, order);
        if (std::count(how.locking_orders.begin(), how.locking_orders.end(), order) > 0)
          app_.summary.check_upper_bound(name + ": locks, error with both reduced / error", 1.0 / ratio, 1.0 / kLocked,
                                         kPaper);
        else
          app_.summary.check_upper_bound(name + ": does not lock, error / error with both reduced", ratio, kLocked,
                                         kPaper);
      }
  }

  void compare_with_prototype() {
    TablePrinter table("\nError of the centerline beside that of a prototype of the element (" +
                           std::to_string(kPrototypeElements) + " elements, both parts reduced)",
                       {"k"}, {"slenderness 10", "slenderness 1000"}, "prototype");
    for (int order = 1; order <= static_cast<int>(kPrototypeErrors.size()); ++order) {
      std::vector<ComparedValue> values;
      for (double slenderness : {10.0, 1000.0})
        if (const RollupRun* run = find(kBothReduced, slenderness, order, kPrototypeElements))
          values.push_back({kPrototypeErrors[order - 1], run->l2_error, Agreement::informative});
      if (values.size() == 2) table.add_row({std::to_string(order)}, values);
    }
    table.print(app_.out());
  }

  Application& app_;
  double length_ = 0.0, bending_stiffness_ = 0.0, curvature_ = 0.0;
  std::vector<RollupRun> runs_;
};

ListSpec rollup_spec() {
  constexpr double kMost = 1e10;
  ListSpec spec("Meshes, orders and slendernesses L/a (square section of side a); GA = EA/2, EI as in the scene.");
  spec.add(sizes("Slenderness", {10, 100, 1000}, kMost, "For full integration and for both parts reduced."));
  spec.add(sizes("Slenderness of Selective Reduction", {1000}, kMost, "For one of the two parts reduced."));
  spec.add(counts("Orders", {1, 2, 3, 4}, 8, "Element orders k where elements may lock."));
  spec.add(counts("Orders Both Reduced", {1, 2, 3, 4, 5, 6}, 8, "Element orders k where they do not."));
  spec.add(counts("Elements", {8, 16, 32, 64, 128, 256, 512}, 100000,
                  "Numbers of elements, ascending; fewer than 5 would turn by more than pi.", 5));
  spec.add(sizes("Exact Slenderness", {10, 1000, 1e6}, kMost, "For the values that are exact on every mesh."));
  spec.add(counts("Exact Orders", {1, 2, 3, 4, 5, 6, 7, 8}, 8, "Element orders k for these values."));
  spec.add(count("Exact Elements", 8, 100000, "Number of elements for them.", 5));
  return spec;
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "rollup",
      "a straight cantilever bent to a double circle by a moment at its tip; convergence and locking.",
      mixbeam::rollup_spec(), [](mixbeam::Application& app) { mixbeam::RollupStudy(app).run(); });
}
