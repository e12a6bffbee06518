#include "apps/common/studies/judged_path.hpp"

#include "apps/common/studies/study.hpp"
#include "discretization/geometry/vector_algebra.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

/// Ends that are the same equilibrium differ by what Newton's tolerance of 1e-11 leaves, divided by the smallest
/// eigenvalue; those of two branches differ by far more.
constexpr double kSameEnd = 1e-7;
/// References agree when they are not a matter of their steps.
constexpr double kSameReference = 1e-10;
/// A path along its length through several limit points takes more steps than one along the load.
constexpr int kStepsPerStep = 6;

std::vector<Vector3> displacements(const Simulation& simulation) {
  std::vector<Vector3> all;
  for (const Point& point : simulation.scene().points) all.push_back(simulation.displacement(point.name));
  for (const Member& member : simulation.scene().members)
    for (const InnerPoint& point : member.inner_points) all.push_back(simulation.displacement(point.point));
  return all;
}

double length_of(const Scene& scene) {
  vector_algebra::Box box;
  for (const Point& point : scene.points) box.enclose(point.position);
  return vector_algebra::largest_component(vector_algebra::difference(box.high, box.low));
}

/// Largest distance of a point in two ends of the same structure.
double difference_of(const FollowedPath& a, const FollowedPath& b) {
  double largest = 0.0;
  for (size_t p = 0; p < a.displacements.size(); ++p)
    for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs(a.displacements[p][i] - b.displacements[p][i]));
  return largest;
}

SolverParameters with_steps(SolverParameters parameters, double step) {
  parameters.load_path.method = LoadPathMethod::automatic;
  parameters.load_path.initial_step = std::min(parameters.load_path.initial_step, step);
  parameters.load_path.maximum_step = step;
  parameters.load_path.maximum_steps = static_cast<int>(kStepsPerStep / step);
  parameters.load_path.minimum_step = std::min(parameters.load_path.minimum_step, 1e-3 * step);
  return parameters;
}

}  // namespace

FollowedPath follow(const Scene& scene, const SolverParameters& parameters, const Communicator& comm, bool plainly) {
  FollowedPath path;
  const RunWatch watch;
  Simulation simulation(scene, parameters, comm);
  const PathObserver keep = [&path](const StepReport& report, const State&) {
    path.critical_points += static_cast<int>(report.critical_points.size());
    path.negative = report.stability && report.stability->symmetric ? report.stability->negative : -1;
    if (report.step == 0) path.began_stable = path.negative == 0;
  };
  const LoadPathResult& result = plainly ? simulation.settle(State(simulation.state()), keep) : simulation.run(keep);
  path.processor_seconds = watch.processor_seconds();
  path.finished = result.finished;
  path.displacements = displacements(simulation);
  path.steps = result.steps;
  path.failed_steps = result.failed_steps;
  path.iterations = result.newton_iterations;
  path.failure = result.failure;
  return path;
}

bool contradicts_itself(const FollowedPath& path) {
  return path.began_stable && path.critical_points == 0 && path.negative > 0;
}

bool is_same_end(const Scene& scene, const FollowedPath& a, const FollowedPath& b) {
  return difference_of(a, b) <= kSameEnd * length_of(scene);
}

JudgedPath judge_path(const Scene& scene, const SolverParameters& parameters, double reference_step,
                      const Communicator& comm) {
  JudgedPath judged;
  const double length = length_of(scene);
  judged.followed = follow(scene, parameters, comm);
  judged.reference = follow(scene, with_steps(parameters, reference_step), comm);
  if (judged.followed.finished && contradicts_itself(judged.followed)) judged.outcome = PathOutcome::wrong;
  if (!judged.reference.finished || contradicts_itself(judged.reference)) return judged;
  const FollowedPath finer = follow(scene, with_steps(parameters, 0.5 * reference_step), comm);
  judged.reference_difference = difference_of(judged.reference, finer) / length;
  judged.reference_known = finer.finished && judged.reference_difference <= kSameReference;
  if (!judged.reference_known) return judged;
  judged.difference = difference_of(judged.followed, judged.reference) / length;
  if (!judged.followed.finished)
    judged.outcome = PathOutcome::refused;
  else if (judged.outcome != PathOutcome::wrong)
    judged.outcome = judged.difference <= kSameEnd ? PathOutcome::right : PathOutcome::wrong;
  return judged;
}

}  // namespace mixbeam
