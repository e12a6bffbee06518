/// How a branch is entered: along a direction in the eigenspace of a bifurcation that no mesh and no rounding changes.
#pragma once

#include "nonlinear/path/corrector.hpp"
#include "nonlinear/stability/stability.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace mixbeam {

/// Vectors of motion one, at right angles, that span a space.
std::vector<MixedVector> orthonormal(const PathMeasure& measure, const std::vector<MixedVector>& space);

/// Of motion one, in the space of the modes; Branch::negative gives the opposite of Branch::positive.
///
/// Along the projection of a displacement on the eigenspace, which for a single mode is a choice of its sign: of the
/// component that the user names (Branch Point, Branch Component); else of the mean displacement of the structure, its
/// first component x, y, z that is nearly the largest; where that vanishes, of the first half of a member, in the order
/// of the scene. Where all of them vanish (modes that only twist) the sign is that of EigenMode. None when the modes do
/// not move the component that is named. Collective.
std::optional<MixedVector> branch_direction(const BeamProblem& problem, const AnalysisParameters& analysis,
                                            const PathMeasure& measure, const std::vector<MixedVector>& eigenspace);

/// The first point of a branch and how far along the direction it lies from the critical point.
struct BranchPoint {
  Correction found;
  double amplitude = 0.0;
};

/// Sought at smaller and smaller amplitudes until a point moves along the direction and is taken; `is_taken` is asked
/// for each solve, also one that has not converged. Collective.
std::optional<BranchPoint> first_point_of_branch(const BeamProblem& problem, Corrector& corrector,
                                                 const PathMeasure& measure, const CriticalPoint& from,
                                                 const MixedVector& direction,
                                                 const std::function<bool(const Correction&)>& is_taken);

}  // namespace mixbeam
