#include "kernels/element_block.hpp"

#include "kernels/element_kinematics.hpp"
#include "kernels/element_softening.hpp"
#include "kernels/element_tangent.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace mixbeam {

template <int K, bool General>
void residual_loop(const ElementBlock&, const StructureViews&, const StateViews&, const ElementEquations&);
template <int K, bool General>
void tangent_loop(const ElementBlock&, const StructureViews&, const StateViews&, const KernelView<const double*>&,
                  const ElementEquations&);
template <int K, bool General>
void recover_loop(const ElementBlock&, const StateViews&, const ElementEquations&, const KernelView<const double* [6]>&,
                  const KernelView<double*>&);

namespace {

/// Calls action(std::integral_constant<int, K>) for the block's order: the one place where a run-time order meets
/// compile-time sizes.
template <class Action, int K = 1>
void for_order(int order, Action&& action) {
  if (order == K) return action(std::integral_constant<int, K>());
  if constexpr (K < kMaximumOrder)
    for_order<Action, K + 1>(order, std::forward<Action>(action));
  else
    throw std::invalid_argument("element order " + std::to_string(order) + " is outside 1.." +
                                std::to_string(kMaximumOrder));
}

/// for_order with the kind of section as well: action(order, std::bool_constant<General>).
template <class Action>
void for_kind(const ElementBlock& block, Action&& action) {
  for_order(block.order, [&](auto order) {
    if (block.general_section)
      action(order, std::true_type());
    else
      action(order, std::false_type());
  });
}

struct ApplyLoop {
  KernelView<const double* [4]> from_triad;
  KernelView<const double*> from_interior, increment;
  KernelView<double* [4]> to_triad;
  KernelView<double*> to_interior;
  double scale;
  int first_element, unknowns;
  size_t interior_offset, increment_offset;

  KOKKOS_INLINE_FUNCTION void operator()(int e) const {
    const double* d = increment.data() + increment_offset + static_cast<size_t>(e) * (unknowns + 3);
    const double* x = from_interior.data() + interior_offset + static_cast<size_t>(e) * unknowns;
    double* y = to_interior.data() + interior_offset + static_cast<size_t>(e) * unknowns;
    for (int i = 0; i < unknowns; ++i) y[i] = x[i] + scale * d[i];
    const Quat turn = exp_quaternion(scale * load_vector(d + unknowns));
    const Quat triad = load_quaternion(&from_triad(first_element + e, 0));
    store_quaternion(normalized(triad * turn), &to_triad(first_element + e, 0));
  }
};

}  // namespace

void evaluate_residual(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                       const ElementEquations& equations) {
  for_kind(block, [&](auto order, auto general) {
    residual_loop<order.value, general.value>(block, structure, state, equations);
  });
}

void evaluate_tangent(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                      const ElementEquations& equations) {
  condense_right_hand_side(block, structure, state, KernelView<const double*>(), equations);
}

void condense_right_hand_side(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                              const KernelView<const double*>& rhs_interior, const ElementEquations& equations) {
  for_kind(block, [&](auto order, auto general) {
    tangent_loop<order.value, general.value>(block, structure, state, rhs_interior, equations);
  });
}

void softening_rows(const ElementBlock& block, const StructureViews& structure,
                    const KernelView<const double*>& increment, const KernelView<double*>& rows) {
  for_kind(block, [&](auto order, auto general) {
    const SofteningLoop<order.value, general.value> loop{block, structure, increment, rows};
    Kokkos::parallel_for("mixbeam::elements::softening", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), loop);
  });
}

void recover_interior(const ElementBlock& block, const StateViews& state, const ElementEquations& equations,
                      const KernelView<const double* [6]>& vertex_increment, const KernelView<double*>& increment) {
  for_kind(block, [&](auto order, auto general) {
    recover_loop<order.value, general.value>(block, state, equations, vertex_increment, increment);
  });
}

void apply_interior_increment(const ElementBlock& block, const StateViews& from,
                              const KernelView<const double*>& increment, double scale, const StateViews& to) {
  const ApplyLoop loop{from.element_triad,
                       from.interior,
                       increment,
                       to.element_triad,
                       to.interior,
                       scale,
                       block.first_element,
                       block.interior.unknowns(),
                       block.interior_offset,
                       block.increment_offset};
  Kokkos::parallel_for("mixbeam::elements::apply", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), loop);
}

}  // namespace mixbeam
