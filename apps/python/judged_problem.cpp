#include "apps/python/judged_problem.hpp"

#include "apps/common/run/quantity_values.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/studies/variants.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

/// More than the k + 1 that are exact for what an element can represent: the reference is no such polynomial.
constexpr int kMoreGaussPoints = 4;
/// Steps end at load factors that are asked for, but for rounding.
constexpr double kSameTraceLoad = 1e-12;

double energy_of(const Simulation& simulation) {
  const StrainEnergy energy = simulation.strain_energy();
  return energy.force + energy.moment;
}

int judging_points(const Simulation& simulation) { return simulation.scene().members.front().order + kMoreGaussPoints; }

/// The scenes belong to applications with studies of their own, which do not matter here.
Application read_other_scene(const Application& app, const std::string& file) {
  ApplicationDefinition definition;
  definition.name = app.name;
  definition.study = ListSpec("Of another application.").without_checks();
  Application read;
  read.communicator = app.communicator;
  read_scene_file(read, file, definition);
  return read;
}

}  // namespace

PathTrace::PathTrace(const std::vector<ExpectedValue>& on_path) {
  for (const ExpectedValue& value : on_path)
    if (!value.critical_point && !value.point.empty()) wanted_.push_back(value);
}

void PathTrace::add(const Simulation& simulation, const StepReport& report) {
  for (const CriticalPoint& point : report.critical_points) critical_loads_.push_back(point.load_factor);
  for (const ExpectedValue& value : wanted_)
    if (std::abs(report.load_factor - *value.load_factor) <= kSameTraceLoad)
      displacements_.push_back(simulation.displacement(value.point));
}

double PathTrace::error_against(const PathTrace& exact, double displacement) const {
  if (critical_loads_.size() != exact.critical_loads_.size() || displacements_.size() != exact.displacements_.size() ||
      (critical_loads_.empty() && displacements_.empty()))
    return std::nan("");
  double size = 0.0, error = 0.0;
  for (const double load : exact.critical_loads_) size = std::max(size, std::abs(load));
  for (size_t i = 0; i < critical_loads_.size(); ++i)
    error = std::max(error, std::abs(critical_loads_[i] - exact.critical_loads_[i]) / size);
  for (size_t i = 0; i < displacements_.size(); ++i)
    error = std::max(error, vector_algebra::distance(displacements_[i], exact.displacements_[i]) / displacement);
  return error;
}

JudgedProblem::JudgedProblem(Application& app, const std::string& file, const JudgedCase& about)
    : app_(app), is_own_scene_(file.empty()), about_(about) {
  const Application read = is_own_scene_ ? app : read_other_scene(app, file);
  scene_ = with_loads(scene_of_case(read.scene, about.load_case), about.load_share);
  solver_ = read.solver;
  for (const ExpectedValue& value : read.expected) {
    const bool is_on_path = value.critical_point || value.load_factor.value_or(scene_.stages) != scene_.stages;
    if (is_on_path && about.is_as_in_file) on_path_.push_back(value);
    if (!is_on_path && value.load_case == about.load_case && about.load_share == 1.0) expected_.push_back(value);
  }
  if (about.is_as_in_file) return;
  if (about.point.empty() && scene_.point_loads.empty())
    throw InputError("the study judges the displacement of the first loaded point; the scene has no point load");
  if (about.point.empty()) about_.point = scene_.point_loads.front().point;
  if (about.branch == "positive") solver_.analysis.branch = Branch::positive;
  solver_.analysis.stability = solver_.analysis.branch != Branch::primary;
}

Scene JudgedProblem::on(int order, int elements, bool is_full) const {
  Scene changed = scene_;
  const int own = own_elements();
  for (Member& member : changed.members) {
    member.order = order;
    member.elements = about_.is_as_in_file ? (member.elements * elements + own - 1) / own : elements;
    member.force_integration = is_full ? ForceIntegration::full : ForceIntegration::both_reduced;
  }
  return changed;
}

int JudgedProblem::own_elements() const {
  int most = 1;
  for (const Member& member : scene_.members) most = std::max(most, member.elements);
  return most;
}

JudgedRun JudgedProblem::solve(int order, int elements, bool is_full, std::optional<int> threads, double most_seconds,
                               bool follows) const {
  const Scene scene = on(order, elements, is_full);
  SolverParameters parameters = solver_;
  if (threads) parameters.threads = *threads;
  PathTrace trace(on_path_);
  const RunWatch watch;
  Simulation simulation(scene, parameters, app_.communicator);
  const double setup = watch.seconds();
  PathControl control;
  control.stop = [&] { return app_.communicator->getSize() == 1 && watch.processor_seconds() > most_seconds; };
  if (follows)
    simulation.run([&](const StepReport& report, const State&) { trace.add(simulation, report); }, control);
  else
    simulation.run({}, control);
  const RunTimes times{watch.seconds(), setup, watch.processor_seconds()};
  return {std::move(simulation), std::move(trace), times};
}

JudgedRun JudgedProblem::solve_accurately(double wanted, int threads) const {
  Scene scene = scene_;
  scene.accuracy = wanted;
  for (Member& member : scene.members) {
    member.keeps_order = member.keeps_elements = false;
    member.stations.clear();
    member.force_integration = ForceIntegration::both_reduced;
  }
  SolverParameters parameters = solver_;
  parameters.threads = threads;
  std::vector<ExpectedValue> values = expected_;
  values.insert(values.end(), on_path_.begin(), on_path_.end());
  const bool keeps_path = asks_for_path(solver_, values, about_.load_case, scene_);
  PathTrace trace(on_path_);  // of the last path
  AccurateRunObserver observer;
  observer.begin = [&](const Simulation&) { trace = PathTrace(on_path_); };
  observer.step = [&](const Simulation& simulation, const StepReport& report) { trace.add(simulation, report); };
  observer.end = [&](const Simulation& simulation, const StepReport& report, const ErrorEstimate&) {
    trace.add(simulation, report);
  };
  const RunWatch watch;
  AccurateRun run = run_accurately(scene, parameters, app_.communicator, keeps_path, observer);
  const RunTimes times{watch.seconds(), std::nan(""), watch.processor_seconds()};
  return {std::move(run.simulation), std::move(trace), times, run.end, std::move(run.rounds)};
}

Errors JudgedProblem::estimated(const JudgedRun& run) const {
  using vector_algebra::norm;
  const ErrorEstimate estimate = run.simulation.estimate_error();
  if (!estimate.exists()) return {std::nan(""), std::nan(""), std::nan(""), std::nan("")};
  const Vector3 error = estimate.vertex_displacement.at(vertex_of(run.simulation.model().mesh(), about_.point));
  return {norm(error) / norm(run.simulation.displacement(about_.point)), estimate.displacement.relative(),
          estimate.moment.relative(), std::abs(estimate.energy.relative())};
}

void JudgedProblem::check_expected(const JudgedRun& run, const std::string& name) const {
  if (is_own_scene_) return app_.check_expected(run.simulation);
  for (const ExpectedValue& value : expected_)
    if (const auto present = present_value(run.simulation, value))
      app_.summary.check_expected(name + ": " + value.name, *present, value);
}

JudgedReference::JudgedReference(const JudgedProblem& problem, const JudgedRun& run) : run_(run) {
  const Simulation& simulation = run_.simulation;
  const int gauss = judging_points(simulation);
  if (problem.judges_all_points()) {
    for (const auto& [name, vertex] : simulation.model().mesh().vertex_of_point) points_.push_back(name);
    scale_[kDisplacement] = largest_displacement(simulation.model(), simulation.state());
  } else {
    points_ = {problem.point()};
    scale_[kDisplacement] = vector_algebra::norm(simulation.displacement(problem.point()));
  }
  scale_[kCenterline] = simulation.l2_norm(gauss, [](const PointSample& sample, int) { return sample.displacement; });
  scale_[kMoment] = simulation.l2_norm(gauss, [](const PointSample& sample, int) { return sample.moment; });
  scale_[kEnergy] = energy_of(simulation);
}

Errors JudgedReference::errors_of(const JudgedRun& run) const {
  const Simulation &simulation = run_.simulation, &other = run.simulation;
  const int gauss = judging_points(other);
  const auto exact = [&](const PointSample& sample, int member) {
    const double length = simulation.model().mesh().member_length[member];
    return sample_member(simulation.model(), simulation.state(), member, sample.arc_length / length);
  };
  Errors errors{};
  for (const std::string& point : points_)
    errors[kDisplacement] = std::max(
        errors[kDisplacement], vector_algebra::distance(other.displacement(point), simulation.displacement(point)));
  errors[kCenterline] = other.l2_norm(gauss, [&](const PointSample& sample, int member) {
    return sample.displacement - exact(sample, member).displacement;
  });
  errors[kMoment] = other.l2_norm(
      gauss, [&](const PointSample& sample, int member) { return sample.moment - exact(sample, member).moment; });
  errors[kEnergy] = std::abs(energy_of(other) - scale_[kEnergy]);
  for (int i = 0; i < kErrors; ++i) errors[i] /= scale_[i];
  return errors;
}

double JudgedReference::path_error_of(const JudgedRun& other) const {
  return other.trace.error_against(run_.trace, scale_[kDisplacement]);
}

}  // namespace mixbeam
