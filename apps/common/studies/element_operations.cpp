#include "apps/common/studies/element_operations.hpp"

#include "kernels/loops/dispatch.hpp"
#include "kernels/loops/planar_loops.hpp"
#include "kernels/loops/recovery.hpp"
#include "kernels/loops/residual.hpp"
#include "kernels/loops/tangent.hpp"

namespace mixbeam {

namespace {

constexpr int kCounted = 0;  ///< lanes of a CountedNumber

/// A straight, stress-free element of length one along x; what the numbers are makes no difference to the count.
struct CountedElement {
  ElementBlock block;
  StructureViews structure{KernelView<SectionConstants*>("section", 1)};
  StateViews state;
  ElementEquations equations;
  KernelView<double* [6]> vertex_increment { "vertex_increment", 2 };
  KernelView<double*> increment;
  PlanarBlock planar;
  PlanarTangents planar_tangents{"planar_tangents", 1};

  explicit CountedElement(int order) : increment("increment", InteriorLayout{order, order}.increments()) {
    block.order = order;
    block.count = 1;
    block.interior = {order, order};
    block.reference_layout = {order, order};
    block.reference = KernelView<double**>("reference", 1, block.reference_layout.size());
    block.vertices = KernelView<int* [2]>("vertices", 1);
    block.vertices(0, 1) = 1;
    block.member = KernelView<int*>("member", 1);
    block.reference(0, block.reference_layout.length()) = 1.0;
    for (int end = 0; end < 2; ++end) block.reference(0, block.reference_layout.end_triad(end)) = 1.0;
    for (int q = 0; q < order; ++q) block.reference(0, block.reference_layout.tangent(q)) = 1.0;
    Kokkos::deep_copy(structure.member_section, ones());
    state = {KernelView<double* [3]>("displacement", 2), KernelView<double* [4]>("rotation", 2),
             KernelView<double* [4]>("triad", 1), KernelView<double*>("interior", block.interior.unknowns())};
    state.vertex_rotation(0, 0) = state.vertex_rotation(1, 0) = state.element_triad(0, 0) = 1.0;
    equations.residual = equations.condensed_residual = KernelView<double* [12]>("residual", 1);
    equations.planar_rows = KernelView<double* [4]>("planar_rows", 1);
    equations.interior_residual = increment;
    equations.condensed_tangent = KernelView<double**>("tangent", 1, kSymmetricTangent);
    equations.response = KernelView<double*>("response", block.response_size());
    equations.largest_end_angle = KernelView<double*>("end_angle", 1);
    planar = make_planar_block(block, {{{1.0, 0.0, 0.0}}, {{0.0, 1.0, 0.0}}, {{0.0, 0.0, 1.0}}}, 1);
  }

 private:
  static SectionConstants ones() {
    SectionConstants section{};
    for (int i = 0; i < SectionConstants::kCount; ++i) section.numbers()[i] = 1.0;
    return section;
  }
};

template <class Loop>
double flops_of(const Loop& loop) {
  return static_cast<double>(operations_of([&] { loop(0); }).flops());
}

template <int K>
ElementOperations operations_in_space(const CountedElement& e) {
  const ElementGather<K, false, kCounted> gather(e.block, e.structure, e.state);
  const size_t offset = e.block.response_offset;
  const int size = e.block.response_size();
  return {flops_of(ResidualLoop<K, false, kCounted>{gather, e.equations}),
          flops_of(TangentLoop<K, false, kCounted>{gather, e.equations, {}, offset, size}),
          flops_of(RecoverLoop<K, false, kCounted>{gather, e.equations.response, e.vertex_increment, e.increment,
                                                   offset, size})};
}

template <int K>
ElementOperations operations_in_plane(const CountedElement& e) {
  const PlanarGather<K, kCounted> gather(e.block, e.planar, e.structure, e.state);
  return {flops_of(PlanarResidualLoop<K, kCounted>{gather, e.equations}),
          flops_of(PlanarTangentLoop<K, kCounted>{gather, e.planar_tangents, e.equations.planar_rows, {}}),
          flops_of(PlanarRecoverLoop<K, kCounted>{e.planar, e.block, e.vertex_increment, e.increment})};
}

}  // namespace

ElementOperations element_operations(int order) {
  ElementOperations result{};
  for_order(order, [&](auto k) { result = operations_in_space<k.value>(CountedElement(order)); });
  return result;
}

ElementOperations planar_operations(int order) {
  ElementOperations result{};
  for_order(order, [&](auto k) { result = operations_in_plane<k.value>(CountedElement(order)); });
  return result;
}

}  // namespace mixbeam
