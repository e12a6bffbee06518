/// Orders and numbers of elements for a wanted accuracy: the start mesh, and the next mesh after an error estimate.
#pragma once

#include "nonlinear/accuracy/error_estimate.hpp"

#include <vector>

namespace mixbeam {

struct MemberMesh {
  int order = 1, elements = 1;
  bool operator==(const MemberMesh& other) const { return order == other.order && elements == other.elements; }
};
using MeshChoice = std::vector<MemberMesh>;  ///< (member)

/// Largest growth of the number of elements of a member from mesh to mesh: beyond, predictions are unreliable.
inline constexpr int kLargestRefinement = 4;

/// Accuracy for scenes that specify neither a mesh nor an accuracy.
inline constexpr double kAccuracyWithoutMesh = 1e-4;
/// Whether a scene leaves its mesh to the program: no accuracy, and no member with a fixed order or number of elements,
/// except rigid arms, which are exact on the mesh that they keep.
bool names_no_mesh(const Scene& scene);
/// Whether a member other than a rigid arm has a fixed order and number of elements.
bool keeps_some_mesh(const Scene& scene);

/// Present orders and numbers of elements.
MeshChoice mesh_of(const Scene& scene);
/// Larger order and larger number of elements for each member.
MeshChoice joined(MeshChoice one, const MeshChoice& other);

/// Returns the scene on this mesh. Fixed numbers (Member::keeps_order, keeps_elements) stay unchanged.
Scene on_mesh(const Scene& scene, const MeshChoice& choice);

/// Chooses the cheapest mesh that suffices for the accuracy if members rotate along their length as in the undeformed
/// structure, by their eigenstrains, and by a guess from the sizes of the loads.
/// `of_vertices`: for numbers of vertices alone, which converge with the power 2 k instead of k + 1.
MeshChoice start_mesh(const Scene& scene, double accuracy, bool of_vertices = false);

/// Least size of displacements for relative errors: relative to smaller ones, errors are rounding, or insignificant
/// since the structure as a whole hardly moves. `length`: of the structure.
double least_displacement(double length, double accuracy);
/// Raises the sizes of displacements in an estimate to at least this.
ErrorEstimate with_least_displacement(ErrorEstimate estimate, double least);

/// Error that decides whether an accuracy is reached: the larger relative error of vertices and centerline.
double judged_error(const ErrorEstimate& estimate);

/// Rotation of a member from element to element: theta such that the mean of theta_e^(k+1) over its elements is
/// theta^(k+1). `vertex_rotation`: (vertex, 4) unit quaternions w, x, y, z. [radian]
std::vector<double> element_turning(const Scene& scene, const Mesh& mesh, const std::vector<double>& vertex_rotation);
/// Largest such rotation that is consistent with an accuracy. [radian]
double allowed_turning(int order, double accuracy, bool of_vertices = false);
/// Adds enough elements to members that rotate too much, up to kLargestRefinement times as many; `turning`: of present
/// elements.
MeshChoice mesh_for_turning(const Scene& scene, const MeshChoice& present, const std::vector<double>& turning,
                            double accuracy, bool of_vertices = false);

/// Doubles the elements.
MeshChoice doubled(const Scene& scene, const MeshChoice& present);

/// Raises the order by one, or doubles the elements if the order is fixed or the highest.
MeshChoice richer(const Scene& scene, const MeshChoice& present);
/// Whether every member of the larger mesh has at least the order and the elements of the smaller one.
bool contains(const MeshChoice& larger, const MeshChoice& smaller);

/// Part of judged_error() due to members with fixed order and elements, which remains if all others are exact.
double error_of_kept(const Scene& scene, const Mesh& mesh, const ErrorEstimate& estimate);

/// Estimated error of one member, relative to the sizes of the quantities.
struct ErrorOfMember {
  double inside = 0.0;  ///< rms over the structure of the part that the element itself cannot represent
  double vertex = 0.0;  ///< its share of the largest error of a vertex
};
std::vector<ErrorOfMember> errors_of_members(const Scene& scene, const Mesh& mesh, const ErrorEstimate& estimate);

/// Chooses the cheapest mesh whose predicted error is at most `aim`, or that of the least error. `errors`: of each
/// member.
///
/// The error inside the elements of a member falls as (q h)^(k+1), the error of vertices as (q h)^(2k) with the share
/// of the member. Each q follows from the estimate with the assumption that an error of one belongs to q h = 1,
/// which the measured errors of smooth beams obey over eight digits (apps/docs/trade.md). `mesh`: the one that was
/// estimated; elements grow by kLargestRefinement at most.
MeshChoice next_mesh(const Scene& scene, const Mesh& mesh, const MeshChoice& present,
                     const std::vector<ErrorOfMember>& errors, double aim);

}  // namespace mixbeam
