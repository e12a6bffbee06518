#include "discretization/quantities/quantity_derivative.hpp"

#include "discretization/state/element_polynomials.hpp"
#include "kernels/element/section.hpp"

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

void StateDerivative::add_energy(double force, double moment) {
  force_energy_ += force;
  moment_energy_ += moment;
  for_each_owned_element(model_->structure(), *state_, [&](const ElementView& element) {
    double* rows = element.increments_in(interior_);
    if (element.block().general_section)
      add_general_energy_of(element, force, moment, rows);
    else
      add_energy_of(element, force, moment, rows);
  });
}

void StateDerivative::add_energy_of(const ElementView& element, double force, double moment, double* rows) const {
  const SectionConstants& section = element.section();
  const double h = element.length();
  for_each_force_rule(element.order(), element.block().force_integration, [&](int first, int count, int from, int to) {
    double points[kMaximumOrder + 1], weights[kMaximumOrder + 1];
    gauss_rule(count, points, weights);
    for (int q = 0; q < count; ++q)
      for (int i = from; i < to; ++i)
        rows[element.layout().force(first + q) + i] +=
            force * 0.5 * h * weights[q] * section.force_compliance[i] * element.force(first + q)[i];
  });
  for (int j = 0; j <= element.order(); ++j)
    for (int i = 0; i < 3; ++i)
      rows[element.layout().moment(j) + i] +=
          moment * h / (2 * j + 1) * section.moment_compliance[i] * element.moment(j)[i];
}

/// Each of the two energies has half of what couples them.
void StateDerivative::add_general_energy_of(const ElementView& element, double force, double moment,
                                            double* rows) const {
  const int k = element.order(), n = element.layout().force_points;
  const GeneralSection<> section{&element.block().compliance(element.index(), 0), {k, n}, 0.0, 0.0};
  double points[kMaximumOrder + 1], weights[kMaximumOrder + 1], P[kMaximumOrder + 1];
  const double half = 0.5 * element.length(), coupled = 0.5 * (force + moment);
  gauss_rule(n, points, weights);
  for (int q = 0; q < n; ++q) {
    legendre(k, points[q], P);
    const Vec present = element.force(q);
    const Mat coupling = section.force_moment(q);
    add_to(rows + element.layout().force(q), (half * weights[q]) * (force * (section.force_force(q) * present) +
                                                                    coupled * (coupling * element.moment_at(P))));
    for (int j = 0; j <= k; ++j)
      add_to(rows + element.layout().moment(j),
             (half * weights[q] * coupled * P[j]) * transpose_times(coupling, present));
  }
  gauss_rule(k + 1, points, weights);
  for (int q = 0; q <= k; ++q) {
    legendre(k, points[q], P);
    const Vec strain = section.moment_moment(q) * element.moment_at(P);
    for (int j = 0; j <= k; ++j)
      add_to(rows + element.layout().moment(j), (half * weights[q] * moment * P[j]) * strain);
  }
}

}  // namespace mixbeam
