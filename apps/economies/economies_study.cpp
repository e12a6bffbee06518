#include "apps/economies/economies_study.hpp"

#include "apps/common/session/machine_facts.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/economies/economies_page.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <ostream>

namespace mixbeam {

namespace {

const char* const kSource = "the same scene, solved the other way";

TimedWay run_once(const Application& app, const Way& way, int threads) {
  SolverParameters solver = way.solver;
  solver.threads = threads;
  const std::string point = way.scene.point_loads.at(0).point;
  const auto start = std::chrono::steady_clock::now();
  Simulation simulation(way.scene, solver, app.communicator);
  StepReport last;
  simulation.run([&](const StepReport& report, const State&) { last = report; });
  if (way.estimates) simulation.estimate_error();
  if (way.records) {
    const StepRecord record = simulation.record(last, kPointsByOrder, {point});
    ResultHeader header;
    header.scene_name = way.scene.name;
    ResultFile file(app.output / "recorded.h5", std::move(header), app.communicator);
    file.append_step(record);
    file.close();
  }
  TimedWay result;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!simulation.result().finished) throw ConvergenceError(way.description + ": no equilibrium was found");
  result.iterations = simulation.work().newton_iterations;
  result.load_steps = simulation.result().steps;
  result.tip = simulation.displacement(point);
  return result;
}

TimedWay median_of(std::vector<TimedWay> runs) {
  std::sort(runs.begin(), runs.end(), [](const TimedWay& a, const TimedWay& b) { return a.seconds < b.seconds; });
  return runs[runs.size() / 2];
}

/// Both ways in turn, so that a machine that slows down for a while does so for both; the first round warms up.
EconomyResult measure(const Application& app, const Economy& economy, int rounds, int threads) {
  std::vector<TimedWay> plain, other;
  for (int round = 0; round <= rounds; ++round) {
    const TimedWay a = run_once(app, economy.plain, threads), b = run_once(app, economy.other, threads);
    if (round == 0 && rounds > 1) continue;
    plain.push_back(a);
    other.push_back(b);
  }
  return {economy, median_of(plain), median_of(other)};
}

std::vector<EconomyResult> measure_all(Application& app, const std::vector<Economy>& economies) {
  const int rounds = app.study().get<int>("Rounds"), threads = app.study().get<int>("Threads");
  app.out()
      << "\nFeatures that are not used\n  name              as shipped, s  other, s  ratio  iterations  difference\n";
  std::vector<EconomyResult> results;
  for (const Economy& economy : economies) {
    results.push_back(measure(app, economy, rounds, threads));
    const EconomyResult& r = results.back();
    char line[160];
    std::snprintf(line, sizeof line, "  %-18s %12.4f %9.4f %6.2f %5d /%4d  %10.1e\n", economy.name.c_str(),
                  r.plain.seconds, r.other.seconds, r.ratio(), r.plain.iterations, r.other.iterations, r.difference());
    app.out() << line << std::flush;
    app.summary.check_upper_bound(economy.name + ": difference of the two ways", r.difference(), economy.tolerance,
                                  kSource);
    app.summary.newton_iterations += r.plain.iterations + r.other.iterations;
    app.summary.load_steps += r.plain.load_steps + r.other.load_steps;
  }
  return results;
}

void write_table(const std::filesystem::path& path, const std::vector<EconomyResult>& results) {
  CsvTable table(path, {"name", "plain", "other", "plain_seconds", "other_seconds", "ratio", "plain_iterations",
                        "other_iterations", "difference"});
  for (const EconomyResult& r : results)
    table.add_row({r.economy.name, r.economy.plain.description, r.economy.other.description, r.plain.seconds,
                   r.other.seconds, r.ratio(), r.plain.iterations, r.other.iterations, r.difference()});
}

}  // namespace

double EconomyResult::difference() const {
  double square = 0.0, size = 0.0;
  for (int i = 0; i < 3; ++i) {
    square += (plain.tip[i] - other.tip[i]) * (plain.tip[i] - other.tip[i]);
    size += plain.tip[i] * plain.tip[i];
  }
  return std::sqrt(square / size);
}

ListSpec economies_spec() {
  ListSpec spec("How both ways are timed.");
  spec.add(integer("Rounds").at_least(1).at_most(1000).by_default(5).means("Timed runs of each way, in turn."));
  spec.add(integer("Threads").at_least(1).at_most(1024).by_default(1).means("OpenMP threads."));
  return spec;
}

void run_economies_study(Application& app) {
  if (app.scene.point_loads.size() != 1 || app.scene.members.size() != 1)
    throw app.xml.source.error({"Scene"}, std::to_string(app.scene.members.size()) + " members and " +
                                              std::to_string(app.scene.point_loads.size()) +
                                              " point loads; allowed: one rod along x from the origin with one load at "
                                              "its end, to which the study adds what it compares");
  const auto unused = measure_all(app, unused_features(app.scene, app.solver));
  if (!app.writes_files()) return;
  std::filesystem::remove(app.output / "recorded.h5");
  std::filesystem::remove(app.output / "recorded.xdmf");
  write_table(app.output / "economies.csv", unused);
  CsvTable machine(app.output / "machine.csv", {"name", "value"});
  for (const auto& [name, value] : machine_facts()) machine.add_row({name, value});
  std::ofstream page(app.output / "economies.md");
  write_economies_page(page, app.scene, unused);
}

}  // namespace mixbeam
