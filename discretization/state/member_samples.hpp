/// Sampled configuration of a structure at one converged step, for result files, tables and plots. Plain data,
/// independent of how it was computed. Lengths, forces and moments in the consistent units of the scene.
#pragma once

#include "discretization/scene/scene.hpp"
#include "discretization/state/acting.hpp"
#include "discretization/state/resume_point.hpp"
#include "discretization/stresses/section_stresses.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// Unit quaternion (w, x, y, z) of a total triad: the columns of its rotation matrix are the spatial components of g1,
/// g2, g3.
using TriadQuaternion = std::array<double, 4>;

/// Description of a sampled member, without its samples.
struct SampledMember {
  std::string name{};            ///< the member's name in the scene
  int order = 0, elements = 0;   ///< of its mesh
  int points_per_element = 0;    ///< samples per element
  RowShare share{};              ///< samples of the member held here
  int number = 0;                ///< among all members
  std::size_t first_sample = 0;  ///< of the member, among those of all members
};

/// One member sampled along its centerline, or the share of a rank in it. Every vector has one entry per sample, in
/// order of arc length. Elements may differ in triad and strains at a common vertex, so a vertex inside the member is
/// sampled once for each of its two elements; `element` distinguishes them.
struct MemberSamples : SampledMember {
  std::vector<double> arc_length;           ///< s of the undeformed centerline, 0 at the member's start point
  std::vector<int> element;                 ///< element within the member, 0, 1, ...
  std::vector<Vector3> reference_position;  ///< undeformed centerline, spatial
  std::vector<Vector3> position;            ///< deformed centerline r, spatial
  std::vector<Vector3> displacement;        ///< position - reference_position, spatial
  std::vector<TriadQuaternion> triad;       ///< total rotation of the section, from the global frame to g1, g2, g3
  std::vector<Vector3> force_strain;        ///< gamma, material (axial, shear 2, shear 3)
  std::vector<Vector3> moment_strain;       ///< kappa, material (torsion, bending 2, bending 3), 1/length
  std::vector<Vector3> material_force;      ///< N, material
  std::vector<Vector3> material_moment;     ///< M, material
  /// Largest stresses of the section at each sample, if requested (else empty): normal stress with its sign. NaN:
  /// section not given by its shape.
  std::vector<double> largest_normal_stress, largest_shear_stress, von_mises_stress;
  std::vector<double> utilisation;  ///< same: von Mises stress over strength. NaN: no strength given

  /// Number of samples held here.
  std::size_t size() const { return arc_length.size(); }

  /// Allocates all `count` samples: zeros, and the triad of the global frame.
  void resize(std::size_t count) { hold(all_rows(count)); }

  /// Allocates a share of the samples.
  void hold(const RowShare& rows) {
    share = rows;
    const std::size_t count = rows.held();
    arc_length.resize(count);
    element.resize(count);
    for (auto* field : {&reference_position, &position, &displacement, &force_strain, &moment_strain, &material_force,
                        &material_moment}) {
      field->resize(count);
    }
    triad.resize(count, TriadQuaternion{1, 0, 0, 0});
  }

  /// True if every field has one entry for each sample of the share.
  bool is_complete() const {
    if (size() != share.held()) return false;
    for (const auto* field : {&reference_position, &position, &displacement, &force_strain, &moment_strain,
                              &material_force, &material_moment}) {
      if (field->size() != size()) return false;
    }
    for (const auto* stress : {&largest_normal_stress, &largest_shear_stress, &von_mises_stress, &utilisation})
      if (!stress->empty() && stress->size() != size()) return false;
    return element.size() == size() && triad.size() == size();
  }
};

/// Members of which a rank holds samples, in the order of the scene, and counts for the whole structure.
class SampledMembers {
 public:
  SampledMembers() = default;
  /// Takes all members and sets their numbers and first samples.
  SampledMembers(std::vector<MemberSamples> all);
  SampledMembers(std::initializer_list<MemberSamples> all) : SampledMembers(std::vector<MemberSamples>(all)) {}
  /// Adds the next member of the structure, of which no sample is held here: by its counts, or by its description.
  void add_absent(std::size_t samples, int elements);
  void add_absent(SampledMember member);
  /// Adds the next member, of which all or some samples are held.
  void add(MemberSamples member);

  auto begin() { return held_.begin(); }
  auto end() { return held_.end(); }
  auto begin() const { return held_.begin(); }
  auto end() const { return held_.end(); }
  std::size_t size() const { return held_.size(); }
  MemberSamples& operator[](std::size_t i) { return held_[i]; }
  const MemberSamples& operator[](std::size_t i) const { return held_[i]; }
  /// Null if no sample of the member is held.
  const MemberSamples* find(int number) const;

  // Counts for the whole structure.
  std::size_t members() const { return members_; }
  std::size_t samples() const { return samples_; }
  std::size_t elements() const { return elements_; }
  /// Calls action(SampledMember) for each member that is held or described, in order.
  template <class Action>
  void for_each_known(const Action& action) const {
    std::size_t next = 0;
    for (const SampledMember& member : absent_) {
      for (; next < held_.size() && held_[next].number < member.number; ++next) action(held_[next]);
      action(member);
    }
    for (; next < held_.size(); ++next) action(held_[next]);
  }

 private:
  void number(SampledMember& member);

  std::vector<MemberSamples> held_;
  std::vector<SampledMember> absent_;
  std::size_t members_ = 0, samples_ = 0, elements_ = 0;
};

/// Quantity recorded along the load path, such as the displacement of a point: one value, or three spatial components.
struct MonitoredQuantity {
  std::string name;                ///< for example "tip.displacement"
  std::vector<double> components;  ///< size 1 (scalar) or 3 (vector)
};

/// Reaction that a support, springs included, exerts on the structure. Spatial; the moment acts on the vertex itself.
struct RecordedReaction {
  std::string point{};
  Vector3 force{}, moment{};
};

/// Sums over all external forces and reactions, see Balance in reactions.hpp. NaN: not computed.
struct RecordedBalance {
  Vector3 applied_force{}, applied_moment{}, reaction_force{}, reaction_moment{};
  double force_error = std::numeric_limits<double>::quiet_NaN();
  double moment_error = std::numeric_limits<double>::quiet_NaN();
};

/// Stability of an equilibrium, in the words of files and messages: "true", "false", "neutral" (no negative eigenvalue,
/// one is zero) or "unknown".
struct RecordedStability {
  std::string stable = "unknown";
  std::string held{};         ///< under displacement control; empty: not known
  int negative = -1;          ///< number of negative eigenvalues of the tangent; -1: not counted
  bool has_potential = true;  ///< the loads have a potential; otherwise stability is never certain
};

/// Jump from the last stable state on a path to another stable state of lower total potential.
struct RecordedJump {
  double from = 0.0, to = 0.0;  ///< load factors between which the stable path ends
  double released = 0.0;        ///< energy [force * length], theory (66)
  double motion = 0.0;          ///< between the states, theory (53): displacements over the scene's length, rotations
  double largest = 0.0;         ///< largest displacement of a vertex between the states [length]
  std::string place{};          ///< of that vertex
  int factorizations = 0;       ///< used by the search
};

/// Limit point or bifurcation between two steps, see CriticalPoint, without its fields.
struct CriticalPointSummary {
  std::string kind{};  ///< "limit point", "bifurcation", "flutter"
  double load_factor = 0.0;
  double load_factor_error = 0.0;               ///< estimated
  int negative_before = 0, negative_after = 0;  ///< negative eigenvalues on either side, in the direction of the path
  int modes = 1;                                ///< number that become singular, or coincide, together
  double omega = std::numeric_limits<double>::quiet_NaN();  ///< of flutter
  std::vector<MonitoredQuantity> monitored{};               ///< as in the step
  std::vector<RecordedReaction> reactions{};
};

/// Fields at the samples of all members that the rank holds, one after the other, spatial.
struct RecordedCriticalPoint : CriticalPointSummary {
  std::vector<Vector3> position{}, displacement{};
  std::vector<Vector3> mode{};  ///< displacement of the critical mode, per unit of its largest |du_i|/L or |dtheta_i|
  StateShare state{};
};

/// Mode of the linear buckling analysis of the undeformed structure.
struct RecordedBucklingMode {
  double load_factor = 0.0;     ///< negative: under the reversed load
  std::vector<Vector3> mode{};  ///< displacement at the samples, scaled like that of a critical point
  double residual{};            ///< see linear_buckling()
  bool confirmed{};             ///< by the inertia of the tangent on both sides
  double error = std::numeric_limits<double>::quiet_NaN();  ///< of the mesh, estimated; NaN: not known
};

/// Natural mode of the structure about an equilibrium state.
struct RecordedVibrationMode {
  int track = -1;           ///< number of its track along the path, from 1, see ModeTracks; negative: not tracked
  double eigenvalue = 0.0;  ///< omega^2; negative if the state is unstable
  double omega = 0.0;       ///< its square root; zero if negative
  double frequency = 0.0;   ///< omega / (2 pi)
  double growth = 0.0;      ///< growth rate; negative: decay
  double modal_mass = 0.0;  ///< twice its kinetic energy at unit rate
  double participation_x = 0.0, participation_y = 0.0, participation_z = 0.0;  ///< momentum over the modal mass
  double residual = 0.0;                                                       ///< see vibration_modes()
  bool confirmed = false;       ///< by the inertia: no lower mode is missing
  std::vector<Vector3> mode{};  ///< displacement at the samples, scaled like that of a critical point
};

/// Estimated error and the size of the quantity that it belongs to.
struct RecordedError {
  double error = 0.0, size = 0.0;
  double relative() const { return size > 0.0 ? error / size : 0.0; }
};

/// Number and its estimated error.
struct EstimatedValue {
  std::string name{};
  double value = 0.0;
  double error = std::numeric_limits<double>::quiet_NaN();  ///< relates to the size of the value; NaN: none
  std::string not_estimated{};                              ///< reason, if an estimate was requested
  bool is_estimated() const { return !std::isnan(error); }
  double relative() const { return error == 0.0 ? 0.0 : error / std::abs(value); }
};

/// Derivatives of a number with respect to numbers of the scene, and to those of each element of the mesh: six each,
/// for N1, N2, N3, M1, M2, M3.
struct RecordedGradient {
  std::string quantity{};
  double value = 0.0;
  std::vector<double> derivative{};                                         ///< (number)
  std::vector<std::array<double, 6>> stiffness{}, compliance{}, natural{};  ///< (element); empty unless requested
  std::string note{};                                                       ///< reason if some derivatives are NaN
};
struct RecordedGradients {
  std::string not_found{};             ///< reason if there are none, else empty
  std::vector<std::string> numbers{};  ///< their paths
  std::vector<RecordedGradient> quantities{};
};

/// See ErrorEstimate (nonlinear/accuracy/error_estimate.hpp).
struct ErrorSummary {
  std::string not_estimated{};  ///< reason if there is none, else empty
  RecordedError largest_displacement{}, displacement{}, moment{}, energy{};
  std::vector<MonitoredQuantity> points{};   ///< error of the displacement of the monitored points
  std::vector<EstimatedValue> quantities{};  ///< (column of the requested quantities)
  std::vector<EstimatedValue> sections{};    ///< largest section forces, stress and utilisation, of runs with stresses
  std::string layers{};                      ///< note on boundary layers that elements do not resolve; empty if none
};
struct RecordedErrorEstimate : ErrorSummary {
  std::vector<Vector3> vertex_displacement{};                    ///< (vertex of the mesh)
  std::vector<double> element_displacement{}, element_moment{};  ///< (element of the mesh)
};

/// Sample of a member with the largest von Mises stress.
struct StressedMember {
  std::string member{};
  double arc_length = 0.0, length = 0.0;  ///< s of the sample, and of the whole member
  LargestStresses stresses{};
  std::optional<double> utilisation{};  ///< von Mises stress over the strength of the material, if given
  double torsion_share = 0.0;           ///< of an I section: share of the von Mises stress due to torque alone
  EstimatedValue estimated{};           ///< von Mises stress, anywhere along the member
};

/// Largest number of its kind, with its location.
struct LargestAlong {
  std::string member{};
  double arc_length = 0.0;
  double value = 0.0;
  double limit = 0.0;  ///< warn above this
  double error = 0.0;  ///< estimated, if known
};

/// Stresses and strains of a report.
struct StressSummary {
  std::vector<StressedMember> members{};  ///< at most kMostStressed, the largest von Mises stress first
  LargestAlong strain{};                  ///< largest relative to its limit, see Section::largest_strain
  LargestAlong curvature{};               ///< see SectionStresses::curvature_error; members with a shape
  LargestAlong utilisation{};             ///< members with a strength; the limit is 1
  bool has_strength = false;              ///< the material of some section has one
};

/// Summary of a converged configuration and how it was reached: the same on every rank.
struct StepSummary {
  int step = 0;               ///< 0 is the unloaded state; increases from record to record
  double load_factor = 0.0;   ///< may decrease along a path past a limit point
  int newton_iterations = 0;  ///< spent on this step, failed attempts included
  double residual = std::numeric_limits<double>::quiet_NaN();       ///< scale-free norm at the last iterate
  double strain_energy = std::numeric_limits<double>::quiet_NaN();  ///< of the whole structure
  double force_energy = std::numeric_limits<double>::quiet_NaN();   ///< share of the force strains in it
  double moment_energy = std::numeric_limits<double>::quiet_NaN();  ///< share of the moment strains
  std::vector<MonitoredQuantity> monitored{};                       ///< same names in all records of a run
  std::vector<RecordedReaction> reactions{};                        ///< same supports in all records of a run
  RecordedBalance balance{};
  RecordedStability stability{};
  std::optional<RecordedJump> jump{};       ///< that led to the step; none: it follows the path
  std::optional<StressSummary> stresses{};  ///< if the members hold stresses
  std::vector<NewtonIteration> history{};   ///< of all attempts at this step
  PathPoint point{};                        ///< of the state
};

/// A converged configuration. On several ranks each holds its own share of the samples and of the state.
struct StepRecord : StepSummary {
  SampledMembers members{};                               ///< same members and samples in all records of a run
  std::vector<RecordedCriticalPoint> critical_points{};   ///< passed since the last step, in path order
  std::vector<RecordedBucklingMode> buckling{};           ///< in at most one record of a run: closest to zero first
  std::vector<RecordedVibrationMode> vibration{};         ///< if requested: lowest first
  std::optional<RecordedErrorEstimate> error_estimate{};  ///< at the end of the path, if requested
  std::optional<RecordedGradients> gradients{};           ///< same
  StateShare state{};                                     ///< for resuming; empty: cannot resume from this record
  std::shared_ptr<const Acting> acting{};                 ///< supports, loads etc.; of the first record of a run
};

/// Copies all but the members and the fields at samples, vertices and elements: few bytes per step.
StepRecord without_rows(const StepRecord& record);
RecordedCriticalPoint without_rows(const RecordedCriticalPoint& point);

}  // namespace mixbeam
