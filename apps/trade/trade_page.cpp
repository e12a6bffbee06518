#include "apps/trade/trade_page.hpp"

#include "apps/common/session/machine_facts.hpp"
#include "apps/common/tables/convergence_table.hpp"
#include "apps/trade/estimate_check.hpp"
#include "apps/trade/trade_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <set>

namespace mixbeam {

namespace {

template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

using Results = std::vector<BenchmarkResult>;

/// Median over the cells: 1 on an idle machine.
double wall_over_processor(const Results& results, int threads) {
  std::vector<double> ratios;
  for (const BenchmarkResult& result : results)
    for (const CellResult& cell : result.cells)
      if (cell.converged()) ratios.push_back(cell.seconds(threads) / cell.processor_seconds(threads));
  if (ratios.empty()) return std::nan("");
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<long>(ratios.size() / 2), ratios.end());
  return ratios[ratios.size() / 2];
}

void write_head(std::ostream& page, const Results& results, const MatrixPlan& plan) {
  int cells = 0, converged = 0;
  for (const BenchmarkResult& result : results)
    for (const CellResult& cell : result.cells) {
      cells += cell.status == CellStatus::converged || cell.status == CellStatus::failed ? 1 : 0;
      converged += cell.converged() ? 1 : 0;
    }
  page << "# The trade between accuracy and cost\n\n"
          "Every element order on every mesh, on "
       << results.size()
       << " structures: what each digit costs, and which order pays when.\nWritten by the program; to renew it:\n\n"
          "```sh\n./run.sh trade && cp results/trade/trade.md results/trade/*.png apps/docs/\n```\n\n";
  for (const auto& [name, value] : machine_facts())
    if (name != "flags") page << name << " " << value << ", ";
  page << today() << "; " << cells << " cells, " << converged << " with an equilibrium.\n\n"
       << "A cell is an order k on a number of elements for each member, written k x n. Its error is the largest of "
          "four, all\nrelative to a reference: displacement of a tip, centerline and material moment in the L2 norm, "
          "strain energy. Its time\nis the processor time with one thread from the scene to equilibrium, reading left "
          "out, "
          "which is the wall time on an idle\nmachine: the median of several runs for short ones. Wall times are in "
          "trade.csv; here they were "
       << format("%.2f", wall_over_processor(results, plan.timing.threads.front()))
       << " times as long (median).\nStability is looked at only where a branch is followed.\n";
}

/// A row for each accuracy, the price of each order in it.
void write_prices(std::ostream& page, const Results& results, const MatrixPlan& plan, const Criterion& by) {
  page << "| error | benchmarks |";
  for (const int order : plan.orders) page << " k = " << order << " |";
  page << " take k | n | cost against 1e-02 |\n| --- | --- |";
  for (std::size_t i = 0; i < plan.orders.size(); ++i) page << " --- |";
  page << " --- | --- | --- |\n";
  for (const double accuracy : accuracies()) {
    const auto prices = order_prices(results, by, accuracy);
    const auto best = best_order(prices);
    if (!best) continue;
    page << "| " << accuracy_text(accuracy) << " | " << best->judged << " |";
    for (const OrderPrice& price : prices) {
      const std::string text = format("%.2f (%.1f)", price.mean, price.worst);
      page << " "
           << (price.reached < best->reached ? format("%d of %d", price.reached, price.judged)
               : price.order == best->order  ? "**" + text + "**"
                                             : text)
           << " |";
    }
    page << format(" **%d** | %.0f | %.1f |\n", best->order, best->elements,
                   cost_ratio(results, by, accuracy, accuracies().front()));
  }
}

void write_orders(std::ostream& page, const Results& results, const MatrixPlan& plan) {
  page
      << "\n## Which order to take\n\n"
         "Price of an order: cost of its cheapest mesh over that of the cheapest mesh of all orders, geometric mean "
         "over the\nbenchmarks (largest in brackets). Where an order misses the accuracy on some benchmarks with the "
         "meshes allowed, it says on\nhow many it is reached. `benchmarks`: those on which the accuracy can be judged. "
         "`n`: elements of each member for the\norder taken, geometric mean.\n\n"
         "![Price of each order](trade_orders.png)\n\n"
         "Meshes are powers of two, so that prices below about 1.5 are as good as equal. By time:\n\n";
  write_prices(page, results, plan, {largest_error, processor_time(plan.timing.threads.front())});
  page << "\nBy floating-point operations (counted for a Newton iteration of a plain section, times iterations): what "
          "large structures\ncost, where the time does not go into what is the same on every mesh.\n\n";
  write_prices(page, results, plan, {largest_error, operations});
  page << "\n![What each digit costs](trade_digits.png)\n";
}

void write_cheapest(std::ostream& page, const Results& results, const ErrorMeasure& error, int threads) {
  const Criterion by{error, processor_time(threads)};
  page << "| benchmark |";
  for (const double accuracy : accuracies()) page << " " << accuracy_text(accuracy) << " |";
  page << "\n| --- |";
  for (std::size_t i = 0; i < accuracies().size(); ++i) page << " --- |";
  page << "\n";
  for (const BenchmarkResult& result : results) {
    page << "| " << result.problem.about.name << " |";
    for (const double accuracy : accuracies()) {
      const CellResult* cell = cheapest(result, by, accuracy);
      page << " "
           << (cell == nullptr ? std::string("-")
                               : mesh_text(cell->cell) + ", " + time_text(cell->processor_seconds(threads)))
           << " |";
    }
    page << "\n";
  }
}

void write_recommendations(std::ostream& page, const Results& results, int threads) {
  page << "\n## The cheapest cell of each benchmark\n\n"
          "For the largest of the four errors; `-`: below what is judged (ten times the difference of the references), "
          "or not\nreached.\n\n";
  write_cheapest(page, results, largest_error, threads);
  page << "\nFor the displacement of the tip alone, which converges with the power 2 k in place of k + 1:\n\n";
  write_cheapest(page, results, displacement_error, threads);
  page << "\n![Error over time](trade_time.png)\n\n![Error over unknowns](trade_unknowns.png)\n";
}

/// Rate of one quantity over the meshes of an order, or "-".
std::string rate_text(const BenchmarkResult& result, int order, const ErrorMeasure& error) {
  std::vector<int> elements;
  std::vector<double> errors;
  for (const CellResult& cell : result.cells)
    if (cell.converged() && cell.cell.order == order && cell.cell.integration == ForceIntegration::both_reduced) {
      elements.push_back(cell.cell.elements);
      errors.push_back(error(cell.errors));
    }
  const auto rate = observed_rate(elements, errors, std::max(1e-11, result.floor()));
  return rate ? format("%.1f", *rate) : "-";
}

void write_rates(std::ostream& page, const Results& results, const MatrixPlan& plan) {
  page << "\n## Rates of convergence\n\n"
          "Displacement of the tip / centerline / moment / energy, between the finest two meshes above rounding and "
          "reference.\n\n| benchmark |";
  for (const int order : plan.orders) page << " k = " << order << " |";
  page << "\n| --- |";
  for (std::size_t i = 0; i < plan.orders.size(); ++i) page << " --- |";
  page << "\n";
  const std::vector<ErrorMeasure> measures = {
      [](const Errors& e) { return e.displacement; }, [](const Errors& e) { return e.centerline; },
      [](const Errors& e) { return e.moment; }, [](const Errors& e) { return e.energy; }};
  for (const BenchmarkResult& result : results) {
    page << "| " << result.problem.about.name << " |";
    for (const int order : plan.orders)
      for (std::size_t i = 0; i < measures.size(); ++i)
        page << " " << rate_text(result, order, measures[i]) << (i + 1 < measures.size() ? " /" : " |");
    page << "\n";
  }
}

std::string mesh_sentence(const Discretization& mesh) { return format("k = %d, n = %d", mesh.order, mesh.elements); }

std::string best_text(const AccuracyPrice& price) {
  return price.best ? mesh_text(*price.best) + ", " + time_text(price.best_seconds) : "-";
}

std::string ratio_text(const AccuracyPrice& price) { return price.best ? format("%.2f", price.ratio()) : "-"; }

/// "48 of 48 errors are below the accuracy; the ratio is 1.6 (median) and 2.4 at most"
void write_totals(std::ostream& page, const Results& results) {
  const AccuracyTotals totals = accuracy_totals(results);
  page << totals.kept << " of " << totals.judged << " true errors are below the accuracy.";
  for (const auto& [threads, ratios] : totals.ratios)
    page << format(" Ratio with %d thread%s: %.2f (median), at most %.2f.", threads, threads == 1 ? "" : "s",
                   ratios.middle, ratios.largest);
  page << "\n\n";
}

void write_accuracy_rows(std::ostream& page, const Results& results, bool with_path) {
  page << "| " << (with_path ? "scene" : "benchmark") << " | wanted | meshes | estimated | true |"
       << (with_path ? " on the path |" : "") << " time | best cell | ratio |";
  std::string rule = with_path ? "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
                               : "| --- | --- | --- | --- | --- | --- | --- | --- |";
  std::set<int> more;
  for (const BenchmarkResult& result : results)
    for (const AccurateCell& cell : result.accurate)
      for (const auto& [threads, price] : cell.prices)
        if (threads != cell.prices.begin()->first) more.insert(threads);
  for (const int threads : more) {
    page << " " << threads << " threads | best cell | ratio |";
    rule += " --- | --- | --- |";
  }
  page << "\n" << rule << "\n";
  for (const BenchmarkResult& result : results)
    for (const AccurateCell& cell : result.accurate) {
      page << "| " << result.problem.about.name << " | " << accuracy_text(cell.wanted) << " | " << meshes_text(cell)
           << format(" | %.1e | %.1e |", cell.estimated, motion_error(cell.errors));
      if (with_path) page << " " << (cell.path_error ? format("%.1e", *cell.path_error) : "-") << " |";
      for (const auto& [threads, price] : cell.prices)
        page << " " << time_text(price.seconds) << " | " << best_text(price) << " | " << ratio_text(price) << " |";
      page << "\n";
    }
}

void write_accuracies(std::ostream& page, const Results& results, const Results& gallery) {
  page << "\n## Asking for an accuracy\n\n"
          "What the program makes of `Accuracy` in a scene: meshes that it went through (order x elements of a member, "
          "the finest\nwhere they differ; a star: the solution carried over, else the whole path followed), estimated "
          "and true error of tip and\ncenterline, time of all of it, the cheapest single cell with so small an error, "
          "and the ratio of the times. Times are those of\nthe processor with one thread and those of the clock with "
          "more: medians of runs of both in turn. More threads than one are\nused where a structure is large enough, "
          "unless the user says otherwise; here they were forced on all. Times of the clock mean something on an idle "
          "machine "
          "only.\n\n";
  write_totals(page, results);
  write_accuracy_rows(page, results, false);
  if (gallery.empty()) return;
  page << "\n### Scenes of the gallery\n\n"
          "The start meshes were found with the benchmarks above; these scenes had no part in that. They are solved as "
          "their files\nsay, stability, steps and stages included, so that time is that of the whole path. The error "
          "is the larger one of\ncenterline and points, these over the largest displacement. `on the path`: critical "
          "loads, and displacements at load factors\nfor which the file has values; no accuracy was asked for them. "
          "Cells: the elements of the file, halved and doubled, in all\norders, as far as they may be the cheapest for "
          "one of the accuracies.\n\n";
  write_totals(page, gallery);
  write_accuracy_rows(page, gallery, true);
}

void write_references(std::ostream& page, const Results& results, const MatrixPlan& plan) {
  page << "\n## References\n\n"
          "Errors are measured against "
       << mesh_sentence(plan.reference) << ", which " << mesh_sentence(plan.confirmation)
       << " confirms; the run checks that they agree to 1e-10,\nand holds the reference against the closed forms and "
          "literature values of the scene.\n\n"
          "| benchmark | what | tip | displacement | centerline | moment | energy | values checked |\n"
          "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const BenchmarkResult& result : results) {
    const Benchmark& about = result.problem.about;
    page << "| " << about.name << " | " << about.kind << " | " << about.point
         << format(" | %.0e | %.0e | %.0e | %.0e | ", result.difference.displacement, result.difference.centerline,
                   result.difference.moment, result.difference.energy)
         << result.problem.expected.size() << " |\n";
  }
}

void write_gallery_references(std::ostream& page, const Results& gallery) {
  if (gallery.empty()) return;
  page << "\nScenes of the gallery: k = 8, confirmed by k = 6 on 1.5 times as many elements; displacements only. `n`: "
          "elements of\nthe finest member. Values of the path are compared by the scene itself.\n\n"
          "| scene | what | members | n | displacement | centerline | values checked |\n"
          "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const BenchmarkResult& result : gallery)
    page << "| " << result.problem.about.name << " | " << result.problem.about.kind << " | "
         << result.problem.scene.members.size() << " | "
         << result.problem.own_elements() * result.problem.about.refinement
         << format(" | %.0e | %.0e | ", result.difference.displacement, result.difference.centerline)
         << result.problem.expected.size() << " |\n";
}

/// Error and time with force strains fully integrated beside those with both parts reduced.
void write_integration(std::ostream& page, const BenchmarkResult& result, int threads) {
  page << "\n"
       << result.problem.about.name
       << ":\n\n| k x n | reduced | full | reduced | full |\n| --- | --- | --- | --- | --- |\n";
  for (const CellResult& full : result.cells) {
    if (full.cell.integration != ForceIntegration::full || full.cell.elements != 16) continue;
    for (const CellResult& reduced : result.cells) {
      const bool same = reduced.cell.order == full.cell.order && reduced.cell.elements == full.cell.elements;
      if (!same || reduced.cell.integration != ForceIntegration::both_reduced) continue;
      const auto error = [](const CellResult& cell) {
        return cell.converged() ? format("%.1e", cell.errors.largest()) : std::string(name_of(cell.status));
      };
      const auto time = [&](const CellResult& cell) {
        return cell.converged() ? time_text(cell.processor_seconds(threads)) : std::string("-");
      };
      page << "| " << mesh_text(full.cell) << " | " << error(reduced) << " | " << error(full) << " | " << time(reduced)
           << " | " << time(full) << " |\n";
    }
  }
}

void write_integrations(std::ostream& page, const Results& results, int threads) {
  if (std::none_of(results.begin(), results.end(), [](const auto& r) { return r.problem.about.integrations; })) return;
  page << "\n## Full integration of the force strains\n\nError and time on 16 elements.\n";
  for (const BenchmarkResult& result : results)
    if (result.problem.about.integrations) write_integration(page, result, threads);
}

void write_two_threads(std::ostream& page, const Results& results, const std::vector<int>& threads) {
  if (threads.size() < 2) return;
  page << "\n## Threads\n\n"
       << "Time with " << threads[0] << " thread over time with " << threads[1]
       << ", geometric mean over the cells with so many elements in all.\n\n| elements | cells | gain |\n| --- | --- | "
          "--- "
          "|\n";
  for (int least = 1; least <= 1024; least *= 4) {
    double sum = 0.0;
    int count = 0;
    for (const BenchmarkResult& result : results)
      for (const CellResult& cell : result.cells) {
        const auto elements = cell.cell.elements * result.problem.scene.members.size();
        const double gain = cell.seconds(threads[0]) / cell.seconds(threads[1]);
        if (elements < static_cast<std::size_t>(least) || elements >= 4U * least || !std::isfinite(gain)) continue;
        sum += std::log(gain);
        ++count;
      }
    if (count > 0) page << format("| %d to %d | %d | %.2f |\n", least, 4 * least - 1, count, std::exp(sum / count));
  }
}

/// Meshes on which no equilibrium was found.
void write_failures(std::ostream& page, const Results& results) {
  page << "\n## Meshes without an equilibrium\n\n";
  bool any = false;
  for (const BenchmarkResult& result : results) {
    std::string meshes;
    for (const CellResult& cell : result.cells)
      if (cell.status == CellStatus::failed)
        meshes += (meshes.empty() ? "" : ", ") + mesh_text(cell.cell) +
                  (cell.cell.integration == ForceIntegration::both_reduced ? "" : " (full)");
    if (meshes.empty()) continue;
    any = true;
    page << "- " << result.problem.about.name << ": " << meshes << "\n";
  }
  if (!any) page << "None.\n";
}

}  // namespace

void write_page(std::ostream& page, const std::vector<BenchmarkResult>& results,
                const std::vector<BenchmarkResult>& gallery, const MatrixPlan& plan) {
  const int threads = plan.timing.threads.front();
  write_head(page, results, plan);
  write_orders(page, results, plan);
  write_recommendations(page, results, threads);
  write_accuracies(page, results, gallery);
  write_rates(page, results, plan);
  write_integrations(page, results, threads);
  write_two_threads(page, results, plan.timing.threads);
  write_judgements(page, results);
  write_references(page, results, plan);
  write_gallery_references(page, gallery);
  write_failures(page, results);
}

}  // namespace mixbeam
