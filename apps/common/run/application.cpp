#include "apps/common/run/application.hpp"

#include "apps/common/run/quantity_values.hpp"
#include "apps/common/run/room_check.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/common/session/progress.hpp"
#include "kernels/execution/execution_space.hpp"
#include "kernels/execution/pack.hpp"
#include "mixbeam/version.hpp"

#include <omp.h>
#include <signal.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <future>
#include <iostream>
#include <memory>
#include <thread>

namespace mixbeam {

namespace {

/// See work_of(). An iteration with this much work takes 10 ms on one thread, three times as long as a thread may wait
/// on a busy machine; smaller runs take a fraction of a second anyway.
constexpr long long kWorkForThreads = 10000;

/// Tolerance between a load factor in a scene and that of a step.
constexpr double kWrittenLoadFactor = 1e-9;

/// A stream that discards everything.
std::ostream& nowhere() {
  static std::ostream stream(nullptr);
  return stream;
}

/// Work of an iteration: the condensation of an element of order k costs about (k+1)^2.
long long work_of(const Scene& scene) {
  long long work = 0;
  for (const Member& member : scene.members)
    work += static_cast<long long>(member.elements) * (member.order + 1) * (member.order + 1);
  return work;
}

/// System, release, processor and name of the machine.
std::string machine() {
  utsname system{};
  if (uname(&system) != 0) return "unknown";
  return std::string(system.sysname) + " " + system.release + " " + system.machine + ", " + system.nodename;
}

/// Makes libgomp spin briefly. It reads its spin count when it is loaded, long before main(), and a restart with
/// another environment costs 35 ms. But at each wait it checks whether it manages more threads than there are
/// processors, and then spins 100 times instead of 300,000 (do_spin in its config/linux/wait.h, gomp_managed_threads).
/// So an idle thread opens a team as large as the machine and sleeps in it; together with the program's team these are
/// too many. No effect with other OpenMP libraries.
void crowd(std::promise<void>& ready) {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);  // signals are for the main thread
  [[maybe_unused]] int members = 0;
  const int machine = std::max(omp_get_num_procs(), omp_get_max_threads());  // now; when libgomp was loaded
#pragma omp parallel num_threads(machine) reduction(+ : members)
  ++members;
  ready.set_value();
  for (;;) pause();
}

bool crowd_once() {
  std::promise<void> ready;
  std::thread([&ready] { crowd(ready); }).detach();
  ready.get_future().wait();
  return true;
}

/// Lets threads that wait at the end of a loop sleep after microseconds instead of spinning for milliseconds: on a busy
/// machine, spinning threads occupy cores that working ones wait for. Only for programs, not for hosts of the library;
/// does nothing if the user has chosen (OMP_WAIT_POLICY, GOMP_SPINCOUNT).
void let_waiting_threads_sleep() {
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  [[maybe_unused]] static const bool done = crowd_once();
}

}  // namespace

std::string instructions() { return std::string(kInstructions) + ", " + std::to_string(kLanes) + " lanes"; }

// Threads that synchronize after every loop cost a small scene more than they gain, above all on a busy machine, where
// a loop of microseconds waits for a thread that is not scheduled.
int Application::threads_for(const Scene& solved, const SolverParameters& parameters) const {
  int threads = work_of(solved) < kWorkForThreads ? 1 : summary.threads;
  if (std::getenv("OMP_NUM_THREADS") != nullptr) threads = summary.threads;
  if (parameters.threads > 0) threads = parameters.threads;
  if (threads > 1 && terminal == nullptr) let_waiting_threads_sleep();  // threads of a host wait as it has chosen
  return threads;
}

std::ostream& Application::out() const {
  if (!writes_files()) return nowhere();
  return terminal != nullptr ? *terminal : std::cout;
}

void Application::warn(const std::string& text) {
  summary.warnings.push_back(text);
  out() << "warning: " << text << "\n";
}

std::ostream& Application::progress_out(const std::string& label) const {
  return quiet || label.empty() ? nowhere() : out();
}

bool Application::is_asked_to_stop() const {
  return interrupt_requested(communicator) || (asked_to_stop && asked_to_stop());
}

std::filesystem::path failure_file_of(const std::filesystem::path& results) {
  return results.parent_path() / (results.stem().string() + "_failure.txt");
}

Simulation Application::walk(const std::shared_ptr<const Scene>& solved, const SolverParameters& parameters,
                             const std::string& label, const PathControl& control,
                             const std::function<void(Simulation&)>& prepare, const RunObserver& observer) {
  SolverParameters chosen = parameters;
  chosen.threads = threads_for(*solved, parameters);
  Simulation simulation(solved, chosen, communicator);
  if (prepare) prepare(simulation);
  const int iterations_before = control.resume ? control.resume->newton_iterations : 0;
  const int steps_before = control.resume ? control.resume->step : 0;
  Progress progress(progress_out(label), name + " " + label, solved->stages,
                    control.resume ? simulation.share_done() : 0.0);
  PathControl watched = control;
  watched.step_failed = [&progress](const StepFailure& failure) { progress.report(failure); };
  watched.descends = [&progress](const DescentProgress& descent) { progress.report(descent); };
  simulation.run(
      [&](const StepReport& report, const State&) {
        progress.report(report, simulation.share_done());
        if (observer) observer(simulation, report);
      },
      watched);
  const LoadPathResult& result = simulation.result();
  summary.add_work(result.steps - steps_before, result.newton_iterations - iterations_before, simulation.times());
  return simulation;
}

Simulation Application::try_to_solve(const Scene& solved, const SolverParameters& parameters,
                                     const RunObserver& observer, const PathControl& control) {
  SolverParameters chosen = parameters;
  for (;; ++chosen.analysis.closeness) {
    Simulation simulation = walk(std::make_shared<const Scene>(solved), chosen, "", control, {}, observer);
    if (observer || !simulation.result().returned || chosen.analysis.closeness == kMostCloseness) return simulation;
  }
}

StepReport stored_report(const StoredRun& run, std::size_t position) {
  StepReport report;
  report.point = run.steps()[position];
  report.step = report.point.step;
  report.load_factor = report.point.load_factor;
  const int jumps_before = position == 0 ? 0 : run.steps()[position - 1].jumps;
  if (report.point.jumps > jumps_before) report.jump = run.jump(position);
  for (const MonitoredSeries& series : run.monitor()) {
    if (series.name == "newton_iterations") report.newton_iterations = static_cast<int>(series.values[position]);
    if (series.name == "residual") report.residual = series.values[position];
  }
  return report;
}

std::vector<CriticalPoint> stored_critical_points(Simulation& simulation, const StoredRun& run, std::size_t position) {
  std::vector<CriticalPoint> points;
  for (const RecordedCriticalPoint& stored : run.critical_points(position)) {
    simulation.restore(stored.state.held, stored.load_factor);
    CriticalPoint point{CriticalKind::limit_point,
                        stored.load_factor,
                        stored.negative_before,
                        stored.negative_after,
                        simulation.state(),
                        simulation.model().create_vector(),
                        stored.modes};
    for (const CriticalKind kind : {CriticalKind::bifurcation, CriticalKind::flutter})
      if (stored.kind == name_of(kind)) point.kind = kind;
    point.omega = stored.omega;
    point.error = stored.load_factor_error;
    points.push_back(point);
  }
  return points;
}

/// Restores the last step of a stored run; before that, calls the observer for its steps with expected values.
void Application::replay(Simulation& simulation, const StoredRun& run, const RunObserver& observer) const {
  for (std::size_t i = 0; i < run.steps().size(); ++i) {
    const PathPoint& point = run.steps()[i];
    const bool is_last = i + 1 == run.steps().size();
    const bool is_critical = point.critical_points > (i == 0 ? 0 : run.steps()[i - 1].critical_points);
    const auto belongs_here = [&](const ExpectedValue& value) {
      if (value.critical_point) return is_critical;
      if (!value.load_factor && solver.analysis.control) return is_last;
      return std::abs(value.load_factor.value_or(simulation.scene().stages) - point.load_factor) <= kWrittenLoadFactor;
    };
    const bool is_expected = std::any_of(expected.begin(), expected.end(), belongs_here);
    if (!is_expected && !is_last) continue;
    StepReport report = stored_report(run, i);
    if (is_expected && is_critical) report.critical_points = stored_critical_points(simulation, run, i);
    simulation.restore(writes_files() ? run.state(i) : StateSnapshot{}, point.load_factor, run.stability()[i],
                       point.jumps);
    if (is_expected && observer) observer(simulation, report);
  }
}

Simulation Application::solve(const Scene& solved, const SolverParameters& parameters, const std::string& label,
                              const RunObserver& observer) {
  require_room(*this, solved, parameters);
  StepReport last;
  Simulation simulation = walk(std::make_shared<const Scene>(solved), parameters, label, {}, {},
                               [&](const Simulation& running, const StepReport& report) {
                                 last = report;
                                 if (observer) observer(running, report);
                               });
  if (simulation.result().finished) return simulation;
  const std::filesystem::path file = output / ((label.empty() ? name : label) + "_last_converged.h5");
  const StepRecord last_record = simulation.record(last, kPointsByOrder, {});
  ResultFile results(file, header(solved), communicator);
  results.append_step(last_record);
  results.close();
  give_up(simulation, label, "The last converged state is in " + file.string() + ".", file);
}

void Application::give_up(const Simulation& simulation, const std::string& label, const std::string& where_state,
                          const std::filesystem::path& results) const {
  const std::filesystem::path file = failure_file_of(results);
  const std::string page = (label.empty() ? "" : label + ": ") + simulation.result().failure + where_state;
  if (!writes_files() || results.empty()) throw ConvergenceError(page);
  try {
    const bool durable = false;
    replace_file(file, page + "\n", durable);
  } catch (const FileError& error) {  // the failure itself matters more
    throw ConvergenceError(page + " This report cannot be written: " + error.what());
  }
  throw ConvergenceError(page + " This report is in " + file.string() + ".");
}

Simulation Application::solve_and_record(const Scene& solved, const SolverParameters& parameters,
                                         const std::string& file, int points_per_element, const RunObserver& observer) {
  Recording recording;
  recording.file = output / (file + ".h5");
  recording.points_per_element = points_per_element;
  recording.observer = observer;
  return record(solved, parameters, recording);
}

ResultHeader Application::header(const Scene& solved, const std::map<std::string, std::string>& properties) const {
  ResultHeader result{solved.name,
                      xml.text,
                      kVersion,
                      {{"program", name},
                       {"compiler", kCompiler},
                       {"instructions", instructions()},
                       {"machine", machine()},
                       {"threads", std::to_string(number_of_threads())},
                       {"ranks", std::to_string(communicator->getSize())}}};
  result.imported = xml.source.files();
  if (xml.list->isSublist("Report")) {
    const Teuchos::ParameterList& report = xml.list->sublist("Report");
    for (auto entry = report.begin(); entry != report.end(); ++entry)
      result.properties["report / " + report.name(entry)] = report.get<std::string>(report.name(entry));
  }
  result.properties.insert(properties.begin(), properties.end());
  return result;
}

void Application::compare(const Simulation& simulation, const std::function<bool(const ExpectedValue&)>& is_due,
                          const OwnQuantity& own_quantity) {
  std::vector<ExpectedValue> due;
  for (const ExpectedValue& value : expected) {
    if (value.load_case != load_case || !is_due(value)) continue;
    if (value.word.empty()) {
      due.push_back(value);
      continue;
    }
    compared_.insert(value.name);
    summary.check_word(value.name, simulation.stability().stable, value.word, value.source);
  }
  if (due.empty()) return;
  const std::vector<std::optional<double>> present = present_values(simulation, due, quantities);
  for (std::size_t i = 0; i < due.size(); ++i) {
    const ExpectedValue& value = due[i];
    std::optional<double> actual = present[i];
    if (!actual && own_quantity) actual = own_quantity(simulation, value);
    if (!actual) continue;
    compared_.insert(value.name);
    summary.check_expected(value.name, *actual, value);
  }
}

void Application::check_expected(const Simulation& simulation, double load_factor, const OwnQuantity& own_quantity) {
  const bool is_end = simulation.is_end_of_path(load_factor);
  const auto is_due = [&](const ExpectedValue& value) {
    if (value.critical_point) return false;
    return value.load_factor ? std::abs(*value.load_factor - load_factor) <= kWrittenLoadFactor : is_end;
  };
  compare(simulation, is_due, own_quantity);
}

void Application::check_expected(const Simulation& simulation, const StepReport& report,
                                 const OwnQuantity& own_quantity) {
  int number = report.point.critical_points - static_cast<int>(report.critical_points.size());
  for (const CriticalPoint& point : report.critical_points) {
    critical_points_[load_case] = ++number;
    const auto is_due = [number](const ExpectedValue& value) { return value.critical_point == number; };
    compare(simulation.at(point.state, point.load_factor), is_due, own_quantity);
  }
  check_expected(simulation, report.load_factor, own_quantity);
}

void Application::forget_path(std::size_t checks) {
  summary.keep_checks(checks);
  critical_points_.erase(load_case);
  for (const ExpectedValue& value : expected)
    if (value.load_case == load_case) compared_.erase(value.name);
}

int Application::critical_points(const std::string& of_case) const {
  const auto found = critical_points_.find(of_case);
  return found == critical_points_.end() ? 0 : found->second;
}

std::vector<ExpectedValue> Application::not_compared() const {
  std::vector<ExpectedValue> left_out;
  for (const ExpectedValue& value : expected)
    if (compared_.count(value.name) == 0) left_out.push_back(value);
  return left_out;
}

}  // namespace mixbeam
