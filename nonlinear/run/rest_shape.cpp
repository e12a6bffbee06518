#include "nonlinear/run/rest_shape.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/stability/stability.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace mixbeam {

namespace {

/// Each takes out what rounding has left of the balance: the second one finds nothing more, but in networks.
constexpr int kRefinementsOfForces = 3;
/// Of the largest load, where refinement ends; rounding of sums over the elements at a vertex.
constexpr double kBalanceOfForces = 1e-14;
/// What may be left of a row when the shape is taken for an equilibrium: digits that a run would ask for.
constexpr double kAcceptedResidual = 1e-9;
/// Each turn changes forces by the share of shear strains, so that few are needed unless shear governs.
constexpr int kMostTurns = 60;
constexpr double kSettledTurn = 2e-15;  // rounding of angles [radian]
/// Turns that nothing tells from rounding. [radian]
constexpr double kNoTurn = 1e-12;
/// Of a random force, the least that is no rounding.
constexpr double kFreeRow = 1e-9;

BoundList<RestShapeParameters> declared_rest_shape_parameters() {
  BoundList<RestShapeParameters> inverse(
      "Find the rest shape: natural curvatures and cut lengths with which the structure under all its loads takes the "
      "shape that is drawn. Writes their tables and a scene with them beside the results, and runs that.");
  inverse.bind(&RestShapeParameters::loops, text("Loops").by_default(),
               "Forces in structures whose loops carry forces of their own: refused; least energy: those of least "
               "strain energy, of a frame that is assembled under force and keeps stress without its loads.",
               {{"refused", LoopForces::refused}, {"least energy", LoopForces::least_energy}});
  inverse.bind(&RestShapeParameters::turns_triads, text("Shear").by_default(),
               "Where sections are not rigid in shear: turned: sections stand askew to the drawn axis, at ends and "
               "supports too, so that the member has natural curvatures alone; natural: a natural shear strain.",
               {{"turned", true}, {"natural", false}});
  inverse.bind(&RestShapeParameters::load_case, text("Case").by_default(),
               "Load case or combination whose loads deform the rest shape into the drawn one.");
  return inverse;
}

const BoundList<RestShapeParameters> kRestShapeParameters = declared_rest_shape_parameters();

/// Throws InputError for a scene that has natural strains of its own, or parts that bear nothing in the drawn shape.
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

/// Of all loads. Strains that grow with them keep the drawn shape in equilibrium at every load factor.
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

/// Vertices at which more than the two elements of one member meet, or something acts or holds.
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

double end_value_of(int j, int end) { return end == 1 || j % 2 == 0 ? 1.0 : -1.0; }

/// phi_e of theory (12).
Vec end_rotation(const ElementView& element, int end) {
  Vec psi{{0.0, 0.0, 0.0}};
  for (int j = 1; j < element.order(); ++j) psi += end_value_of(j, end) * element.relative_rotation(j);
  return log_quaternion(conjugate(element.triad() * exp_quaternion(psi)) * element.end_triad(end));
}

/// Lambda_E at a place of an element.
Quat triad_at(const ElementView& element, double xi) {
  double P[kMaximumOrder + 1];
  legendre(element.order(), xi, P);
  return element.triad() * exp_quaternion(element.relative_rotation_at(P));
}

/// The rotation that takes one unit vector into another by the shortest way.
Quat shortest_turn(const Vec& from, const Vec& to) {
  const Vec axis = cross(from, to);
  return normalized(Quat{1.0 + dot(from, to), axis[0], axis[1], axis[2]});
}

enum class RowsOf { forces, motions };

/// Of N and M, or all others, of each element.
void clear_rows(const Structure& structure, const KernelView<double*>& interior, RowsOf which) {
  for_each_element(structure, [&](const ElementView& element) {
    double* const row = element.increments_in(interior);
    double* const end = row + element.layout().relative_rotation(1);
    if (which == RowsOf::forces)
      std::fill(row, end, 0.0);
    else
      std::fill(end, row + element.layout().increments(), 0.0);
  });
}

/// Finds forces that balance the loads in the drawn geometry, and sections turned so that shear needs no natural
/// strain.
class RestShapeFinder {
 public:
  RestShapeFinder(const Scene& scene, const SolverParameters& parameters, const Communicator& comm)
      : problem_(scene, comm, parameters),
        model_(problem_.model),
        load_factor_(scene.stages),
        drawn_(model_.reference_state()),
        state_(drawn_) {}

  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  int redundancy() const;

  void find_forces(bool is_redundant);
  /// Finds forces and turns of sections together. Throws ConvergenceError.
  void find_turned(bool is_redundant, const InputPlace& place);
  std::vector<NaturalMember> natural_members(bool turns_triads) const;

 private:
  MixedVector rows_of(const ResidualScales* scales) const;
  Vector3 turn_at(const ElementView& element, int end) const;
  void add_strains(const ElementView& element, const double* row, bool turns_triads, NaturalMember& member) const;
  void add_curvatures(const ElementView& element, const double* row, bool is_first, bool is_last,
                      NaturalMember& member) const;
  FieldTable::Piece piece_of(const ElementView& element, const GaussPoints& gauss) const;
  State without_stress() const;
  double turn_sections();
  void turn_vertices();
  void check_inner_points(const InputPlace& place) const;

  BeamProblem problem_;
  const Model& model_;
  double load_factor_;
  State drawn_, state_;
};

/// Rows at the present state under all loads, scaled, or as they are.
MixedVector RestShapeFinder::rows_of(const ResidualScales* scales) const {
  MixedVector rows = model_.create_vector();
  const EvaluationPoint point = mixed_residual(model_, state_, load_factor_, rows);
  unscale_rows(model_, point.scales, rows);
  if (scales != nullptr) scale_rows(model_, *scales, rows);
  return rows;
}

/// Six forces are unknown in each element, as many rows of equilibrium are in each vertex, those of constraints aside:
/// the rest is redundant. In a plane that counts what lies in it.
int RestShapeFinder::redundancy() const {
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

State RestShapeFinder::without_stress() const {
  State state = allocate_state(model_.structure());
  Kokkos::deep_copy(state.views.vertex_displacement, state_.views.vertex_displacement);
  Kokkos::deep_copy(state.views.vertex_rotation, state_.views.vertex_rotation);
  Kokkos::deep_copy(state.views.element_triad, state_.views.element_triad);
  Kokkos::deep_copy(state.views.interior, state_.views.interior);
  state.in_plane = state_.in_plane;
  state.turns = state_.turns;
  for_each_element(model_.structure(), state, [](const ElementView& element) {
    std::fill_n(element.unknowns(), element.layout().relative_rotation(1), 0.0);
  });
  return state;
}

/// Theory (75): the tangent at N = M = 0 and without loads, whose motions are thrown away.
void RestShapeFinder::find_forces(bool is_redundant) {
  state_ = without_stress();
  MixedVector rows = model_.create_vector();
  EvaluationPoint unloaded = mixed_residual(model_, state_, 0.0, rows);
  unloaded.scales = scales_of(model_, state_, load_factor_);
  const Cap cap = cap_for(model_, unloaded.scales);
  Linearization linear(problem_, unloaded, cap, {});
  const auto fixed = model_.fixed_rows();
  for (int i = 0; i < kRefinementsOfForces; ++i) {
    rows = rows_of(&unloaded.scales);
    const KernelView<double*> vertex = rows.vertex(), interior = rows.writable_interior(true);
    for (size_t r = 0; r < vertex.extent(0); ++r)
      if (fixed(r) != 0) vertex(r) = 0.0;
    clear_rows(model_.structure(), interior, RowsOf::forces);
    if (!(rows.maximum_norm() > kBalanceOfForces)) return;
    MixedVector increment = model_.create_vector();
    linear.solve(rows, increment);
    if (is_redundant && cap.cuts_off) remove_cap_compliance(linear, cap.least_ratio, increment);
    clear_rows(model_.structure(), increment.writable_interior(true), RowsOf::motions);
    Kokkos::deep_copy(increment.vertex(), 0.0);
    state_ = model_.apply(state_, increment, 1.0);
  }
}

/// Theory (76). Returns the largest shear strain that is left; sections stay where that is rounding.
double RestShapeFinder::turn_sections() {
  const MixedVector rows = rows_of(nullptr);
  double left = 0.0;
  for_each_element(model_.structure(), state_, [&](const ElementView& element) {
    const double* row = element.increments_in(rows.interior());
    for (int q = 0; q < element.order(); ++q)
      for (int c = 1; c < 3; ++c) left = std::max(left, std::abs(row[element.layout().force(q) + c]));
  });
  if (left <= kSettledTurn) return left;
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
      turned.push_back(triad_at(element.in(drawn_.views), gauss.xi[q]) * shortest_turn(goal, Vec{{1.0, 0.0, 0.0}}));
    }
    const FittedRotation fit = fit_rotation(element.triad(), turned, gauss.xi, gauss.weight, k);
    store_quaternion(fit.triad, element.triad_numbers());
    for (int j = 1; j < k; ++j) store_vector(fit.psi[j], element.unknowns() + element.layout().relative_rotation(j));
  });
  return left;
}

/// Between the elements of a member, to the mean of both.
void RestShapeFinder::turn_vertices() {
  const Structure& structure = model_.structure();
  const std::set<int> attached = attached_vertices(model_.scene(), model_.mesh());
  std::vector<Vec> turn(structure.local_vertices(), Vec{{0.0, 0.0, 0.0}});
  for_each_element(structure, state_, [&](const ElementView& element) {
    const ElementView before = element.in(drawn_.views);
    for (int end = 0; end < 2; ++end) {
      const Quat triad = triad_at(element, end == 0 ? -1.0 : 1.0), drawn = triad_at(before, end == 0 ? -1.0 : 1.0);
      turn[element.vertex(end)] += 0.5 * log_quaternion(triad * conjugate(drawn));
    }
  });
  for (int v = 0; v < structure.local_vertices(); ++v)
    if (attached.count(structure.local_vertex_to_global[v]) == 0)
      store_quaternion(exp_quaternion(turn[v]), &state_.views.vertex_rotation(v, 0));
}

/// A jump of shear inside a member would be a kink of its rest shape.
void RestShapeFinder::check_inner_points(const InputPlace& place) const {
  const Mesh& mesh = model_.mesh();
  const std::set<int> attached = attached_vertices(model_.scene(), mesh);
  for_each_element(model_.structure(), state_, [&](const ElementView& element) {
    const MeshElement& here = mesh.elements[element.mesh_element()];
    const int last = mesh.elements_of(here.member) - 1;
    for (int end = 0; end < 2; ++end) {
      if (here.index == (end == 0 ? 0 : last) || attached.count(here.vertex[end]) == 0) continue;
      if (norm(end_rotation(element, end) - end_rotation(element.in(drawn_.views), end)) > kNoTurn)
        throw place.error("given, but something acts or holds inside of member \"" +
                          excerpt(model_.scene().members[here.member].name) +
                          "\", whose sections shear turns there; allowed: two members, or \"Shear\" = \"natural\"");
    }
  });
}

void RestShapeFinder::find_turned(bool is_redundant, const InputPlace& place) {
  for (int i = 0; i < kMostTurns; ++i) {
    find_forces(is_redundant);
    if (turn_sections() <= kSettledTurn) return check_inner_points(place);
    turn_vertices();
  }
  throw ConvergenceError(
      "the rest shape: turns of sections by shear do not settle; \"Shear\" = \"natural\" needs none");
}

/// By which a section is turned against its vertex, but for what its drawn shape has.
Vector3 RestShapeFinder::turn_at(const ElementView& element, int end) const {
  const Vec turn = end_rotation(element, end) - end_rotation(element.in(drawn_.views), end);
  return {turn[0], turn[1], turn[2]};
}

FieldTable::Piece RestShapeFinder::piece_of(const ElementView& element, const GaussPoints& gauss) const {
  FieldTable::Piece piece;
  const MeshElement& place = model_.mesh().elements[element.mesh_element()];
  for (const double xi : gauss.xi) piece.s.push_back(model_.mesh().arc_length(place, xi));
  return piece;
}

void RestShapeFinder::add_strains(const ElementView& element, const double* row, bool turns_triads,
                                  NaturalMember& member) const {
  const GaussPoints& gauss = gauss_points(element.order());
  FieldTable::Piece piece = piece_of(element, gauss);
  for (int q = 0; q < element.order(); ++q) {
    const double* strain = row + element.layout().force(q);
    piece.value.push_back({strain[0], turns_triads ? 0.0 : strain[1], turns_triads ? 0.0 : strain[2]});
    member.cut_length += 0.5 * element.length() * gauss.weight[q] * strain[0];
  }
  member.tables[0].pieces.push_back(std::move(piece));
}

void RestShapeFinder::add_curvatures(const ElementView& element, const double* row, bool is_first, bool is_last,
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
        if (is_first) moment -= end_value_of(j, 0) * member.end_turns[0][c];
        if (is_last) moment -= member.end_turns[1][c];
        curvature[c] += (2 * j + 1) / element.length() * P[j] * moment;
      }
  }
  member.tables[1].pieces.push_back(std::move(piece));
}

/// Theory (77), from the rows of N and M that are left.
std::vector<NaturalMember> RestShapeFinder::natural_members(bool turns_triads) const {
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
      if (turns_triads && i == 0) member.end_turns[0] = vector_algebra::scaled(-1.0, turn_at(element, 0));
      if (turns_triads && i == count - 1) member.end_turns[1] = turn_at(element, 1);
      add_strains(element, row, turns_triads, member);
      add_curvatures(element, row, i == 0, i == count - 1, member);
    }
  }
  return all;
}

double largest_of_table(const FieldTable& table) {
  double largest = 0.0;
  for (const FieldTable::Piece& piece : table.pieces)
    for (const Vector3& value : piece.value)
      for (const double component : value) largest = std::max(largest, std::abs(component));
  return largest;
}

/// The drawn state in the structure with its natural strains.
void judge(const Scene& scene, const State& state, const SolverParameters& parameters, const Communicator& comm,
           RestShape& shape) {
  BeamProblem problem(with_rest_shape(scene, shape), comm, parameters);
  MixedVector rows = problem.model.create_vector();
  mixed_residual(problem.model, state, scene.stages, rows);
  shape.residual = rows.maximum_norm();
  if (!(shape.residual <= kAcceptedResidual))
    throw ConvergenceError(
        "the rest shape: no forces of the members balance the loads in the drawn shape (largest "
        "scaled residual " +
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
  RestShape shape;
  shape.stage = stage_of_loads(scene, place);
  RestShapeFinder finder(scene, parameters, comm);
  shape.redundancy = finder.redundancy();
  const bool is_redundant = shape.redundancy > 0;
  if (is_redundant && wanted.loops == LoopForces::refused)
    throw place["Loops"].error("value \"refused\", but equilibrium leaves " + std::to_string(shape.redundancy) +
                               " force(s) or moment(s) of loops free; allowed: \"least energy\", or as many joints");
  wanted.turns_triads ? finder.find_turned(is_redundant, place) : finder.find_forces(is_redundant);
  shape.members = finder.natural_members(wanted.turns_triads);
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

std::vector<NaturalStation> natural_curve(const Scene& scene, const NaturalMember& member, int pieces) {
  const Mesh mesh = build_mesh(scene);
  const MeshMember& drawn = mesh.members[member_index(scene, member.name)];
  const auto curvature = [&](double s) {
    const Vector3 more = member.tables[1].at(s);
    return drawn.curve.curvature(s) + Vec{{more[0], more[1], more[2]}};
  };
  const auto vector = [](const Vector3& v) { return Vec{{v[0], v[1], v[2]}}; };
  const auto plain = [](const Vec& v) { return Vector3{v[0], v[1], v[2]}; };
  NaturalStation here;
  Vec position = drawn.curve.position(0.0);
  Quat triad = drawn.curve.triad(0.0) * exp_quaternion(vector(member.end_turns[0]));
  std::vector<NaturalStation> all;
  const auto add = [&] {
    const Mat axes = rotation_matrix(triad);
    here.position = plain(position);
    for (int i = 0; i < 3; ++i) {
      Vec axis{{0.0, 0.0, 0.0}};
      axis[i] = 1.0;
      here.triad[i] = plain(axes * axis);
    }
    all.push_back(here);
  };
  add();
  constexpr int kStepsOfPiece = 8;  // of fourth order
  const double gauss = std::sqrt(3.0) / 6.0;
  for (int e = 0; e < drawn.elements; ++e)
    for (int p = 0; p < pieces * kStepsOfPiece; ++p) {
      const double h = drawn.element_length(e) / (pieces * kStepsOfPiece), s = drawn.arc_length(e, -1.0) + p * h;
      // Magnus' expansion over a part t of the step, and Simpson's rule for the axis
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
