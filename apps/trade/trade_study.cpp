#include "apps/trade/trade_study.hpp"

#include "apps/common/run/expected_quantity.hpp"
#include "apps/common/session/machine_facts.hpp"
#include "apps/common/tables/convergence_table.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/trade/estimate_check.hpp"
#include "apps/trade/matrix.hpp"
#include "apps/trade/trade_page.hpp"
#include "apps/trade/trade_tables.hpp"
#include "kernels/element/layout.hpp"

#include <algorithm>
#include <fstream>
#include <ostream>

namespace mixbeam {

namespace {

constexpr double kMostElements = 100000.0;

/// The references agree to this: a tenth of the smallest accuracy that every benchmark is judged by.
constexpr double kReferencesAgree = 1e-10;

// Theory: polynomials of degree k. Higher orders reach round-off on meshes too coarse to tell a rate.
constexpr int kHighestRatedOrder = 4;
constexpr double kRateTolerance = 0.2;
constexpr double kRateRoundOff = 1e-10;

// Confirm the references of the scenes of the gallery: another order, one and a half times as many elements.
constexpr int kConfirmingOrder = 6;
constexpr std::pair<int, int> kConfirmingElements{3, 2};

constexpr double kShareBeyond = 0.05, kMostBelow = 10.0;

std::vector<int> counts_of(Application& app, const char* name) {
  std::vector<int> counts = app.study().get<Teuchos::Array<int>>(name).toVector();
  std::sort(counts.begin(), counts.end());
  return counts;
}

MatrixPlan plan_of(Application& app) {
  Teuchos::ParameterList& study = app.study();
  const auto reference = study.get<Teuchos::Array<int>>("Reference");
  const auto confirmation = study.get<Teuchos::Array<int>>("Confirmation");
  MatrixPlan plan;
  plan.orders = counts_of(app, "Orders");
  plan.elements = counts_of(app, "Elements");
  plan.reference = {reference[0], reference[1]};
  plan.confirmation = {confirmation[0], confirmation[1]};
  plan.accuracies = study.get<Teuchos::Array<double>>("Accuracies").toVector();
  plan.timing.threads = study.get<Teuchos::Array<int>>("Threads").toVector();
  plan.timing.repetitions = study.get<int>("Repetitions");
  plan.timing.budget = study.get<double>("Seconds");
  plan.timing.most_seconds = study.get<double>("Most Seconds");
  return plan;
}

/// The two solutions against each other, and the finer one against closed forms and values from the literature.
void check_reference(Application& app, const BenchmarkProblem& problem, const Reference& reference) {
  const std::string& name = problem.about.name;
  const Errors& difference = reference.difference();
  app.summary.check_upper_bound(name + ": difference of the references",
                                problem.about.in_gallery ? motion_error(difference) : difference.largest(),
                                kReferencesAgree, "another order on another mesh");
  if (problem.about.file.empty()) return app.check_expected(reference.simulation());
  for (const ExpectedValue& value : problem.expected) {
    const auto present = present_value(reference.simulation(), value);
    if (!present) continue;
    const std::string what = name + ": " + value.name;
    if (value.kind == ToleranceKind::absolute)
      app.summary.check_absolute(what, *present, value.value, value.tolerance, value.source);
    else
      app.summary.check_relative(what, *present, value.value, value.tolerance, value.source);
  }
}

/// The error of the centerline falls with the power k + 1 of the element length.
void check_rates(Application& app, const BenchmarkResult& result, const MatrixPlan& plan) {
  if (!result.problem.about.rates) return;
  for (const int order : plan.orders) {
    if (order > kHighestRatedOrder) continue;
    std::vector<int> elements;
    std::vector<double> errors;
    for (const CellResult& cell : result.cells) {
      if (cell.cell.order != order || cell.cell.integration != ForceIntegration::both_reduced || !cell.converged())
        continue;
      elements.push_back(cell.cell.elements);
      errors.push_back(cell.errors.centerline);
    }
    const auto rate = observed_rate(elements, errors, kRateRoundOff);
    if (!rate) continue;
    app.summary.check_absolute(result.problem.about.name + " k=" + std::to_string(order) + ": rate of the centerline",
                               *rate, order + 1, kRateTolerance,
                               "Humer, Steinbrecher, Pechstein: polynomials of degree k, optimal rate k + 1");
  }
}

/// Promised of displacements and moments; the energy is told beside.
void check_estimates(Application& app, const std::vector<BenchmarkResult>& results) {
  for (const EstimateJudgement& judgement : judge_estimates(results)) {
    if (judgement.cells == 0 || judgement.quantity == "energy") continue;
    const std::string name = "estimate of the " + judgement.quantity;
    app.summary.check_upper_bound(name + ": cells beyond a factor of 5", 1.0 - judgement.share(), kShareBeyond,
                                  "goal of mixbeam: 95 % of all cells within a factor of 5");
    app.summary.check_upper_bound(name + ": largest true error over estimate", 1.0 / judgement.least, kMostBelow,
                                  "goal of mixbeam: never less than a tenth");
  }
}

/// What the program promises for a wanted accuracy, where the references tell so small errors.
void check_accuracies(Application& app, const BenchmarkResult& result) {
  for (const AccurateCell& cell : result.accurate)
    if (cell.wanted >= result.floor())
      app.summary.check_upper_bound(
          result.problem.about.name + ": error for a wanted accuracy of " + accuracy_text(cell.wanted),
          motion_error(cell.errors), cell.wanted, "the accuracy that was asked for");
}

void count_work(Application& app, const BenchmarkResult& result) {
  for (const CellResult& cell : result.cells) {
    app.summary.load_steps += cell.load_steps;
    app.summary.newton_iterations += cell.iterations;
  }
}

BenchmarkResult compute(Application& app, const Benchmark& benchmark, const MatrixPlan& plan) {
  const BenchmarkProblem problem = read_benchmark(app, benchmark);
  const Reference reference(problem, app.communicator, plan.reference, plan.confirmation);
  check_reference(app, problem, reference);
  BenchmarkResult result = measure_matrix(problem, reference, plan, app.communicator);
  for (const double wanted : plan.accuracies)
    result.accurate.push_back(measure_accurate_cell(result, reference, wanted, plan.timing, app.communicator));
  check_rates(app, result, plan);
  check_accuracies(app, result);
  count_work(app, result);
  print_matrix(app.out(), result, plan.timing.threads.front());
  return result;
}

/// A scene of the gallery.
BenchmarkResult compute_scene(Application& app, const Benchmark& scene, const MatrixPlan& plan) {
  const BenchmarkProblem problem = read_benchmark(app, scene);
  const int finest = problem.own_elements() * scene.refinement;
  const Discretization confirmation{kConfirmingOrder, finest * kConfirmingElements.first / kConfirmingElements.second};
  const Reference reference(problem, app.communicator, {kMaximumOrder, finest}, confirmation);
  check_reference(app, problem, reference);
  BenchmarkResult result = measure_front(problem, reference, plan, app.communicator);
  for (const double wanted : plan.accuracies)
    result.accurate.push_back(measure_accurate_cell(result, reference, wanted, plan.timing, app.communicator));
  check_accuracies(app, result);
  count_work(app, result);
  return result;
}

using Compute = BenchmarkResult (*)(Application&, const Benchmark&, const MatrixPlan&);

/// Those of a list that the parameter `name` of the study names.
std::vector<BenchmarkResult> compute_chosen(Application& app, const std::vector<Benchmark>& list, const char* name,
                                            Compute compute_one, const MatrixPlan& plan) {
  const auto chosen = app.study().get<Teuchos::Array<std::string>>(name);
  std::vector<BenchmarkResult> results;
  for (const Benchmark& benchmark : list)
    if (std::find(chosen.begin(), chosen.end(), benchmark.name) != chosen.end())
      results.push_back(compute_one(app, benchmark, plan));
  return results;
}

void write_machine(const Application& app) {
  CsvTable machine(app.output / "machine.csv", {"name", "value"});
  for (const auto& [name, value] : machine_facts()) machine.add_row({name, value});
}

}  // namespace

ListSpec trade_spec() {
  const auto counts = [](const char* name, const std::vector<int>& by_default, double most, const char* meaning,
                         int length = 0) {
    const ParameterSpec list = array(name, ParameterType::integer_array, length).at_least(1).at_most(most);
    return list.by_default(Teuchos::Array<int>(by_default)).means(meaning);
  };
  ListSpec spec("Which benchmarks and which cells; a single cell can be measured again by naming it alone.");
  spec.add(subset("Benchmarks", names_of(all_benchmarks()))
               .by_default(Teuchos::Array<std::string>(names_of(all_benchmarks())))
               .means("Those that are measured; thick_cantilever is the scene of this file, whatever it is."));
  spec.add(subset("Gallery", names_of(all_scenes()))
               .by_default(Teuchos::Array<std::string>(names_of(all_scenes())))
               .means("Scenes of the gallery on which the program is asked for the accuracies."));
  spec.add(counts("Orders", {1, 2, 3, 4, 5, 6, 7, 8}, kMaximumOrder, "Element orders k."));
  spec.add(counts("Elements", {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024}, kMostElements,
                  "Numbers of elements of each member."));
  spec.add(counts("Reference", {8, 64}, kMostElements, "Order and elements of each member of the reference.", 2));
  spec.add(counts("Confirmation", {6, 96}, kMostElements, "The same of the solution that confirms it.", 2));
  spec.add(array("Accuracies", ParameterType::real_array)
               .above(0.0)
               .below(1.0)
               .by_default(Teuchos::Array<double>(std::vector<double>{1e-3, 1e-6, 1e-9}))
               .means("Errors of displacements that the program is asked for, to choose meshes itself."));
  spec.add(counts("Threads", {1, 2}, kMostElements, "Numbers of threads; recommendations are those of the first."));
  spec.add(integer("Repetitions")
               .at_least(1)
               .at_most(1000)
               .by_default(7)
               .means("Timed runs of a cell with each number of threads, at most; at least three if Seconds allow."));
  spec.add(real("Seconds").at_least(0.0).by_default(0.06).means("For the repetitions of a cell; else one run counts."));
  spec.add(
      real("Most Seconds")
          .above(0.0)
          .by_default(0.5)
          .means(
              "Processor time: a cell that takes longer is stopped after its load step, finer meshes are left out."));
  return spec;
}

void run_trade_study(Application& app) {
  const MatrixPlan plan = plan_of(app);
  const auto results = compute_chosen(app, all_benchmarks(), "Benchmarks", compute, plan);
  const auto gallery = compute_chosen(app, all_scenes(), "Gallery", compute_scene, plan);
  print_recommendation(app.out(), results, plan.timing.threads.front());
  print_judgements(app.out(), results);
  check_estimates(app, results);
  print_accuracies(app.out(), results);
  print_accuracies(app.out(), gallery);
  if (!app.writes_files()) return;
  write_tables(app.output, results, gallery, plan.timing.threads);
  write_estimates(app.output / "estimates.csv", results);
  write_machine(app);
  std::ofstream page(app.output / "trade.md");
  write_page(page, results, gallery, plan);
}

}  // namespace mixbeam
