/// Fields of a state at any point of an element or member, for results, plots and error norms.
#pragma once

#include "discretization/assembly/model.hpp"
#include "discretization/state/member_samples.hpp"

#include <functional>
#include <optional>

namespace mixbeam {

/// True if this rank owns an element of the mesh: it starts at one of its vertices.
bool answers_for(const Structure& structure, int mesh_element);

/// Same for a place on a member, see sample_member().
bool answers_for(const Model& model, int member, double position, bool before_vertex);

/// Fields at one point of an element.
struct PointSample {
  double arc_length = 0.0;                                  ///< along the member
  Vec3<double> reference_position, position, displacement;  ///< spatial
  Quaternion<double> triad;                                 ///< Lambda_E, spatial
  Vec3<double> force, moment;  ///< N, M: material; N interpolated through its Gauss points (degree k - 1 or k)
  Vec3<double> force_strain, moment_strain;  ///< C^-1 N, C^-1 M: material
};

/// Components in which N is interpolated.
enum class ForceComponents { material, spatial };

/// Fields at xi in [-1, 1] of a local element.
PointSample sample_element(const Structure& structure, const Mesh& mesh, const State& state, int local_element,
                           double xi, ForceComponents components = ForceComponents::material);

/// Sets the strains from the force and moment of a sample.
void set_strains(const Structure& structure, const Mesh& mesh, int local_element, PointSample& sample);

/// Samples a member at relative arc length `position` in [0, 1], on every rank; at a vertex in the element that starts
/// there (at the end of the member in its last one), or, `before_vertex`, in the one that ends there. Collective.
PointSample sample_member(const Model& model, const State& state, int member, double position,
                          bool before_vertex = false, ForceComponents components = ForceComponents::material);

/// Place in a local element, xi in [-1, 1].
struct PlaceInElement {
  int local_element = 0;
  double xi = 0.0;
};
/// Place for sample_member(); empty if this rank does not own it.
std::optional<PlaceInElement> place_in_element(const Model& model, int member, double position, bool before_vertex);

/// Gauss points per element for its length: accurate to 1e-12 for an element that rotates by one radian.
inline constexpr int kPointsOfLength = 16;
/// Length of the deformed centerline of a member. Collective.
double deformed_length(const Model& model, const State& state, int member);

/// Points per element for drawing an element of this order as a smooth curve: two per degree of its polynomials, and
/// enough for a smooth arc if the order is low but the element rotates by up to one radian.
int smooth_points(int order);
/// Points per element in result files, for a member with so many elements: smooth_points(), or fewer, down to both
/// ends, if the member is a smooth curve with those.
int recorded_points(int order, int elements);

/// More samples do not make curves look better: elements of larger structures are sampled only at both ends.
inline constexpr size_t kMostSmoothSamples = 1'000'000;

/// Instead of a number of points per element: recorded_points() of its member, or only both ends if that would make
/// more than kMostSmoothSamples.
inline constexpr int kPointsByOrder = 0;

/// Samples every element of the scene at `points_per_element` equidistant points (both ends included, so that one-sided
/// values at vertices are visible) or at kPointsByOrder. Returns the share of this rank: the elements that start at one
/// of its vertices. Rank 0 has descriptions of all members.
SampledMembers sample_own_elements(const Scene& scene, const Model& model, const State& state, int points_per_element);

/// Displacements of a motion at the same samples, all members in turn. Collective.
std::vector<Vector3> sample_own_motion(const Scene& scene, const Model& model, const MixedVector& motion,
                                       int points_per_element);

/// Samples members completely on rank 0; other ranks return the members without samples. For small structures.
/// Collective.
std::vector<MemberSamples> sample_members(const Scene& scene, const Model& model, const State& state,
                                          int points_per_element);

/// sqrt(1/L int |field(point)|^2 ds) over the whole structure, L its total length, by Gauss rules with `points` points
/// per element. Collective.
double l2_norm(const Model& model, const State& state, int points,
               const std::function<Vec3<double>(const PointSample&, int member)>& field);

/// Strain energies of the force strains and of the moment strains (all ranks). Collective.
struct StrainEnergy {
  double force = 0.0, moment = 0.0;
};
StrainEnergy strain_energy(const Model& model, const State& state);

/// Displacement (3) and rotation vector of Lambda_V (3, norm at most pi) of a global vertex, on every rank. Collective.
std::array<double, 6> vertex_motion(const Model& model, const State& state, int vertex);
/// Undeformed position of a global vertex, on every rank. Collective.
Vector3 reference_position(const Model& model, int vertex);
/// Largest displacement of any vertex. Collective.
double largest_displacement(const Model& model, const State& state);

}  // namespace mixbeam
