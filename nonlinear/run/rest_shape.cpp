#include "nonlinear/run/rest_shape.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/path/load_path.hpp"
#include "nonlinear/stability/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <set>

namespace mixbeam {

namespace {

/// Tolerance of the balance of forces, over the largest load, and of rotations [radian]: rounding of short sums.
constexpr double kSettled = 2e-15;
/// Tolerance if rounding keeps them above that, and they no longer halve.
constexpr double kNearlySettled = 1e-10;
/// Limit of rotations of sections: each changes forces by the share of shear strains; few do unless shear governs.
constexpr int kMostTurns = 60;
/// Tolerances of forces without loads, over those under loads: the residual of Newton's method.
constexpr double kClosed = 1e-12, kNearlyClosed = 1e-8;
/// Limit of iterations, usually two to five; very large deformations need more.
constexpr int kMostClosures = 20;
/// Limit of redundancy, six for each loop of a frame in space: every one costs a solution in each iteration.
constexpr int kMostRedundant = 30;
/// Limit of steps of the path to the structure without loads, which takes a few if it succeeds.
constexpr int kMostStepsWithoutLoads = 60;
/// Relative length of a vector after projection below which it depends on the others.
constexpr double kDependent = 1e-6;
/// Scaled residual up to which the drawn shape is accepted as an equilibrium.
constexpr double kAcceptedResidual = 1e-9;
/// Rotation below which it is rounding. [radian]
constexpr double kNoTurn = 1e-12;
/// Share of a random force below which a projected row is rounding.
constexpr double kFreeRow = 1e-9;

const BoundList<RestShapeParameters> kRestShapeParameters = [] {
  BoundList<RestShapeParameters> inverse(
      "Find the rest shape: natural curvatures and cut lengths with which the structure under all its loads takes the "
      "shape that is drawn. Writes their tables and a scene with them beside the results, and runs that.");
  inverse.bind(
      &RestShapeParameters::loops, text("Loops").by_default(),
      "Forces in structures whose loops carry forces of their own: refused; closed: those of a frame that is "
      "made and assembled without force, and has no stress without its loads; least energy: those of least "
      "strain energy, of a frame that is assembled under force and keeps stress without its loads.",
      {{"refused", LoopForces::refused}, {"closed", LoopForces::closed}, {"least energy", LoopForces::least_energy}});
  inverse.bind(&RestShapeParameters::turns_triads, text("Shear").by_default(),
               "Where sections are not rigid in shear: turned: sections stand askew to the drawn axis, at ends and "
               "supports too, so that the member has natural curvatures alone; natural: a natural shear strain.",
               {{"turned", true}, {"natural", false}});
  inverse.bind(&RestShapeParameters::load_case, text("Case").by_default(),
               "Load case or combination whose loads deform the rest shape into the drawn one.");
  return inverse;
}();

/// Throws InputError for a scene with natural strains of its own, or with springs, unstressed in the drawn shape.
void check_offered(const Scene& scene, const InputPlace& place) {
  const auto refuse = [&place](const std::string& what, const std::string& allowed) {
    throw place.error("given, but " + what + "; allowed: " + allowed);
  };
  if (!scene.eigenstrains.empty()) refuse("the scene has \"Eigenstrains\"", "none: they are what is looked for");
  if (scene.accuracy) refuse("the scene has an \"Accuracy\"", "\"Order\" and \"Elements\" of members");
  for (const Support& support : scene.supports) {
    if (ActingKind<Support>::acts(support))
      refuse("the support at \"" + excerpt(support.point) + "\" has a prescribed motion", "supports that stand still");
    if (!vector_algebra::is_zero(support.displacement_stiffness) ||
        !vector_algebra::is_zero(support.rotation_stiffness))
      refuse("the support at \"" + excerpt(support.point) + "\" has springs", "none: they bear nothing as drawn");
  }
  for (const Joint& joint : scene.joints)
    if (joint.stiffness != 0.0) refuse("joint \"" + excerpt(joint.name) + "\" has a spring", "joints without springs");
  for (const Member& member : scene.members)
    if (member.force_integration != ForceIntegration::both_reduced)
      refuse("member \"" + excerpt(member.name) + "\" has another \"Force Integration\"", "\"both reduced\"");
}

/// Stage of all loads. Natural strains that grow with them keep the drawn shape in equilibrium at every load factor.
int stage_of_loads(const Scene& scene, const InputPlace& place) {
  std::set<Stage> stages;
  bool has_amplitude = false;
  for_each_acting(scene, [&](const auto& load, auto kind) {
    if (!kind.acts(load)) return;
    stages.insert(load.stage);
    has_amplitude = has_amplitude || !load.amplitude.empty();
  });
  if (stages.empty()) throw place.error("given, but no loads act; allowed: loads that deform the rest shape");
  if (stages.size() > 1 || has_amplitude)
    throw place.error("given, but loads grow in their own ways; allowed: all in one \"Stage\", without \"Amplitude\"");
  return *stages.begin();
}

/// Vertices at ends of members, and those with supports, joints or point loads.
std::set<int> attached_vertices(const Scene& scene, const Mesh& mesh) {
  std::set<int> attached;
  const auto add = [&](const std::string& point) { attached.insert(vertex_of(mesh, point)); };
  for (const Member& member : scene.members) {
    add(member.start_point);
    add(member.end_point);
  }
  for (const Support& support : scene.supports) add(support.point);
  for (const PointLoad& load : scene.point_loads) add(load.point);
  for (const MeshJoint& joint : mesh.joints) {
    attached.insert(joint.master);
    attached.insert(joint.slave);
  }
  return attached;
}

/// Relative rotation phi_e at an end, theory (12).
Vec end_rotation(const ElementView& element, int end) {
  Vec psi{{0.0, 0.0, 0.0}};
  for (int j = 1; j < element.order(); ++j) psi += end_value(end, j) * element.relative_rotation(j);
  return log_quaternion(conjugate(element.triad() * exp_quaternion(psi)) * element.end_triad(end));
}

/// Triad Lambda_E at a point of an element.
Quat triad_at(const ElementView& element, double xi) {
  double P[kMaximumOrder + 1];
  legendre(element.order(), xi, P);
  return element.triad() * exp_quaternion(element.relative_rotation_at(P));
}

/// Solves with a tangent and corrects for its cap; returns only N and M of the increment.
MixedVector forces_by(Linearization& linear, const MixedVector& scaled_rows, bool removes_cap) {
  MixedVector increment = linear.tangent().model().create_vector();
  const Cap& cap = linear.tangent().cap();
  linear.solve(scaled_rows, increment);
  if (removes_cap && cap.cuts_off) remove_cap_compliance(linear, cap.least_ratio, increment);
  clear_rows(linear.tangent().model().structure(), increment.writable_interior(true), RowsOf::motions);
  Kokkos::deep_copy(increment.vertex(), 0.0);
  return increment;
}

double length_of(const MixedVector& forces) { return std::sqrt(forces.inner_product(forces)); }

/// Makes the last vector orthogonal to the others and of unit length, and applies the same operations to `belonging`.
/// False if only rounding is left of it.
bool orthonormalize_last(std::vector<MixedVector>& vectors, std::vector<MixedVector>* belonging = nullptr) {
  const size_t last = vectors.size() - 1;
  for (int again = 0; again < 2; ++again)  // the second pass removes rounding of the first
    for (size_t i = 0; i < last; ++i) {
      const double factor = vectors[i].inner_product(vectors[last]);
      vectors[last].update(-factor, vectors[i], 1.0);
      if (belonging != nullptr) (*belonging)[last].update(-factor, (*belonging)[i], 1.0);
    }
  const double length = length_of(vectors[last]);
  if (!(length > kDependent)) return false;
  vectors[last].scale(1.0 / length);
  if (belonging != nullptr) (*belonging)[last].scale(1.0 / length);
  return true;
}

/// Finds forces that balance the loads in the drawn geometry, and rotates sections so that no natural shear strain is
/// needed.
class RestShapeFinder {
 public:
  RestShapeFinder(const Scene& scene, const RestShapeParameters& wanted, const SolverParameters& parameters,
                  const Communicator& comm)
      : wanted_(wanted),
        problem_(scene, comm, parameters),
        model_(problem_.model),
        load_factor_(scene.stages),
        attached_(attached_vertices(scene, model_.mesh())),
        drawn_(model_.reference_state()),
        state_(model_.reference_state()) {}

  const Model& model() const { return model_; }
  const State& state() const { return state_; }

  /// Degree of redundancy: six unknown forces for each element less the rows of equilibrium of vertices without
  /// constraints. In a plane only the in-plane ones count.
  int redundancy() const {
    const Structure& structure = model_.structure();
    const bool is_planar = drawn_.in_plane;
    const KernelView<double*> rows("mixbeam::rest_shape::rows",
                                   static_cast<size_t>(kVertexDofs) * structure.owned_vertices);
    for (int v = 0; v < structure.owned_vertices; ++v) {
      Vec force{{1.0, std::sqrt(2.0), std::sqrt(3.0)}}, moment{{std::sqrt(5.0), std::sqrt(7.0), std::sqrt(11.0)}};
      if (is_planar) {
        const Vec n = model_.plane()->n;
        force = force - dot(force, n) * n;
        moment = dot(moment, n) * n;
      }
      set_rows_of(rows, v, kForcePart, std::sqrt(1.0 + v) * force);
      set_rows_of(rows, v, kMomentPart, std::sqrt(1.0 + v) * moment);
    }
    model_.project_on_free_motions(drawn_, rows);
    int free = 0;
    for (size_t i = 0; i < rows.extent(0); ++i)
      if (model_.fixed_rows()(i) == 0 && std::abs(rows(i)) > kFreeRow) ++free;
    return (is_planar ? 3 : 6) * structure.local_elements() - free;
  }

  /// Finds the forces, those of least energy if there are loops. Throws ConvergenceError, InputError at `place`.
  void find(bool is_redundant, const InputPlace& place) {
    is_redundant_ = is_redundant;
    MixedVector rows = model_.create_vector();
    EvaluationPoint unloaded = mixed_residual(model_, drawn_, 0.0, rows);
    unloaded.scales = scales_of(model_, drawn_, load_factor_);
    linear_ = std::make_unique<Linearization>(problem_, unloaded, cap_for(model_, unloaded.scales), TangentKind{});
    settle();
    if (wanted_.turns_triads) check_inner_points(place);
  }

  /// Computes natural strains by theory (79), from the residuals of the rows of N and M.
  std::vector<NaturalMember> natural_members() const {
    const Mesh& mesh = model_.mesh();
    const MixedVector rows = rows_of(nullptr);
    std::vector<NaturalMember> all;
    for (size_t m = 0; m < mesh.members.size(); ++m) {
      NaturalMember& member = all.emplace_back();
      member.name = model_.scene().members[m].name;
      member.cut_length = mesh.member_length[m];
      const int first = mesh.first_element[m], count = mesh.elements_of(static_cast<int>(m));
      for (int i = 0; i < count; ++i) {
        const ElementView element(model_.structure(), state_, model_.structure().local_element(first + i));
        const double* row = element.increments_in(rows.interior());
        if (wanted_.turns_triads && i == 0) member.end_turns[0] = vector_algebra::to_array(-turn_at(element, 0));
        if (wanted_.turns_triads && i == count - 1) member.end_turns[1] = vector_algebra::to_array(turn_at(element, 1));
        add_strains(element, row, member);
        add_curvatures(element, row, i == 0, i == count - 1, member);
      }
    }
    return all;
  }

  // Vectors of forces, which contain N times the length of the structure, and M, of all elements.
  MixedVector forces_of(const State& state) const {
    MixedVector forces = model_.create_vector();
    const KernelView<double*> interior = forces.writable_interior(false);
    Kokkos::deep_copy(interior, 0.0);
    for_each_element(model_.structure(), state, [&](const ElementView& element) {
      double* row = element.increments_in(interior);
      for (int i = 0; i < element.layout().relative_rotation(1); ++i)
        row[i] = element.unknowns()[i] * (i < element.layout().moment(0) ? model_.structure().length : 1.0);
    });
    return forces;
  }

  /// Adds these forces to a state.
  State with_forces(const State& state, const MixedVector& forces) const {
    MixedVector increment = forces.clone(true);
    const KernelView<double*> interior = increment.writable_interior(true);
    for_each_element(model_.structure(), [&](const ElementView& element) {
      double* row = element.increments_in(interior);
      for (int i = 0; i < element.layout().moment(0); ++i) row[i] /= model_.structure().length;
    });
    return model_.apply(state, increment, 1.0);
  }

  /// Finds orthonormal self-stresses, as responses of the drawn structure to arbitrary strains. Fewer than `count` if
  /// fewer are independent.
  std::vector<MixedVector> self_stresses(int count) {
    std::vector<MixedVector> basis;
    for (int i = 0; i < count; ++i) {
      MixedVector strains = any_strains(i);
      scale_rows(model_, linear_->tangent().point().scales, strains);
      basis.push_back(forces_of(model_.apply(drawn_, forces_by(*linear_, strains, true), 1.0)));
      basis.back().scale(1.0 / length_of(basis.back()));
      if (!orthonormalize_last(basis)) basis.pop_back();
    }
    return basis;
  }

  /// Elastic strains of these forces: the rows of N and M without them less those with them.
  MixedVector strains_of(const MixedVector& forces) const {
    MixedVector with = model_.create_vector(), strains = model_.create_vector();
    element_rows(model_, with_forces(drawn_, forces), 0.0, ElementLoads::none, with);
    element_rows(model_, drawn_, 0.0, ElementLoads::none, strains);
    strains.update(-1.0, with, 1.0);
    Kokkos::deep_copy(strains.vertex(), 0.0);
    const KernelView<double*> rows = strains.writable_interior(true);
    clear_rows(model_.structure(), rows, RowsOf::motions);
    if (wanted_.turns_triads)
      for_each_element(model_.structure(), [&](const ElementView& element) {
        for (int q = 0; q < element.order(); ++q)
          std::fill_n(element.increments_in(rows) + element.layout().force(q) + 1, 2, 0.0);
      });
    return strains;
  }

  void add_forces(const MixedVector& forces) {
    state_ = with_forces(state_, forces);
    settle();
  }

  /// Whether the forces of the present state are more than rounding.
  bool carries_forces() const {
    const ResidualScales& scales = linear_->tangent().point().scales;
    return forces_of(state_).maximum_norm() > kSettled * model_.structure().length * scales.force;
  }

 private:
  /// Rows at the present state under all loads; `scales`: divisors, null: unscaled.
  MixedVector rows_of(const ResidualScales* scales) const {
    MixedVector rows = model_.create_vector();
    const EvaluationPoint point = mixed_residual(model_, state_, load_factor_, rows);
    unscale_rows(model_, point.scales, rows);
    if (scales != nullptr) scale_rows(model_, *scales, rows);
    return rows;
  }

  /// Solves theory (77) for a correction: the first one finds the forces, later ones remove residuals of rounding and
  /// of rotated sections. Returns the previous imbalance.
  double balance() {
    const auto fixed = model_.fixed_rows();
    MixedVector rows = rows_of(&linear_->tangent().point().scales);
    const KernelView<double*> vertex = rows.vertex();
    for (size_t r = 0; r < vertex.extent(0); ++r)
      if (fixed(r) != 0) vertex(r) = 0.0;
    clear_rows(model_.structure(), rows.writable_interior(true), RowsOf::forces);
    const double left = rows.maximum_norm();
    if (!(left <= kSettled)) state_ = model_.apply(state_, forces_by(*linear_, rows, is_redundant_), 1.0);
    return left;
  }

  void settle() {
    double before = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMostTurns; ++i) {
      const double forces = balance(), turns = wanted_.turns_triads ? turn_sections() : 0.0;
      const double left = std::max(forces, turns);
      if (left <= kSettled || (left <= kNearlySettled && left > 0.5 * before)) return;
      before = left;
    }
    throw ConvergenceError(
        "the rest shape: no forces of members balance the loads in the drawn shape (a mechanism has none), or turns of "
        "sections by shear do not settle");
  }

  double largest_shear_left(const MixedVector& rows) const {
    double left = 0.0;
    for_each_element(model_.structure(), state_, [&](const ElementView& element) {
      const double* row = element.increments_in(rows.interior());
      for (int q = 0; q < element.order(); ++q)
        for (int c = 1; c < 3; ++c) left = std::max(left, std::abs(row[element.layout().force(q) + c]));
    });
    return left;
  }

  /// Rotates sections by theory (78). Returns the previous shear residual; does nothing if that is rounding.
  double turn_sections() {
    const MixedVector rows = rows_of(nullptr);
    const double left = largest_shear_left(rows);
    if (left <= kSettled) return left;
    for_each_element(model_.structure(), state_, [&](const ElementView& element) {
      const int k = element.order();
      const GaussPoints& gauss = gauss_points(k);
      const double* row = element.increments_in(rows.interior());
      std::vector<Quat> turned;
      for (int q = 0; q < k; ++q) {
        const Vec tangent = load_vector(element.reference(element.block().reference_layout.tangent(q)));
        const Vec seen = transpose_times(rotation_matrix(triad_at(element, gauss.xi[q])), tangent);
        Vec goal = seen - load_vector(row + element.layout().force(q));
        const double across = goal[1] * goal[1] + goal[2] * goal[2];
        if (!(across < 1.0)) throw ConvergenceError("the rest shape: shear turns sections along the drawn axis");
        goal[0] = std::sqrt(1.0 - across);
        turned.push_back(triad_at(element.in(drawn_.views), gauss.xi[q]) *
                         smallest_rotation(goal, Vec{{1.0, 0.0, 0.0}}));
      }
      const FittedRotation fit = fit_rotation(element.triad(), turned, gauss.xi, gauss.weight, k);
      store_quaternion(fit.triad, element.triad_numbers());
      for (int j = 1; j < k; ++j) store_vector(fit.psi[j], element.unknowns() + element.layout().relative_rotation(j));
    });
    turn_vertices();
    return left;
  }

  /// Rotates vertices between the elements of a member by the mean of both.
  void turn_vertices() {
    const Structure& structure = model_.structure();
    std::vector<Vec> turn(structure.local_vertices(), Vec{{0.0, 0.0, 0.0}});
    for_each_element(structure, state_, [&](const ElementView& element) {
      const ElementView before = element.in(drawn_.views);
      for (int end = 0; end < 2; ++end) {
        const Quat triad = triad_at(element, end == 0 ? -1.0 : 1.0), drawn = triad_at(before, end == 0 ? -1.0 : 1.0);
        turn[element.vertex(end)] += 0.5 * log_quaternion(triad * conjugate(drawn));
      }
    });
    for (int v = 0; v < structure.local_vertices(); ++v)
      if (attached_.count(structure.local_vertex_to_global[v]) == 0)
        store_quaternion(exp_quaternion(turn[v]), &state_.views.vertex_rotation(v, 0));
  }

  /// Throws if shear jumps inside a member, which would be a kink of its rest shape.
  void check_inner_points(const InputPlace& place) const {
    const Mesh& mesh = model_.mesh();
    for_each_element(model_.structure(), state_, [&](const ElementView& element) {
      const MeshElement& here = mesh.elements[element.mesh_element()];
      const int last = mesh.elements_of(here.member) - 1;
      for (int end = 0; end < 2; ++end) {
        if (here.index == (end == 0 ? 0 : last) || attached_.count(here.vertex[end]) == 0) continue;
        if (norm(turn_at(element, end)) > kNoTurn)
          throw place.error("given, but something acts or holds inside of member \"" +
                            excerpt(model_.scene().members[here.member].name) +
                            "\", whose sections shear turns there; allowed: two members, or \"Shear\" = \"natural\"");
      }
    });
  }

  /// Rotation of an end section relative to its vertex, in addition to that of the drawn shape.
  Vec turn_at(const ElementView& element, int end) const {
    return end_rotation(element, end) - end_rotation(element.in(drawn_.views), end);
  }

  FieldTable::Piece piece_of(const ElementView& element, const GaussPoints& gauss) const {
    FieldTable::Piece piece;
    const MeshElement& place = model_.mesh().elements[element.mesh_element()];
    for (const double xi : gauss.xi) piece.s.push_back(model_.mesh().arc_length(place, xi));
    return piece;
  }

  void add_strains(const ElementView& element, const double* row, NaturalMember& member) const {
    const double shear = wanted_.turns_triads ? 0.0 : 1.0;
    const GaussPoints& gauss = gauss_points(element.order());
    FieldTable::Piece piece = piece_of(element, gauss);
    for (int q = 0; q < element.order(); ++q) {
      const double* strain = row + element.layout().force(q);
      piece.value.push_back({strain[0], shear * strain[1], shear * strain[2]});
      member.cut_length += 0.5 * element.length() * gauss.weight[q] * strain[0];
    }
    member.tables[0].pieces.push_back(std::move(piece));
  }

  void add_curvatures(const ElementView& element, const double* row, bool is_first, bool is_last,
                      NaturalMember& member) const {
    const int k = element.order();
    const GaussPoints& gauss = gauss_points(k + 1);
    FieldTable::Piece piece = piece_of(element, gauss);
    for (const double xi : gauss.xi) {
      double P[kMaximumOrder + 1];
      legendre(k, xi, P);
      Vector3& curvature = piece.value.emplace_back(Vector3{});
      for (int j = 0; j <= k; ++j)
        for (int c = 0; c < 3; ++c) {
          double moment = row[element.layout().moment(j) + c];
          if (is_first) moment -= end_value(0, j) * member.end_turns[0][c];
          if (is_last) moment -= member.end_turns[1][c];
          curvature[c] += (2 * j + 1) / element.length() * P[j] * moment;
        }
    }
    member.tables[1].pieces.push_back(std::move(piece));
  }

  /// Pseudo-random strains, in the plane of the scene if it has one.
  MixedVector any_strains(int number) const {
    MixedVector rows = model_.create_vector();
    const KernelView<double*> interior = rows.writable_interior(false);
    Kokkos::deep_copy(interior, 0.0);
    double phase = number;
    for_each_element(model_.structure(), drawn_, [&](const ElementView& element) {
      double* row = element.increments_in(interior);
      const Mat triad = rotation_matrix(element.triad());
      for (int i = 0; i < element.layout().relative_rotation(1); i += 3) {
        phase += 1.3 + number;
        Vec strain{{std::sin(phase), std::sin(1.7 * phase), std::sin(2.3 * phase)}};
        if (drawn_.in_plane) {
          const Vec n = model_.plane()->n, out = dot(strain, n) * n;
          strain = transpose_times(triad, i < element.layout().moment(0) ? strain - out : out);
        }
        store_vector(strain, row + i);
      }
    });
    return rows;
  }

  const RestShapeParameters& wanted_;
  BeamProblem problem_;
  const Model& model_;
  double load_factor_;
  std::set<int> attached_;
  State drawn_, state_;
  std::unique_ptr<Linearization> linear_;  ///< at N = M = 0, without loads
  bool is_redundant_ = false;
};

/// The structure with natural strains and without loads.
class UnloadedStructure {
 public:
  UnloadedStructure(const Scene& scene, SolverParameters parameters, const Communicator& comm)
      : scene_(scene), parameters_(std::move(parameters)), comm_(comm) {
    scene_.point_loads.clear();
    scene_.distributed_loads.clear();
    parameters_.analysis = {};
    parameters_.analysis.stability = false;
    parameters_.load_path.maximum_steps = std::min(parameters_.load_path.maximum_steps, kMostStepsWithoutLoads);
  }

  /// Finds its equilibrium, starting from the last one or else from the drawn shape; null if there is none.
  const State* find(const RestShape& shape) {
    problem_ = Teuchos::rcp(new BeamProblem(with_rest_shape(scene_, shape), comm_, parameters_));
    State state = state_ ? *state_ : problem_->model.reference_state();
    const LoadPathResult path =
        state_ ? settle_at_end(problem_, parameters_, state, {}) : follow_load_path(problem_, parameters_, state, {});
    if (!path.finished) return nullptr;
    state_ = state;
    return &*state_;
  }
  std::unique_ptr<Linearization> linearized() const {
    MixedVector rows = problem_->model.create_vector();
    return linearize(*problem_, take_residual(*problem_, *state_, scene_.stages, rows), {});
  }

 private:
  Scene scene_;
  SolverParameters parameters_;
  Communicator comm_;
  Teuchos::RCP<BeamProblem> problem_{};
  std::optional<State> state_{};
};

/// Combines the self-stresses `own` whose strains, omitted from the natural ones, cause `stress` without loads.
MixedVector source_of_stress(const MixedVector& stress, const RestShapeFinder& finder,
                             const std::vector<MixedVector>& own, Linearization& unloaded, const InputPlace& place) {
  const Model& model = finder.model();
  MixedVector cause = model.create_vector();
  std::vector<MixedVector> causes, answers;
  for (const MixedVector& one : own) {
    MixedVector strains = finder.strains_of(one);
    scale_rows(model, unloaded.tangent().point().scales, strains);
    answers.push_back(finder.forces_of(model.apply(model.reference_state(), forces_by(unloaded, strains, true), 1.0)));
    causes.push_back(one.clone(true));
    if (!orthonormalize_last(answers, &causes))
      throw place["Loops"].error(
          "value \"closed\", but forces of loops have no part in the rest shape where members are rigid; allowed: "
          "\"least energy\"");
    cause.update(answers.back().inner_product(stress), causes.back(), 1.0);
  }
  return cause;
}

/// Newton's method for the redundant forces under loads such that the unloaded structure has no stress. Without
/// `closes`: computes that stress for the given forces.
void close_loops(RestShapeFinder& finder, UnloadedStructure unloaded, bool closes, RestShape& shape,
                 const InputPlace& place) {
  if (closes && shape.redundancy > kMostRedundant)
    throw place["Loops"].error("value \"closed\", but loops leave " + std::to_string(shape.redundancy) +
                               " forces free; allowed: up to " + std::to_string(kMostRedundant) +
                               ", or \"least energy\"");
  if (!finder.carries_forces()) return;
  const std::vector<MixedVector> own = closes ? finder.self_stresses(shape.redundancy) : std::vector<MixedVector>();
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration <= kMostClosures; ++iteration) {
    shape.members = finder.natural_members();
    const State* state = unloaded.find(shape);
    shape.stress_left = state == nullptr
                            ? std::numeric_limits<double>::quiet_NaN()
                            : length_of(finder.forces_of(*state)) / length_of(finder.forces_of(finder.state()));
    const double left = shape.stress_left;
    if (!closes || left <= kClosed || (left <= kNearlyClosed && left > 0.5 * before)) return;
    if (!std::isfinite(left)) break;
    before = left;
    const std::unique_ptr<Linearization> there = unloaded.linearized();
    MixedVector change = source_of_stress(finder.forces_of(*state), finder, own, *there, place);
    change.scale(-1.0);
    finder.add_forces(change);
  }
  throw ConvergenceError(
      "the rest shape: no forces of the loops are found that leave the structure free of stress without its loads; "
      "\"Loops\" = \"least energy\" asks for none");
}

double largest_of_table(const FieldTable& table) {
  double largest = 0.0;
  for (const FieldTable::Piece& piece : table.pieces)
    for (const Vector3& value : piece.value)
      for (const double component : value) largest = std::max(largest, std::abs(component));
  return largest;
}

/// Checks residual and stability of the drawn state in the structure with its natural strains.
void judge(const Scene& scene, const State& state, const SolverParameters& parameters, const Communicator& comm,
           RestShape& shape) {
  BeamProblem problem(with_rest_shape(scene, shape), comm, parameters);
  MixedVector rows = problem.model.create_vector();
  mixed_residual(problem.model, state, scene.stages, rows);
  shape.residual = rows.maximum_norm();
  if (!(shape.residual <= kAcceptedResidual))
    throw ConvergenceError(
        "the rest shape: no forces of the members balance the loads in the drawn shape (largest scaled residual " +
        rounded(shape.residual, 3) + "); a mechanism has none");
  if (const auto stability = Stability(problem).ask({state, static_cast<double>(scene.stages)}, How::inertia)) {
    shape.negative = stability->negative;
    shape.stable = text_of(stability->verdict());
  }
}

}  // namespace

ListSpec rest_shape_spec() { return kRestShapeParameters.spec; }

RestShapeParameters read_rest_shape_parameters(const Teuchos::ParameterList& list) {
  return kRestShapeParameters.read(list);
}

RestShape find_rest_shape(const Scene& all_cases, const RestShapeParameters& wanted, const SolverParameters& parameters,
                          const Communicator& comm, const InputPlace& place) {
  const std::vector<std::string> cases = alternatives(all_cases);
  if (cases.empty() != wanted.load_case.empty() ||
      (!cases.empty() && std::find(cases.begin(), cases.end(), wanted.load_case) == cases.end()))
    throw place["Case"].error((wanted.load_case.empty() ? "missing" : "value \"" + excerpt(wanted.load_case) + "\"") +
                              "; allowed: " + (cases.empty() ? "nothing, the scene has no cases" : quoted_list(cases)));
  if (comm->getSize() > 1) throw place.error("given under mpirun; allowed: one process");
  const Scene scene = scene_of_case(all_cases, wanted.load_case);
  check_offered(scene, place);
  if (parameters.analysis.control) throw place.error("given beside \"Control\"; allowed: loads of a known size");
  RestShape shape;
  shape.stage = stage_of_loads(scene, place);
  RestShapeFinder finder(scene, wanted, parameters, comm);
  shape.redundancy = finder.redundancy();
  const bool is_redundant = shape.redundancy > 0;
  if (is_redundant && wanted.loops == LoopForces::refused)
    throw place["Loops"].error("value \"refused\", but equilibrium leaves " + std::to_string(shape.redundancy) +
                               " force(s) or moment(s) of loops free; allowed: \"closed\", \"least energy\"");
  finder.find(is_redundant, place);
  shape.members = finder.natural_members();
  if (is_redundant)
    close_loops(finder, UnloadedStructure(scene, parameters, comm), wanted.loops == LoopForces::closed, shape, place);
  for (const NaturalMember& member : shape.members) {
    shape.largest_strain = std::max(shape.largest_strain, largest_of_table(member.tables[0]));
    shape.largest_curvature = std::max(shape.largest_curvature, largest_of_table(member.tables[1]));
    for (const Vector3& turn : member.end_turns)
      shape.largest_turn = std::max(shape.largest_turn, vector_algebra::norm(turn));
  }
  judge(scene, finder.state(), parameters, comm, shape);
  return shape;
}

Scene with_rest_shape(Scene scene, const RestShape& shape) {
  for (const NaturalMember& member : shape.members) {
    Eigenstrain strain;
    strain.member = member.name;
    strain.stage = shape.stage;
    strain.strain_table = std::make_shared<const FieldTable>(member.tables[0]);
    strain.curvature_table = std::make_shared<const FieldTable>(member.tables[1]);
    strain.end_turns = member.end_turns;
    scene.eigenstrains.push_back(strain);
  }
  return scene;
}

std::vector<NaturalStation> natural_curve(const MeshMember& drawn, const NaturalMember& member, int pieces) {
  const auto curvature = [&](double s) {
    return drawn.curve.curvature(s) + vector_algebra::to_vec3(member.tables[1].at(s));
  };
  NaturalStation here;
  Vec position = drawn.curve.position(0.0);
  Quat triad = drawn.curve.triad(0.0) * exp_quaternion(vector_algebra::to_vec3(member.end_turns[0]));
  std::vector<NaturalStation> all;
  const auto add = [&] {
    const Mat axes = rotation_matrix(triad);
    here.position = vector_algebra::to_array(position);
    for (int i = 0; i < 3; ++i) here.triad[i] = {axes(0, i), axes(1, i), axes(2, i)};
    all.push_back(here);
  };
  add();
  constexpr int kStepsOfPiece = 8;  // of a fourth-order method
  const double gauss = std::sqrt(3.0) / 6.0;
  for (int e = 0; e < drawn.elements; ++e)
    for (int p = 0; p < pieces * kStepsOfPiece; ++p) {
      const double h = drawn.element_length(e) / (pieces * kStepsOfPiece), s = drawn.arc_length(e, -1.0) + p * h;
      // Magnus expansion over a part t of the step, and Simpson's rule for the axis.
      const auto turned = [&](double t) {
        const Vec a = curvature(s + (0.5 - gauss) * t), b = curvature(s + (0.5 + gauss) * t);
        return triad * exp_quaternion((0.5 * t) * (a + b) + (std::sqrt(3.0) / 12.0 * t * t) * cross(a, b));
      };
      const auto slope = [&](const Quat& at, double place) {
        return (1.0 + member.tables[0].at(place)[0]) * (rotation_matrix(at) * Vec{{1.0, 0.0, 0.0}});
      };
      const Quat middle = turned(0.5 * h), end = normalized(turned(h));
      position += (h / 6.0) * (slope(triad, s) + 4.0 * slope(middle, s + 0.5 * h) + slope(end, s + h));
      here.natural_length += h * (1.0 + member.tables[0].at(s + 0.5 * h)[0]);
      triad = end;
      here.arc_length = s + h;
      if ((p + 1) % kStepsOfPiece == 0) add();
    }
  return all;
}

}  // namespace mixbeam
