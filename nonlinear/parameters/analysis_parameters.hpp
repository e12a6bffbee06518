/// Questions about the path of a structure, whatever way it is computed.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"

#include <Teuchos_ParameterList.hpp>

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

struct Scene;

/// Which of the paths that meet at the first bifurcation is followed.
enum class Branch { primary, positive, negative };

/// Behaviour where no stable state lies on the path at the next load.
enum class Snap {
  follow,  ///< the path, through unstable states
  jump     ///< down the total potential to a stable state at that load
};

/// A displacement that is driven to a target, while the load factor is whatever equilibrium needs.
struct MonitoredComponent {
  std::string point;
  int component = 0;    ///< 0, 1, 2: x, y, z
  double target = 0.0;  ///< displacement at the end of the path
};

/// Whether the discretization error of the state at the end of the path is estimated.
enum class ErrorEstimation { automatic, on, off };

/// States of which the stresses along members are computed, for sections given by their shape.
enum class StressesOf { automatic, every_step, none };

/// Natural modes about converged states.
struct ModesParameters {
  int number = 0;
  bool every_step = false;             ///< at the end of the path alone otherwise
  std::vector<double> load_factors{};  ///< likewise, where the path first has them; it stops there
  bool in_plane = false;               ///< of a scene in a plane: without the motions that leave it
};

/// Whether modes are asked for about a state of the path.
bool asks_for_modes(const ModesParameters& modes, double load_factor, bool end_of_path);

struct AnalysisParameters {
  /// Count the negative eigenvalues of every converged state and locate critical points. Not said: for all but the
  /// largest meshes (kVerticesForStability).
  std::optional<bool> stability{};
  bool trace = false;  ///< follow the path by its length from the start, never with a load step of any size
  /// How closely the path is followed where it is unstable: 0 as others, 1 as with `trace`, each one more with half the
  /// angle. Of a run that starts again, not of a scene.
  int closeness = 0;
  Branch branch = Branch::primary;  ///< positive, negative: along the mode of the first bifurcation, or against it
  /// Whose displacement is positive on the positive branch; `target` is not used. Not said: by rule (branch_direction).
  std::optional<MonitoredComponent> branch_point{};
  Snap snap = Snap::follow;
  int buckling_modes = 0;  ///< of the linear buckling analysis of the unloaded structure
  ModesParameters modes{};
  std::optional<MonitoredComponent> control{};
  ErrorEstimation error_estimate = ErrorEstimation::automatic;  ///< automatic: see kElementsForEstimate
  StressesOf stresses = StressesOf::automatic;                  ///< automatic: see kElementsForStresses
};

/// A path that returns to an earlier state is followed again from its start, up to this closeness.
inline constexpr int kMostCloseness = 3;

/// Above this size the factorisations that stability needs take longer, and more memory, than the rest of a load step.
inline constexpr int kVerticesForStability = 100'000;

/// Above this number of elements a run estimates its error on request only: it costs about two Newton iterations and a
/// second set of equations in memory.
inline constexpr int kElementsForEstimate = 100'000;

/// Up to this number of elements the stresses of the state at the end of a path are computed unasked: a few
/// microseconds for each sample, together about what a few Newton iterations take.
inline constexpr int kElementsForStresses = 20'000;

/// Whether the stresses of a state are computed.
inline bool computes_stresses(const AnalysisParameters& parameters, size_t elements, bool end_of_path) {
  if (parameters.stresses == StressesOf::automatic) return end_of_path && elements <= kElementsForStresses;
  return parameters.stresses == StressesOf::every_step;
}

/// Whether the error of the state at the end of a path is estimated in a mesh of this many elements.
inline bool estimates_error(const AnalysisParameters& parameters, size_t elements) {
  if (parameters.error_estimate == ErrorEstimation::automatic) return elements <= kElementsForEstimate;
  return parameters.error_estimate == ErrorEstimation::on;
}

/// Whether stability is determined in a mesh of this many vertices.
inline bool looks_at_stability(const AnalysisParameters& parameters, int vertices) {
  return parameters.stability.value_or(vertices <= kVerticesForStability);
}

/// Declaration of the list "Analysis".
ListSpec analysis_spec();

/// Validates and reads the list. `path`: where it stands below the root of `source`. Throws InputError.
AnalysisParameters read_analysis_parameters(Teuchos::ParameterList& list, const Scene& scene,
                                            const ParameterSource& source, const ParameterPath& path = {"Analysis"});

}  // namespace mixbeam
