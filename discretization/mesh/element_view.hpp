/// Access to the data of an element on the host: its fields, its vertices, its offsets in all arrays. Use no other.
#pragma once

#include "discretization/mesh/communicator.hpp"
#include "discretization/mesh/structure.hpp"

namespace mixbeam {

/// Local element, with the numbers of a state if one is given. Vectors are in the frames of theory (8).
class ElementView {
 public:
  ElementView(const Structure& structure, const ElementBlock& block, int e, const StateViews* state = nullptr)
      : structure_(&structure), block_(&block), state_(state), e_(e) {}
  /// Views a local element.
  ElementView(const Structure& structure, const State& state, int local)
      : ElementView(structure, structure.block_of(local), 0, &state.views) {
    e_ = local - block_->first_element;
  }

  /// Views the same element in another state.
  ElementView in(const StateViews& state) const { return {*structure_, *block_, e_, &state}; }

  const ElementBlock& block() const { return *block_; }
  const InteriorLayout& layout() const { return block_->interior; }
  int index() const { return e_; }  ///< in its block
  int local() const { return block_->first_element + e_; }
  int mesh_element() const { return structure_->local_element_to_mesh[local()]; }
  int order() const { return block_->order; }
  int vertex(int end) const { return block_->vertices(e_, end); }  ///< local
  /// True if this rank counts it in sums: it starts at one of the rank's vertices.
  bool is_owned() const { return vertex(0) < structure_->owned_vertices; }
  double length() const { return *reference(block_->reference_layout.length()); }
  const double* reference(int offset) const { return &block_->reference(e_, offset); }
  const SectionConstants& section() const { return structure_->views.sections(block_->section(e_)); }

  /// Its interior unknowns in the state.
  double* unknowns() const { return state_->interior.data() + block_->unknowns_at()(e_); }
  /// Its part of an array of increments or interior rows.
  template <class View>
  auto* increments_in(const View& array) const {
    return array.data() + block_->increments_at()(e_);
  }

  Vec displacement(int end) const { return load_vector(&state_->vertex_displacement(vertex(end), 0)); }
  double* triad_numbers() const { return &state_->element_triad(local(), 0); }
  Quat triad() const { return load_quaternion(triad_numbers()); }  ///< Lambda_lo
  /// Lambda_V Lambda_0 at one end.
  Quat end_triad(int end) const {
    return load_quaternion(&state_->vertex_rotation(vertex(end), 0)) *
           load_quaternion(reference(block_->reference_layout.end_triad(end)));
  }
  Vec force(int q) const { return load_vector(unknowns() + layout().force(q)); }    ///< N_q, material
  Vec moment(int j) const { return load_vector(unknowns() + layout().moment(j)); }  ///< M_j, material
  Vec bubble(int j) const { return load_vector(unknowns() + layout().bubble(j)); }  ///< beta_j, spatial
  Vec relative_rotation(int j) const { return load_vector(unknowns() + layout().relative_rotation(j)); }  ///< psi_j

  /// M and psi at a point with Legendre values P.
  Vec moment_at(const double* P) const {
    Vec sum{{0.0, 0.0, 0.0}};
    for (int j = 0; j <= order(); ++j) sum += P[j] * moment(j);
    return sum;
  }
  Vec relative_rotation_at(const double* P) const {
    Vec sum{{0.0, 0.0, 0.0}};
    for (int j = 1; j < order(); ++j) sum += P[j] * relative_rotation(j);
    return sum;
  }

 private:
  const Structure* structure_;
  const ElementBlock* block_;
  const StateViews* state_;
  int e_;
};

/// Calls action(first point, points, first component, end) for each Gauss rule and the components of N on it: the axial
/// one, then the two shear ones, on the same points if both parts use one rule.
template <class Action>
void for_each_force_rule(int order, ForceIntegration integration, const Action& action) {
  const int axial = axial_points(order, integration), shear = shear_points(order, integration);
  action(0, axial, 0, 1);
  action(axial == shear ? 0 : axial, shear, 1, 3);
}

/// Calls action(ElementView) for every element of this rank, in a fixed order.
template <class Action>
void for_each_element(const Structure& structure, const StateViews* state, const Action& action) {
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count; ++e) action(ElementView(structure, block, e, state));
}
template <class Action>
void for_each_element(const Structure& structure, const Action& action) {
  for_each_element(structure, nullptr, action);
}
template <class Action>
void for_each_element(const Structure& structure, const State& state, const Action& action) {
  for_each_element(structure, &state.views, action);
}

/// Visits elements on all threads: actions must be independent.
template <class Action>
void for_each_element_on_threads(const char* label, const Structure& structure, const StateViews& state,
                                 const Action& action) {
  for (const ElementBlock& block : structure.blocks)
    Kokkos::parallel_for(label, Kokkos::RangePolicy<ExecutionSpace>(0, block.count),
                         [&](int e) { action(ElementView(structure, block, e, &state)); });
}

/// Visits the elements owned by this rank: each element of the mesh on exactly one rank.
template <class Action>
void for_each_owned_element(const Structure& structure, const State& state, const Action& action) {
  for_each_element(structure, state, [&](const ElementView& element) {
    if (element.is_owned()) action(element);
  });
}

}  // namespace mixbeam
