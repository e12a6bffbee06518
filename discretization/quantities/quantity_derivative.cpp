#include "discretization/quantities/quantity_derivative.hpp"

#include "discretization/state/element_polynomials.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

void add_to(double* row, const Vec& value) {
  for (int i = 0; i < 3; ++i) row[i] += value[i];
}

Quat rotation_of(const State& state, int vertex) { return load_quaternion(&state.views.vertex_rotation(vertex, 0)); }

}  // namespace

StateDerivative::StateDerivative(const Model& model, const State& state)
    : model_(&model),
      state_(&state),
      rows_(model.create_vector()),
      vertex_(rows_.vertex()),
      interior_(rows_.writable_interior(true)) {
  Kokkos::deep_copy(vertex_, 0.0);
  Kokkos::deep_copy(interior_, 0.0);
}

void StateDerivative::add_displacement(int vertex, const Vec& weight) {
  add_to(&vertex_(vertex_row(vertex, kForcePart)), weight);
}

/// d theta = T^-1 times the spin.
void StateDerivative::add_rotation_vector(int vertex, const Vec& weight) {
  const Mat inverse = inverse_tangent_map(log_quaternion(rotation_of(*state_, vertex)));
  add_to(&vertex_(vertex_row(vertex, kMomentPart)), transpose_times(inverse, weight));
}

void StateDerivative::add_triad(int vertex, const Mat& weights) {
  const Mat triad = rotation_matrix(rotation_of(*state_, vertex));
  for (int j = 0; j < 3; ++j) {
    const Vec axis{{triad(0, j), triad(1, j), triad(2, j)}}, weight{{weights(j, 0), weights(j, 1), weights(j, 2)}};
    add_to(&vertex_(vertex_row(vertex, kMomentPart)), cross(axis, weight));
  }
}

void StateDerivative::add_displacement(const PlaceInElement& place, const Vec& weight) {
  const ElementView element = element_at(place);
  double B[kMaximumOrder + 1];
  integrated_legendre(element.order(), place.xi, B);
  add_displacement(element.vertex(0), (0.5 * (1.0 - place.xi)) * weight);
  add_displacement(element.vertex(1), (0.5 * (1.0 + place.xi)) * weight);
  double* rows = element.increments_in(interior_);
  for (int j = 1; j < element.order(); ++j)
    add_to(rows + element.layout().bubble(j), (0.5 * element.length() * B[j]) * weight);
}

/// Theory (9): Lambda_lo (w + T d psi).
void StateDerivative::add_spin(const PlaceInElement& place, const Vec& weight) {
  const ElementView element = element_at(place);
  double P[kMaximumOrder + 1];
  legendre(element.order(), place.xi, P);
  const Vec in_element = transpose_times(rotation_matrix(element.triad()), weight);
  const Vec by_psi = transpose_times(tangent_map(element.relative_rotation_at(P)), in_element);
  double* rows = element.increments_in(interior_);
  add_to(rows + element.layout().spin(), in_element);
  for (int j = 1; j < element.order(); ++j) add_to(rows + element.layout().relative_rotation(j), P[j] * by_psi);
}

void StateDerivative::add_stress(const PlaceInElement& place, const Vec& force, const Vec& moment) {
  const ElementView element = element_at(place);
  double P[kMaximumOrder + 1];
  legendre(element.order(), place.xi, P);
  double* rows = element.increments_in(interior_);
  add_force_derivative(element, place.xi, force, rows);
  for (int j = 0; j <= element.order(); ++j) add_to(rows + element.layout().moment(j), P[j] * moment);
}

void StateDerivative::add_length(int member, double weight) {
  const MeshMember& m = model_->mesh().members[member];
  double xi[kPointsOfLength], gauss[kPointsOfLength];
  gauss_rule(kPointsOfLength, xi, gauss);
  for (int e = 0; e < model_->mesh().elements_of(member); ++e) {
    const ElementView element(model_->structure(), *state_, model_->structure().local_element(m.first_element + e));
    const double h = element.length();
    double* rows = element.increments_in(interior_);
    for (int q = 0; q < kPointsOfLength; ++q) {
      double P[kMaximumOrder + 1];
      legendre(element.order(), xi[q], P);
      Vec slope =
          m.curve.tangent(m.arc_length(e, xi[q])) + (1.0 / h) * (element.displacement(1) - element.displacement(0));
      for (int j = 1; j < element.order(); ++j) slope += P[j] * element.bubble(j);
      const Vec by_slope = (0.5 * h * gauss[q] * weight / norm(slope)) * slope;
      add_displacement(element.vertex(0), (-1.0 / h) * by_slope);
      add_displacement(element.vertex(1), (1.0 / h) * by_slope);
      for (int j = 1; j < element.order(); ++j) add_to(rows + element.layout().bubble(j), P[j] * by_slope);
    }
  }
}

/// Energies of an element are quadratic in its N and M: central differences are exact.
void StateDerivative::add_energy(double force, double moment) {
  force_energy_ += force;
  moment_energy_ += moment;
  for_each_owned_element(model_->structure(), *state_, [&](const ElementView& element) {
    double *rows = element.increments_in(interior_), *numbers = element.unknowns();
    const int moments = element.layout().moment(0), all = element.layout().relative_rotation(1);
    const auto energy_with = [&](int i, double value) {
      const double kept = std::exchange(numbers[i], value);
      const StrainEnergy energy = element_energy(element);
      numbers[i] = kept;
      return force * energy.force + moment * energy.moment;
    };
    for (int i = 0; i < all; ++i) {
      double size = 0.0;
      for (int k = i < moments ? 0 : moments; k < (i < moments ? moments : all); ++k)
        size = std::max(size, std::abs(numbers[k]));
      const double step = size > 0.0 ? size : 1.0, up = numbers[i] + step, down = numbers[i] - step;
      rows[i] += (energy_with(i, up) - energy_with(i, down)) / (up - down);
    }
  });
}

}  // namespace mixbeam
