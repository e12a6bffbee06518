/// A scene solved to a wanted accuracy (Scene::accuracy): on a mesh that the program chooses.
///
/// The whole path is followed on a start mesh, the error of its end estimated, the next mesh chosen from that. The
/// state is carried over to it and Newton's method goes on from there, until the estimate is small enough. A path that
/// turns the elements of a start mesh too far is left early, for a finer one. Where the path has critical points it is
/// followed on a second mesh, which tells how far their load factors are from right, and so on until that is small
/// enough.
#pragma once

#include "nonlinear/accuracy/mesh_choice.hpp"
#include "nonlinear/run/simulation.hpp"

#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

/// One mesh on the way.
struct MeshRound {
  MeshChoice mesh;
  int elements = 0;       ///< of all members
  bool followed = false;  ///< the whole path; else corrected from the mesh before
  int steps = 0, failed_steps = 0, iterations = 0;
  double seconds = 0.0;     ///< wall time, error estimate included
  double error = 0.0;       ///< estimated, relative, see judged_error() or what counts in its place; not a number: none
  int critical_points = 0;  ///< of the path that was followed, multiple ones as often
  /// Largest relative difference of their load factors from those of the mesh before, which this one contains: the
  /// error there, and more than the error here. Zero without critical points; not a number: not known.
  double critical_error = 0.0;
  double buckling_error =
      0.0;               ///< estimated, of linear buckling factors, where they are asked for, and known if they count
  std::string remark{};  ///< why it was left, where that is not the estimate
};

enum class AccuracyEnd {
  reached,
  kept_meshes,     ///< members that keep order or elements prevent it
  rounding,        ///< a finer mesh was not more accurate
  too_many,        ///< meshes
  not_estimated,   ///< no estimate: see ErrorEstimate
  interrupted,     ///< from outside
  no_equilibrium,  ///< the path did not arrive: see result() of the simulation
};

/// "reached", "orders and elements that members keep prevent it", ...
std::string text_of(AccuracyEnd end);

/// What watches a run. `begin`: a mesh is about to be solved; `step`: of its path, all but the last; `end`: its last
/// step with the estimated error.
struct AccurateRunObserver {
  /// Relative error that counts in place of displacements, NaN where it is not known.
  using ErrorOf = std::function<double(const Simulation& simulation, const ErrorEstimate& estimate)>;
  ErrorOf error_of{};
  bool of_vertices = false;  ///< what counts is made of motions of vertices alone: see start_mesh()
  /// (member): its share of that error, relative; empty where that is not known.
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

/// The estimate must be below this share of the accuracy: it is within a factor of two of the error nearly always.
inline constexpr double kShareOfAccuracy = 0.5;

/// Solves a scene with an accuracy. The path is also followed on the last mesh if the caller wants its steps
/// (`keeps_path`), if it has critical points, or under displacement control. Throws InputError. Collective.
AccurateRun run_accurately(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                           bool keeps_path, const AccurateRunObserver& observer = {});

/// The same for the sake of the mesh of a scene that names none, from this mesh on: as short as it can be. Critical
/// points are looked for where the path needs them, their load factors are not compared; a path that does not arrive
/// ends the search.
AccurateRun search_mesh(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                        const MeshChoice& start, const AccurateRunObserver& observer);

}  // namespace mixbeam
