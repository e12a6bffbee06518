/// Solution of a scene to a wanted accuracy (Scene::accuracy), on a mesh that the program chooses.
///
/// The whole path is followed on a start mesh, the error at its end is estimated, and the next mesh chosen from that.
/// The state is transferred to it and corrected by Newton's method, and so on until the estimate is small enough. If a
/// path rotates the elements of a start mesh too far it is abandoned for a finer mesh. If the path has critical points
/// it is followed on a second mesh too, which provides the errors of their load factors, and so on until these are
/// small enough.
#pragma once

#include "nonlinear/accuracy/mesh_choice.hpp"
#include "nonlinear/run/simulation.hpp"

#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

/// One mesh of the sequence.
struct MeshRound {
  MeshChoice mesh;
  int elements = 0;       ///< of all members
  bool followed = false;  ///< the whole path was followed; false: corrected from the previous mesh
  int steps = 0, failed_steps = 0, iterations = 0;
  double seconds = 0.0;     ///< wall time, error estimate included
  double error = 0.0;       ///< estimated relative error: judged_error(), or AccurateRunObserver::error_of; NaN: none
  int critical_points = 0;  ///< number on the path that was followed, multiple ones counted as often
  /// Largest relative difference of their load factors from those of the previous mesh, which this one contains: the
  /// error there, and a bound of the error here. Zero without critical points; NaN: unknown.
  double critical_error = 0.0;
  double buckling_error = 0.0;  ///< estimated error of linear buckling factors, if requested; NaN: unknown
  std::string remark{};         ///< why the mesh was left, if not because of the estimate
};

enum class AccuracyEnd {
  reached,
  kept_meshes,     ///< members that keep order or elements prevent it
  rounding,        ///< a finer mesh was not more accurate
  too_many,        ///< too many meshes
  not_estimated,   ///< no estimate: see ErrorEstimate
  interrupted,     ///< stopped from outside
  no_equilibrium,  ///< the path did not arrive: see result() of the simulation
};

/// "reached", "orders and elements that members keep prevent it", ...
std::string text_of(AccuracyEnd end);

/// Callbacks of a run. `begin`: a mesh is about to be solved; `step`: a step of its path, except the last; `end`: its
/// last step with the estimated error.
struct AccurateRunObserver {
  /// Relative error to judge instead of that of displacements; NaN: unknown.
  using ErrorOf = std::function<double(const Simulation& simulation, const ErrorEstimate& estimate)>;
  ErrorOf error_of{};
  bool of_vertices = false;  ///< that error depends on motions of vertices alone: see start_mesh()
  /// (member): its relative share of that error; empty: unknown.
  std::function<std::vector<ErrorOfMember>(const Simulation& simulation, const ErrorEstimate& estimate)> shares_of{};
  std::function<void(const Simulation& simulation)> begin{};
  std::function<void(const Simulation& simulation, const StepReport& report)> step{};
  std::function<void(const Simulation& simulation, const StepReport& report, const ErrorEstimate& estimate)> end{};
  std::function<bool()> stop{};  ///< see PathControl
  std::function<void(const StepFailure& failure)> step_failed{};
  std::function<int(const Scene& scene)> threads{};  ///< to use on a mesh; none: SolverParameters::threads
};

struct AccurateRun {
  Simulation simulation;  ///< on the last mesh
  ErrorEstimate estimate;
  AccuracyEnd end = AccuracyEnd::reached;
  std::vector<MeshRound> rounds;
};

/// Share of the accuracy that the estimate must not exceed: it is nearly always within a factor of two of the error.
inline constexpr double kShareOfAccuracy = 0.5;

/// Solves a scene with an accuracy. The path is also followed on the last mesh if the caller wants its steps
/// (`keeps_path`), if it has critical points, or under displacement control. Throws InputError. Collective.
AccurateRun run_accurately(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                           bool keeps_path, const AccurateRunObserver& observer = {});

/// Searches a mesh, from `start` on, for a scene without one, with as little work as possible. Critical points are
/// located only if the path needs them, and their load factors are not compared; a path that does not arrive ends the
/// search.
AccurateRun search_mesh(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                        const MeshChoice& start, const AccurateRunObserver& observer);

}  // namespace mixbeam
