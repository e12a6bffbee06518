/// Stresses along members from their sampled forces.
#pragma once

#include "discretization/mesh/communicator.hpp"
#include "discretization/mesh/mesh.hpp"
#include "discretization/state/member_samples.hpp"

namespace mixbeam {

/// Members that a report names.
inline constexpr std::size_t kMostStressed = 5;

/// Error of the bending stress of a curved member that is worth a warning.
inline constexpr double kCurvatureError = 0.05;

/// Fills the stresses of all samples that this rank holds, of the section where they are (tapers), and finds the
/// largest ones of the structure. A few microseconds for each sample, in parallel; the same bits for any number of
/// threads. Collective.
StressSummary sample_stresses(const Scene& scene, const Mesh& mesh, const Communicator& comm, SampledMembers& members);

}  // namespace mixbeam
