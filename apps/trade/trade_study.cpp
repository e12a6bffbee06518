// The trade between accuracy and cost: every order on every mesh of many benchmarks, and what the program makes of
// wanted accuracies on them and on the scenes of the gallery. Which order is the best for what tells
// apps/plots/trade_page.py.
#include "apps/common/run/expected_quantity.hpp"
#include "apps/common/studies/study.hpp"
#include "apps/common/tables/convergence_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/trade/cell.hpp"
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

MatrixPlan plan_of(Application& app) {
  const auto integers = [&app](const char* name) { return study_list<int>(app, name); };
  const auto mesh = [&](const char* name) { return Discretization{integers(name)[0], integers(name)[1]}; };
  Teuchos::ParameterList& study = app.study();
  MatrixPlan plan{integers("Orders"),
                  integers("Elements"),
                  mesh("Reference"),
                  mesh("Confirmation"),
                  {app.communicator, integers("Threads"), study.get<int>("Repetitions"), study.get<double>("Seconds"),
                   study.get<double>("Most Seconds")},
                  study_list<double>(app, "Accuracies")};
  std::sort(plan.orders.begin(), plan.orders.end());
  std::sort(plan.elements.begin(), plan.elements.end());
  return plan;
}

/// The two solutions against each other, and the finer one against closed forms and values from the literature.
void check_reference(Application& app, const BenchmarkProblem& problem, const Reference& reference) {
  const std::string& name = problem.about.name;
  const Errors& difference = reference.difference();
  app.summary.check_upper_bound(name + ": difference of the references",
                                problem.about.in_gallery ? motion_error(difference) : largest_error(difference),
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
  for (const int order : plan.orders) {
    std::vector<int> elements;
    std::vector<double> errors;
    for (const CellResult& cell : result.cells) {
      if (cell.cell.order != order || cell.cell.integration != ForceIntegration::both_reduced || !cell.converged())
        continue;
      elements.push_back(cell.cell.elements);
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
  return cell.converged() && cell.cell.integration == ForceIntegration::both_reduced && error >= kSmallestError &&
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
BenchmarkResult compute(Application& app, const Benchmark& benchmark, const MatrixPlan& plan) {
  BenchmarkResult result{read_benchmark(app, benchmark), plan.reference, plan.confirmation};
  const BenchmarkProblem& problem = result.problem;
  if (benchmark.in_gallery) {
    const int finest = problem.own_elements() * benchmark.refinement;
    result.reference = {kMaximumOrder, finest};
    result.confirmation = {kConfirmingOrder, finest * kConfirmingElements.first / kConfirmingElements.second};
  }
  const Reference reference(problem, app.communicator, result.reference, result.confirmation);
  result.difference = reference.difference();
  check_reference(app, problem, reference);
  (benchmark.in_gallery ? measure_front : measure_matrix)(result, reference, plan);
  for (const double wanted : plan.accuracies)
    result.accurate.push_back(measure_accurate_cell(result, reference, wanted, plan.timing));
  if (benchmark.rates) check_rates(app, result, plan);
  for (const AccurateCell& cell : result.accurate) {
    if (cell.wanted >= result.floor())
      app.summary.check_upper_bound(
          benchmark.name + ": error for a wanted accuracy of " + formatted("%.0e", cell.wanted),
          motion_error(cell.errors), cell.wanted, "the accuracy that was asked for");
  }
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

/// The tables of the study, row by row.
class TradeTables {
 public:
  TradeTables(const Application& app, const MatrixPlan& plan)
      : plan_(plan),
        benchmarks_(app, "benchmarks.csv",
                    words("benchmark,set,kind,members,point,floor,displacement_difference,centerline_difference,"
                          "moment_difference,energy_difference,values_checked,reference,confirmation")),
        cells_(app, "trade.csv", columns_of_cells(plan.timing.threads)),
        accuracies_(app, "accuracy.csv",
                    words("benchmark,wanted,outcome,meshes,estimated_error,displacement_error,centerline_error,"
                          "path_error,threads,seconds,best_order,best_elements,best_seconds,ratio,set,rounds"),
                    14) {}

  void add(const BenchmarkResult& result) {
    const BenchmarkProblem& problem = result.problem;
    const Benchmark& about = problem.about;
    const char* set = about.in_gallery ? "gallery" : "matrix";
    const Errors& d = result.difference;
    benchmarks_.add_row({about.name, set, about.kind, problem.scene.members.size(), about.point, result.floor(), d[0],
                         d[1], d[2], d[3], problem.expected.size(), mesh_text(result.reference),
                         mesh_text(result.confirmation)});
    for (const CellResult& cell : result.cells) cells_.add_row(row_of(about.name, set, cell));
    for (const AccurateCell& cell : result.accurate)
      for (const auto& [threads, price] : cell.prices)
        accuracies_.add_row({about.name, cell.wanted, text_of(cell.end), meshes_text(cell), cell.rounds.back().error,
                             cell.errors[kDisplacement], cell.errors[kCenterline], cell.path_error, threads,
                             price.seconds, price.best ? price.best->order : 0, price.best ? price.best->elements : 0,
                             price.best_seconds, price.seconds / price.best_seconds, set, cell.rounds.size()});
  }

 private:
  static std::vector<std::string> columns_of_cells(const std::vector<int>& threads) {
    std::vector<std::string> columns = words(
        "benchmark,integration,order,elements,status,set,flops,global_unknowns,interior_unknowns,load_steps,"
        "failed_steps,newton_iterations,largest_error");
    for (const char* what : {"_error", "_estimate"})
      for (const char* quantity : kErrorNames) columns.push_back(quantity + std::string(what));
    columns.emplace_back("estimate_seconds");
    for (const int n : threads)
      for (const char* what : {"seconds_", "setup_seconds_", "processor_seconds_"})
        columns.push_back(what + std::to_string(n));
    return columns;
  }

  std::vector<CsvCell> row_of(const std::string& name, const char* set, const CellResult& cell) const {
    const bool full = cell.cell.integration == ForceIntegration::full;
    const char* integration = full ? "full" : "both reduced";
    const char* status = kStatusNames[static_cast<std::size_t>(cell.status)];
    std::vector<CsvCell> row = {name, integration, cell.cell.order, cell.cell.elements, status, set, cell.flops};
    for (const int count :
         {cell.global_unknowns, cell.interior_unknowns, cell.load_steps, cell.failed_steps, cell.iterations})
      row.emplace_back(count);
    row.emplace_back(largest_error(cell.errors));
    for (const Errors& errors : {cell.errors, cell.estimated}) row.insert(row.end(), errors.begin(), errors.end());
    row.emplace_back(cell.estimate_seconds);
    for (const int n : plan_.timing.threads) {
      const auto found = cell.times.find(n);
      const RunTimes times = found == cell.times.end() ? RunTimes{} : found->second;
      for (const double value : {times.seconds, times.setup_seconds, times.processor_seconds}) row.emplace_back(value);
    }
    return row;
  }

  const MatrixPlan& plan_;
  StudyTable benchmarks_, cells_, accuracies_;
};

std::vector<std::string> names_of(const std::vector<Benchmark>& list) {
  std::vector<std::string> names;
  for (const Benchmark& benchmark : list) names.push_back(benchmark.name);
  return names;
}

ListSpec trade_spec() {
  const auto pair = [](const char* name, const std::vector<int>& by_default, const char* meaning) {
    ParameterSpec spec = counts(name, by_default, kMostElements, meaning);
    spec.length = 2;
    return spec;
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
  spec.add(pair("Reference", {8, 64}, "Order and elements of each member of the reference."));
  spec.add(pair("Confirmation", {6, 96}, "The same of the solution that confirms it."));
  spec.add(
      array("Accuracies", ParameterType::real_array).above(0.0).below(1.0).by_default(Teuchos::tuple(1e-3, 1e-6, 1e-9)),
      "Errors of displacements that the program is asked for, to choose meshes itself.");
  spec.add(counts("Threads", {1, 2}, kMostElements, "Numbers of threads; recommendations are those of the first."));
  spec.add(count("Repetitions", 7, 1000,
                 "Timed runs of a cell with each number of threads, at most; at least three if Seconds allow."));
  spec.add(real("Seconds").at_least(0.0).by_default(0.06), "For the repetitions of a cell; else one run counts.");
  spec.add(real("Most Seconds").above(0.0).by_default(0.5),
           "Processor time: a cell that takes longer is stopped after its load step, finer meshes are left out.");
  return spec;
}

void run_trade_study(Application& app) {
  const MatrixPlan plan = plan_of(app);
  TradeTables tables(app, plan);
  std::vector<BenchmarkResult> results;
  const auto run_chosen = [&](const std::vector<Benchmark>& list, const char* parameter) {
    const auto chosen = study_list<std::string>(app, parameter);
    for (const Benchmark& benchmark : list)
      if (std::find(chosen.begin(), chosen.end(), benchmark.name) != chosen.end()) {
        results.push_back(compute(app, benchmark, plan));
        tables.add(results.back());
      }
  };
  run_chosen(all_benchmarks(), "Benchmarks");
  check_estimates(app, results);
  run_chosen(all_scenes(), "Gallery");
  write_machine(app);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "trade",
      "what each digit costs: error against time for every element order and mesh, on many scenes.",
      mixbeam::trade_spec(), mixbeam::run_trade_study);
}
