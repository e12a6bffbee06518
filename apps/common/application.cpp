#include "apps/common/application.hpp"

#include "apps/common/progress.hpp"
#include "kernels/execution_space.hpp"
#include "mixbeam/version.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>

namespace mixbeam {

namespace {

constexpr int kSamplesPerElement = 9;

/// See work_of(). An iteration with this much work takes 10 ms on one thread, three times as long as a busy machine may
/// keep a thread waiting; a run below takes a fraction of a second anyway.
constexpr long long kWorkForThreads = 10000;

/// Load factors are sums of rounded steps.
constexpr double kSameLoadFactor = 1e-9;

/// A stream that swallows everything.
std::ostream& nowhere() {
  static std::ostream stream(nullptr);
  return stream;
}

/// Work of an iteration on a scene: the condensation of order k costs about as much as (k+1)^2 tells.
long long work_of(const Scene& scene) {
  long long work = 0;
  for (const Member& member : scene.members)
    work += static_cast<long long>(member.elements) * (member.order + 1) * (member.order + 1);
  return work;
}

/// Threads that wait for each other after every loop cost a small scene more than they give, above all on a machine
/// that has other things to do: then a loop of microseconds waits for a thread that is not running.
int chosen_threads(const Scene& scene, const SolverParameters& parameters, int available) {
  if (parameters.threads > 0) return parameters.threads;
  if (std::getenv("OMP_NUM_THREADS") != nullptr) return available;
  return work_of(scene) < kWorkForThreads ? 1 : available;
}

/// Component of a vector by the names of the list "Expected".
double component(const Vector3& v, const std::string& name) {
  if (name == "norm") return std::hypot(v[0], v[1], v[2]);
  return v[name == "x" ? 0 : name == "y" ? 1 : 2];
}

}  // namespace

std::ostream& Application::out() const { return writes_files() ? std::cout : nowhere(); }

Simulation Application::solve(const Scene& solved, const SolverParameters& parameters, const std::string& label,
                              const RunObserver& observer) {
  SolverParameters chosen = parameters;
  chosen.threads = chosen_threads(solved, parameters, summary.threads);
  Simulation simulation(solved, chosen, communicator);
  Progress progress(quiet || label.empty() ? nowhere() : out(), name + " " + label, solved.stages);
  StepReport last;
  simulation.run([&](const StepReport& report, const State&) {
    last = report;
    progress.report(report);
    if (observer) observer(simulation, report);
  });
  summary.load_steps += simulation.result().steps;
  summary.newton_iterations += simulation.result().newton_iterations;
  for (const auto& [phase, seconds] : simulation.times()) summary.seconds[phase] += seconds;
  if (simulation.result().finished) return simulation;
  const std::filesystem::path file = output / ((label.empty() ? name : label) + "_last_converged.h5");
  const StepRecord record = simulation.record(last, kSamplesPerElement, {});
  if (writes_files()) {
    ResultFile results(file, header(solved));
    results.append_step(record);
    results.close();
  }
  throw ConvergenceError((label.empty() ? "" : label + ": ") + simulation.result().failure +
                         " The last converged state is in " + file.string() + ".");
}

Simulation Application::solve_and_record(const Scene& solved, const SolverParameters& parameters,
                                         const std::string& file, int points_per_element, const RunObserver& observer) {
  std::unique_ptr<ResultFile> results;
  if (writes_files()) results = std::make_unique<ResultFile>(output / (file + ".h5"), header(solved));
  std::vector<std::string> points;
  for (const Support& support : solved.supports) points.push_back(support.point);
  for (const PointLoad& load : solved.point_loads) points.push_back(load.point);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  Simulation simulation = solve(solved, parameters, file, [&](const Simulation& running, const StepReport& report) {
    const StepRecord record = running.record(report, points_per_element, points);
    if (results != nullptr) results->append_step(record);
    if (observer) observer(running, report);
  });
  if (results != nullptr) results->close();
  return simulation;
}

ResultHeader Application::header(const Scene& solved) const {
  return {solved.name,
          xml.text,
          kVersion,
          {{"program", name},
           {"compiler", kCompiler},
           {"threads", std::to_string(number_of_threads())},
           {"ranks", std::to_string(communicator->getSize())}}};
}

void Application::check_expected(const Simulation& simulation, double load_factor, const OwnQuantity& own_quantity) {
  for (const ExpectedValue& value : expected) {
    const double wanted = value.load_factor.value_or(simulation.scene().stages);
    if (std::abs(wanted - load_factor) > kSameLoadFactor) continue;
    double actual = 0.0;
    if (value.quantity == "displacement")
      actual = component(simulation.displacement(value.point), value.component);
    else if (value.quantity == "position")
      actual = component(simulation.position(value.point), value.component);
    else if (value.quantity == "rotation")
      actual = component(simulation.rotation(value.point), value.component);
    else if (own_quantity)
      actual = own_quantity(value);
    else
      continue;
    compared_.insert(value.name);
    if (value.kind == ToleranceKind::absolute)
      summary.check_absolute(value.name, actual, value.value, value.tolerance, value.source);
    else
      summary.check_relative(value.name, actual, value.value, value.tolerance, value.source);
  }
}

std::vector<ExpectedValue> Application::not_compared() const {
  std::vector<ExpectedValue> left_out;
  for (const ExpectedValue& value : expected)
    if (compared_.count(value.name) == 0) left_out.push_back(value);
  return left_out;
}

}  // namespace mixbeam
