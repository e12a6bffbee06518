// The paper's third example: a circular arc under a force out of its plane.
#include "apps/arc_segment/arc.hpp"
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/convergence_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/common/tables/printed_digits.hpp"
#include "apps/common/tables/table_printer.hpp"
#include "discretization/text/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

namespace mixbeam {

namespace {

/// A row of the paper's table of tip displacements.
struct PaperRow {
  double slenderness;
  int order;
  int elements;
  std::array<std::string, 3> tip;  ///< u1, u2, u3 with 6 significant digits, as printed
};

/// A tip displacement computed without finite elements.
struct IndependentValue {
  std::string name;
  double slenderness;
  double force_factor;  ///< times the force of the paper
  bool shear_rigid, inextensible;
  std::array<std::string, 3> tip;
};

constexpr int kPrintedFigures = 6;  // the paper rounds its table to these

const std::vector<PaperRow> kRowsBeforeRounding = {
    {10, 1, 4, {"-23.75125", "-13.59944", "54.49189"}},    {10, 2, 4, {"-23.65101", "-13.63756", "54.08983"}},
    {10, 3, 4, {"-23.64497", "-13.63205", "54.095"}},      {10, 4, 4, {"-23.64501", "-13.63207", "54.09503"}},
    {10, 1, 32, {"-23.64685", "-13.63184", "54.10082"}},   {10, 2, 32, {"-23.64503", "-13.63208", "54.09503"}},
    {10, 3, 32, {"-23.64501", "-13.63207", "54.09503"}},   {10, 4, 32, {"-23.64501", "-13.63207", "54.09503"}},
    {100, 1, 4, {"-23.66304", "-13.57181", "53.87134"}},   {100, 2, 4, {"-23.56625", "-13.61001", "53.46957"}},
    {100, 3, 4, {"-23.5602", "-13.6045", "53.47483"}},     {100, 4, 4, {"-23.56024", "-13.60452", "53.47486"}},
    {100, 1, 32, {"-23.56202", "-13.60429", "53.48064"}},  {100, 2, 32, {"-23.56026", "-13.60453", "53.47486"}},
    {100, 3, 32, {"-23.56024", "-13.60452", "53.47486"}},  {100, 4, 32, {"-23.56024", "-13.60452", "53.47486"}},
    {1000, 1, 4, {"-23.66215", "-13.57153", "53.86514"}},  {1000, 2, 4, {"-23.56541", "-13.60974", "53.46337"}},
    {1000, 3, 4, {"-23.55935", "-13.60423", "53.46863"}},  {1000, 4, 4, {"-23.55939", "-13.60425", "53.46866"}},
    {1000, 1, 32, {"-23.56118", "-13.60401", "53.47444"}}, {1000, 2, 32, {"-23.55941", "-13.60426", "53.46866"}},
    {1000, 3, 32, {"-23.55939", "-13.60425", "53.46866"}}, {1000, 4, 32, {"-23.55939", "-13.60425", "53.46866"}},
};

const std::string kPaperTable = "Humer, Steinbrecher, Pechstein, table of tip displacements of the arc-segment";

// The source has its centre at -e2: there u2 has the other sign.
const std::string kIndependentSource =
    "shooting on the rod ODE, Runge-Kutta 7(8), step doubling below 1e-10 (u2 mirrored: centre at +e2)";

/// All 24 rows, by slenderness.
const std::vector<PaperRow>& paper_table() {
  static const std::vector<PaperRow> rows = [] {
    std::vector<PaperRow> rounded = kRowsBeforeRounding;
    for (PaperRow& row : rounded)
      for (std::string& number : row.tip) number = rounded_to_figures(number, kPrintedFigures);
    return rounded;
  }();
  return rows;
}

const std::vector<IndependentValue> kIndependentValues = {
    {"rho=10", 10, 1, false, false, {"-23.645012476468", "-13.632073912208", "54.095027011161"}},
    {"rho=100", 100, 1, false, false, {"-23.560239545026", "-13.604521347307", "53.474858791825"}},
    {"rho=100, 5 F", 100, 5, false, false, {"-47.686369893902", "-25.056445964830", "68.539089493083"}},
    {"rho=100, shear-rigid", 100, 1, true, false, {"-23.558527901019", "-13.603966104681", "53.471762953030"}},
    {"rho=100, rigid", 100, 1, true, true, {"-23.559383718350", "-13.604243719187", "53.468598442323"}},
    {"rho=10000", 1e4, 1, false, false, {"-23.559383803932", "-13.604243746950", "53.468599068354"}}};

const std::string kPaper = "Humer, Steinbrecher, Pechstein, section \"Arc-segment under out-of-plane force\"";
const std::string kGoal = "goal of mixbeam: one load step and at most 11 iterations, up to the rigid limit";
constexpr int kGoalIterations = 11;

/// What the source claims for its values; the mesh has a much smaller error.
constexpr double kIndependentTolerance = 1e-10;
constexpr int kIndependentElements = 32;
constexpr int kIndependentOrder = 4;

constexpr double kRateTolerance = 0.15;
/// Newton is led to round-off, whose share in a displacement of a quarter of R is about this on fine meshes.
constexpr double kResidualTolerance = 1e-13;
constexpr double kRoundOff = 1e-12;

const std::vector<const char*> kComponentNames = {"u1", "u2", "u3"};

std::string short_text(double number) { return formatted("%g", number); }

Vector3 tip_displacement(const Simulation& simulation) {
  return simulation.displacement(simulation.scene().members.front().end_point);
}

/// The arc as it stands, and the shapes of the paper's figure.
void record_shapes(Application& app, const ArcScene& arc) {
  constexpr int kSamples = 17;  // of each element
  app.check_expected(app.solve_and_record(app.scene, app.solver, "single", kSamples));
  const Member& member = app.scene.members.front();
  for (double slenderness : study_list<double>(app, "Slenderness"))
    app.solve_and_record(arc.variant({slenderness, member.order, member.elements}), app.solver,
                         "single_rho" + short_text(slenderness), kSamples);
}

struct TipResult {
  PaperRow paper;
  Vector3 u;
  Vec3<double> in_paper_measure;
  int iterations;
};

std::vector<TipResult> compute_paper_table(Application& app, const ArcScene& arc) {
  std::vector<TipResult> results;
  for (const PaperRow& row : paper_table()) {
    const Simulation simulation = app.solve(arc.variant({row.slenderness, row.order, row.elements}));
    const Vector3 u = tip_displacement(simulation);
    results.push_back({row, u, Vec3<double>{{u[0], u[1], u[2]}} + offset_of_paper(simulation),
                       simulation.result().newton_iterations});
  }
  return results;
}

void write_table(const Application& app, const std::vector<TipResult>& results) {
  app.out() << "\nDisplacement of the tip against the exact arc";
  StudyTable csv(app, "table.csv",
                 {"slenderness", "order", "elements", "u1", "u2", "u3", "u1_paper_measure", "u2_paper_measure",
                  "u3_paper_measure", "paper_u1", "paper_u2", "paper_u3", "iterations"},
                 6);
  for (const TipResult& result : results) {
    const PaperRow& row = result.paper;
    const auto& [u, measured] = std::tie(result.u, result.in_paper_measure);
    csv.add_row({row.slenderness, row.order, row.elements, u[0], u[1], u[2], measured[0], measured[1], measured[2],
                 row.tip[0], row.tip[1], row.tip[2], result.iterations});
  }
}

void compare_with_paper(Application& app, const std::vector<TipResult>& results) {
  TablePrinter table(
      "\nArc-segment under out-of-plane force: displacement of the tip. The arc curves towards +e2, so that u2 < 0 as "
      "in\n"
      "the paper, and u is in the paper's measure: against a projection of the arc to polynomials of degree k.",
      {"k", "elements"}, {"u1", "u2", "u3"});
  double slenderness = 0.0;
  for (const TipResult& result : results) {
    const PaperRow& row = result.paper;
    if (row.slenderness != slenderness) table.add_group("slenderness " + short_text(slenderness = row.slenderness));
    std::vector<ComparedValue> values;
    const std::string name = formatted("rho=%g k=%d, %d elements: ", row.slenderness, row.order, row.elements);
    for (int i = 0; i < 3; ++i)
      values.push_back(compared(app, name + kComponentNames[i] + " in the paper's measure", result.in_paper_measure[i],
                                row.tip[i], kPaperTable));
    table.add_row({std::to_string(row.order), std::to_string(row.elements)}, values);
  }
  table.print(app.out());
}

void compare_with_independent_values(Application& app, const ArcScene& arc) {
  TablePrinter table("\nDisplacement of the tip beside values computed without finite elements (" +
                         std::to_string(kIndependentElements) + " elements of order " +
                         std::to_string(kIndependentOrder) + ")",
                     {"arc", ""}, {"tip displacement"}, "shooting");
  for (const IndependentValue& value : kIndependentValues) {
    const Simulation simulation = app.solve(arc.variant({value.slenderness, kIndependentOrder, kIndependentElements,
                                                         value.force_factor, value.shear_rigid, value.inextensible}));
    const Vector3 u = tip_displacement(simulation);
    for (int i = 0; i < 3; ++i) {
      const bool agrees =
          app.summary.check_relative(value.name + ": " + kComponentNames[i], u[i], printed_value(value.tip[i]),
                                     kIndependentTolerance, kIndependentSource);
      table.add_row({i == 0 ? value.name : "", kComponentNames[i]},
                    {{value.tip[i], u[i], agrees ? Agreement::agrees : Agreement::differs}});
    }
  }
  table.print(app.out());
}

/// Newton's iterations in one load step, from thick to rigid.
void report_iterations(Application& app, const ArcScene& arc) {
  constexpr double rigid = std::numeric_limits<double>::infinity();
  const int elements = app.study().get<int>("Iteration Elements");
  auto slendernesses = study_list<double>(app, "Iteration Slenderness");
  slendernesses.push_back(rigid);
  app.out() << "\nNewton iterations in one load step, " << elements << " elements";
  StudyTable table(app, "", {"slenderness", "k", "iterations"}, 3);
  for (double slenderness : slendernesses) {
    const bool is_rigid = slenderness == rigid;
    const std::string name = is_rigid ? "rigid" : short_text(slenderness);
    for (int order : study_list<int>(app, "Orders")) {
      const ArcVariant variant{is_rigid ? arc.slenderness() : slenderness, order, elements, 1.0, is_rigid, is_rigid};
      const Simulation simulation = app.solve(arc.variant(variant), with_fixed_steps(app.solver, 1), "");
      const int iterations = simulation.result().newton_iterations;
      table.add_row({name, order, iterations});
      app.summary.check_upper_bound(
          (is_rigid ? name : "rho=" + name) + " k=" + std::to_string(order) + ": Newton iterations in one load step",
          iterations, kGoalIterations, kGoal);
    }
  }
}

std::vector<int> meshes_that_divide(Application& app, int reference_elements) {
  const auto elements = study_list<int>(app, "Elements");
  for (int n : elements)
    if (reference_elements % n != 0)
      throw InputError("list \"Study\": \"Reference Elements\" = " + std::to_string(reference_elements) +
                       "; allowed: a multiple of every number of \"Elements\", and " + std::to_string(n) + " is one");
  return elements;
}

/// Error of the displacement along the arc against a much finer mesh.
void report_convergence(Application& app, const ArcScene& arc) {
  const int reference_order = app.study().get<int>("Reference Order");
  const int reference_elements = app.study().get<int>("Reference Elements");
  const auto elements = meshes_that_divide(app, reference_elements);
  SolverParameters solver = app.solver;
  solver.newton.residual_tolerance = std::min(solver.newton.residual_tolerance, kResidualTolerance);
  StudyTable csv(app, "convergence.csv", {"order", "slenderness", "elements", "l2_error"});
  ConvergenceTable table("\nError of the displacement, 1/R sqrt(1/L int |u - u_ref|^2 ds), against " +
                             std::to_string(reference_elements) + " elements of order " +
                             std::to_string(reference_order),
                         elements, kRoundOff);
  for (double slenderness : study_list<double>(app, "Slenderness")) {
    table.add_group("slenderness " + short_text(slenderness));
    const DisplacementField reference(
        app.solve(arc.variant({slenderness, reference_order, reference_elements}), solver, ""));
    for (int order : study_list<int>(app, "Orders")) {
      std::vector<double> errors;
      for (int n : elements) {
        const DisplacementField field(app.solve(arc.variant({slenderness, order, n}), solver, ""));
        errors.push_back(l2_difference(field, reference) / arc.radius());
        csv.add_row({order, slenderness, n, errors.back()});
      }
      const auto rate = table.add_row(order, errors);
      if (rate)
        app.summary.check_absolute(
            "rho=" + short_text(slenderness) + " k=" + std::to_string(order) + ": convergence rate", *rate, order + 1,
            kRateTolerance, kPaper + ": optimal rate k + 1");
    }
  }
  table.print(app.out());
}

ListSpec arc_spec() {
  constexpr double kMost = 1e12;
  ListSpec spec("Slendernesses R/a (square section of side a), orders and meshes; loads follow a^4.");
  spec.add(sizes("Slenderness", {10.0, 100.0, 1000.0}, kMost, "For the convergence study and the recorded shapes."));
  spec.add(
      counts("Orders", {1, 2, 3, 4}, 8, "Element orders k of the convergence study and of the count of iterations."));
  spec.add(counts("Elements", {2, 4, 8, 16, 32, 64, 128}, 100000,
                  "Numbers of elements of the convergence study, ascending."));
  spec.add(count("Reference Order", 4, 8, "Order of the reference mesh."));
  spec.add(count("Reference Elements", 512, 1000000,
                 "Number of elements of the reference mesh, a multiple of all the others."));
  spec.add(sizes("Iteration Slenderness", {10.0, 1e3, 1e6, 1e10}, kMost,
                 "For the count of Newton's iterations, besides the rigid limit."));
  spec.add(count("Iteration Elements", 8, 100000, "Number of elements for it."));
  return spec;
}

/// Records the arc at three slendernesses (single_rho*.h5), compares with the paper's table (table.csv) and with
/// independent values, checks Newton's iterations up to the rigid limit, and the rates of convergence
/// (convergence.csv).
void run_arc_study(Application& app) {
  const ArcScene arc(app.scene);
  record_shapes(app, arc);
  const auto results = compute_paper_table(app, arc);
  compare_with_paper(app, results);
  write_table(app, results);
  compare_with_independent_values(app, arc);
  report_iterations(app, arc);
  report_convergence(app, arc);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "arc_segment",
      "45 degree arc clamped at one end under a force out of its plane; the paper's table, convergence.",
      mixbeam::arc_spec(), mixbeam::run_arc_study);
}
