/// Entry to a branch: along a direction in the eigenspace of a bifurcation that does not depend on mesh or rounding.
#pragma once

#include "nonlinear/path/corrector.hpp"
#include "nonlinear/stability/stability.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace mixbeam {

/// Orthonormalises vectors in the measure of motion.
std::vector<MixedVector> orthonormal(const PathMeasure& measure, const std::vector<MixedVector>& space);

/// Returns a direction of unit motion in the space of the modes, opposite for Branch::negative and Branch::positive.
///
/// It is the projection of a displacement on the eigenspace, which for a single mode is a choice of its sign: of the
/// component that the user names (Branch Point, Branch Component); else of the mean displacement of the structure, its
/// first component x, y, z that is nearly the largest; if that vanishes, of the first half of a member, in the order of
/// the scene. If all of them vanish (purely torsional modes) the sign is that of EigenMode. None if the modes do not
/// move the named component. Collective.
std::optional<MixedVector> branch_direction(const BeamProblem& problem, const AnalysisParameters& analysis,
                                            const PathMeasure& measure, const std::vector<MixedVector>& eigenspace);

/// First point of a branch, and its distance from the critical point along the direction.
struct BranchPoint {
  Correction found;
  double amplitude = 0.0;
};

/// Seeks the point at smaller and smaller amplitudes until one moves along the direction and is accepted; `is_taken` is
/// called for each solve, also if it has not converged. Collective.
std::optional<BranchPoint> first_point_of_branch(const BeamProblem& problem, Corrector& corrector,
                                                 const PathMeasure& measure, const CriticalPoint& from,
                                                 const MixedVector& direction,
                                                 const std::function<bool(const Correction&)>& is_taken);

}  // namespace mixbeam
