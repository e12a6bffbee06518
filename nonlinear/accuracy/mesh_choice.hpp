/// Orders and numbers of elements for a wanted accuracy: where to start, and what to take after an error estimate.
#pragma once

#include "nonlinear/accuracy/error_estimate.hpp"

#include <vector>

namespace mixbeam {

struct MemberMesh {
  int order = 1, elements = 1;
  bool operator==(const MemberMesh& other) const { return order == other.order && elements == other.elements; }
};
using MeshChoice = std::vector<MemberMesh>;  ///< (member)

/// Elements of a member grow by at most this from mesh to mesh: further away nothing is known.
inline constexpr int kLargestRefinement = 4;

/// Of scenes that name neither a mesh nor an accuracy.
inline constexpr double kAccuracyWithoutMesh = 1e-4;
/// Whether a scene leaves its mesh to the program: no accuracy, no member that keeps an order or elements. Rigid arms
/// are exact on the one that they keep.
bool names_no_mesh(const Scene& scene);
/// Whether a member, no rigid arm, keeps its order and its elements.
bool keeps_some_mesh(const Scene& scene);

/// Orders and elements as they stand.
MeshChoice mesh_of(const Scene& scene);
/// Member by member the larger order and the larger number of elements.
MeshChoice joined(MeshChoice one, const MeshChoice& other);

/// The scene on this mesh. What a member keeps (Member::keeps_order, keeps_elements) stays as it is.
Scene on_mesh(const Scene& scene, const MeshChoice& choice);

/// The cheapest mesh that suffices for the accuracy if members turn as they do in the undeformed structure, by their
/// eigenstrains, and by a guess from the sizes of the loads.
/// `of_vertices`: for numbers of vertices alone, which converge with the power 2 k in place of k + 1.
MeshChoice start_mesh(const Scene& scene, double accuracy, bool of_vertices = false);

/// Displacements that an accuracy is not measured against, nor by less: an error that belongs to this size of the
/// largest displacement is rounding, or nothing where the structure as a whole hardly moves. `length`: of the
/// structure.
double least_displacement(double length, double accuracy);
/// The estimate with displacements that are at least as large as this.
ErrorEstimate with_least_displacement(ErrorEstimate estimate, double least);

/// What decides whether an accuracy is reached: the larger relative error of vertices and centerline.
double judged_error(const ErrorEstimate& estimate);

/// How far a member turns from element to element: theta such that the mean of theta_e^(k+1) over its elements is
/// theta^(k+1). `vertex_rotation`: (vertex, 4) unit quaternions w, x, y, z. [radian]
std::vector<double> element_turning(const Scene& scene, const Mesh& mesh, const std::vector<double>& vertex_rotation);
/// The largest such turning that goes with an accuracy.
double allowed_turning(int order, double accuracy, bool of_vertices = false);
/// Enough elements for members that turn too much, or kLargestRefinement times as many where that is less; `turning`:
/// of present elements.
MeshChoice mesh_for_turning(const Scene& scene, const MeshChoice& present, const std::vector<double>& turning,
                            double accuracy, bool of_vertices = false);

/// Twice as many elements.
MeshChoice doubled(const Scene& scene, const MeshChoice& present);

/// One order more, or twice as many elements where the order is kept or is the highest.
MeshChoice richer(const Scene& scene, const MeshChoice& present);
/// Whether every member has at least the order and the elements that it had.
bool contains(const MeshChoice& larger, const MeshChoice& smaller);

/// What of judged_error() is left where all other members are exact: that of members which keep order and elements.
double error_of_kept(const Scene& scene, const Mesh& mesh, const ErrorEstimate& estimate);

/// What an estimate says about one member, relative to the sizes of the quantities.
struct ErrorOfMember {
  double inside = 0.0;  ///< root mean square over the structure of what the element itself cannot represent
  double vertex = 0.0;  ///< its share in the largest error of a vertex
};
std::vector<ErrorOfMember> errors_of_members(const Scene& scene, const Mesh& mesh, const ErrorEstimate& estimate);

/// The cheapest mesh whose predicted error is at most `aim`; where there is none, that of the least error. `errors`: of
/// each member.
///
/// The error inside the elements of a member falls as (q h)^(k+1), the error of vertices as (q h)^(2k) with the share
/// of the member in it. Each q follows from the estimate with the assumption that an error of one belongs to q h = 1,
/// which the measured errors of smooth beams obey over eight digits (apps/docs/trade.md). `mesh`: the one that was
/// estimated; elements grow by kLargestRefinement at most.
MeshChoice next_mesh(const Scene& scene, const Mesh& mesh, const MeshChoice& present,
                     const std::vector<ErrorOfMember>& errors, double aim);

}  // namespace mixbeam
