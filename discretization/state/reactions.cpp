#include "discretization/state/reactions.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/state/structure_parts.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>

namespace mixbeam {

namespace {

using namespace vector_algebra;

/// A force and a moment, the moment about some fixed point.
struct Wrench {
  Vec force{}, moment{};
  void add(const Vec& f, const Vec& m, const Vec& arm) {
    force += f;
    moment += m + cross(arm, f);
  }
};

using Rows = KernelView<const double*>;

Vec vector_at(const Rows& rows, size_t first) { return load_vector(&rows(first)); }

/// Turns the rows of the elements into those that supports balance: adds loads, and slaves to their masters.
void leave_to_supports(const Model& model, const State& state, double load_factor, const KernelView<double*>& rows) {
  for (const auto& energy : model.external())
    if (!energy->is_support()) energy->add_rows(state, load_factor, rows);
  for (const VertexJoint& joint : model.conditions().joints) join_rows(joint, state, rows);
}

SpatialLoad reaction_of(const VertexSupport& support, const State& state, const KernelView<double*>& rows) {
  return support_reaction(support, state, rows_of(rows, support.vertex, kForcePart),
                          rows_of(rows, support.vertex, kMomentPart));
}

/// Reactions from the rows that supports balance.
std::vector<Reaction> reactions_in(const Model& model, const State& state, const KernelView<double*>& rows) {
  const std::vector<Support>& supports = model.scene().supports;
  std::vector<double> all(6 * supports.size(), 0.0);
  for (const VertexSupport& support : model.conditions().supports) {
    const SpatialLoad reaction = reaction_of(support, state, rows);
    store_vector(reaction.force, &all[6 * support.index]);
    store_vector(reaction.moment, &all[6 * support.index + 3]);
  }
  sum_over_ranks(*model.map()->getComm(), all.data(), all.size());
  std::vector<Reaction> result;
  for (size_t i = 0; i < supports.size(); ++i) {
    const double* values = &all[6 * i];
    result.push_back({supports[i].point, {values[0], values[1], values[2]}, {values[3], values[4], values[5]}});
  }
  return result;
}

/// Reference tangents of an element as a polynomial of degree k - 1 whose mean is the chord between the vertices: the
/// part that the displacements of the element can reproduce in a rigid rotation of the vertices.
struct TangentPolynomial {
  Vec coefficient[kMaximumOrder];  ///< of the Legendre polynomials

  TangentPolynomial(const ElementView& element, const Vec& chord) {
    const ElementBlock& block = element.block();
    const int points = axial_points(block.order, block.force_integration);
    const double h = element.length();
    double xi[kMaximumOrder + 1], weight[kMaximumOrder + 1], P[kMaximumOrder + 1];
    gauss_rule(points, xi, weight);
    coefficient[0] = (1.0 / h) * chord;
    for (int j = 1; j < block.order; ++j) coefficient[j] = Vec{{0.0, 0.0, 0.0}};
    for (int q = 0; q < points; ++q) {
      legendre(block.order, xi[q], P);
      const Vec tangent = load_vector(element.reference(block.reference_layout.tangent(q)));
      for (int j = 1; j < block.order; ++j) coefficient[j] += (0.5 * (2 * j + 1) * weight[q] * P[j]) * tangent;
    }
  }
  Vec at(int order, const double* P) const {
    Vec value{{0.0, 0.0, 0.0}};
    for (int j = 0; j < order; ++j) value += P[j] * coefficient[j];
    return value;
  }
};

Vec chord_of(const Mesh& mesh, const MeshElement& element) {
  return to_vec3(mesh.vertex_position[element.vertex[1]]) - to_vec3(mesh.vertex_position[element.vertex[0]]);
}

/// Data of an element for the two sums below.
struct TurnedElement {
  const ElementView& view;
  const ElementBlock& block;
  TangentPolynomial tangent;

  TurnedElement(const ElementView& element, const Mesh& mesh)
      : view(element),
        block(element.block()),
        tangent(element, chord_of(mesh, mesh.elements[element.mesh_element()])) {}

  /// Moment of the spatial forces n at the Gauss points about the difference between the reference tangent and the
  /// polynomial: see Balance::curve_moment.
  Vec curve_moment() const {
    Vec sum{{0.0, 0.0, 0.0}};
    const int axial = axial_points(block.order, block.force_integration);
    add_curve_moment(0, axial, sum);
    if (block.interior.force_points > axial) add_curve_moment(axial, block.interior.force_points - axial, sum);
    return sum;
  }

  /// Virtual work of line loads in the motion of the element interior under a rigid rotation: `rows` is the
  /// contribution of the loads to the rows of this element.
  Vec moment_of_interior_load(const double* rows) const {
    Vec sum = -(rotation_matrix(view.triad()) * load_vector(rows + block.interior.spin()));
    for (int j = 1; j < block.order; ++j)
      sum += -cross(tangent.coefficient[j] + view.bubble(j), load_vector(rows + block.interior.bubble(j)));
    return sum;
  }

 private:
  void add_curve_moment(int first, int count, Vec& sum) const {
    double xi[kMaximumOrder + 1], weight[kMaximumOrder + 1], P[kMaximumOrder + 1];
    gauss_rule(count, xi, weight);
    for (int q = 0; q < count; ++q) {
      legendre(block.order, xi[q], P);
      const Vec force =
          rotation_matrix(view.triad() * exp_quaternion(view.relative_rotation_at(P))) * view.force(first + q);
      const Vec here = load_vector(view.reference(block.reference_layout.tangent(first + q)));
      sum += (0.5 * view.length() * weight[q]) * cross(tangent.at(block.order, P) - here, force);
    }
  }
};

/// Sums over one part of a structure.
struct PartSums {
  Box box{};  ///< around it, undeformed
  Wrench applied{}, reactions{};
  Vec curve_moment{};
  double largest_force = 0.0, largest_moment = 0.0;
  Vec center() const { return 0.5 * to_vec3(sum(box.low, box.high)); }
};

/// Sums of the balance on one rank, part by part.
class BalanceSums {
 public:
  /// Without `parts` the structure is one part. `reactions`: null if not needed.
  BalanceSums(const Model& model, const State& state, double load_factor, const StructureParts& parts,
              std::vector<Reaction>* reactions = nullptr)
      : model_(model), state_(state), load_factor_(load_factor), parts_(parts), sums_(parts.count) {
    find_boxes();
    MixedVector rows = model.create_vector();
    element_rows(model, state, load_factor, ElementLoads::with_centrifugal, rows);
    if (model.line_fields().has_loads() || model.rotating() != nullptr) add_line_loads(rows);
    leave_to_supports(model, state, load_factor, rows.vertex());
    if (reactions != nullptr) *reactions = reactions_in(model, state, rows.vertex());
    add_point_loads();
    for (const VertexSupport& support : model.conditions().supports)
      add(&PartSums::reactions, support.vertex, reaction_of(support, state, rows.vertex()));
    for_each_owned_element(model.structure(), state, [&](const ElementView& element) {
      part_of(element).curve_moment += TurnedElement(element, model.mesh()).curve_moment();
    });
  }

  Balance over_all_ranks() const;
  /// Balance of one part, `scales` its own. One rank only.
  Balance of_part(int part, const ResidualScales& scales) const;

 private:
  void find_boxes() {
    if (parts_.of_vertex.empty()) {
      sums_[0].box = model_.mesh().box;
      return;
    }
    const Share<Vector3>& position = model_.mesh().vertex_position;
    for (std::size_t v = 0; v < position.size(); ++v) sums_[parts_.of_vertex[v]].box.enclose(position[v]);
  }
  PartSums& part_at(int vertex) { return sums_[parts_.of_vertex.empty() ? 0 : parts_.of_vertex[vertex]]; }
  PartSums& part_of(const ElementView& element) {
    return sums_[parts_.of_element.empty() ? 0 : parts_.of_element[element.local()]];
  }
  Vec arm(int vertex, const PartSums& part) const {
    const int global = model_.structure().local_vertex_to_global[vertex];
    // far from the origin positions hold fewer digits of displacements: the similar ones are subtracted first
    return (to_vec3(model_.mesh().vertex_position[global]) - part.center()) +
           load_vector(&state_.views.vertex_displacement(vertex, 0));
  }
  void add(Wrench PartSums::*sum, int vertex, const SpatialLoad& load) {
    PartSums& part = part_at(vertex);
    const Vec lever = arm(vertex, part);
    (part.*sum).add(load.force, load.moment, lever);
    part.largest_force = std::max(part.largest_force, norm(load.force));
    part.largest_moment = std::max({part.largest_moment, norm(load.moment), norm(cross(lever, load.force))});
  }
  void add_point_loads() {
    for (const auto& energy : model_.external())
      if (!energy->is_support())
        energy->forces(state_, load_factor_,
                       [this](int vertex, const SpatialLoad& load) { add(&PartSums::applied, vertex, load); });
  }
  void add_line_loads(const MixedVector& loaded) {
    MixedVector difference = model_.create_vector();
    element_rows(model_, state_, load_factor_, ElementLoads::none, difference);
    difference.update(1.0, loaded, -1.0);
    const Rows rows = difference.vertex(), interior = difference.interior();
    for (int v = 0; v < model_.structure().owned_vertices; ++v) {
      const size_t first = static_cast<size_t>(kVertexDofs) * v;
      PartSums& part = part_at(v);
      part.applied.add(-vector_at(rows, first), -vector_at(rows, first + 3), arm(v, part));
    }
    for_each_owned_element(model_.structure(), state_, [&](const ElementView& element) {
      part_of(element).applied.moment +=
          TurnedElement(element, model_.mesh()).moment_of_interior_load(element.increments_in(interior));
    });
  }

  const Model& model_;
  const State& state_;
  double load_factor_;
  const StructureParts& parts_;
  std::vector<PartSums> sums_;
};

/// `force`, `moment`: largest in the structure. A force also counts as a moment, by the length of the structure: force
/// rows in equilibrium to 1e-11 leave as much of a moment, however small the moments are.
Balance to_balance(const Vec& center, const Wrench& applied, const Wrench& reactions, const Vec& curve, double force,
                   double moment) {
  Balance result;
  result.center = to_array(center);
  result.applied_force = to_array(applied.force);
  result.applied_moment = to_array(applied.moment);
  result.reaction_force = to_array(reactions.force);
  result.reaction_moment = to_array(reactions.moment);
  result.force_error = norm(applied.force + reactions.force) / force;
  result.moment_error = norm(applied.moment + reactions.moment - curve) / moment;
  result.curve_moment = norm(curve) / moment;
  return result;
}

Balance BalanceSums::of_part(int part, const ResidualScales& scales) const {
  const PartSums& sums = sums_[part];
  return to_balance(sums.center(), sums.applied, sums.reactions, sums.curve_moment,
                    std::max(sums.largest_force, scales.force),
                    std::max({sums.largest_moment, scales.moment, scales.force * scales.length}));
}

Balance BalanceSums::over_all_ranks() const {
  const Teuchos::Comm<int>& comm = *model_.map()->getComm();
  const PartSums& sums = sums_.front();
  std::array<double, 15> all{};
  const Vec parts[5] = {sums.applied.force, sums.applied.moment, sums.reactions.force, sums.reactions.moment,
                        sums.curve_moment};
  for (int part = 0; part < 5; ++part) store_vector(parts[part], &all[3 * part]);
  sum_over_ranks(comm, all.data(), all.size());
  // internal forces count too: prescribed motions leave no load, and internal forces may cancel in the supports
  const ResidualScales scales = scales_of(model_, state_, load_factor_);
  const double force = maximum_over_ranks(comm, std::max(sums.largest_force, scales.force));
  const double moment =
      maximum_over_ranks(comm, std::max({sums.largest_moment, scales.moment, scales.force * scales.length}));
  return to_balance(sums.center(), {load_vector(&all[0]), load_vector(&all[3])},
                    {load_vector(&all[6]), load_vector(&all[9])}, load_vector(&all[12]), force, moment);
}

}  // namespace

std::vector<Reaction> reactions(const Model& model, const State& state, double load_factor) {
  MixedVector rows = model.create_vector();
  element_rows(model, state, load_factor, ElementLoads::with_centrifugal, rows);
  leave_to_supports(model, state, load_factor, rows.vertex());
  return reactions_in(model, state, rows.vertex());
}

std::vector<Balance> balance_of_parts(const Model& model, const State& state, double load_factor,
                                      const StructureParts& parts, const std::vector<ResidualScales>& scales) {
  const BalanceSums sums(model, state, load_factor, parts);
  std::vector<Balance> result;
  result.reserve(scales.size());
  for (int part = 0; part < parts.count; ++part) result.push_back(sums.of_part(part, scales[part]));
  return result;
}

Balance balance(const Model& model, const State& state, double load_factor, std::vector<Reaction>* reactions) {
  return BalanceSums(model, state, load_factor, {}, reactions).over_all_ranks();
}

}  // namespace mixbeam
