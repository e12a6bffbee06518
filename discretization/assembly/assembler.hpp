/// Where Tpetra meets the kernels: residual and condensed tangent of the whole structure, gathered row by row (each row
/// is written by one thread in a fixed order, so results do not depend on the number of threads, and there are no
/// atomics).
#pragma once

#include "discretization/assembly/line_fields.hpp"
#include "discretization/assembly/phase_timer.hpp"
#include "discretization/assembly/plane.hpp"
#include "discretization/assembly/residual_scales.hpp"
#include "discretization/constraints/constraint_rows.hpp"
#include "discretization/linear_system/vertex_matrix.hpp"
#include "discretization/mesh/mixed_vector.hpp"
#include "discretization/mesh/structure.hpp"
#include "discretization/mesh/tpetra_types.hpp"

#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

struct AssemblerOptions {
  double force_stiffness_cap = 1e5;   ///< tangent only: force stiffness limited to cap * max(EI / L^2, largest force)
  double residual_tolerance = 1e-11;  ///< see residual_scales
  bool planar = true;                 ///< scenes in a plane have tangents in the plane
};

class Assembler {
 public:
  Assembler(const Scene& scene, const Communicator& comm, const AssemblerOptions& options);

  const Scene& scene() const { return scene_; }
  const Mesh& mesh() const { return mesh_; }
  const Structure& structure() const { return structure_; }
  const Teuchos::RCP<const DofMap>& map() const { return maps_.rows; }
  const VertexMaps& vertex_maps() const { return maps_; }
  const ElementEquations& equations() const { return equations_; }
  const Conditions& conditions() const { return conditions_; }
  const LineFields& line_fields() const { return line_fields_; }
  PhaseTimes& times() const { return times_; }

  /// In the plane of the scene, if there is one.
  State reference_state() const;
  /// The plane that the scene keeps to and is solved in.
  const std::optional<PlaneAxes>& plane() const { return plane_; }
  /// Whether a vector of increments or residuals has no part that leaves the plane. Collective.
  bool is_in_plane(const MixedVector& v) const;
  MixedVector create_vector() const;

  /// Mixed residual, every row divided by its scale.
  void residual(const State& state, double load_factor, MixedVector& out);

  /// Unscaled rows of the elements alone, without point loads and supports: the forces and moments (spatial) that hold
  /// the elements at each vertex in place, and the interior rows. `with_line_loads` false: as if the members carried
  /// none.
  void element_rows(const State& state, double load_factor, bool with_line_loads, MixedVector& out);
  /// Scales that residual() would use.
  ResidualScales scales_of(const State& state, double load_factor);

  /// Element tangents and the condensed residual of `state`; call residual() of the same state first. What is asked of
  /// a tangent below refers to the last one.
  void tangent(const State& state, double load_factor);
  /// Eigenvalues below zero of the interiors of all elements while their vertices stand still, at the last tangent():
  /// the J0 of Wittrick and Williams, which the count of the condensed matrix lacks. Collective.
  struct InteriorCount {
    long negative = 0;       ///< of elements without a potential their parity
    bool uncertain = false;  ///< one is zero within rounding
  };
  InteriorCount interior_count() const;
  /// The same for Newton's method: where the state lies in the plane of the scene, so does the tangent unless
  /// `in_space` is asked for, and right-hand sides must. What sees motions out of the plane (stability) takes
  /// tangent().
  void newton_tangent(const State& state, double load_factor, bool in_space = false);
  /// Another one with each tangent() and newton_tangent(), and with each change of the cap, with which right-hand sides
  /// would be condensed: who keeps the number of his tangent knows whether it is still the last one. Zero: none yet.
  long tangent_number() const { return tangent_.number; }
  /// Whether the last tangent is in the plane; matrix() then evaluates the spatial one of the same state.
  bool has_planar_tangent() const { return tangent_.planar; }
  const PlanarTangents& planar_tangents() const { return planar_tangents_; }
  /// The tangent as one matrix over all vertices, gathered when it is first asked for. Collective.
  const Teuchos::RCP<DofMatrix>& matrix() const;
  /// Gathers the links of the tangent into a matrix over some of the vertices and adds loads, supports and joints.
  void fill(const VertexMatrix& matrix, const LinkMatrices<kSpatialDofs>& links) const;
  /// Elements at each owned vertex, in an order that is the same for every partition.
  struct Adjacency {
    KernelView<int*> start;        ///< entries of vertex v: [start(v), start(v + 1))
    KernelView<int* [2]> element;  ///< local element, its end here
  };
  const Adjacency& adjacency() const { return adjacency_; }
  /// Condensed (unscaled) residual of the last tangent().
  DofVector& condensed_residual() const { return *condensed_residual_; }

  /// Newton increment of the interior that belongs to a vertex increment; both parts of `increment` are complete
  /// afterwards.
  void recover(const State& state, MixedVector& increment);

  /// Condenses a scaled right-hand side (rows as residual() returns them) at the state of the last tangent():
  /// afterwards condensed_residual() and recover() refer to it.
  void condense(const State& state, double load_factor, const MixedVector& scaled_rhs);

  /// Cap over stiffness, where that is largest among the stiffnesses that the cap of the present tangent() cuts off and
  /// that are finite; zero where it cuts off none. (What is exactly rigid shares nothing by stiffness.)
  double least_cap_ratio() const { return least_cap_ratio_; }
  /// What the softened tangent leaves out: rows of (J - softened J) times an increment, scaled as residual() does.
  void softening_rows(const MixedVector& increment, MixedVector& out) const;
  /// The largest of these rows. Collective.
  double largest_softening_row(const MixedVector& increment) const;

  /// `from` moved by step * increment, as a new state: displacements and interior added, rotations composed.
  State apply(const State& from, const MixedVector& increment, double step);

  /// d(scaled residual)/d(load factor).
  void load_derivative(const State& state, double load_factor, MixedVector& out);

  /// Matrix times a vertex vector, as assembled.
  void apply_matrix(const DofVector& x, DofVector& y) const { matrix()->apply(x, y); }

  /// Spatial forces and moments of the owned vertices (6 * owned vertex + component) become the free rows of the
  /// equations, those of constraints zero. Linear: the transpose of the motions that supports and joints permit.
  void turn_rows(const State& state, const KernelView<double*>& rows) const { constraints_.turn(state, rows); }
  /// The same at the state of the tangent.
  void turn_tangent_rows(const KernelView<double*>& rows) const { constraints_.turn(tangent_.state, rows); }
  /// (6 * owned vertex + component): 1 where a constraint stands in place of an equilibrium.
  KernelView<const unsigned char*> fixed_rows() const { return fixed_; }

  /// Caps the force stiffness of the tangents to come at this multiple of the usual cap.
  void raise_cap(double factor);
  double cap_raise() const { return cap_raise_; }
  /// Stiffness of forces that the last tangent was capped at.
  double stiffness_cap() const { return stiffness_cap_; }
  /// Largest stresses, motions and loads. Collective.
  StateMagnitude magnitude(const State& state) const;

  /// Row scales of the last residual(), or those of another state that is to be worked on.
  const ResidualScales& scales() const { return scales_; }
  void use_scales(const ResidualScales& scales) { scales_ = scales; }
  /// Takes rows scaled by `from` to `to`, which are used from then on.
  void rescale(MixedVector& rows, const ResidualScales& from, const ResidualScales& to);
  /// Takes rows scaled by scales() to forces, moments and integrals of strains.
  void unscale(MixedVector& rows) const { scale_rows(rows, true); }
  /// Largest force or moment row of a scaled residual: equilibrium without compatibility and supports.
  double equilibrium_norm(const MixedVector& scaled_residual) const;
  /// Largest row of N or M of a scaled residual: compatibility and the constitutive law.
  double compatibility_norm(const MixedVector& scaled_residual) const;
  /// Scaled residual that counts as converged.
  double residual_tolerance() const { return options_.residual_tolerance; }
  /// Largest relative rotation between an element and its vertices in the last residual (all ranks), and where.
  struct EndAngle {
    double angle = 0.0;
    std::string member;
    int element = 0;
  };
  EndAngle largest_end_angle() const;

 private:
  void build_maps(const Communicator& comm);
  void mark_fixed_rows();
  void mark_owned_interior();
  void build_adjacency();
  void set_load_factor(double load_factor);
  void cap_force_stiffness();
  void evaluate_elements(const State& state, MixedVector& out);
  void gather_rows(const KernelView<double* [12]>& element_rows, const KernelView<double*>& rows) const;
  void gather_planar_rows(const KernelView<double*>& rows) const;
  void scale_vertex_rows(const KernelView<double*>& rows, bool inverse) const;
  void scale_rows(MixedVector& v, bool inverse) const;
  void add_load_tangents(const MatrixRows& rows) const;
  void build_plane();
  void evaluate_spatial_tangents(const State& state) const;
  void spatial_tangent(const State& state, double load_factor);
  void finish_tangent(const State& state, double load_factor, bool planar);
  void remember_constraint_forces(const State& state, double load_factor);
  KernelView<const double* [6]> local_increment(const MixedVector& increment) const;

  Scene scene_;
  Mesh mesh_;
  Structure structure_;
  LineFields line_fields_;
  Conditions conditions_;
  ConstraintRows constraints_;
  AssemblerOptions options_;
  VertexMaps maps_;
  std::shared_ptr<VectorPool> vectors_ = std::make_shared<VectorPool>();
  /// Where the tangent was taken.
  struct {
    State state;
    double load_factor = 0.0;
    long number = 0;
    bool planar = false;
  } tangent_;
  mutable std::unique_ptr<VertexMatrix> matrix_;  ///< over all vertices, built when it is first asked for
  mutable bool matrix_is_filled_ = false;
  Teuchos::RCP<DofVector> condensed_residual_, ghosted_increment_;
  ElementEquations equations_;
  std::optional<PlaneAxes> plane_;
  std::vector<PlanarBlock> planar_blocks_;  ///< as Structure::blocks, where there is a plane
  PlanarTangents planar_tangents_;
  KernelView<unsigned char*> owned_interior_;
  KernelView<unsigned char*> fixed_;  ///< (6 * owned vertex + component)
  Adjacency adjacency_;
  ResidualScales scales_;
  double load_factor_ = 0.0;
  bool line_fields_set_ = false;
  double stiffness_cap_ = 0.0, cap_raise_ = 1.0;
  double least_cap_ratio_ = 0.0;
  KernelView<int*> interior_negative_;  ///< (element): ElementEquations::interior_negative of the last tangent()
  mutable PhaseTimes times_;
};

}  // namespace mixbeam
