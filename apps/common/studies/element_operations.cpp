#include "apps/common/studies/element_operations.hpp"

#include "kernels/execution/counted_number.hpp"
#include "kernels/loops/recovery.hpp"

#include <stdexcept>
#include <string>

namespace mixbeam {

/// Nowhere: what is written is not asked for.
template <>
struct ElementRows<CountedNumber> {
  void store(int, int, const CountedNumber*) const {}
};

namespace {

/// A straight, stress-free element of length one; what the numbers are makes no difference to the count.
template <int K>
struct CountedElement {
  InteriorLayout layout{K, K};
  ReferenceLayout reference_layout{K, K};
  CountedNumber interior[InteriorLayout{K, K}.unknowns()], reference[ReferenceLayout{K, K}.size()];
  SectionNumbers<CountedNumber> section;
  ElementInput<CountedNumber> in;

  CountedElement() {
    reference[reference_layout.length()] = 1.0;
    for (int end = 0; end < 2; ++end) {
      reference[reference_layout.end_triad(end)] = 1.0;
      in.vertex_rotation[end] = identity_quaternion<CountedNumber>();
    }
    for (int q = 0; q < K; ++q) reference[reference_layout.tangent(q)] = 1.0;
    for (int i = 0; i < 3; ++i)
      section.force_compliance[i] = section.tangent_force_stiffness[i] = section.moment_stiffness[i] =
          section.moment_compliance[i] = 1.0;
    in.triad = identity_quaternion<CountedNumber>();
    in.interior = interior;
    in.reference = reference;
  }
  ElementGather<K, false> gather() const {
    ElementBlock block;
    block.order = K;
    block.interior = layout;
    block.reference_layout = reference_layout;
    return ElementGather<K, false>(block, StructureViews(), StateViews());
  }
};

template <int K>
OperationCount residual_operations(const CountedElement<K>& element, const ElementGather<K, false>& gather) {
  return operations_of([&] {
    const ElementKinematics<K, CountedNumber> kinematics(element.in, element.layout);
    ElementGradient<K, CountedNumber> gradient;
    element_gradient(element.in, kinematics, gather.tables, element.layout, element.reference_layout, element.section,
                     gradient);
    CountedNumber interior_row[InteriorLayout{K, K}.increments()], vertex_row[12];
    store_residual(gradient, kinematics, element.layout, interior_row, vertex_row);
  });
}

template <int K>
OperationCount tangent_operations(const CountedElement<K>& element, const ElementGather<K, false>& gather) {
  return operations_of([&] {
    const ElementKinematics<K, CountedNumber> kinematics(element.in, element.layout);
    CondensedElement<K, false, CountedNumber> condensed;
    clear(condensed.gradient);
    condensed.build(gather, element.in, kinematics, element.section, true);
    solve_in_lanes(condensed.system, condensed.response, condensed.condensed);
    condensed.store_response(gather, kinematics, element.section, ElementRows<CountedNumber>());
    CountedNumber tangent[kSymmetricTangent], residual[12];
    symmetric_tangent(condensed.condensed.matrix, kinematics.triad, kinematics.length, tangent);
    store_condensed_residual(condensed.condensed, condensed.gradient, kinematics, residual);
  });
}

template <int K>
OperationCount recovery_operations(const CountedElement<K>& element, const ElementGather<K, false>& gather) {
  return operations_of([&] {
    const ElementKinematics<K, CountedNumber> kinematics(element.in, element.layout);
    const Vec3<CountedNumber> change{};
    auto d = RecoverLoop<K, false>::reduced(kinematics, change, change, change, change);
    const CountedNumber response[ResponseLayout{K, K}.size()];
    CountedNumber increments[InteriorLayout{K, K}.increments()];
    recover_element(element.in, kinematics, gather.tables, element.layout, element.reference_layout, d, response,
                    increments);
  });
}

template <int K>
ElementOperations operations_of_order(int order) {
  if (order == K) {
    const CountedElement<K> element;
    const auto gather = element.gather();
    return {static_cast<double>(residual_operations(element, gather).flops()),
            static_cast<double>(tangent_operations(element, gather).flops()),
            static_cast<double>(recovery_operations(element, gather).flops())};
  }
  if constexpr (K < kMaximumOrder)
    return operations_of_order<K + 1>(order);
  else
    throw std::invalid_argument("element order " + std::to_string(order));
}

}  // namespace

ElementOperations element_operations(int order) { return operations_of_order<1>(order); }

}  // namespace mixbeam
