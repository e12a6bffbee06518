#include "apps/common/studies/element_operations.hpp"
#include "kernels/execution/counted_number.hpp"
#include "kernels/planar/element.hpp"

#include <stdexcept>
#include <string>

namespace mixbeam {

namespace {

/// A straight, stress-free element of length one; what the numbers are makes no difference to the count.
template <int K>
PlanarState<K, CountedNumber> straight_element() {
  PlanarState<K, CountedNumber> state{};
  state.length = 1.0;
  for (int q = 0; q < K; ++q) state.reference_tangent[q] = {1.0, 0.0};
  state.section = {{1.0, 1.0}, {1.0, 1.0}, 1.0, 1.0};
  const PlaneRotor<CountedNumber> rotor{1.0, 0.0}, rotors[2] = {rotor, rotor};
  const Vec2<CountedNumber> displacement[2] = {{0.0, 0.0}, {0.0, 0.0}};
  set_planar_ends(rotor, rotors, rotors, displacement, state);
  return state;
}

template <int K>
long residual_flops(const PlanarTables<K>& tables) {
  return operations_of([&] {
           const auto state = straight_element<K>();
           PlanarGradient<K, CountedNumber> gradient;
           planar_gradient(state, tables, gradient);
         })
      .flops();
}

template <int K>
long tangent_flops(const PlanarTables<K>& tables) {
  return operations_of([&] {
           const auto state = straight_element<K>();
           PlanarSystem<K, CountedNumber> system;
           PlanarPoints<K, CountedNumber> points;
           PlanarSolution<K, CountedNumber> solution;
           CountedNumber moment_row[K + 1], angle[K], end_moment[2], tangent[kPlanarTangent], gradient[4];
           CountedNumber response[PlanarRows<K>::kCount][kPlanarColumns];
           planar_system<K, CountedNumber>(state, tables, nullptr, moment_row, points, system);
           solve_planar(state.length, system, solution);
           columns_to_plane(state, solution);
           planar_response(state, tables, points, moment_row, solution, response);
           planar_moment_gradient<K>(state.moment, angle, end_moment);
           planar_condensed(state, solution, end_moment, tangent, gradient);
         })
      .flops();
}

template <int K>
ElementOperations operations_of_order(int order) {
  if (order == K) {
    const PlanarTables<K> tables;
    constexpr double recovery = 2.0 * PlanarRows<K>::kCount * (kPlanarColumns - 1);  // a product and a sum for each
    return {static_cast<double>(residual_flops<K>(tables)), static_cast<double>(tangent_flops<K>(tables)), recovery};
  }
  if constexpr (K < kMaximumOrder)
    return operations_of_order<K + 1>(order);
  else
    throw std::invalid_argument("element order " + std::to_string(order));
}

}  // namespace

ElementOperations planar_operations(int order) { return operations_of_order<1>(order); }

}  // namespace mixbeam
