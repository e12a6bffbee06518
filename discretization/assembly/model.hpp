/// Structure of a scene as its equations use it, immutable once built: mesh, partition, maps, conditions, constraints,
/// plane. Open this first; residual.hpp evaluates the equations of a state, tangent.hpp linearises them. One thread
/// gathers each row in a fixed order, without atomics, so results do not depend on the number of threads.
#pragma once

#include "discretization/assembly/line_fields.hpp"
#include "discretization/assembly/phase_timer.hpp"
#include "discretization/constraints/external_energy.hpp"
#include "discretization/constraints/rotating_frame.hpp"
#include "discretization/linear_system/vertex_matrix.hpp"
#include "discretization/mesh/mixed_vector.hpp"
#include "discretization/mesh/structure.hpp"
#include "kernels/loops/planar_block.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace mixbeam {

struct ModelOptions {
  double force_stiffness_cap = 1e5;   ///< tangent only: force stiffness limited to cap * max(EI / L^2, largest force)
  double residual_tolerance = 1e-11;  ///< see residual_scales
  bool planar = true;                 ///< use planar tangents for planar scenes
};

/// Elements at each owned vertex, in the same order for every partition.
struct Adjacency {
  KernelView<int*> start;        ///< entries of vertex v: [start(v), start(v + 1))
  KernelView<int* [2]> element;  ///< local element, its end here
};

struct Workspace;

class Model {
 public:
  /// The scene must not change afterwards; the second constructor copies it.
  Model(std::shared_ptr<const Scene> scene, const Communicator& comm, const ModelOptions& options);
  Model(const Scene& scene, const Communicator& comm, const ModelOptions& options)
      : Model(std::make_shared<const Scene>(scene), comm, options) {}
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const Scene& scene() const { return *scene_; }
  /// Mesh of this rank.
  const Mesh& mesh() const { return mesh_; }
  /// Whole mesh, rebuilt on several ranks: for rare use.
  std::shared_ptr<const Mesh> whole_mesh() const;
  const Structure& structure() const { return structure_; }
  const ModelOptions& options() const { return options_; }
  const Teuchos::RCP<const DofMap>& map() const { return maps_.rows; }
  const VertexMaps& vertex_maps() const { return maps_; }
  const Conditions& conditions() const { return conditions_; }
  const ConstraintRows& constraints() const { return constraints_; }
  const ExternalEnergies& external() const { return external_; }
  const LineFields& line_fields() const { return line_fields_; }
  /// Rotating frame in which the scene is at rest.
  const FrameSpin& frame() const { return frame_; }
  /// Null if no element has mass or the frame does not rotate.
  const RotatingElements* rotating() const { return rotating_.get(); }
  /// Clock of all amplitudes, set by the path.
  LoadClock& clock() const { return *clock_; }
  const Adjacency& adjacency() const { return adjacency_; }
  /// Plane of the scene, whether or not it is solved in it.
  const std::optional<PlaneAxes>& plane_of_scene() const { return plane_of_scene_; }
  /// That plane if the scene is solved in it, and the planar blocks of the structure.
  const std::optional<PlaneAxes>& plane() const { return plane_; }
  const std::vector<PlanarBlock>& planar_blocks() const { return planar_blocks_; }
  /// (6 * owned vertex + component): 1 if a constraint replaces the equilibrium equation.
  KernelView<const unsigned char*> fixed_rows() const { return fixed_; }

  /// Undeformed state, marked planar if there is a plane.
  State reference_state() const;
  MixedVector create_vector() const;
  /// True if a vector of increments or residuals has no out-of-plane part. Collective.
  bool is_in_plane(const MixedVector& v) const;
  /// New state `from` + step * increment: displacements and interior added, rotations composed.
  State apply(const State& from, const MixedVector& increment, double step) const;
  /// Vertex part of an increment at all local vertices.
  KernelView<const double* [6]> local_increment(const MixedVector& increment) const;

  /// Projects spatial forces and moments of the owned vertices (6 * owned vertex + component) on the free rows of the
  /// equations; rows of constraints become zero. Transpose of the motions that supports and joints permit.
  void project_on_free_motions(const State& state, const KernelView<double*>& rows) const {
    constraints_.project(state, rows);
  }

  /// Wall time of the evaluations so far.
  PhaseTimes& times() const { return times_; }
  /// Memory reused by evaluations. No result depends on contents left by an earlier evaluation.
  Workspace& workspace() const { return *workspace_; }
  /// Frees arrays of vectors, and of tangents if `tangents`, that are kept for reuse.
  void release_idle_arrays(bool tangents = false) const;

 private:
  void build_maps(const Communicator& comm);
  void mark_owned_interior();
  void build_adjacency();
  void build_plane();
  void keep_own_mesh();

  std::shared_ptr<const Scene> scene_;
  Mesh mesh_;
  Structure structure_;
  std::shared_ptr<LoadClock> clock_;
  LineFields line_fields_;
  Conditions conditions_;
  ConstraintRows constraints_;
  ExternalEnergies external_;
  FrameSpin frame_;
  std::unique_ptr<const RotatingElements> rotating_;
  ModelOptions options_;
  VertexMaps maps_;
  std::shared_ptr<VectorPool> vectors_ = std::make_shared<VectorPool>();
  std::optional<PlaneAxes> plane_of_scene_, plane_;
  std::vector<PlanarBlock> planar_blocks_;  ///< same order as Structure::blocks; empty without a plane
  KernelView<unsigned char*> owned_interior_;
  KernelView<unsigned char*> fixed_;  ///< (6 * owned vertex + component)
  Adjacency adjacency_;
  mutable PhaseTimes times_;
  std::unique_ptr<Workspace> workspace_;
};

/// Matrix over all vertices, for Tangent::gather. Collective.
VertexMatrix whole_matrix(const Model& model);

}  // namespace mixbeam
