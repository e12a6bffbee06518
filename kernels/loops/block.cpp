#include "kernels/loops/block.hpp"

#include "kernels/condensation/tangent.hpp"
#include "kernels/element/kinematics.hpp"
#include "kernels/loops/cap_compliance.hpp"
#include "kernels/loops/dispatch.hpp"

namespace mixbeam {

template <int K, bool General, int W>
void residual_loop(const ElementBlock&, const StructureViews&, const StateViews&, const ElementEquations&);
template <int K, bool General, int W>
void tangent_loop(const ElementBlock&, const StructureViews&, const StateViews&, const KernelView<const double*>&,
                  const ElementEquations&);
template <int K, bool General, int W>
void recover_loop(const ElementBlock&, const StateViews&, const ElementEquations&, const KernelView<const double* [6]>&,
                  const KernelView<double*>&);

namespace {

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

}  // namespace

void evaluate_residual(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                       const ElementEquations& equations) {
  for_kind(block, [&](auto order, auto general) {
    residual_loop<order.value, general.value, kLanes>(block, structure, state, equations);
  });
}

void evaluate_tangent(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                      const ElementEquations& equations) {
  condense_right_hand_side(block, structure, state, KernelView<const double*>(), equations);
}

void condense_right_hand_side(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                              const KernelView<const double*>& rhs_interior, const ElementEquations& equations) {
  for_kind(block, [&](auto order, auto general) {
    tangent_loop<order.value, general.value, kLanes>(block, structure, state, rhs_interior, equations);
  });
}

void cap_compliance_rows(const ElementBlock& block, const StructureViews& structure,
                         const KernelView<const double*>& increment, const KernelView<double*>& rows) {
  for_kind(block, [&](auto order, auto general) {
    const CapComplianceLoop<order.value, general.value> loop{block, structure, increment, rows};
    Kokkos::parallel_for("mixbeam::elements::cap_compliance", Kokkos::RangePolicy<ExecutionSpace>(0, block.count),
                         loop);
  });
}

double largest_cap_row(const ElementBlock& block, const StructureViews& structure,
                       const KernelView<const double*>& increment, const ResidualScales& scales) {
  double largest = 0.0;
  for_kind(block, [&](auto order, auto general) {
    const LargestCapRowLoop<order.value, general.value> loop{{block, structure, increment, KernelView<double*>()},
                                                             scales};
    Kokkos::parallel_reduce("mixbeam::elements::largest_cap_row", Kokkos::RangePolicy<ExecutionSpace>(0, block.count),
                            loop, Kokkos::Max<double>(largest));
  });
  return largest;
}

void recover_interior(const ElementBlock& block, const StateViews& state, const ElementEquations& equations,
                      const KernelView<const double* [6]>& vertex_increment, const KernelView<double*>& increment) {
  for_kind(block, [&](auto order, auto general) {
    recover_loop<order.value, general.value, kLanes>(block, state, equations, vertex_increment, increment);
  });
}

}  // namespace mixbeam
