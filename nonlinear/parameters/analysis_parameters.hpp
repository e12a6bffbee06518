/// Analysis options: what to determine about the path of a structure, independent of how it is computed.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"

#include <Teuchos_ParameterList.hpp>

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

struct Scene;

/// Path to follow from the first bifurcation.
enum class Branch { primary, positive, negative };

/// Behaviour where the path has no stable state at the next load.
enum class Snap {
  follow,  ///< follow the path through unstable states
  jump     ///< descend the total potential to a stable state at that load
};

/// A displacement that is driven to a target, while the load factor follows from equilibrium.
struct MonitoredComponent {
  std::string point;
  int component = 0;    ///< 0, 1, 2: x, y, z
  double target = 0.0;  ///< displacement at the end of the path
};

/// Whether the discretization error of the state at the end of the path is estimated.
enum class ErrorEstimation { automatic, on, off };

/// States in which stresses along members are computed, for sections given by their shape.
enum class StressesOf { automatic, every_step, none };

/// Natural modes about converged states.
struct ModesParameters {
  int number = 0;
  bool every_step = false;             ///< false: at the end of the path alone
  std::vector<double> load_factors{};  ///< also at these, where the path first reaches them; it stops there
  bool in_plane = false;               ///< planar scenes: without out-of-plane modes
};

/// Whether modes are requested about a state of the path.
bool asks_for_modes(const ModesParameters& modes, double load_factor, bool end_of_path);

struct AnalysisParameters {
  /// Count the negative eigenvalues of every converged state and locate critical points. Unset: for all but the largest
  /// meshes (kVerticesForStability).
  std::optional<bool> stability{};
  bool trace = false;  ///< follow the path by arc length from the start, without load steps
  /// How closely the path is followed where it is unstable: 0 as elsewhere, 1 as with `trace`, each further level with
  /// half the angle. Set when a run starts again, not by a scene.
  int closeness = 0;
  Branch branch = Branch::primary;  ///< positive, negative: along the mode of the first bifurcation, or against it
  /// Displacement that is positive on the positive branch; `target` is not used. Unset: by rule (branch_direction).
  std::optional<MonitoredComponent> branch_point{};
  Snap snap = Snap::follow;
  int buckling_modes = 0;  ///< of the linear buckling analysis of the unloaded structure
  ModesParameters modes{};
  std::optional<MonitoredComponent> control{};
  ErrorEstimation error_estimate = ErrorEstimation::automatic;  ///< automatic: see kElementsForEstimate
  StressesOf stresses = StressesOf::automatic;                  ///< automatic: see kElementsForStresses
};

/// Largest closeness: a path that returns to an earlier state is followed again from its start, up to this level.
inline constexpr int kMostCloseness = 3;

/// Vertices above which the factorisations for stability take more time and memory than the rest of a load step.
inline constexpr int kVerticesForStability = 100'000;

/// Elements above which the error is estimated on request only: an estimate costs about two Newton iterations and a
/// second set of equations in memory.
inline constexpr int kElementsForEstimate = 100'000;

/// Elements up to which stresses at the end of a path are computed by default: a few microseconds for each sample,
/// in total about as long as a few Newton iterations.
inline constexpr int kElementsForStresses = 20'000;

/// Whether the stresses of a state are computed.
inline bool computes_stresses(const AnalysisParameters& parameters, size_t elements, bool end_of_path) {
  if (parameters.stresses == StressesOf::automatic) return end_of_path && elements <= kElementsForStresses;
  return parameters.stresses == StressesOf::every_step;
}

/// Whether the error at the end of a path is estimated for a mesh of this many elements.
inline bool estimates_error(const AnalysisParameters& parameters, size_t elements) {
  if (parameters.error_estimate == ErrorEstimation::automatic) return elements <= kElementsForEstimate;
  return parameters.error_estimate == ErrorEstimation::on;
}

/// Whether stability is determined for a mesh of this many vertices.
inline bool looks_at_stability(const AnalysisParameters& parameters, int vertices) {
  return parameters.stability.value_or(vertices <= kVerticesForStability);
}

/// Declaration of the list "Analysis".
ListSpec analysis_spec();

/// Validates and reads the list. `path`: its location below the root of `source`. Throws InputError.
AnalysisParameters read_analysis_parameters(Teuchos::ParameterList& list, const Scene& scene,
                                            const ParameterSource& source, const ParameterPath& path = {"Analysis"});

}  // namespace mixbeam
