/// The derivative of a quantity with respect to the unknowns of a state: the right-hand side of its adjoint, theory
/// (80).
#pragma once

#include "discretization/mesh/element_view.hpp"
#include "discretization/state/sampling.hpp"

#include <vector>

namespace mixbeam {

/// force . f + moment . m of the spatial rows f, m of a vertex that its support holds: these rows are not unknowns, and
/// their derivative is that of the equations.
struct HeldRows {
  int vertex = 0;  ///< local
  Vec force{}, moment{};
};

/// Sum of derivatives of quantities. One process only; the model and the state must outlive it.
class StateDerivative {
 public:
  StateDerivative(const Model& model, const State& state);

  const Model& model() const { return *model_; }
  /// By the increments of a state, theory (34): spatial displacement and spin of vertices; N, M, psi, beta and w.
  const MixedVector& rows() const { return rows_; }
  const std::vector<HeldRows>& held() const { return held_; }

  /// Each adds the derivative of weight . quantity, at a local vertex.
  void add_displacement(int vertex, const Vec& weight);
  void add_rotation_vector(int vertex, const Vec& weight);
  /// `weights`: rows of g1, g2, g3 of the rotation of the vertex.
  void add_triad(int vertex, const Mat& weights);
  void add_held(const HeldRows& held) { held_.push_back(held); }
  void add_rows(const MixedVector& rows) { rows_.update(1.0, rows, 1.0); }

  /// Adds the derivative of weight . displacement at a place in an element.
  void add_displacement(const PlaceInElement& place, const Vec& weight);
  /// Adds the derivative of weight . spin of Lambda_E, spatial.
  void add_spin(const PlaceInElement& place, const Vec& weight);
  /// Adds the derivative of force . N + moment . M, material.
  void add_stress(const PlaceInElement& place, const Vec& force, const Vec& moment);

  /// Adds that of the length of a member.
  void add_length(int member, double weight);
  /// Adds those of the energies of N and of M.
  void add_energy(double force, double moment);
  double force_energy() const { return force_energy_; }
  double moment_energy() const { return moment_energy_; }
  /// Notes that compliances enter the quantity besides the state, other than through energies.
  void know_compliance() { knows_compliance_ = true; }
  bool knows_compliance() const { return knows_compliance_; }
  /// Notes that the quantity depends on a natural frequency, whose derivative is not included.
  void know_mode(int mode) { modes_.push_back(mode); }
  const std::vector<int>& modes() const { return modes_; }

 private:
  ElementView element_at(const PlaceInElement& place) const {
    return {model_->structure(), *state_, place.local_element};
  }

  const Model* model_;
  const State* state_;
  MixedVector rows_;
  std::vector<HeldRows> held_{};
  double force_energy_ = 0.0, moment_energy_ = 0.0;  ///< weights
  bool knows_compliance_ = false;
  std::vector<int> modes_{};
  KernelView<double*> vertex_, interior_;  ///< of rows_
};

}  // namespace mixbeam
