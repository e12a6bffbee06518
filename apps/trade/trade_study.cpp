// The trade between accuracy and cost: every order on every mesh of many benchmarks, and what the program makes of
// wanted accuracies on them and on the scenes of the gallery. Which order is the best for what tells
// apps/plots/trade_page.py.
#include "apps/common/run/expected_quantity.hpp"
#include "apps/common/studies/study.hpp"
#include "apps/common/tables/convergence_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/trade/cell.hpp"
#include "discretization/parameters/binding.hpp"
#include "kernels/element/layout.hpp"

#include <algorithm>
#include <ostream>

namespace mixbeam {

namespace {

constexpr double kMostElements = 100000.0;

/// The references agree to this: a tenth of the smallest accuracy that every benchmark is judged by.
constexpr double kReferencesAgree = 1e-10;
// Confirm the references of the scenes of the gallery: another order, one and a half times as many elements.
constexpr int kConfirmingOrder = 6;
constexpr std::pair<int, int> kConfirmingElements{3, 2};

// Theory: polynomials of degree k. Higher orders reach round-off on meshes too coarse to tell a rate.
constexpr int kHighestRatedOrder = 4;
constexpr double kRateTolerance = 0.2;
constexpr double kRateRoundOff = 1e-10;

// Estimates are judged where the true error is neither that of a mesh that says little nor that of rounding, and known
// to a tenth by the references.
constexpr double kLargestError = 1e-2, kSmallestError = 1e-10, kAboveDifference = 10.0;
constexpr double kFactor = 5.0, kShareBeyond = 0.05, kMostBelow = 10.0;

/// The two solutions against each other, and the finer one against closed forms and values from the literature.
void check_reference(Application& app, const BenchmarkProblem& problem, const Reference& reference) {
  const std::string& name = problem.about.name;
  app.summary.check_upper_bound(name + ": difference of the references", problem.judged(reference.difference),
                                kReferencesAgree, "another order on another mesh");
  if (problem.about.file.empty()) return app.check_expected(reference.simulation);
  for (const ExpectedValue& value : problem.expected)
    if (const auto present = present_value(reference.simulation, value))
      app.summary.check_expected(name + ": " + value.name, *present, value);
}

/// The error of the centerline falls with the power k + 1 of the element length.
void check_rates(Application& app, const BenchmarkResult& result, const TradePlan& plan) {
  for (const int order : plan.orders) {
    std::vector<int> elements;
    std::vector<double> errors;
    for (const CellResult& cell : result.cells) {
      if (cell.mesh.order != order || cell.mesh.integration != ForceIntegration::both_reduced || !cell.converged())
        continue;
      elements.push_back(cell.mesh.elements);
      errors.push_back(cell.errors[kCenterline]);
    }
    const auto rate = observed_rate(elements, errors, kRateRoundOff);
    if (order > kHighestRatedOrder || !rate) continue;
    app.summary.check_absolute(result.problem.about.name + " k=" + std::to_string(order) + ": rate of the centerline",
                               *rate, order + 1, kRateTolerance,
                               "Humer, Steinbrecher, Pechstein: polynomials of degree k, optimal rate k + 1");
  }
}

bool is_judged(const BenchmarkResult& result, const CellResult& cell, int quantity) {
  const double error = cell.errors[quantity];
  return cell.converged() && cell.mesh.integration == ForceIntegration::both_reduced && error >= kSmallestError &&
         error <= kLargestError && error >= kAboveDifference * result.difference[quantity];
}

/// Promised of displacements and moments; the energy is told beside.
void check_estimates(Application& app, const std::vector<BenchmarkResult>& results) {
  for (const int quantity : {kDisplacement, kCenterline, kMoment}) {
    int cells = 0, within = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const BenchmarkResult& result : results)
      for (const CellResult& cell : result.cells) {
        if (!is_judged(result, cell, quantity)) continue;
        const double ratio = cell.estimated[quantity] / cell.errors[quantity];
        ++cells;
        within += ratio >= 1.0 / kFactor && ratio <= kFactor ? 1 : 0;
        least = std::fmin(least, ratio);
      }
    if (cells == 0) continue;
    const std::string name = std::string("estimate of the ") + kErrorNames[quantity];
    app.summary.check_upper_bound(name + ": cells beyond a factor of 5", 1.0 - static_cast<double>(within) / cells,
                                  kShareBeyond, "goal of mixbeam: 95 % of all cells within a factor of 5");
    app.summary.check_upper_bound(name + ": largest true error over estimate", 1.0 / least, kMostBelow,
                                  "goal of mixbeam: never less than a tenth");
  }
}

/// Cells, then accuracies, and what is promised of them.
BenchmarkResult compute(Application& app, const Benchmark& benchmark, const TradePlan& plan) {
  const auto mesh = [](const std::array<int, 2>& numbers) { return Discretization{numbers[0], numbers[1]}; };
  BenchmarkResult result{read_benchmark(app, benchmark), mesh(plan.reference), mesh(plan.confirmation)};
  const BenchmarkProblem& problem = result.problem;
  if (benchmark.in_gallery) {
    const int finest = problem.own_elements() * benchmark.refinement;
    result.reference = {kMaximumOrder, finest};
    result.confirmation = {kConfirmingOrder, finest * kConfirmingElements.first / kConfirmingElements.second};
  }
  const Reference reference(problem, app.communicator, result.reference, result.confirmation);
  result.difference = reference.difference;
  check_reference(app, problem, reference);
  measure_cells(result, reference, plan);
  for (const double wanted : plan.accuracies)
    result.accurate.push_back(measure_accurate_cell(result, reference, wanted, plan));
  if (benchmark.rates) check_rates(app, result, plan);
  for (const AccurateCell& cell : result.accurate)
    if (cell.wanted >= result.floor())
      app.summary.check_upper_bound(
          benchmark.name + ": error for a wanted accuracy of " + formatted("%.0e", cell.wanted),
          motion_error(cell.errors), cell.wanted, "the accuracy that was asked for");
  for (const CellResult& cell : result.cells) {
    app.summary.load_steps += cell.load_steps;
    app.summary.newton_iterations += cell.iterations;
  }
  return result;
}

std::string mesh_text(const Discretization& mesh) {
  return std::to_string(mesh.order) + " x " + std::to_string(mesh.elements);
}

/// "5 x 4, 7 x 6": order and elements of the members, those of the finest member where they differ; mesh after mesh,
/// with a star where the solution was carried over.
std::string meshes_text(const AccurateCell& cell) {
  std::string text;
  for (const MeshRound& round : cell.rounds) {
    const auto work = [](const MemberMesh& mesh) { return (mesh.order + 1) * mesh.elements; };
    const MemberMesh finest = *std::max_element(round.mesh.begin(), round.mesh.end(),
                                                [&](const auto& a, const auto& b) { return work(a) < work(b); });
    text += (text.empty() ? "" : ", ") + mesh_text({finest.order, finest.elements}) +
            (round.followed || &round == &cell.rounds.front() ? "" : "*");
  }
  return text;
}

std::vector<std::string> columns_of_cells(const std::vector<int>& threads) {
  std::vector<std::string> columns = words(
      "benchmark,integration,order,elements,status,set,flops,global_unknowns,interior_unknowns,load_steps,"
      "failed_steps,newton_iterations,largest_error");
  for (const char* what : {"_error", "_estimate"})
    for (const char* quantity : kErrorNames) columns.push_back(quantity + std::string(what));
  columns.emplace_back("estimate_seconds");
  for (const int n : threads)
    for (const char* what : kTimeNames) columns.push_back(what + std::to_string(n));
  return columns;
}

std::vector<CsvCell> row_of(const Benchmark& about, const CellResult& cell, const std::vector<int>& threads) {
  const char* integration = cell.mesh.integration == ForceIntegration::full ? "full" : "both reduced";
  const char* status = kStatusNames[static_cast<std::size_t>(cell.status)];
  std::vector<CsvCell> row = {about.name, integration, cell.mesh.order, cell.mesh.elements, status, about.set()};
  const auto add = [&row](const auto& numbers) { row.insert(row.end(), numbers.begin(), numbers.end()); };
  row.emplace_back(cell.flops);
  add(std::array{cell.global_unknowns, cell.interior_unknowns, cell.load_steps, cell.failed_steps, cell.iterations});
  row.emplace_back(largest_error(cell.errors));
  add(cell.errors);
  add(cell.estimated);
  row.emplace_back(cell.estimate_seconds);
  for (const int n : threads) {
    const auto found = cell.times.find(n);
    add(found == cell.times.end() ? RunTimes{std::nan(""), std::nan(""), std::nan("")} : found->second);
  }
  return row;
}

std::vector<std::string> names_of(bool gallery) {
  std::vector<std::string> names;
  for (const Benchmark& benchmark : benchmarks_of(gallery)) names.push_back(benchmark.name);
  return names;
}

BoundList<TradePlan> declared_plan() {
  using Plan = TradePlan;
  BoundList<Plan> list("Which benchmarks and which cells; a single cell can be measured again by naming it alone.");
  const auto add_names = [&list](auto field, const char* name, bool gallery, const char* meaning) {
    const std::vector<std::string> all = names_of(gallery);
    list.bind(field, subset(name, all).by_default(Teuchos::Array<std::string>(all)), meaning);
  };
  const auto add_counts = [&list](auto field, const char* name, double most, const char* meaning, int length = 0) {
    const ParameterSpec numbers = array(name, ParameterType::integer_array, length);
    list.bind(field, numbers.at_least(1.0).at_most(most).by_default(), meaning);
  };
  add_names(&Plan::benchmarks, "Benchmarks", false,
            "Those that are measured; thick_cantilever is the scene of this file, whatever it is.");
  add_names(&Plan::gallery, "Gallery", true, "Scenes of the gallery on which the program is asked for the accuracies.");
  add_counts(&Plan::orders, "Orders", kMaximumOrder, "Element orders k.");
  add_counts(&Plan::elements, "Elements", kMostElements, "Numbers of elements of each member.");
  add_counts(&Plan::reference, "Reference", kMostElements, "Order and elements of each member of the reference.", 2);
  add_counts(&Plan::confirmation, "Confirmation", kMostElements, "The same of the solution that confirms it.", 2);
  list.bind(&Plan::accuracies, array("Accuracies", ParameterType::real_array).above(0.0).below(1.0).by_default(),
            "Errors of displacements that the program is asked for, to choose meshes itself.");
  add_counts(&Plan::threads, "Threads", kMostElements, "Numbers of threads; recommendations are those of the first.");
  list.bind(&Plan::repetitions, integer("Repetitions").at_least(1.0).at_most(1000.0).by_default(),
            "Timed runs of a cell with each number of threads, at most; at least three if Seconds allow.");
  list.bind(&Plan::budget, real("Seconds").at_least(0.0).by_default(),
            "For the repetitions of a cell; else one run counts.");
  list.bind(&Plan::most_seconds, real("Most Seconds").above(0.0).by_default(),
            "Processor time: a cell that takes longer is stopped after its load step, finer meshes are left out.");
  return list;
}

void run_trade_study(Application& app) {
  TradePlan plan = declared_plan().read(app.study());
  plan.communicator = app.communicator;
  std::sort(plan.orders.begin(), plan.orders.end());
  std::sort(plan.elements.begin(), plan.elements.end());
  StudyTable benchmarks(app, "benchmarks.csv",
                        words("benchmark,set,kind,members,point,floor,displacement_difference,centerline_difference,"
                              "moment_difference,energy_difference,values_checked,reference,confirmation"));
  StudyTable cells(app, "trade.csv", columns_of_cells(plan.threads));
  StudyTable accuracies(app, "accuracy.csv",
                        words("benchmark,wanted,outcome,meshes,estimated_error,displacement_error,centerline_error,"
                              "path_error,threads,seconds,best_order,best_elements,best_seconds,ratio,set,rounds"),
                        14);
  const auto add_rows = [&](const BenchmarkResult& result) {
    const Benchmark& about = result.problem.about;
    const Errors& d = result.difference;
    benchmarks.add_row({about.name, about.set(), about.kind, result.problem.scene.members.size(), about.point,
                        result.floor(), d[0], d[1], d[2], d[3], result.problem.expected.size(),
                        mesh_text(result.reference), mesh_text(result.confirmation)});
    for (const CellResult& cell : result.cells) cells.add_row(row_of(about, cell, plan.threads));
    for (const AccurateCell& cell : result.accurate)
      for (const auto& [threads, price] : cell.prices) {
        const Discretization best = price.best.value_or(Discretization{0, 0});
        accuracies.add_row({about.name, cell.wanted, text_of(cell.end), meshes_text(cell), cell.rounds.back().error,
                            cell.errors[kDisplacement], cell.errors[kCenterline], cell.path_error, threads,
                            price.seconds, best.order, best.elements, price.best_seconds,
                            price.seconds / price.best_seconds, about.set(), cell.rounds.size()});
      }
  };
  std::vector<BenchmarkResult> results;
  const auto run = [&](const std::vector<std::string>& chosen, bool gallery) {
    for (const Benchmark& benchmark : benchmarks_of(gallery))
      if (std::find(chosen.begin(), chosen.end(), benchmark.name) != chosen.end()) {
        results.push_back(compute(app, benchmark, plan));
        add_rows(results.back());
      }
  };
  run(plan.benchmarks, false);
  check_estimates(app, results);
  run(plan.gallery, true);
  write_machine(app);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "trade",
      "what each digit costs: error against time for every element order and mesh, on many scenes.",
      mixbeam::declared_plan().spec, mixbeam::run_trade_study);
}
