/// The end of a path held against the same path in small steps.
#pragma once

#include "nonlinear/run/simulation.hpp"

#include <string>
#include <vector>

namespace mixbeam {

enum class PathOutcome {
  right,    ///< the end is that of the reference
  refused,  ///< the path ended early, as it must where a step cannot be verified
  wrong,    ///< another end, without a failure
  unknown   ///< the references do not agree with each other, or have no end
};

inline constexpr std::array<const char*, 4> kOutcomeNames = {"right", "refused", "wrong", "unknown"};

/// How one path was followed.
struct FollowedPath {
  bool finished = false;
  bool began_stable = false;
  std::vector<Vector3> displacements{};  ///< of the points of the scene, in their order
  int steps = 0, failed_steps = 0, iterations = 0;
  int negative = -1;  ///< eigenvalues of the last state; -1: not counted, or of no meaning (unsymmetric tangent)
  int critical_points = 0;
  double processor_seconds = 0.0;
  std::string failure{};
};

/// Along the load path; `plainly`: by Newton's method for the whole load at once, without any check.
FollowedPath follow(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                    bool plainly = false);

/// Whether the states of the path contradict each other: it began stable, met no critical point and ended unstable.
bool contradicts_itself(const FollowedPath& path);

/// Whether two paths of one structure end in the same equilibrium.
bool is_same_end(const Scene& scene, const FollowedPath& a, const FollowedPath& b);

struct JudgedPath {
  PathOutcome outcome = PathOutcome::unknown;
  bool reference_known = false;
  FollowedPath followed{};            ///< with the parameters given
  FollowedPath reference{};           ///< in the smaller steps
  double difference = 0.0;            ///< of the ends, largest displacement over the length of the structure
  double reference_difference = 0.0;  ///< likewise, of the references with each other
};

/// Follows the path as `parameters` say, and again with load steps of at most `reference_step` and half of it, with the
/// same checks: an end counts as known where these two agree and do not contradict themselves. A path that contradicts
/// itself is wrong whatever the reference says.
JudgedPath judge_path(const Scene& scene, const SolverParameters& parameters, double reference_step,
                      const Communicator& comm);

}  // namespace mixbeam
