/// The structure of a scene as its equations see it, built once and never changed: mesh, partition, maps, conditions,
/// constraints, plane. Open this first; residual.hpp evaluates the equations of a state, tangent.hpp linearises them.
/// Each row is gathered by one thread in a fixed order, so results do not depend on the number of threads, and there
/// are no atomics.
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
  bool planar = true;                 ///< scenes in a plane have tangents in the plane
};

/// Elements at each owned vertex, in an order that is the same for every partition.
struct Adjacency {
  KernelView<int*> start;        ///< entries of vertex v: [start(v), start(v + 1))
  KernelView<int* [2]> element;  ///< local element, its end here
};

struct Workspace;

class Model {
 public:
  /// The scene must not change from here on; one that may is copied.
  Model(std::shared_ptr<const Scene> scene, const Communicator& comm, const ModelOptions& options);
  Model(const Scene& scene, const Communicator& comm, const ModelOptions& options)
      : Model(std::make_shared<const Scene>(scene), comm, options) {}
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const Scene& scene() const { return *scene_; }
  /// The share of this rank.
  const Mesh& mesh() const { return mesh_; }
  /// All of it, made anew on several ranks: for rare questions.
  std::shared_ptr<const Mesh> whole_mesh() const;
  const Structure& structure() const { return structure_; }
  const ModelOptions& options() const { return options_; }
  const Teuchos::RCP<const DofMap>& map() const { return maps_.rows; }
  const VertexMaps& vertex_maps() const { return maps_; }
  const Conditions& conditions() const { return conditions_; }
  const ConstraintRows& constraints() const { return constraints_; }
  const ExternalEnergies& external() const { return external_; }
  const LineFields& line_fields() const { return line_fields_; }
  /// The frame in which the scene is at rest.
  const FrameSpin& frame() const { return frame_; }
  /// Null: no element has a mass in a frame that turns.
  const RotatingElements* rotating() const { return rotating_.get(); }
  /// With which all amplitudes run; a path sets it.
  LoadClock& clock() const { return *clock_; }
  const Adjacency& adjacency() const { return adjacency_; }
  /// The plane that the scene keeps to, be it solved in it or not.
  const std::optional<PlaneAxes>& plane_of_scene() const { return plane_of_scene_; }
  /// That plane where the scene is solved in it, and the blocks of the structure there.
  const std::optional<PlaneAxes>& plane() const { return plane_; }
  const std::vector<PlanarBlock>& planar_blocks() const { return planar_blocks_; }
  /// (6 * owned vertex + component): 1 where a constraint stands in place of an equilibrium.
  KernelView<const unsigned char*> fixed_rows() const { return fixed_; }

  /// In the plane of the scene, if there is one.
  State reference_state() const;
  MixedVector create_vector() const;
  /// Whether a vector of increments or residuals has no part that leaves the plane. Collective.
  bool is_in_plane(const MixedVector& v) const;
  /// `from` moved by step * increment, as a new state: displacements and interior added, rotations composed.
  State apply(const State& from, const MixedVector& increment, double step) const;
  /// The vertex part of an increment at all local vertices.
  KernelView<const double* [6]> local_increment(const MixedVector& increment) const;

  /// Spatial forces and moments of the owned vertices (6 * owned vertex + component) become the free rows of the
  /// equations, those of constraints zero. Linear: the transpose of the motions that supports and joints permit.
  void project_on_free_motions(const State& state, const KernelView<double*>& rows) const {
    constraints_.project(state, rows);
  }

  /// Wall time that evaluations took so far.
  PhaseTimes& times() const { return times_; }
  /// Memory that evaluations use again. No number depends on the contents that another evaluation left there.
  Workspace& workspace() const { return *workspace_; }
  /// Frees arrays of vectors, and of tangents if told so, that the next evaluation would use again.
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
  std::vector<PlanarBlock> planar_blocks_;  ///< as Structure::blocks, where there is a plane
  KernelView<unsigned char*> owned_interior_;
  KernelView<unsigned char*> fixed_;  ///< (6 * owned vertex + component)
  Adjacency adjacency_;
  mutable PhaseTimes times_;
  std::unique_ptr<Workspace> workspace_;
};

/// A matrix over all vertices, for Tangent::gather. Collective.
VertexMatrix whole_matrix(const Model& model);

}  // namespace mixbeam
